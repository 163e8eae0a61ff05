//! T12: a face that slides or turns on another, as a part does in the grasp.
//!
//! A face that slides without turning is held back through its centre of pressure (Mason 1986, Int.
//! J. Robot. Res. 5:53): beside the middle by `e` the friction `mu N` has the moment `mu N e`. A soft
//! face of patch radius `rho` also resists a turn: at each point that bears `N`, force `F` and moment
//! `M` lie within `(F/mu N)^2 + (M/mu N rho)^2 = 1` (Howe and Cutkosky 1996, Int. J. Robot. Res.
//! 15:557). A face of points at the radius `r` then turns at `mu N sqrt(rho^2 + r^2)`.
//!
//! T15: the friction of a contact patch ([`Torsion::Patch`]). It turns at `mu N` times the mean
//! distance of its area from the centre of pressure, 4.0 mm for 12 x 9 mm, whatever points carry it;
//! loaded `e` beside its middle only the part about that centre is pressed, shorter by `2 e`.

use super::build::{self, Measured};
use super::{CheckRow, Tolerance};
use contact::Engine;
use contact::scene::{BodyId, Friction, Pose, Scene, Spring, Torsion};
use input::units::{GRAM, MM};
use nalgebra::{Rotation2, Translation3, UnitQuaternion, Vector2, Vector3};

/// Friction, load and patch of the face: finger and plug in the grasp.
const FRICTION: f64 = 1.0;
const LOAD: f64 = 5.0;
const PATCH: f64 = 30.0 * MM;
/// The block: its face is as large as a fingertip's pad.
const MASS: f64 = 5.0 * GRAM;
const SIZE: [f64; 3] = [12.0 * MM, 8.4 * MM, 6.0 * MM];
/// Distances of the load from the middle along y, m.
const BESIDE: [f64; 2] = [1.5 * MM, 3.0 * MM];
/// Springs that hold the block: along, N/m, and about the normal, N m/rad.
const HOLD: f64 = 1e4;
const TURN: f64 = 10.0;
/// Speeds at which a hand draws the block, m/s, and turns it, rad/s: as slow as slip in a grasp.
const DRAWN: f64 = 1.0 * MM;
const TURNED: f64 = DRAWN / PATCH;
/// Duration, s: nine times what an uneven face takes to come to rest in its turn.
const DRAWING: f64 = 4.0;

/// Returns the moments of a pad's friction, T12 rows; fewer on an engine without torsional friction.
pub fn t12(engine: &dyn Engine) -> Vec<CheckRow> {
    let drawn = |beside: f64| {
        let quantity = format!("moment of a face loaded {} mm beside", beside / MM);
        let case = Case { beside, speed: DRAWN, ..TURNING };
        moment("T12", quantity, FRICTION * LOAD * beside, case.hold(engine))
    };
    let mut rows = BESIDE.map(drawn).to_vec();
    if !engine.version().starts_with("rapier") {
        rows.extend([0.0, DRAWN].into_iter().flat_map(|speed| turning(engine, speed)));
    }
    rows
}

/// Returns the moment, and force if it moves, of a face that turns while it is drawn at a speed, m/s.
fn turning(engine: &dyn Engine, speed: f64) -> Vec<CheckRow> {
    let held = Case { speed, spin: TURNED, ..TURNING }.hold(engine);
    let angle = held.as_ref().map_or(0.0, |held| held.angle);
    let (force, resisting) = friction(speed, TURNED, angle);
    let how = if speed > 0.0 { "drawn and turned" } else { "turned" };
    let mut rows = vec![moment("T12", format!("moment of a face, {how}"), resisting, held)];
    if speed > 0.0 {
        let (quantity, held) = (format!("force of a face, {how}"), held.map(|held| held.force));
        rows.push(CheckRow::new("T12", quantity, force, held, "N", Tolerance::Relative(0.02)));
    }
    rows
}

fn moment(check: &'static str, quantity: String, expected: f64, held: Measured<Held>) -> CheckRow {
    let measured = held.map(|held| held.moment / MM);
    CheckRow::new(check, quantity, expected / MM, measured, "N mm", Tolerance::Relative(0.02))
}

/// Returns the force along x, N, and moment, N m, of a moving and turning face on four equal corners.
fn friction(speed: f64, spin: f64, angle: f64) -> (f64, f64) {
    let corners = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    corners.into_iter().fold((0.0, 0.0), |(force, moment), (x, y)| {
        let r = Rotation2::new(angle) * Vector2::new(x * SIZE[0], y * SIZE[1]) / 2.0;
        let v = Vector2::new(speed - spin * r.y, spin * r.x);
        let press = FRICTION * LOAD / 4.0 / libm::hypot(v.norm(), spin * PATCH);
        let turning = r.perp(&v) + PATCH * PATCH * spin;
        (force + press * v.x, moment + press * turning)
    })
}

/// Returns the moments of a contact patch, T15 rows; none on an engine without such friction.
pub fn t15(engine: &dyn Engine) -> Vec<CheckRow> {
    let patch = Case { torsion: Torsion::Patch, ..TURNING };
    if engine.supports(&patch.scene().0).is_err() {
        return Vec::new();
    }
    let turned = [0.0, BESIDE[0]].map(|beside| {
        let quantity = format!("moment of a patch turned, load {} mm beside", beside / MM);
        let lever = mean_lever([SIZE[0], SIZE[1] - 2.0 * beside]);
        // Not guided, it turns about its centre of pressure.
        let case = Case { beside, spin: TURNED, guide: 0.0, time: 1.0, ..patch };
        moment("T15", quantity, FRICTION * LOAD * lever, case.hold(engine))
    });
    let drawn = BESIDE.map(|beside| {
        let quantity = format!("moment of a patch drawn, load {} mm beside", beside / MM);
        let case = Case { beside, speed: DRAWN, ..patch };
        moment("T15", quantity, FRICTION * LOAD * beside, case.hold(engine))
    });
    [turned, drawn].concat()
}

/// Returns the mean distance of a rectangle's area from its middle by the midpoint rule, m.
fn mean_lever(sides: [f64; 2]) -> f64 {
    const CELLS: usize = 400;
    let at = |i: usize, side: f64| side * ((i as f64 + 0.5) / CELLS as f64 - 0.5);
    let cells = (0..CELLS).flat_map(|i| (0..CELLS).map(move |j| (i, j)));
    let sum: f64 = cells.map(|(i, j)| libm::hypot(at(i, sides[0]), at(j, sides[1]))).sum();
    sum / (CELLS * CELLS) as f64
}

/// Resistance of a block that a hand draws and turns over a floor.
#[derive(Debug, Clone, Copy)]
struct Held {
    force: f64,
    moment: f64,
    angle: f64,
}

#[derive(Debug, Clone, Copy)]
struct Case {
    torsion: Torsion,
    /// Distance of the load from the middle along y, m.
    beside: f64,
    speed: f64,
    spin: f64,
    /// Springs along x and y, N/m.
    guide: f64,
    time: f64,
}

/// Block loaded in its middle, at rest.
const TURNING: Case = Case {
    torsion: Torsion::Radius(PATCH),
    beside: 0.0,
    speed: 0.0,
    spin: 0.0,
    guide: HOLD,
    time: DRAWING,
};

impl Case {
    fn hold(&self, engine: &dyn Engine) -> Measured<Held> {
        let Case { beside, speed, spin, guide, .. } = *self;
        let (scene, hand, block) = self.scene();
        let mut world = engine.world(&scene);
        world.push(block, -Vector3::z() * LOAD, -Vector3::x() * (LOAD * beside));
        let step = world.step_s();
        let mut to = Pose::identity();
        for k in 1..=build::steps(world.as_ref(), self.time) {
            let time = k as f64 * step;
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), spin * time);
            to = Pose::from_parts(Translation3::new(speed * time, 0.0, 0.0), turn);
            world.drive(hand, to);
            world.step()?;
        }
        let at = world.pose(block);
        let angle = |pose: &Pose| pose.rotation.scaled_axis().z;
        let lag = to.translation.vector - (at * foot()).translation.vector;
        // Drawn only, the face's friction turns the block; the hand's spring holds against it.
        let moment = TURN * (angle(&to) - angle(&at)).abs();
        Ok(Held { force: guide * lag.x, moment, angle: angle(&at) })
    }

    /// Returns a block on a floor through the origin, on springs in the plane to a driven hand.
    fn scene(&self) -> (Scene, BodyId, BodyId) {
        let mut scene = Scene::default();
        let floor = scene.body(build::ground([0.2, 0.2, 0.02], Pose::identity()));
        let block = scene.body(build::block("block", MASS, Vector3::from(SIZE), foot().inverse()));
        scene.contact(floor, block, Friction { coefficient: FRICTION, torsion: self.torsion });
        let hand = scene.body(build::driven("hand", Pose::identity(), Vec::new()));
        let springs = [self.guide, self.guide, 0.0, 0.0, 0.0, TURN];
        // Damped within a few milliseconds.
        let sprung = |stiffness: f64| Some(Spring::new(stiffness, stiffness * 2e-3));
        let frames = [Pose::identity(), foot()];
        build::joint(&mut scene, "springs", [hand, block], frames, springs.map(sprung));
        (scene, hand, block)
    }
}

fn foot() -> Pose {
    Pose::translation(0.0, 0.0, -SIZE[2] / 2.0)
}
