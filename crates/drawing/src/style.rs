//! Styles of shapes and text.

use std::fmt::{Display, Formatter, Result};

/// Fill and line of a shape.
#[derive(Debug, Clone, Copy)]
pub struct Style {
    fill: &'static str,
    opacity: f64,
    stroke: &'static str,
    width: f64,
    dashed: bool,
}

impl Style {
    /// Returns a fill of a colour (`#33507a`) without a line.
    pub const fn fill(colour: &'static str) -> Self {
        Style { fill: colour, opacity: 1.0, stroke: "none", width: 0.0, dashed: false }
    }

    /// Returns a line of a colour and width without a fill.
    pub const fn line(colour: &'static str, width: f64) -> Self {
        Style::fill("none").outlined(colour, width)
    }

    /// Returns the style with a line of a colour and width.
    pub const fn outlined(self, colour: &'static str, width: f64) -> Self {
        Style { stroke: colour, width, ..self }
    }

    /// Returns the style with an opacity of the fill, 0 to 1.
    pub const fn opacity(self, opacity: f64) -> Self {
        Style { opacity, ..self }
    }

    /// Returns the style with a dashed line: dashes of 5, gaps of 3 line widths.
    pub const fn dashed(self) -> Self {
        Style { dashed: true, ..self }
    }
}

impl Display for Style {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, " fill=\"{}\"", self.fill)?;
        if self.opacity < 1.0 {
            write!(f, " fill-opacity=\"{}\"", self.opacity)?;
        }
        if self.width > 0.0 {
            write!(f, " stroke=\"{}\" stroke-width=\"{}\"", self.stroke, self.width)?;
        }
        if self.dashed {
            let [dash, gap] = [5.0, 3.0].map(|widths| super::rounded(widths * self.width));
            write!(f, " stroke-dasharray=\"{dash} {gap}\"")?;
        }
        Ok(())
    }
}

/// Size, colour and alignment of text; the size is in units of the drawing.
#[derive(Debug, Clone, Copy)]
pub struct Font {
    size: f64,
    colour: &'static str,
    anchor: &'static str,
    bold: bool,
}

impl Font {
    /// Returns a dark grey font of a size, whose text starts at its point.
    pub const fn new(size: f64) -> Self {
        Font { size, colour: "#222", anchor: "start", bold: false }
    }

    /// Returns the font in a colour.
    pub const fn colour(self, colour: &'static str) -> Self {
        Font { colour, ..self }
    }

    /// Returns the font with text centred on its point.
    pub const fn middle(self) -> Self {
        Font { anchor: "middle", ..self }
    }

    /// Returns the font with text that ends at its point.
    pub const fn end(self) -> Self {
        Font { anchor: "end", ..self }
    }

    /// Returns the font in bold.
    pub const fn bold(self) -> Self {
        Font { bold: true, ..self }
    }

    /// Returns the font, reduced if necessary to fit a text into a width, but not below the size `least`.
    pub fn fitting(self, words: &str, width: f64, least: f64) -> Self {
        // Assumed mean width of a character: 0.52 of the size.
        let fits = width / (0.52 * words.chars().count() as f64);
        Font { size: self.size.min(fits.max(least)), ..self }
    }
}

impl Display for Font {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, " font-size=\"{}\" fill=\"{}\"", super::rounded(self.size), self.colour)?;
        if self.anchor != "start" {
            write!(f, " text-anchor=\"{}\"", self.anchor)?;
        }
        if self.bold { f.write_str(" font-weight=\"bold\"") } else { Ok(()) }
    }
}
