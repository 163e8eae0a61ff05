//! T16: friction along an axis, as of contact springs.
//!
//! A block that is pushed down slowly resists with the friction that is given for its depth: linear between
//! the depths, the last below them. The pusher bears that less the block's weight. Released, the block is held by
//! a friction of its weight, and stays (Coulomb).

use super::build::{self, Measured, block, cuboid, driven, fixed};
use super::{CheckRow, Tolerance};
use contact::scene::{AxialFriction, BodyId, Friction, Pose, Scene};
use contact::{Engine, World};
use input::units::{GRAM, MM};
use nalgebra::Vector3;

/// Depth, mm, and largest friction, N.
const GIVEN: [[f64; 2]; 3] = [[0.0, 0.0], [2.0, 12.0], [6.0, 8.0]];
/// Depths at which it is read, mm, and the friction there, N.
const READ: [[f64; 2]; 5] = [[1.0, 6.0], [2.0, 12.0], [3.0, 11.0], [5.0, 9.0], [7.0, 8.0]];
/// Speed of the push, m/s.
const SPEED: f64 = 4.0 * MM;
/// Time in which the released block is watched, s.
const HELD_S: f64 = 0.1;
/// Size of the block, m, its tip in the middle of its height.
const SIZE: f64 = 10.0 * MM;
const MASS: f64 = 5.0 * GRAM;

struct Pushed {
    world: Box<dyn World>,
    socket: BodyId,
    pusher: BodyId,
    plug: BodyId,
    top: f64,
}

impl Pushed {
    fn new(engine: &dyn Engine) -> Self {
        let mut scene = Scene { gravity: Vector3::z() * -build::GRAVITY, ..Scene::default() };
        let size = Vector3::repeat(SIZE);
        let socket = scene.body(fixed("socket", Pose::identity(), Vec::new()));
        let plug = scene.body(block("plug", MASS, size, Pose::identity()));
        let top = Pose::translation(0.0, 0.0, SIZE);
        let pusher =
            scene.body(driven("pusher", top, vec![cuboid("pusher", size, Pose::identity())]));
        let force = GIVEN.map(|[depth, force]| [depth * MM, force]).to_vec();
        let region = [[-MM, MM]; 2];
        scene.axial_friction = Some(AxialFriction { parent: socket, child: plug, region, force });
        scene.contact(plug, socket, Friction::hard(0.0));
        scene.contact(pusher, plug, Friction::hard(0.2));
        Pushed { world: engine.world(&scene), socket, pusher, plug, top: SIZE }
    }

    fn depth(&self) -> f64 {
        -self.world.pose(self.plug).translation.z
    }

    /// Vertical force of a body on the plug, N.
    fn force(&self, body: BodyId) -> f64 {
        self.world.contact(body, self.plug).net.z
    }

    /// Pushes the block down to this depth, m; friction on it and force of the pusher there, N.
    fn push_to(&mut self, depth: f64) -> Measured<[f64; 2]> {
        while self.depth() < depth {
            self.top -= SPEED * self.world.step_s();
            self.world.drive(self.pusher, Pose::translation(0.0, 0.0, self.top));
            self.world.step()?;
        }
        Ok([self.force(self.socket), -self.force(self.pusher)])
    }

    /// Lifts the pusher; how far the block then sinks, m, and the friction on it, N.
    fn release(&mut self) -> Measured<[f64; 2]> {
        let depth = self.depth();
        self.world.drive(self.pusher, Pose::translation(0.0, 0.0, self.top + SIZE));
        build::advance(self.world.as_mut(), HELD_S)?;
        Ok([self.depth() - depth, self.force(self.socket)])
    }
}

pub fn t16(engine: &dyn Engine) -> Vec<CheckRow> {
    let mut pushed = Pushed::new(engine);
    let weight = MASS * build::GRAVITY;
    let mut rows = Vec::new();
    for [depth, force] in READ {
        let measured = pushed.push_to(depth * MM);
        for (what, expected, at) in [("friction", force, 0), ("push", force - weight, 1)] {
            let quantity = format!("{what} at a depth of {depth} mm");
            let measured = measured.map(|forces| forces[at]);
            let tolerance = Tolerance::Relative(0.01);
            rows.push(CheckRow::new("T16", quantity, expected, measured, "N", tolerance));
        }
    }
    let held = pushed.release();
    let force = held.map(|[_, force]| force);
    let tolerance = Tolerance::Relative(0.01);
    rows.push(CheckRow::new("T16", "friction at rest", weight, force, "N", tolerance));
    let sunk = held.map(|[sunk, _]| sunk / MM);
    let tolerance = Tolerance::Absolute(1e-3);
    rows.push(CheckRow::new("T16", "sinking at rest", 0.0, sunk, "mm", tolerance));
    rows
}
