//! T8: a block that is pushed over an edge, and independence of the time step.
//!
//! Statics: it tips when its centre of mass is above the edge. The pusher touches it at its foot and
//! without friction, so the couple of push and ground friction shifts the place by less than friction
//! times the pusher's height, 0.1 mm.
//!
//! Halving the step changes no outcome of the cases that can end in two ways, each taken at both
//! sides of its threshold; and a restored snapshot continues exactly like its world.

use super::build::{self, GRAVITY};
use super::{CheckRow, Make, Tolerance, incline, jamming};
use contact::scene::{BodyId, Friction, Pose, Scene};
use contact::{Diverged, Engine, World};
use input::units::{DEG, GRAM, MM};
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
const ALLOWED: f64 = 0.5 * MM;

/// Block on a ledge that ends at x = 0, and its pusher.
struct Push {
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

    /// Returns a copy that continues independently, from a snapshot.
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

/// Returns the place of the centre of mass when the block tips, m beyond the edge.
fn tipping_place(engine: &dyn Engine) -> Result<f64, Diverged> {
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

/// Distance of the cases from their thresholds, as a share.
const MARGIN: f64 = 0.02;
/// A block that is slower than this rests, m/s.
const RESTS: f64 = 0.01 * MM;
const CASES_FRICTION: f64 = 0.3;
/// Simulated time before the snapshot and after it, s: from the push to the fall.
const BEFORE: f64 = 0.3;
const AFTER: f64 = 0.3;

/// Returns the place of tipping, outcomes that change with the step, bits that change with a snapshot, T8 rows.
pub fn t8(make: Make<'_>) -> Vec<CheckRow> {
    let row = |text: &str, measured, unit, allowed| {
        CheckRow::new("T8", text, 0.0, measured, unit, Tolerance::Absolute(allowed))
    };
    let engine = make(1.0);
    let place = tipping_place(engine.as_ref()).map(|place| place / MM);
    vec![
        row("block pushed over an edge tips at", place, "mm", ALLOWED / MM),
        row("outcomes changed by half the step", changed_outcomes(make), "-", 0.0),
        row("steps changed by restoring a snapshot", changed_steps(engine.as_ref()), "-", 0.0),
    ]
}

fn changed_outcomes(make: Make<'_>) -> Result<f64, Diverged> {
    let (whole, half) = (outcomes(make(1.0).as_ref())?, outcomes(make(0.5).as_ref())?);
    Ok(whole.iter().zip(&half).filter(|(a, b)| a != b).count() as f64)
}

/// Returns whether a block rests on an incline at two headings, a peg jams, a peg
/// wedges, below and above their thresholds; whether a block tips at the edge.
fn outcomes(engine: &dyn Engine) -> Result<Vec<bool>, Diverged> {
    let mut all = Vec::new();
    for share in [1.0 - MARGIN, 1.0 + MARGIN] {
        for heading in [0.0, 37.0] {
            all.push(incline::creep(engine, CASES_FRICTION, heading * DEG, share)? < RESTS);
        }
        all.push(jamming::jams_at(engine, share)?);
        all.push(jamming::wedges(engine, CASES_FRICTION, share * CASES_FRICTION)?);
    }
    all.push(tipping_place(engine)?.abs() < ALLOWED);
    Ok(all)
}

/// Steps after which a world and its restored snapshot differ at all.
fn changed_steps(engine: &dyn Engine) -> Result<f64, Diverged> {
    let mut first = Push::new(engine);
    for _ in 0..build::steps(first.world.as_ref(), BEFORE) {
        first.step()?;
    }
    let mut second = first.copy();
    let mut changed = 0;
    for _ in 0..build::steps(first.world.as_ref(), AFTER) {
        first.step()?;
        second.step()?;
        changed += usize::from(first.world.pose(first.block) != second.world.pose(second.block));
    }
    Ok(changed as f64)
}
