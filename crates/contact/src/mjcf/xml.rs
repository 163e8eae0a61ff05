//! As much of XML as a model needs: elements with attributes, indented.

use std::fmt::{Display, Write};

/// An element and what it holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Element>,
}

impl Element {
    /// Without attributes and empty.
    pub fn new(name: &'static str) -> Self {
        Element { name, attributes: Vec::new(), children: Vec::new() }
    }

    /// The same with an attribute more.
    pub fn with(mut self, name: &'static str, value: impl Display) -> Self {
        self.attributes.push((name, value.to_string()));
        self
    }

    /// The same with numbers as an attribute, apart by blanks.
    pub fn numbers(self, name: &'static str, values: impl IntoIterator<Item = f64>) -> Self {
        let words: Vec<String> = values.into_iter().map(|value| value.to_string()).collect();
        self.with(name, words.join(" "))
    }

    /// The same with elements inside.
    pub fn holding(mut self, children: impl IntoIterator<Item = Element>) -> Self {
        self.children.extend(children);
        self
    }

    /// The element as text, indented by `depth` levels.
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
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            c => safe.push(c),
        }
    }
    safe
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
