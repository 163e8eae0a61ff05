//! Closed triangle meshes with outward normals.

use super::read::Triangle;
use super::{edges, mend};
use input::units::MM;
use insertion::task::geometry::surface_moments;
use nalgebra::Point3;
use std::collections::BTreeMap;

/// Spacing of the grid to which corners are rounded, m: that of lengths in task files; it also joins corners that
/// differ by the rounding of mesh files.
pub const GRID: f64 = 1e-4 * MM;
/// Smallest and largest size of a connector, m.
pub const SIZES: [f64; 2] = [3.0 * MM, 300.0 * MM];

/// Smallest volume of a body, m3: the sign of a smaller volume may be due to rounding.
const MIN_VOLUME: f64 = 1.0 * MM * MM * MM;

/// Closed triangle mesh, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Corners, m, on the welding grid.
    pub points: Vec<Point3<f64>>,
    /// Corner indices of the triangles, counter-clockwise from outside.
    pub faces: Vec<[usize; 3]>,
    /// Whether the file had all triangles clockwise.
    pub was_inward: bool,
}

impl Surface {
    /// Welds triangles given in a unit of `unit` metres and closes small gaps; `None` if the result is not watertight,
    /// has faces of inconsistent orientation or encloses no volume.
    pub fn new(triangles: &[Triangle], unit: f64) -> Option<Self> {
        let (points, mut faces) = weld(triangles, unit);
        if mend::mend(&points, &mut faces) {
            faces = without_films(faces);
        }
        let volume = surface_moments(&points, &faces).0;
        if !closed(&faces) || volume.abs() < MIN_VOLUME {
            return None;
        }
        let was_inward = volume < 0.0;
        if was_inward {
            faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        Some(Surface { points, faces, was_inward })
    }

    /// Returns the triangles, m.
    pub fn triangles(&self) -> Vec<Triangle> {
        self.faces.iter().map(|face| face.map(|corner| self.points[corner])).collect()
    }

    /// Returns the enclosed volume, m3.
    pub fn volume(&self) -> f64 {
        surface_moments(&self.points, &self.faces).0
    }
}

/// Rounds a length to the grid.
pub fn snap(value: f64) -> f64 {
    (value / GRID).round() * GRID
}

/// Welds the corners of triangles given in a unit of `unit` metres; drops faces that become lines, and pairs of
/// coincident faces of opposite orientation.
pub fn weld(triangles: &[Triangle], unit: f64) -> (Vec<Point3<f64>>, Vec<[usize; 3]>) {
    let mut places: BTreeMap<[i64; 3], usize> = BTreeMap::new();
    let mut points = Vec::new();
    let mut index = |p: Point3<f64>| {
        let p = p * unit;
        let key: [i64; 3] = std::array::from_fn(|axis| (p[axis] / GRID).round() as i64);
        *places.entry(key).or_insert_with(|| {
            points.push(Point3::from(p.coords.map(snap)));
            points.len() - 1
        })
    };
    let faces = triangles.iter().map(|triangle| triangle.map(&mut index));
    // A face that has become a line on the grid encloses nothing, and its neighbours still meet.
    let faces = faces.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    (points, without_films(faces))
}

/// Removes pairs of coincident faces of opposite orientation, which enclose nothing.
fn without_films(faces: Vec<[usize; 3]>) -> Vec<[usize; 3]> {
    // Rotates the corners so that the smallest index is first.
    let smallest_first = |face: [usize; 3]| {
        let first = (0..3).min_by_key(|&i| face[i]).unwrap_or(0);
        [face[first], face[(first + 1) % 3], face[(first + 2) % 3]]
    };
    let mut seen: BTreeMap<[usize; 3], i32> = BTreeMap::new();
    for face in &faces {
        let [a, b, c] = smallest_first(*face);
        *seen.entry([a, b.min(c), b.max(c)]).or_default() += if b < c { 1 } else { -1 };
    }
    let kept = seen.into_iter().filter(|(_, count)| *count != 0);
    kept.map(|([a, b, c], count)| if count > 0 { [a, b, c] } else { [a, c, b] }).collect()
}

/// Returns whether every edge runs as often in one direction as in the other.
fn closed(faces: &[[usize; 3]]) -> bool {
    let mut ways: BTreeMap<[usize; 2], i32> = BTreeMap::new();
    for [a, b] in faces.iter().copied().flat_map(edges) {
        *ways.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
    }
    ways.values().all(|&way| way == 0)
}
