//! T8, first part: a block that is pushed over an edge.
//!
//! Statics: it tips when its centre of mass is above the edge. The pusher touches it at its foot and
//! without friction, so the couple of push and ground friction shifts the place by less than friction
//! times the pusher's height, 0.1 mm.

use super::build::{self, GRAVITY};
use super::{CheckRow, Tolerance};
use contact::scene::{BodyId, Friction, Pose, Scene};
use contact::{Diverged, Engine, World};
use input::units::{GRAM, MM};
use nalgebra::Vector3;

/// The block, kg and m.
const MASS: f64 = 20.0 * GRAM;
const SIZE: [f64; 3] = [24.0 * MM, 12.0 * MM, 8.0 * MM];
const FRICTION: f64 = 0.1;
/// Height of the pusher, m, and its speed, m/s.
const PUSHER: f64 = 1.0 * MM;
const SPEED: f64 = 5.0 * MM;
/// Where the centre starts and where the push ends, m beyond the edge.
const FROM: f64 = -2.0 * MM;
const TO: f64 = 3.0 * MM;
/// A block that leans by this tips, rad; it leans on by itself within 0.03 s.
const TIPPING: f64 = 2e-3;
/// Largest error of the place, m.
pub(super) const ALLOWED: f64 = 0.5 * MM;

pub fn t8(engine: &dyn Engine) -> Vec<CheckRow> {
    let place = tipping_place(engine).map(|place| place / MM);
    let quantity = "block pushed over an edge tips at";
    vec![CheckRow::new("T8", quantity, 0.0, place, "mm", Tolerance::Absolute(ALLOWED / MM))]
}

/// Block on a ledge that ends at x = 0, and its pusher.
pub(super) struct Push {
    pub world: Box<dyn World>,
    pub block: BodyId,
    pusher: BodyId,
    start: Pose,
    time: f64,
}

impl Push {
    pub fn new(engine: &dyn Engine) -> Self {
        let size = Vector3::from(SIZE);
        let mut scene = Scene { gravity: Vector3::new(0.0, 0.0, -GRAVITY), ..Scene::default() };
        let ledge_size = Vector3::new(60.0 * MM, 30.0 * MM, 20.0 * MM);
        let inside = Pose::translation(-ledge_size.x / 2.0, 0.0, -ledge_size.z / 2.0);
        let ledge = build::cuboid("ledge", ledge_size, inside);
        let ledge = scene.body(build::fixed("ledge", Pose::identity(), vec![ledge]));
        let pose = Pose::translation(FROM, 0.0, size.z / 2.0);
        let block = scene.body(build::block("block", MASS, size, pose));
        let half_pusher = PUSHER / 2.0;
        let start = Pose::translation(FROM - size.x / 2.0 - half_pusher, 0.0, half_pusher);
        let pusher_size = Vector3::new(PUSHER, size.y, PUSHER);
        let pusher = build::cuboid("pusher", pusher_size, Pose::identity());
        let pusher = scene.body(build::driven("pusher", start, vec![pusher]));
        scene.contact(ledge, block, Friction::hard(FRICTION));
        scene.contact(pusher, block, Friction::hard(0.0));
        Push { world: engine.world(&scene), block, pusher, start, time: 0.0 }
    }

    /// Copy that continues independently, from a snapshot.
    pub fn copy(&self) -> Self {
        Push { world: self.world.snapshot(), ..*self }
    }

    pub fn step(&mut self) -> Result<(), Diverged> {
        self.time += self.world.step_s();
        let moved = Pose::translation(SPEED * self.time, 0.0, 0.0);
        self.world.drive(self.pusher, moved * self.start);
        self.world.step()
    }
}

/// Place of the centre of mass when the block tips, m beyond the edge.
pub(super) fn tipping_place(engine: &dyn Engine) -> Result<f64, Diverged> {
    let mut push = Push::new(engine);
    for _ in 0..build::steps(push.world.as_ref(), (TO - FROM) / SPEED) {
        push.step()?;
        let pose = push.world.pose(push.block);
        if pose.rotation.angle() > TIPPING {
            return Ok(pose.translation.x);
        }
    }
    Ok(TO)
}
