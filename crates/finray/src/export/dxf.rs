//! DXF of the profile, for CAD: the R12 form, which every program reads.

use super::rings;
use crate::geometry::Geometry;
use std::fmt::Write;

/// The profile as closed polylines, mm: the outline on one layer, the openings on another.
pub fn write(geometry: &Geometry, title: &str) -> String {
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
        for [x, y] in ring {
            let (x, y) = (format!("{x:.6}"), format!("{y:.6}"));
            out += &pairs(&[("0", "VERTEX"), ("8", layer), ("10", &x), ("20", &y), ("30", "0.0")]);
        }
        out += &pairs(&[("0", "SEQEND"), ("8", layer)]);
    }
    out + &pairs(&[("0", "ENDSEC"), ("0", "EOF")])
}

/// Group codes and their values, a line each.
fn pairs(groups: &[(&str, &str)]) -> String {
    groups.iter().fold(String::new(), |mut out, (code, value)| {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{code:>3}\n{value}");
        out
    })
}
