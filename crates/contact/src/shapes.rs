//! Conversion of shapes and poses to parry, rapier's collision library, and triangles of shapes for pictures and
//! exports. The caller chooses parry's unit of length: `scale` is the number of units in a metre.

use crate::scene::{Pose, Shape};
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use parry::math as pm;
use parry::shape::SharedShape;
use parry::transformation::try_convex_hull;
use rapier3d_f64::parry;

/// Unit of length for hulls, m: parry's tolerances for hulls are too wide in metres.
const MM: f64 = 1e-3;

/// Corners of a closed surface, m, and its triangles, counter-clockwise from outside.
pub type Triangles = (Vec<Point3<f64>>, Vec<[u32; 3]>);

/// Returns the surface of the convex hull of points; `None` if they do not span a volume.
pub fn hull(points: &[Point3<f64>]) -> Option<Triangles> {
    let points: Vec<_> = points.iter().map(|p| (p.coords / MM).into()).collect();
    let (points, triangles) = try_convex_hull(&points).ok()?;
    Some((points.into_iter().map(|p| Point3::from(Vector3::from(p) * MM)).collect(), triangles))
}

/// Returns the surface of a convex shape in its frame: the hull of [`Shape::corners`], which approximate round
/// surfaces. Empty for a hull without volume, which the checks of a task file reject.
pub fn surface(shape: &Shape) -> Triangles {
    hull(&shape.corners()).unwrap_or_default()
}

/// Returns parry's [`SharedShape`] of a shape, and the pose of parry's frame in the frame of the shape.
pub fn shared(shape: &Shape, scale: f64) -> (SharedShape, Pose) {
    let mut turn = UnitQuaternion::identity();
    let shape = match shape {
        Shape::Box { half } => SharedShape::cuboid(half.x * scale, half.y * scale, half.z * scale),
        Shape::Cylinder { half_height, radius } => {
            // parry's cylinders stand along y, ours along z.
            let quarter = std::f64::consts::FRAC_PI_2;
            turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), quarter);
            SharedShape::cylinder(half_height * scale, radius * scale)
        }
        Shape::Hull { points } => {
            let points: Vec<_> = points.iter().map(|p| (p.coords * scale).into()).collect();
            // The checks of a task file reject a degenerate hull; here it becomes a ball of radius 0.
            SharedShape::convex_hull(&points).unwrap_or_else(|| SharedShape::ball(0.0))
        }
        Shape::RoundBox { core, radius } => {
            let (half, radius) = (core * scale, radius * scale);
            match extended(core)[..] {
                [] => SharedShape::ball(radius),
                [axis] => {
                    let end = pm::Vector::from(Vector3::ith(axis, half[axis]));
                    SharedShape::capsule(-end, end, radius)
                }
                _ => SharedShape::round_cuboid(half.x, half.y, half.z, radius),
            }
        }
    };
    (shape, Pose::from_parts(Translation3::identity(), turn))
}

/// Returns the axes along which the core of a round box extends.
pub(super) fn extended(core: &Vector3<f64>) -> Vec<usize> {
    (0..3).filter(|&axis| core[axis] > 0.0).collect()
}

/// Returns the centre and half extents, m, of the box in the shape's frame that encloses it.
pub(super) fn bounds(shape: &Shape) -> (Vector3<f64>, Vector3<f64>) {
    // The prism of a cylinder has corners on x and y, so the box encloses the cylinder, too.
    let corners = shape.corners();
    let infinite = Vector3::repeat(f64::INFINITY);
    let low = corners.iter().fold(infinite, |low, p| low.inf(&p.coords));
    let high = corners.iter().fold(-infinite, |high, p| p.coords.sup(&high));
    ((low + high) / 2.0, (high - low) / 2.0)
}

/// Returns parry's pose for a pose in metres.
pub fn pose(pose: &Pose, scale: f64) -> pm::Pose {
    pm::Pose::from_parts((pose.translation.vector * scale).into(), pose.rotation.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the volume: a sixth of the sum of the triangles' triple products, if all face outward.
    fn volume((points, triangles): &Triangles) -> f64 {
        let of = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| points[i as usize].coords);
            a.dot(&b.cross(&c)) / 6.0
        };
        triangles.iter().map(of).sum()
    }

    #[test]
    fn surfaces_are_closed_and_face_outward() {
        let brick = Shape::Box { half: Vector3::new(1.0, 2.0, 3.0) * MM };
        let found = surface(&brick);
        assert_eq!((found.0.len(), found.1.len()), (8, 12));
        assert!((volume(&found) / MM.powi(3) - 48.0).abs() < 1e-9);
        let rod = surface(&Shape::Cylinder { half_height: MM, radius: 2.0 * MM });
        let prism = 2.0 * 16.0 / 2.0 * 4.0 * libm::sin(std::f64::consts::TAU / 16.0);
        assert!((volume(&rod) / MM.powi(3) - prism).abs() < 1e-9);
        assert_eq!(surface(&Shape::Hull { points: Vec::new() }).1.len(), 0);
    }
}
