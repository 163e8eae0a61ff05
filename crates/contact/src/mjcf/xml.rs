//! XML of a model: elements with attributes, indented.

use std::fmt::Display;

/// Element with its attributes and children.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Element {
    name: &'static str,
    attributes: String,
    children: Vec<Element>,
}

impl Element {
    /// Creates an element without attributes and children.
    pub fn new(name: &'static str) -> Self {
        Element { name, attributes: String::new(), children: Vec::new() }
    }

    /// Adds an attribute.
    pub fn with(mut self, name: &'static str, value: impl Display) -> Self {
        let value = value.to_string().replace('&', "&amp;").replace('"', "&quot;");
        let value = value.replace('<', "&lt;").replace('>', "&gt;");
        self.attributes += &format!(" {name}=\"{value}\"");
        self
    }

    /// Adds an attribute of numbers, separated by spaces.
    pub fn numbers(self, name: &'static str, values: impl IntoIterator<Item = f64>) -> Self {
        let words: Vec<String> = values.into_iter().map(|value| value.to_string()).collect();
        self.with(name, words.join(" "))
    }

    /// Adds children.
    pub fn with_children(mut self, children: impl IntoIterator<Item = Element>) -> Self {
        self.children.extend(children);
        self
    }

    /// Returns the text, indented by `depth` levels.
    pub fn text(&self, depth: usize) -> String {
        let (Element { name, attributes, children }, indent) = (self, "  ".repeat(depth));
        if children.is_empty() {
            return format!("{indent}<{name}{attributes}/>\n");
        }
        let inside: String = children.iter().map(|child| child.text(depth + 1)).collect();
        format!("{indent}<{name}{attributes}>\n{inside}{indent}</{name}>\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_nest_and_values_are_escaped() {
        let inner = Element::new("b").numbers("pos", [0.5, -1e-3, 0.0]);
        let outer = Element::new("a").with("name", "x<\"&\">").with_children([inner]);
        let expected =
            "<a name=\"x&lt;&quot;&amp;&quot;&gt;\">\n  <b pos=\"0.5 -0.001 0\"/>\n</a>\n";
        assert_eq!(outer.text(0), expected);
    }
}
