//! Scenes of the checks: bodies, joints, loads, simulated time.

use contact::scene::{
    Body, BodyId, Geom, Inertia, Joint, Motion, Pose, Scene, Shape, Spring, Springs,
};
use contact::{Diverged, World};
use nalgebra::{Point3, Vector3};

pub type Measured<T = f64> = Result<T, Diverged>;

/// Standard gravity as in the trials, m/s2.
pub const GRAVITY: f64 = 9.81;

pub fn cuboid(name: &str, size: Vector3<f64>, pose: Pose) -> Geom {
    Geom { name: name.into(), shape: Shape::Box { half: size / 2.0 }, pose, friction: None }
}

/// Returns the mass properties of a homogeneous box, m and kg.
pub fn box_inertia(mass: f64, size: Vector3<f64>, centre: Point3<f64>) -> Inertia {
    let square = size.component_mul(&size);
    let moments = Vector3::repeat(square.sum()) - square;
    Inertia { mass, centre, moments: moments * (mass / 12.0) }
}

pub fn fixed(name: &str, pose: Pose, geoms: Vec<Geom>) -> Body {
    Body { name: name.into(), motion: Motion::Fixed, pose, geoms }
}

pub fn driven(name: &str, pose: Pose, geoms: Vec<Geom>) -> Body {
    Body { name: name.into(), motion: Motion::Driven, pose, geoms }
}

/// Returns the fixed ground whose surface is the plane z = 0 of `pose`, of a size in m.
pub fn ground(size: [f64; 3], pose: Pose) -> Body {
    let below = Pose::translation(0.0, 0.0, -size[2] / 2.0);
    fixed("ground", pose, vec![cuboid("ground", size.into(), below)])
}

/// Returns the joint of a parent and a child, with the frame of the joint in each.
pub fn joint(
    scene: &mut Scene,
    name: &str,
    bodies: [BodyId; 2],
    frames: [Pose; 2],
    axes: [Option<Spring>; 6],
) {
    let ([parent, child], [in_parent, in_child]) = (bodies, frames);
    let springs = Springs::Axes(axes);
    scene.joint(Joint { name: name.into(), parent, child, in_parent, in_child, springs });
}

pub fn block(name: &str, mass: f64, size: Vector3<f64>, pose: Pose) -> Body {
    Body {
        name: name.into(),
        motion: Motion::Free(box_inertia(mass, size, Point3::origin())),
        pose,
        geoms: vec![cuboid(name, size, Pose::identity())],
    }
}

pub fn steps(world: &dyn World, time: f64) -> usize {
    (time / world.step_s()).round() as usize
}

/// Simulates for a time, s.
pub fn advance(world: &mut dyn World, time: f64) -> Measured<()> {
    for _ in 0..steps(world, time) {
        world.step()?;
    }
    Ok(())
}

/// Returns the threshold between the bracket's ends by bisection; `low` tells whether a value lies below it.
pub fn bisected(
    [mut from, mut to]: [f64; 2],
    bisections: usize,
    low: impl Fn(f64) -> Measured<bool>,
) -> Measured {
    for _ in 0..bisections {
        let middle = (from + to) / 2.0;
        let end = if low(middle)? { &mut from } else { &mut to };
        *end = middle;
    }
    Ok((from + to) / 2.0)
}

/// Pushes a body with this centre of mass by a force, N, through a world point, and a moment, N m.
pub fn push(
    world: &mut dyn World,
    body: BodyId,
    centre: Point3<f64>,
    at: Point3<f64>,
    [force, moment]: [Vector3<f64>; 2],
) {
    let arm = at - world.pose(body) * centre;
    world.push(body, force, moment + arm.cross(&force));
}
