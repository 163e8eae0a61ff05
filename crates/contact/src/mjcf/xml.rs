//! XML of a model: elements with attributes, indented.

use std::fmt::{Display, Write};

/// Element with its attributes and children.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Element>,
}

impl Element {
    /// Element without attributes and children.
    pub fn new(name: &'static str) -> Self {
        Element { name, attributes: Vec::new(), children: Vec::new() }
    }

    /// Adds an attribute.
    pub fn with(mut self, name: &'static str, value: impl Display) -> Self {
        self.attributes.push((name, value.to_string()));
        self
    }

    /// Adds an attribute of numbers, separated by blanks.
    pub fn numbers(self, name: &'static str, values: impl IntoIterator<Item = f64>) -> Self {
        let words: Vec<String> = values.into_iter().map(|value| value.to_string()).collect();
        self.with(name, words.join(" "))
    }

    /// Adds children.
    pub fn holding(mut self, children: impl IntoIterator<Item = Element>) -> Self {
        self.children.extend(children);
        self
    }

    /// Appends the element as text, indented by `depth` levels.
    pub fn write(&self, depth: usize, out: &mut String) {
        let indent = "  ".repeat(depth);
        // Writing to a string cannot fail.
        let _ = write!(out, "{indent}<{}", self.name);
        for (name, value) in &self.attributes {
            let _ = write!(out, " {name}=\"{}\"", escape(value));
        }
        if self.children.is_empty() {
            out.push_str("/>\n");
            return;
        }
        out.push_str(">\n");
        for child in &self.children {
            child.write(depth + 1, out);
        }
        let _ = writeln!(out, "{indent}</{}>", self.name);
    }
}

fn escape(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    text.replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_nest_and_values_are_escaped() {
        let inner = Element::new("b").numbers("pos", [0.5, -1e-3, 0.0]);
        let outer = Element::new("a").with("name", "x<\"&\">").holding([inner]);
        let mut text = String::new();
        outer.write(0, &mut text);
        let expected =
            "<a name=\"x&lt;&quot;&amp;&quot;&gt;\">\n  <b pos=\"0.5 -0.001 0\"/>\n</a>\n";
        assert_eq!(text, expected);
    }
}
