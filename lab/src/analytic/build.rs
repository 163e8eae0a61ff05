//! Parts that the checks' scenes are made of, and how they are simulated.

use contact::scene::{Body, BodyId, Geom, Inertia, Motion, Pose, Shape};
use contact::{Diverged, World};
use nalgebra::{Point3, Vector3};

/// Standard gravity as the trials have it, m/s2.
pub const GRAVITY: f64 = 9.81;

/// A geom that is a box of the given size, m, centred in a frame.
pub fn cuboid(name: &str, size: Vector3<f64>, pose: Pose) -> Geom {
    Geom { name: name.into(), shape: Shape::Box { half: size / 2.0 }, pose, friction: None }
}

/// Mass properties of a homogeneous box, m and kg.
pub fn box_inertia(mass: f64, size: Vector3<f64>, centre: Point3<f64>) -> Inertia {
    let square = size.component_mul(&size);
    let moments = Vector3::repeat(square.sum()) - square;
    Inertia { mass, centre, moments: moments * (mass / 12.0) }
}

/// A body that stays where it is.
pub fn fixed(name: &str, pose: Pose, geoms: Vec<Geom>) -> Body {
    Body { name: name.into(), motion: Motion::Fixed, pose, geoms }
}

/// A free block with its frame in its centre.
pub fn block(name: &str, mass: f64, size: Vector3<f64>, pose: Pose) -> Body {
    Body {
        name: name.into(),
        motion: Motion::Free(box_inertia(mass, size, Point3::origin())),
        pose,
        geoms: vec![cuboid(name, size, Pose::identity())],
    }
}

/// Steps in a time, s.
pub fn steps(world: &dyn World, time: f64) -> usize {
    (time / world.step_s()).round() as usize
}

/// Simulates for a time, s.
pub fn advance(world: &mut dyn World, time: f64) -> Result<(), Diverged> {
    for _ in 0..steps(world, time) {
        world.step()?;
    }
    Ok(())
}

/// A force in newtons that acts along a line through a point of the world, in
/// metres, with a moment besides, N m.
#[derive(Debug, Clone, Copy)]
pub struct Wrench {
    pub force: Vector3<f64>,
    pub moment: Vector3<f64>,
}

impl Wrench {
    /// Pushes a body whose centre of mass lies at `centre` in its frame.
    pub fn push(&self, world: &mut dyn World, body: BodyId, centre: Point3<f64>, at: Point3<f64>) {
        let arm = at - world.pose(body) * centre;
        world.push(body, self.force, self.moment + arm.cross(&self.force));
    }
}
