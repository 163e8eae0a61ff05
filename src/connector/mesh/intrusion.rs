//! Intrusion of convex parts: their reach beyond the surface that they stand for.

use super::surface::Surface;
use input::units::MM;
use insertion::task::{Part, geometry};
use nalgebra::Point3;
use parry::math::Vector;
use parry::query::PointQuery;
use parry::shape::{TriMesh, TriMeshFlags};
use rapier3d_f64::parry;

/// Spacing of the sample points on parts, m.
const SPACING: f64 = 0.2 * MM;
/// Most sample points along a side of a triangle.
const MOST: usize = 60;

/// Largest intrusion, m, and its point, m, among the sample points that `counts` accepts.
pub fn largest(
    surface: &Surface,
    parts: &[Part],
    counts: impl Fn(&Point3<f64>) -> bool,
) -> Option<(f64, Point3<f64>)> {
    let (points, faces) = surface.in_millimetres();
    let mesh = TriMesh::with_flags(points, faces, TriMeshFlags::ORIENTED).ok()?;
    let outside = |at: Point3<f64>| {
        let point: Vector = (at.coords / MM).into();
        let found = mesh.project_local_point(point, true);
        (if found.is_inside { 0.0 } else { (found.point - point).length() * MM }, at)
    };
    let samples = parts.iter().flat_map(samples).filter(|p| counts(p));
    samples.map(outside).max_by(|a, b| a.0.total_cmp(&b.0))
}

fn samples(part: &Part) -> Vec<Point3<f64>> {
    let Some((corners, faces)) = geometry::hull(&part.solid.corners()) else { return Vec::new() };
    let mut found = Vec::new();
    for face in faces {
        let [a, b, c] = face.map(|corner| corners[corner]);
        let longest = (b - a).norm().max((c - a).norm()).max((c - b).norm());
        let steps = ((longest / SPACING).ceil() as usize).clamp(1, MOST);
        for i in 0..=steps {
            for j in 0..=steps - i {
                let (u, v) = (i as f64 / steps as f64, j as f64 / steps as f64);
                found.push(a + (b - a) * u + (c - a) * v);
            }
        }
    }
    found
}
