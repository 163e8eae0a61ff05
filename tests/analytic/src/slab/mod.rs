//! Insertions of the planar referee in a contact engine: peg and hole as slabs that are thin in y.
//!
//! A joint keeps y and the turns about x and z, so that the engine, too, has three degrees of
//! freedom. The frame of the peg lies in the middle of its tip, z along the peg.

mod check;
mod compare;
mod engines;
mod forms;
mod round;
mod rounded;
mod wedge;
mod yaw;

use crate::build::{self, Measured};
use crate::planar::{Assembly, Outcome, Record, Trial, V3};
use contact::scene::{Body, BodyId, Friction, Motion, Pose, Scene, Spring};
use contact::{Engine, World};
use input::units::{GRAM, MM};
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};

pub use check::forms;
pub use compare::{Agreement, Case, agreement, table};
pub use engines::engine;
pub use forms::{base, sharp};
pub use round::Rounding;
pub use rounded::{rounded, slim};
pub use yaw::{turned, yaw};

/// Mass of the peg, kg.
const MASS: f64 = 20.0 * GRAM;
/// Damping ratio of the springs.
const DAMPING: f64 = 0.3;
/// Speed of the drive, m/s: so slow that dampers and inertia carry next to nothing.
const SPEED: f64 = 10.0 * MM;
/// Time over which a force is averaged, s: longer than a contact rings.
const AVERAGING: f64 = 5e-3;

/// Peg in a world.
pub(crate) struct Slab {
    pub world: Box<dyn World>,
    pub peg: BodyId,
    flange: BodyId,
    /// Bodies on the left and on the right of the hole.
    pub hole: [BodyId; 2],
    assembly: Assembly,
    /// Pose at which the springs are at rest.
    pub target: V3,
    /// Tilt of the target at the start, at which the flange is upright.
    tilt: f64,
}

/// Returns the turn by a tilt, which is positive from x to z.
fn turn(tilt: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -tilt)
}

impl Slab {
    /// Places the unloaded peg with its compliance centre and tilt at a target, on springs of a
    /// damping ratio.
    pub fn new(
        engine: &dyn Engine,
        assembly: &Assembly,
        target: V3,
        rounding: Rounding,
        damping: f64,
    ) -> Self {
        let mut scene = Scene::default();
        let start = Pose::translation(target.x, 0.0, target.y);
        let flange = scene.body(build::driven("flange", start, Vec::new()));
        let peg = scene.body(peg_body(assembly, &target, rounding));
        let arm = Translation3::new(0.0, 0.0, assembly.support.centre);
        let in_child = Pose::from_parts(arm, turn(target.z).inverse());
        let frames = [Pose::identity(), in_child];
        build::joint(&mut scene, "springs", [flange, peg], frames, axes(assembly, damping));
        let [left, right] = rounding.hole(&assembly.hole);
        let hole = [("left", left), ("right", right)].map(|(name, geom)| {
            let body = scene.body(build::fixed(name, Pose::identity(), vec![geom]));
            scene.contact(body, peg, Friction::hard(assembly.friction));
            body
        });
        let world = engine.world(&scene);
        Slab { world, peg, flange, hole, assembly: *assembly, target, tilt: target.z }
    }

    /// Returns the coordinates of the compliance centre.
    pub fn pose(&self) -> V3 {
        let pose = self.world.pose(self.peg);
        let centre = pose * Point3::new(0.0, 0.0, self.assembly.support.centre);
        V3::new(centre.x, centre.z, -pose.rotation.scaled_axis().y)
    }

    /// Returns the load of the springs, whose axes turn with the flange, on the compliance centre.
    pub fn load(&self) -> V3 {
        let (sin, cos) = libm::sincos(self.target.z - self.tilt);
        let turned = |v: V3, sin: f64| V3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z);
        let stiffness = self.assembly.support.stiffness();
        turned(stiffness.component_mul(&turned(self.target - self.pose(), -sin)), sin)
    }

    /// Returns the depth of the middle of the tip, m.
    pub fn depth(&self) -> f64 {
        -self.assembly.support.tip(&self.pose()).y
    }

    /// Drives the target at a velocity for a step.
    pub fn step(&mut self, velocity: &V3) -> Measured<()> {
        self.target += velocity * self.world.step_s();
        let at = Translation3::new(self.target.x, 0.0, self.target.y);
        let pose = Pose::from_parts(at, turn(self.target.z - self.tilt));
        self.world.drive(self.flange, pose);
        self.world.step()
    }

    /// Drives the target for the time of averaging, and returns the mean depth and force.
    pub fn sample(&mut self, velocity: &V3) -> Measured<[f64; 2]> {
        let count = build::steps(self.world.as_ref(), AVERAGING).max(1);
        let mut sum = [0.0, 0.0];
        for _ in 0..count {
            self.step(velocity)?;
            sum = [sum[0] + self.depth(), sum[1] - self.load().y];
        }
        Ok(sum.map(|sum| sum / count as f64))
    }
}

/// Returns the springs along x, z and about y; the other axes are locked.
fn axes(assembly: &Assembly, damping: f64) -> [Option<Spring>; 6] {
    let inertia = inertia(assembly).moments.y;
    let stiffness = assembly.support.stiffness();
    let spring = |stiffness: f64, mass: f64| {
        Some(Spring::new(stiffness, 2.0 * damping * (stiffness * mass).sqrt()))
    };
    let [x, z] = [stiffness.x, stiffness.y].map(|stiffness| spring(stiffness, MASS));
    [x, None, z, None, spring(stiffness.z, inertia), None]
}

fn inertia(assembly: &Assembly) -> contact::scene::Inertia {
    let centre = assembly.support.centre;
    let size = Vector3::new(2.0 * assembly.peg.half_width, round::THICKNESS, 2.0 * centre);
    build::box_inertia(MASS, size, Point3::new(0.0, 0.0, centre))
}

fn peg_body(assembly: &Assembly, target: &V3, rounding: Rounding) -> Body {
    let tip = assembly.support.tip(target);
    Body {
        name: "peg".into(),
        motion: Motion::Carried(inertia(assembly)),
        pose: Pose::from_parts(Translation3::new(tip.x, 0.0, tip.y), turn(target.z)),
        geoms: vec![rounding.peg(&assembly.peg)],
    }
}

/// Runs an insertion of the referee in an engine.
///
/// # Errors
/// If the simulation diverges.
pub fn run(engine: &dyn Engine, trial: &Trial, rounding: Rounding) -> Measured<Record> {
    let mut slab = Slab::new(engine, &trial.assembly, trial.start(), rounding, DAMPING);
    let mut forces = Vec::new();
    let mut last = [f64::NEG_INFINITY, 0.0];
    while last[0] < trial.depth && last[1] < trial.limit {
        last = slab.sample(&(V3::y() * -SPEED))?;
        forces.push(last);
    }
    let outcome = match last[0] < trial.depth {
        true => trial.classify(&slab.pose()),
        false => Outcome::Inserted,
    };
    Ok(Record { outcome, forces, could_wedge: false, snaps: 0 })
}
