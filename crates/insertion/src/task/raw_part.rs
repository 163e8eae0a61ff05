//! Parts of a task file, and their conversion to solids.

use super::edges::{self, Cut, Edge};
use super::geometry::{self, Axis, Part, Solid};
use input::units::{self, MM, read::mm};
use input::{Check, InputError};
use nalgebra::{Point3, Vector3};
use serde::Deserialize;

/// Part of a plug or socket in a task file; lengths in m.
#[derive(Deserialize)]
#[serde(tag = "shape", rename_all = "kebab-case", deny_unknown_fields)]
pub enum RawPart {
    Box {
        name: String,
        #[serde(rename = "x_mm", deserialize_with = "mm")]
        x: [f64; 2],
        #[serde(rename = "y_mm", deserialize_with = "mm")]
        y: [f64; 2],
        #[serde(rename = "z_mm", deserialize_with = "mm")]
        z: [f64; 2],
        #[serde(default)]
        edges: Vec<RawEdges>,
        friction: Option<f64>,
    },
    Cylinder {
        name: String,
        #[serde(rename = "centre_mm", deserialize_with = "mm")]
        centre: [f64; 2],
        #[serde(rename = "diameter_mm", deserialize_with = "mm")]
        diameter: f64,
        #[serde(rename = "z_mm", deserialize_with = "mm")]
        z: [f64; 2],
        friction: Option<f64>,
    },
    Prism {
        name: String,
        axis: Axis,
        #[serde(rename = "outline_mm", deserialize_with = "mm")]
        outline: Vec<[f64; 2]>,
        #[serde(rename = "span_mm", deserialize_with = "mm")]
        span: [f64; 2],
        friction: Option<f64>,
    },
    Hull {
        name: String,
        #[serde(rename = "points_mm", deserialize_with = "mm")]
        points: Vec<[f64; 3]>,
        friction: Option<f64>,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawEdges {
    at: String,
    #[serde(rename = "chamfer_mm", default, deserialize_with = "mm")]
    chamfer: Option<f64>,
    #[serde(rename = "radius_mm", default, deserialize_with = "mm")]
    radius: Option<f64>,
}

/// Largest number of parts of a plug or a socket; a trial computes contacts only of parts near one another.
pub const MAX_PARTS: usize = 3000;
const MAX_CORNERS: usize = 256;
/// Smallest extent of a part or an opening, m.
pub const MIN_EXTENT: f64 = 1e-3 * MM;

/// Converts and checks the parts under a key.
pub fn parts(check: Check<'_>, key: &str, parts: Vec<RawPart>) -> Result<Vec<Part>, InputError> {
    if !(1..=MAX_PARTS).contains(&parts.len()) {
        let problem = format!("there are {}; there must be 1 to {MAX_PARTS}", parts.len());
        return check.fail(key, problem);
    }
    parts.into_iter().map(|raw| part(check, key, raw)).collect()
}

fn part(check: Check<'_>, key: &str, part: RawPart) -> Result<Part, InputError> {
    let (RawPart::Box { name, friction, .. }
    | RawPart::Cylinder { name, friction, .. }
    | RawPart::Prism { name, friction, .. }
    | RawPart::Hull { name, friction, .. }) = &part;
    let (name, friction) = (name.clone(), *friction);
    let at = |field: &str| format!("{key} \"{name}\" {field}");
    let solid = match part {
        RawPart::Box { x, y, z, edges, .. } => {
            for (field, range) in [("x_mm", x), ("y_mm", y), ("z_mm", z)] {
                interval(check, &at(field), range)?;
            }
            let corners = [0, 1].map(|end| Vector3::new(x[end], y[end], z[end]));
            with_cut_edges(check, &at("edges"), corners, &edges)?
        }
        RawPart::Cylinder { centre, diameter, z, .. } => {
            let z = interval(check, &at("z_mm"), z)?;
            Solid::Cylinder { centre, radius: diameter / 2.0, z }
        }
        RawPart::Prism { axis, outline, span, .. } => {
            check_outline(check, &at("outline_mm"), &outline)?;
            let span = interval(check, &at("span_mm"), span)?;
            Solid::Prism { axis: axis as usize, outline, span }
        }
        RawPart::Hull { points, .. } => {
            let points: Vec<_> = points.into_iter().map(Point3::from).collect();
            // Only the corners of the hull remain.
            let Some((points, _)) = geometry::hull(&points) else {
                let problem = "lie in a plane; a hull needs at least four points that do not";
                return check.fail(&at("points_mm"), problem);
            };
            Solid::Hull { points }
        }
    };
    Ok(Part { name, solid, friction })
}

/// Returns an interval, m, after checking that it is not too narrow.
pub fn interval(check: Check<'_>, key: &str, range: [f64; 2]) -> Result<[f64; 2], InputError> {
    if range[1] - range[0] < MIN_EXTENT {
        let [a, b] = range.map(units::mm);
        let problem = format!("is [{a}, {b}]; the second must exceed the first by 0.001 mm");
        return check.fail(key, problem);
    }
    Ok(range)
}

/// Checks that an outline is strictly convex: every turn is to the same side.
fn check_outline(check: Check<'_>, key: &str, outline: &[[f64; 2]]) -> Result<(), InputError> {
    let n = outline.len();
    if !(3..=MAX_CORNERS).contains(&n) {
        return check.fail(key, format!("has {n} corners; it must have 3 to {MAX_CORNERS}"));
    }
    let turn = |i: usize| {
        let [a, b, c] = [0, 1, 2].map(|next| outline[(i + next) % n].map(|v| v / MM));
        (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
    };
    if (0..n).all(|i| turn(i) > 1e-9) || (0..n).all(|i| turn(i) < -1e-9) {
        return Ok(());
    }
    check.fail(key, "is not convex; split the part into convex parts")
}

/// Returns a box with these corners and cut edges.
fn with_cut_edges(
    check: Check<'_>,
    key: &str,
    [min, max]: [Vector3<f64>; 2],
    edges: &[RawEdges],
) -> Result<Solid, InputError> {
    let mut cuts: Vec<(Edge, Cut)> = Vec::new();
    for RawEdges { at, chamfer, radius } in edges {
        let Some(named) = edges::named(at) else {
            let problem = format!(
                "unknown edge {at:?}; give a face, as in \"-z\", for its four edges, or two faces, as in \
                 \"+x-z\", for the edge between them"
            );
            return check.fail(key, problem);
        };
        let cut = match (chamfer, radius) {
            (Some(leg), None) => Cut::Chamfer(*leg),
            (None, Some(radius)) => Cut::Radius(*radius),
            _ => return check.fail(key, "give either chamfer_mm or radius_mm"),
        };
        for edge in named {
            if edges::cut_at(&cuts, edge).is_some() {
                return check.fail(key, format!("at = {at:?} repeats an edge"));
            }
            cuts.push((edge, cut));
        }
    }
    if cuts.is_empty() {
        return Ok(Solid::Box { min, max });
    }
    edges::cut([&min, &max], &cuts).or_else(|problem| check.fail(key, problem))
}
