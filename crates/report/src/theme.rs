//! Colours: fixed in SVG files, variables in the page, which may be light or dark.

use plotters::style::RGBColor;

/// Colour for light and for dark pages, with the name of its CSS variable.
#[derive(Debug, Clone, Copy)]
pub(super) struct Colour {
    name: &'static str,
    /// For light pages and for plots in files.
    pub rgb: RGBColor,
    /// For dark pages, `#RRGGBB`.
    dark: &'static str,
}

macro_rules! colours {
    ($($id:ident = $name:literal, ($($rgb:literal),*), $dark:literal;)*) => {
        $(pub(super) const $id: Colour =
            Colour { name: $name, rgb: RGBColor($($rgb),*), dark: $dark };)*
        const ALL: &[Colour] = &[$($id),*];
    };
}

colours! {
    PAPER = "paper", (254, 254, 253), "#15181c";
    INK = "ink", (31, 35, 40), "#e6e8eb";
    MUTED = "muted", (96, 103, 112), "#9aa3ad";
    LINES = "lines", (222, 225, 230), "#30363d";
    BLUE = "blue", (24, 103, 178), "#6cb2f2";
    ORANGE = "orange", (178, 78, 12), "#f0a060";
    GREEN = "green", (38, 132, 82), "#62c894";
    RED = "red", (190, 50, 44), "#f2837b";
    // Outcomes (LOST_EARLY: contact lost before the search, LOST: in the insertion), distinguishable for all readers:
    // the lightness L* of the failures is at least 25 below that of insertion, and with deuteranopia (Machado et al.
    // 2009) any two differ by a CIEDE2000 distance of at least 15.
    INSERTED = "inserted", (206, 239, 210), "#CEEFD2";
    LOST_EARLY = "lost-early", (59, 41, 102), "#4B357F";
    MISSED = "missed", (63, 105, 213), "#3F69D5";
    JAMMED = "jammed", (207, 122, 17), "#CF7A11";
    LOST = "lost", (162, 32, 42), "#A2202A";
    DIVERGED = "diverged", (139, 145, 153), "#8B9199";
}

impl Colour {
    /// Returns the colour for plots in files as `#RRGGBB`, the format of the drawing library.
    pub fn hex(self) -> String {
        format!("#{:02X}{:02X}{:02X}", self.rgb.0, self.rgb.1, self.rgb.2)
    }
}

/// Returns the colours of light or dark pages as CSS variables, the body of a rule.
pub(super) fn variables(dark: bool) -> String {
    let value = |c: &Colour| if dark { c.dark.to_owned() } else { c.hex() };
    ALL.iter().map(|c| format!("--{}:{};", c.name, value(c))).collect()
}

/// Converts an SVG for the page: replaces colours by CSS variables and removes the size.
pub(super) fn inline(svg: &str) -> String {
    let variable = |svg: String, colour: &Colour| {
        svg.replace(&colour.hex(), &format!("var(--{})", colour.name))
    };
    let svg = ALL.iter().fold(svg.to_owned(), variable);
    let view_box = svg.find("viewBox").unwrap_or(0);
    // HTML implies the namespace.
    format!("<svg {}", svg[view_box..].replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1))
}
