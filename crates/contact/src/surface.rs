//! Triangles of shapes, for pictures and exports.

use super::shapes::{from_vector, vector};
use crate::scene::Shape;
use nalgebra::Point3;
use rapier3d_f64::parry::transformation::try_convex_hull;

/// Hulls are found in millimetres: in metres its tolerances are too wide.
const MM: f64 = 1e-3;

/// A closed surface in the frame of its shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Corners, m.
    pub points: Vec<Point3<f64>>,
    /// Three corners each, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// The surface of a convex shape; of a cylinder that of the prism inside it. Empty for a hull
/// without volume, which no checked file has.
pub fn surface(shape: &Shape) -> Surface {
    // In millimetres, for which parry's tolerances are made.
    let points: Vec<_> = shape.corners().iter().map(|p| vector(&(p.coords / MM))).collect();
    let (points, triangles) = try_convex_hull(&points).unwrap_or_default();
    let points = points.into_iter().map(|p| Point3::from(from_vector(p) * MM)).collect();
    Surface { points, triangles }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    /// Six times the volume is the sum of the triangles' triple products, if all look outward.
    fn volume(surface: &Surface) -> f64 {
        let of = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| surface.points[i as usize].coords);
            a.dot(&b.cross(&c)) / 6.0
        };
        surface.triangles.iter().map(of).sum()
    }

    #[test]
    fn surfaces_are_closed_and_look_outward() {
        let brick = Shape::Box { half: Vector3::new(1.0, 2.0, 3.0) * MM };
        let found = surface(&brick);
        assert_eq!((found.points.len(), found.triangles.len()), (8, 12));
        assert!((volume(&found) / MM.powi(3) - 48.0).abs() < 1e-9);
        let rod = surface(&Shape::Cylinder { half_height: MM, radius: 2.0 * MM });
        let prism = 2.0 * 16.0 / 2.0 * 4.0 * (std::f64::consts::TAU / 16.0).sin();
        assert!((volume(&rod) / MM.powi(3) - prism).abs() < 1e-9);
        assert_eq!(surface(&Shape::Hull { points: Vec::new() }).triangles.len(), 0);
    }
}
