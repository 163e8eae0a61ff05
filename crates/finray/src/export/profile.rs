//! The profile of a finger, drawn, and as a DXF for CAD.

use super::rings;
use crate::geometry::Geometry;
use drawing::{Drawing, Style, View};
use std::fmt::Write;

/// Draws the profile in a view in mm.
pub(super) fn profile(drawing: &mut Drawing, geometry: &Geometry, view: View, style: Style) {
    let ring = |ring: Vec<[f64; 2]>| ring.into_iter().map(move |point| view.place(point.into()));
    drawing.rings(geometry.rings_mm().into_iter().map(ring), style);
}

/// Returns a DXF (R12, which every CAD program reads) of the outline and the openings as polylines on two layers, mm.
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

/// Formats group codes and their values, each on its own line.
fn pairs(groups: &[(&str, &str)]) -> String {
    groups.iter().fold(String::new(), |mut out, (code, value)| {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{code:>3}\n{value}");
        out
    })
}
