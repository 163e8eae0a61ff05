//! Technical drawings as SVG: shapes, text and dimensions on a plane whose y axis points down.

mod dimension;
mod style;

pub use style::{Font, Style};

use nalgebra::{Point2, Vector2};

/// Placement of a view on the drawing.
#[derive(Debug, Clone, Copy)]
pub struct View {
    /// Position of the view's origin on the drawing.
    pub origin: Point2<f64>,
    /// Units of the drawing per unit of the view.
    pub scale: f64,
}

impl View {
    /// Converts a point of the view, whose y axis points up, to a point of the drawing.
    pub fn place(&self, point: Point2<f64>) -> Point2<f64> {
        self.origin + self.scale * Vector2::new(point.x, -point.y)
    }
}

/// Drawing: a list of SVG elements, of which later ones cover earlier ones.
#[derive(Debug, Default)]
pub struct Drawing {
    elements: String,
}

impl Drawing {
    /// Returns the drawing as a stand-alone SVG of a width and height. If `unit` (`mm`) is not empty, it is printed at
    /// this size; otherwise the viewer chooses the size.
    pub fn svg(self, [width, height]: [f64; 2], unit: &str) -> String {
        let [wide, high] = [width, height].map(rounded);
        let size = format!(" width=\"{wide}{unit}\" height=\"{high}{unit}\"");
        let size = if unit.is_empty() { "" } else { &size };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\"{size} viewBox=\"0 0 {wide} {high}\" \
             font-family=\"sans-serif\" fill-rule=\"evenodd\">\n{}</svg>\n",
            self.elements
        )
    }

    /// Fills the background with white.
    pub fn white_background(&mut self) {
        self.element("<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>");
    }

    /// Draws a group of elements with a class for style sheets.
    pub fn group(&mut self, class: &str, draw: impl FnOnce(&mut Self)) {
        self.element(&format!("<g class=\"{class}\">"));
        draw(self);
        self.element("</g>");
    }

    /// Draws a panel with a border, at which the elements in it are clipped; their origin is the panel's upper left
    /// corner.
    pub fn panel(&mut self, corner: Point2<f64>, size: [f64; 2], draw: impl FnOnce(&mut Self)) {
        let [x, y, width, height] = [corner.x, corner.y, size[0], size[1]].map(rounded);
        self.element(&format!("<svg x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\">"));
        self.element("<rect width=\"100%\" height=\"100%\" fill=\"none\" stroke=\"#ccc\"/>");
        draw(self);
        self.element("</svg>");
    }

    /// Writes a text at a point.
    pub fn text(&mut self, at: Point2<f64>, words: &str, font: Font) {
        let [x, y] = [at.x, at.y].map(rounded);
        self.element(&format!("<text x=\"{x}\" y=\"{y}\"{font}>{}</text>", escape(words)));
    }

    /// Draws a line through points.
    pub fn line(&mut self, points: impl IntoIterator<Item = Point2<f64>>, style: Style) {
        self.path(&path(points), style);
    }

    /// Draws a closed shape.
    pub fn polygon(&mut self, points: impl IntoIterator<Item = Point2<f64>>, style: Style) {
        self.rings([points], style);
    }

    /// Draws closed rings as one shape: a ring inside another is a hole.
    pub fn rings<R>(&mut self, rings: impl IntoIterator<Item = R>, style: Style)
    where
        R: IntoIterator<Item = Point2<f64>>,
    {
        let closed = rings.into_iter().map(|ring| path(ring) + "Z");
        self.path(&closed.collect::<String>(), style);
    }

    /// Draws a rectangle between two opposite corners, rounded by a radius.
    pub fn rectangle(&mut self, [a, b]: [Point2<f64>; 2], radius: f64, style: Style) {
        let (corner, size) = (a.inf(&b), (b - a).abs());
        let [x, y, width, height, radius] =
            [corner.x, corner.y, size.x, size.y, radius].map(rounded);
        self.element(&format!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" rx=\"{radius}\"{style}/>"
        ));
    }

    /// Draws a disc.
    pub fn disc(&mut self, at: Point2<f64>, radius: f64, style: Style) {
        let [x, y, radius] = [at.x, at.y, radius].map(rounded);
        self.element(&format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{style}/>"));
    }

    fn path(&mut self, data: &str, style: Style) {
        self.element(&format!("<path d=\"{data}\"{style}/>"));
    }

    fn element(&mut self, text: &str) {
        self.elements += text;
        self.elements.push('\n');
    }
}

/// Returns the path data of a line through points.
fn path(points: impl IntoIterator<Item = Point2<f64>>) -> String {
    let step = |(i, point): (usize, Point2<f64>)| {
        let [x, y] = [point.x, point.y].map(rounded);
        format!("{}{x},{y}", if i == 0 { 'M' } else { 'L' })
    };
    points.into_iter().enumerate().map(step).collect()
}

/// Rounds to three decimals, finer than the eye can resolve; adding 0 turns -0 into 0.
fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3 + 0.0
}

/// Escapes a text for XML.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_rounded_and_words_escaped() {
        let mut drawing = Drawing::default();
        let view = View { origin: Point2::new(1.0, 2.0), scale: 3.0 };
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0 / 3.0]].map(Point2::from);
        drawing.polygon(corners.map(|point| view.place(point)), Style::fill("#abc"));
        drawing.text(Point2::new(-1e-9, 5.0), "a <b> & c", Font::new(3.0).middle());
        let svg = drawing.svg([10.0, 20.5], "mm");
        assert!(svg.contains("<path d=\"M1,2L4,2L1,1Z\" fill=\"#abc\""), "{svg}");
        assert!(svg.contains("<text x=\"0\" y=\"5\"") && svg.contains("a &lt;b&gt; &amp; c"));
        assert!(svg.contains("width=\"10mm\" height=\"20.5mm\" viewBox=\"0 0 10 20.5\""));
    }

    #[test]
    fn a_rectangle_is_the_same_from_each_corner() {
        let drawn = |a: [f64; 2], b: [f64; 2]| {
            let mut drawing = Drawing::default();
            drawing.rectangle([a, b].map(Point2::from), 0.0, Style::line("#000", 1.0));
            drawing.elements
        };
        assert_eq!(drawn([1.0, 2.0], [4.0, 9.0]), drawn([4.0, 2.0], [1.0, 9.0]));
        assert!(drawn([1.0, 9.0], [4.0, 2.0]).contains("y=\"2\" width=\"3\" height=\"7\""));
    }
}
