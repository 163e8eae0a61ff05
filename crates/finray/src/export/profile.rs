//! The profile of a finger as an SVG of its true size, and as a DXF for CAD.

use super::rings;
use crate::geometry::Geometry;
use input::units::MM;
use maud::html;
use std::fmt::Write;

/// SVG of the profile, one unit a millimetre, its front side above: for laser cutters and drawings.
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

/// Path data of the rings, their points (mm; X from the tip, Y from the front side) moved by `to`.
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

/// DXF (R12, for every program) of the outline and the openings as polylines on two layers, mm.
pub fn dxf(geometry: &Geometry, title: &str) -> String {
    let mut out = pairs(&[
        ("999", &format!("finger-opt: {title}; mm")),
        ("0", "SECTION"),
        ("2", "HEADER"),
        ("9", "$ACADVER"),
        ("1", "AC1009"),
        // Millimetres, metric.
        ("9", "$INSUNITS"),
        ("70", "4"),
        ("9", "$MEASUREMENT"),
        ("70", "1"),
        ("0", "ENDSEC"),
        ("0", "SECTION"),
        ("2", "ENTITIES"),
    ]);
    for (i, ring) in rings(geometry).iter().enumerate() {
        let layer = if i == 0 { "OUTLINE" } else { "OPENINGS" };
        // 66: vertices follow; 70: closed.
        out += &pairs(&[("0", "POLYLINE"), ("8", layer), ("66", "1"), ("70", "1")]);
        out += &pairs(&[("10", "0.0"), ("20", "0.0"), ("30", "0.0")]);
        for point in ring {
            let [x, y] = [point.x, point.y].map(|value| format!("{value:.6}"));
            out += &pairs(&[("0", "VERTEX"), ("8", layer), ("10", &x), ("20", &y), ("30", "0.0")]);
        }
        out += &pairs(&[("0", "SEQEND"), ("8", layer)]);
    }
    out + &pairs(&[("0", "ENDSEC"), ("0", "EOF")])
}

/// Group codes and their values, one a line.
fn pairs(groups: &[(&str, &str)]) -> String {
    groups.iter().fold(String::new(), |mut out, (code, value)| {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{code:>3}\n{value}");
        out
    })
}
