//! Shapes, vectors and poses as parry, and so rapier, has them, in a unit of length of
//! the caller's choice: `scale` is how many of it make a metre.

use crate::scene::{Pose, Shape};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use parry::math as pm;
use parry::shape::SharedShape;
use rapier3d_f64::parry;

/// The shape, and the turn from parry's frame of it to ours.
pub fn shared(shape: &Shape, scale: f64) -> (SharedShape, Pose) {
    match shape {
        Shape::Box { half } => {
            let half = half * scale;
            (SharedShape::cuboid(half.x, half.y, half.z), Pose::identity())
        }
        Shape::Cylinder { half_height, radius } => {
            // parry's cylinders stand along y, ours along z.
            let quarter = std::f64::consts::FRAC_PI_2;
            let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), quarter);
            let shape = SharedShape::cylinder(half_height * scale, radius * scale);
            (shape, Pose::from_parts(Translation3::identity(), turn))
        }
        Shape::Hull { points } => {
            let points: Vec<_> = points.iter().map(|p| vector(&(p.coords * scale))).collect();
            // The task file's checks leave no degenerate hull; a ball would be seen at once.
            let hull = SharedShape::convex_hull(&points);
            (hull.unwrap_or_else(|| SharedShape::ball(0.0)), Pose::identity())
        }
    }
}

/// Half extents, in m, of the box about the shape's frame that encloses it, and its centre.
pub(super) fn bounds(shape: &Shape) -> (Vector3<f64>, Vector3<f64>) {
    match shape {
        Shape::Box { half } => (Vector3::zeros(), *half),
        Shape::Cylinder { half_height, radius } => {
            (Vector3::zeros(), Vector3::new(*radius, *radius, *half_height))
        }
        Shape::Hull { points } => {
            let start = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
            let (low, high) = points
                .iter()
                .fold(start, |(low, high), p| (low.inf(&p.coords), high.sup(&p.coords)));
            ((low + high) / 2.0, (high - low) / 2.0)
        }
    }
}

/// To parry's vector, no change of unit.
pub fn vector(v: &Vector3<f64>) -> pm::Vector {
    pm::Vector::new(v.x, v.y, v.z)
}

/// From parry's vector, no change of unit.
pub fn from_vector(v: pm::Vector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

/// A pose in metres to parry's.
pub fn pose(pose: &Pose, scale: f64) -> pm::Pose {
    let q = pose.rotation.coords;
    let rotation = pm::Rotation::from_xyzw(q.x, q.y, q.z, q.w);
    pm::Pose::from_parts(vector(&(pose.translation.vector * scale)), rotation)
}
