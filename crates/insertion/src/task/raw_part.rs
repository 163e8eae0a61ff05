//! Parts as written, and the checks that turn them into solids.

use super::edges::{self, Cut, Edge};
use super::geometry::{self, Axis, Part, Solid};
use super::quantity::{coefficient, size, span};
use input::units::MM;
use input::{Check, InputError};
use nalgebra::{Point3, Vector3};
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(tag = "shape", rename_all = "kebab-case", deny_unknown_fields)]
pub enum RawPart {
    Box {
        name: String,
        x_mm: [f64; 2],
        y_mm: [f64; 2],
        z_mm: [f64; 2],
        #[serde(default)]
        edges: Vec<RawEdges>,
        friction: Option<f64>,
    },
    Cylinder {
        name: String,
        centre_mm: [f64; 2],
        diameter_mm: f64,
        z_mm: [f64; 2],
        friction: Option<f64>,
    },
    Prism {
        name: String,
        axis: Axis,
        outline_mm: Vec<[f64; 2]>,
        span_mm: [f64; 2],
        friction: Option<f64>,
    },
    Hull {
        name: String,
        points_mm: Vec<[f64; 3]>,
        friction: Option<f64>,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawEdges {
    at: String,
    chamfer_mm: Option<f64>,
    radius_mm: Option<f64>,
}

/// Most parts of a plug or a socket: what a collision costs grows with their product.
const MOST_PARTS: usize = 200;
const MOST_CORNERS: usize = 256;

pub fn parts(check: Check<'_>, key: &str, parts: &[RawPart]) -> Result<Vec<Part>, InputError> {
    if parts.is_empty() {
        return check.fail(key, "needs at least one part");
    }
    if parts.len() > MOST_PARTS {
        let count = parts.len();
        return check.fail(key, format!("are {count}; there may be {MOST_PARTS}"));
    }
    parts.iter().map(|raw| part(check, key, raw)).collect()
}

fn part(check: Check<'_>, key: &str, part: &RawPart) -> Result<Part, InputError> {
    let (name, friction) = match part {
        RawPart::Box { name, friction, .. }
        | RawPart::Cylinder { name, friction, .. }
        | RawPart::Prism { name, friction, .. }
        | RawPart::Hull { name, friction, .. } => (name, *friction),
    };
    let at = |field: &str| format!("{key} \"{name}\" {field}");
    let solid = match part {
        RawPart::Box { x_mm, y_mm, z_mm, edges, .. } => {
            let x = span(check, &at("x_mm"), *x_mm)?;
            let y = span(check, &at("y_mm"), *y_mm)?;
            let z = span(check, &at("z_mm"), *z_mm)?;
            let corners = [0, 1].map(|end| Vector3::new(x[end], y[end], z[end]));
            without_edges(check, &at("edges"), corners, edges)?
        }
        RawPart::Cylinder { centre_mm, diameter_mm, z_mm, .. } => Solid::Cylinder {
            centre: check.each(&at("centre_mm"), *centre_mm, Check::distance)?.map(|v| v * MM),
            radius: size(check, &at("diameter_mm"), *diameter_mm)? / 2.0,
            z: span(check, &at("z_mm"), *z_mm)?,
        },
        RawPart::Prism { axis, outline_mm, span_mm, .. } => Solid::Prism {
            axis: *axis as usize,
            outline: outline(check, &at("outline_mm"), outline_mm)?,
            span: span(check, &at("span_mm"), *span_mm)?,
        },
        RawPart::Hull { points_mm, .. } => hull(check, &at("points_mm"), points_mm)?,
    };
    let friction = friction.map(|mu| coefficient(check, &at("friction"), mu)).transpose()?;
    Ok(Part { name: name.clone(), solid, friction })
}

/// Points that span a volume; those inside the hull are left out.
fn hull(check: Check<'_>, key: &str, points: &[[f64; 3]]) -> Result<Solid, InputError> {
    for &value in points.iter().flatten() {
        check.finite(key, value)?;
    }
    let points: Vec<_> = points.iter().map(|p| Point3::from(p.map(|v| v * MM))).collect();
    match geometry::hull(&points) {
        Some((points, _)) => Ok(Solid::Hull { points }),
        None => check.fail(key, "lie in a plane; a hull needs four points or more that do not"),
    }
}

/// A strictly convex outline: every turn is to the same side.
fn outline(check: Check<'_>, key: &str, outline: &[[f64; 2]]) -> Result<Vec<[f64; 2]>, InputError> {
    if !(3..=MOST_CORNERS).contains(&outline.len()) {
        return check.fail(key, format!("needs three corners at least, {MOST_CORNERS} at most"));
    }
    let n = outline.len();
    let mut turns = Vec::with_capacity(n);
    for i in 0..n {
        let [a, b, c] = [outline[i], outline[(i + 1) % n], outline[(i + 2) % n]];
        check.each(key, a, Check::distance)?;
        turns.push((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]));
    }
    let convex = turns.iter().all(|&t| t > 1e-9) || turns.iter().all(|&t| t < -1e-9);
    if !convex {
        return check.fail(key, "is not convex; split the part into convex parts");
    }
    Ok(outline.iter().map(|p| [p[0] * MM, p[1] * MM]).collect())
}

fn without_edges(
    check: Check<'_>,
    key: &str,
    [min, max]: [Vector3<f64>; 2],
    edges: &[RawEdges],
) -> Result<Solid, InputError> {
    let mut cuts: Vec<(Edge, Cut)> = Vec::new();
    for raw in edges {
        let Some(found) = edges::named(&raw.at) else {
            let problem = format!(
                "at = {:?} names no edge; give a face, as in \"-z\", for its four, or two, as in \
                     \"+x-z\", for the one between them",
                raw.at
            );
            return check.fail(key, problem);
        };
        let cut = match (raw.chamfer_mm, raw.radius_mm) {
            (Some(mm), None) => Cut::Chamfer(size(check, &format!("{key}.chamfer_mm"), mm)?),
            (None, Some(mm)) => Cut::Radius(size(check, &format!("{key}.radius_mm"), mm)?),
            _ => return check.fail(key, "need either chamfer_mm or radius_mm"),
        };
        for edge in found {
            if cuts.iter().any(|(other, _)| edges::same(other, &edge)) {
                return check.fail(key, format!("at = {:?} names an edge a second time", raw.at));
            }
            cuts.push((edge, cut));
        }
    }
    if cuts.is_empty() {
        return Ok(Solid::Box { min, max });
    }
    edges::cut(&min, &max, &cuts).or_else(|problem| check.fail(key, problem))
}
