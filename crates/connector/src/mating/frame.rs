//! Axes of a part, and the turns between the axes of two parts.

use super::MatingError;
use crate::mesh::Triangle;
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// Cosine of the largest angle between normals of one direction: half a degree.
const PARALLEL: f64 = 0.999_96;
/// Most directions from which axes are made.
const MOST_DIRECTIONS: usize = 12;
/// Share of the best axes' area with which the axes of the file are kept: round parts have many as good.
const KEPT: f64 = 0.6;

/// Triangles of a part in axes of its own, along which its walls run.
pub struct Part {
    /// File to own axes.
    pub own: Rotation3<f64>,
    /// Triangles in its own axes, m.
    pub triangles: Vec<Triangle>,
}

/// Plug and socket.
pub struct Parts {
    /// Plug.
    pub plug: Part,
    /// Socket.
    pub socket: Part,
}

impl Parts {
    /// Both parts in axes of their own.
    pub fn new(plug: &[Triangle], socket: &[Triangle]) -> Result<Self, MatingError> {
        Ok(Parts { plug: Part::new(plug, "plug")?, socket: Part::new(socket, "socket")? })
    }
}

impl Part {
    /// The part in axes of its own.
    pub fn new(triangles: &[Triangle], name: &'static str) -> Result<Self, MatingError> {
        let directions = directions(triangles);
        let own = axes(&directions).ok_or(MatingError::Empty(name))?;
        Ok(Part { own, triangles: turned(triangles, &own) })
    }
}

/// Turned triangles.
pub fn turned(triangles: &[Triangle], turn: &Rotation3<f64>) -> Vec<Triangle> {
    triangles.iter().map(|corners| corners.map(|p| turn * p)).collect()
}

/// The 24 turns that map axes to axes.
pub fn turns() -> Vec<Rotation3<f64>> {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let signed = axes.iter().flat_map(|axis| [*axis, -axis]).collect::<Vec<_>>();
    let pairs = signed.iter().flat_map(|z| signed.iter().map(move |x| (*z, *x)));
    pairs.filter(|(z, x)| z.dot(x) == 0.0).map(|(z, x)| upright(z, x)).collect()
}

/// Six turns, one for each axis and sense, that map it to z.
pub fn outs() -> Vec<Rotation3<f64>> {
    turns().into_iter().step_by(4).collect()
}

/// Turn that maps `z` to z and `x` to x.
fn upright(z: Vector3<f64>, x: Vector3<f64>) -> Rotation3<f64> {
    let rows = [x, z.cross(&x), z].map(|row| row.transpose());
    Rotation3::from_matrix_unchecked(Matrix3::from_rows(&rows))
}

/// Directions of the normals, either sense, with their area, the largest first.
fn directions(triangles: &[Triangle]) -> Vec<(Vector3<f64>, f64)> {
    let mut normals: Vec<(Vector3<f64>, f64)> = Vec::new();
    for [a, b, c] in triangles {
        let normal = (b - a).cross(&(c - a));
        if let Some((unit, length)) = Unit::try_new_and_get(normal, f64::MIN_POSITIVE) {
            normals.push((unit.into_inner(), length / 2.0));
        }
    }
    normals.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut found: Vec<(Vector3<f64>, f64)> = Vec::new();
    for (normal, area) in normals {
        let same = |(known, _): &(Vector3<f64>, f64)| known.dot(&normal).abs() > PARALLEL;
        match found.iter().position(same) {
            Some(at) => found[at].1 += area,
            None if found.len() < 100 * MOST_DIRECTIONS => found.push((normal, area)),
            None => {}
        }
    }
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    found
}

/// Axes to which most of the area is square; those of the file where they are about as good.
fn axes(directions: &[(Vector3<f64>, f64)]) -> Option<Rotation3<f64>> {
    let area = |turn: &Rotation3<f64>| -> f64 {
        let square = |normal: &Vector3<f64>| (turn * normal).amax() > PARALLEL;
        directions.iter().filter(|(normal, _)| square(normal)).map(|(_, area)| area).sum()
    };
    directions.first()?;
    let few = &directions[..directions.len().min(MOST_DIRECTIONS)];
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
