//! Axes of a part, parallel to its walls, and the rotations between the axes of two parts.

use super::MatingError;
use crate::mesh::Triangle;
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// Cosine of the largest angle between parallel normals: half a degree.
const PARALLEL: f64 = 0.999_96;
/// Largest number of directions of normals that are tried as axes.
const MAX_DIRECTIONS: usize = 12;
/// Share of the best axes' area at and above which the axes of the file are kept: a round part has many equal axes.
const KEPT: f64 = 0.6;

/// Part of a connector (plug or socket) in its own axes, to which its walls are parallel.
pub struct Part {
    /// Rotation from the axes of the file to the part's own axes.
    pub own: Rotation3<f64>,
    /// Triangles in the own axes, m.
    pub triangles: Vec<Triangle>,
}

/// Plug and socket.
pub struct Parts {
    /// Plug.
    pub plug: Part,
    /// Socket.
    pub socket: Part,
}

impl Part {
    /// Rotates the triangles of a file, m, to their own axes; `name` names the part in errors.
    pub fn new(triangles: &[Triangle], name: &'static str) -> Result<Self, MatingError> {
        let directions = directions(triangles);
        let own = axes(&directions).ok_or(MatingError::Empty(name))?;
        Ok(Part { own, triangles: turned(triangles, &own) })
    }
}

/// Rotates triangles.
pub fn turned(triangles: &[Triangle], turn: &Rotation3<f64>) -> Vec<Triangle> {
    triangles.iter().map(|corners| corners.map(|p| turn * p)).collect()
}

/// Returns the 24 rotations that map axes to axes; each four in a row map the same axis to z.
pub fn turns() -> Vec<Rotation3<f64>> {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let signed = axes.iter().flat_map(|axis| [*axis, -axis]).collect::<Vec<_>>();
    let pairs = signed.iter().flat_map(|z| signed.iter().map(move |x| (*z, *x)));
    pairs.filter(|(z, x)| z.dot(x) == 0.0).map(|(z, x)| upright(z, x)).collect()
}

/// Returns six rotations, one for each signed axis, that map this axis to the z axis.
pub fn rotations_to_z() -> Vec<Rotation3<f64>> {
    turns().into_iter().step_by(4).collect()
}

/// Returns the rotation that maps the vector `z` to the z axis and `x` to the x axis.
fn upright(z: Vector3<f64>, x: Vector3<f64>) -> Rotation3<f64> {
    let rows = [x, z.cross(&x), z].map(|row| row.transpose());
    Rotation3::from_matrix_unchecked(Matrix3::from_rows(&rows))
}

/// Returns the directions of the normals, with opposite ones joined, each with the area of its triangles, m2, the
/// largest first.
fn directions(triangles: &[Triangle]) -> Vec<(Vector3<f64>, f64)> {
    let normal = |[a, b, c]: &Triangle| {
        let normal = (b - a).cross(&(c - a));
        let (unit, length) = Unit::try_new_and_get(normal, f64::MIN_POSITIVE)?;
        Some((unit.into_inner(), length / 2.0))
    };
    let mut normals: Vec<(Vector3<f64>, f64)> = triangles.iter().filter_map(normal).collect();
    normals.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut found: Vec<(Vector3<f64>, f64)> = Vec::new();
    for (normal, area) in normals {
        let same = |(known, _): &(Vector3<f64>, f64)| known.dot(&normal).abs() > PARALLEL;
        match found.iter().position(same) {
            Some(at) => found[at].1 += area,
            None if found.len() < 100 * MAX_DIRECTIONS => found.push((normal, area)),
            None => {}
        }
    }
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    found
}

/// Returns the rotation to the axes along which the normals of the largest area point; the identity if the axes of the
/// file have at least the share [`KEPT`] of that area.
fn axes(directions: &[(Vector3<f64>, f64)]) -> Option<Rotation3<f64>> {
    let area = |turn: &Rotation3<f64>| -> f64 {
        let square = |normal: &Vector3<f64>| (turn * normal).amax() > PARALLEL;
        directions.iter().filter(|(normal, _)| square(normal)).map(|(_, area)| area).sum()
    };
    directions.first()?;
    let few = &directions[..directions.len().min(MAX_DIRECTIONS)];
    let mut best = (Rotation3::identity(), area(&Rotation3::identity()) / KEPT);
    for (z, _) in few {
        for (other, _) in few {
            let Some(x) = Unit::try_new(other - z * z.dot(other), 0.1) else { continue };
            let turn = upright(*z, x.into_inner());
            let area = area(&turn);
            if area > best.1 {
                best = (turn, area);
            }
        }
    }
    Some(best.0)
}
