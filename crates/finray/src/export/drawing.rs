//! The profile as an SVG of its true size.

use crate::geometry::Geometry;
use input::units::MM;
use maud::html;
use std::fmt::Write;

/// The profile, one unit a millimetre, its front above: for laser cutters and drawings.
pub fn svg(geometry: &Geometry, title: &str) -> String {
    let outline = &geometry.finger.outline;
    let (length, width) = (outline.length / MM, outline.width / MM);
    let svg = html! {
        svg xmlns="http://www.w3.org/2000/svg" width={ (length) "mm" } height={ (width) "mm" }
            viewBox={ "0 0 " (length) " " (width) } {
            title { (title) }
            path d=(path(geometry, |[x, y]| [x, -y])) fill="#33507a" fill-rule="evenodd" {}
        }
    };
    svg.into_string() + "\n"
}

/// The rings as path data, their points (mm; X from the tip, Y from the front) moved by `to`.
pub(super) fn path(geometry: &Geometry, to: impl Fn([f64; 2]) -> [f64; 2]) -> String {
    let mut out = String::new();
    for ring in geometry.rings_mm() {
        for (i, point) in ring.into_iter().enumerate() {
            let [x, y] = to(point);
            // Writing to a string cannot fail.
            let _ = write!(out, "{}{x:.3},{y:.3}", if i == 0 { 'M' } else { 'L' });
        }
        out.push('Z');
    }
    out
}
