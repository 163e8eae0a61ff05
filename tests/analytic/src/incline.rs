//! T2: a block on an incline; T14: the force of a wall on it.
//!
//! Coulomb: on a slope `s` a block slides with the acceleration g (sin s - mu cos s), and rests if
//! tan s < mu. The block lies on the four corners of a face, turned about the slope's normal by a
//! heading: a friction cone that is a pyramid, or that is shared out wrongly among the corners,
//! shows at one of the headings.
//!
//! T14: the net force of a contact, by which a trial's force stop and peak force go.
//!
//! A weightless block is pushed against a wall by a force F at the angle a to the wall's normal.
//! While it sticks, tan a < mu, the wall holds F cos a along the normal and F sin a along the wall;
//! once it slides, it rubs with mu F cos a (Coulomb). Nothing acts across the push. Wall and block
//! stand askew, so that axes which are taken for others show.

use super::build::{self, GRAVITY, Measured};
use super::{CheckRow, Tolerance};
use contact::Engine;
use contact::scene::{Friction, Pose, Scene};
use input::units::{DEG, GRAM, MM};
use nalgebra::{Translation3, UnitQuaternion, Vector3};

/// Friction of plug and socket, of the published reference case, and of finger and plug.
const FRICTIONS: [f64; 3] = [0.2, 0.3, 1.0];
/// Slopes as multiples of the friction: a sliding block, and one that rests.
const SLIDING: f64 = 1.2;
const RESTING: f64 = 0.99;
/// Headings of the block, degrees.
const HEADINGS: [f64; 2] = [0.0, 37.0];
/// Block, kg and m: flat, so that it does not tip at a friction of 1.
const MASS: f64 = 50.0 * GRAM;
const SIZE: [f64; 3] = [20.0 * MM, 12.0 * MM, 8.0 * MM];
/// Time for the contacts to settle before anything is measured, s.
const SETTLING: f64 = 0.02;
/// Time over which a sliding block is watched, s; a resting one twice as long.
const WATCHING: f64 = 0.1;

pub fn t2(engine: &dyn Engine) -> Vec<CheckRow> {
    let mut rows = Vec::new();
    for friction in FRICTIONS {
        for heading in HEADINGS {
            let case = format!("mu {friction}, heading {heading} deg");
            let measured = sliding_friction(engine, friction, heading * DEG);
            let half_percent = Tolerance::Relative(0.005);
            let name = format!("friction, {case}");
            rows.push(CheckRow::new("T2", name, friction, measured, "-", half_percent));
            let creep = creep(engine, friction, heading * DEG, RESTING).map(|speed| speed / MM);
            let (name, slow) = (format!("creep, {case}"), Tolerance::Absolute(0.01));
            rows.push(CheckRow::new("T2", name, 0.0, creep, "mm/s", slow));
        }
    }
    rows
}

/// Returns the friction that explains the acceleration of a sliding block.
fn sliding_friction(engine: &dyn Engine, friction: f64, heading: f64) -> Measured {
    let slope = libm::atan(SLIDING * friction);
    let [first, second] = ways(engine, friction, slope, heading)?;
    let acceleration = (second - first) / (WATCHING * WATCHING);
    Ok((GRAVITY * libm::sin(slope) - acceleration) / (GRAVITY * libm::cos(slope)))
}

/// Returns the speed of a block on a slope whose tangent is a share of the friction, m/s.
pub(super) fn creep(engine: &dyn Engine, friction: f64, heading: f64, share: f64) -> Measured {
    let [first, second] = ways(engine, friction, libm::atan(share * friction), heading)?;
    Ok((first + second) / (2.0 * WATCHING))
}

/// Distances down the slope in two equal times after settling, m.
fn ways(engine: &dyn Engine, friction: f64, slope: f64, heading: f64) -> Measured<[f64; 2]> {
    let size = Vector3::from(SIZE);
    let tilt = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), slope);
    let downhill = tilt * Vector3::x();
    let mut scene = Scene { gravity: Vector3::new(0.0, 0.0, -GRAVITY), ..Scene::default() };
    let turned = Pose::from_parts(Translation3::identity(), tilt);
    let ground = scene.body(build::ground([0.4, 0.1, 0.02], turned));
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), heading);
    let pose = turned * Pose::from_parts(Translation3::new(0.0, 0.0, size.z / 2.0), turn);
    let block = scene.body(build::block("block", MASS, size, pose));
    scene.contact(ground, block, Friction::hard(friction));

    let mut world = engine.world(&scene);
    build::advance(world.as_mut(), SETTLING)?;
    let mut at = world.pose(block).translation.vector.dot(&downhill);
    let mut found = [0.0; 2];
    for distance in &mut found {
        build::advance(world.as_mut(), WATCHING)?;
        let from = std::mem::replace(&mut at, world.pose(block).translation.vector.dot(&downhill));
        *distance = at - from;
    }
    Ok(found)
}

/// Force of the push, N: as in a grasp.
const FORCE: f64 = 5.0;
/// Friction of block and wall: of the two parts of the force, neither hides in the other.
const PUSH_FRICTION: f64 = 0.5;
/// The push along the wall per push against it, as shares of the friction.
const CASES: [(&str, f64); 2] = [("sticks", 0.8), ("slides", 1.2)];
/// The wall's turn about the world's axes, and direction of the push in the wall, degrees.
const WALL: [f64; 3] = [40.0, -25.0, 70.0];
const HEADING: f64 = 37.0;
/// Time for the contacts to come to rest, s, and time over which the force is averaged.
const PUSH_RESTING: f64 = 0.03;
const AVERAGING: f64 = 0.03;
/// Largest error, as a share of the friction at which the block begins to slide. rapier's
/// friction stands 1.4 degrees askew to the way of a block that is longer than wide, 2.5 %.
const ALLOWED: f64 = 0.03;

pub fn t14(engine: &dyn Engine) -> Vec<CheckRow> {
    CASES.into_iter().flat_map(|(case, share)| push_rows(engine, case, share)).collect()
}

fn push_rows(engine: &dyn Engine, case: &str, share: f64) -> Vec<CheckRow> {
    let angle = libm::atan(share * PUSH_FRICTION);
    let normal = FORCE * libm::cos(angle);
    let along = normal * PUSH_FRICTION * share.min(1.0);
    let found = net_force(engine, angle);
    let parts = [("normal force", normal), ("friction", along), ("across", 0.0)];
    let row = |(axis, (part, expected)): (usize, (&str, f64))| {
        let quantity = format!("wall on a block that {case}, {part}");
        let allowed = Tolerance::Absolute(ALLOWED * PUSH_FRICTION * normal);
        CheckRow::new("T14", quantity, expected, found.map(|force| force[axis]), "N", allowed)
    };
    parts.into_iter().enumerate().map(row).collect()
}

/// Returns the mean force of the wall on the block, N: normal, against the push along it, and across.
fn net_force(engine: &dyn Engine, angle: f64) -> Measured<Vector3<f64>> {
    let size = Vector3::from(SIZE);
    let [x, y, z] = WALL.map(|turn| turn * DEG);
    let turn = UnitQuaternion::from_euler_angles(x, y, z);
    let normal = turn * Vector3::z();
    let push = turn * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), HEADING * DEG);
    let push = push * Vector3::x();
    let mut scene = Scene::default();
    let turned = Pose::from_parts(Translation3::identity(), turn);
    let wall = scene.body(build::ground([0.4, 0.4, 0.02], turned));
    let pose = turned * Pose::translation(0.0, 0.0, size.z / 2.0);
    let block = scene.body(build::block("block", MASS, size, pose));
    scene.contact(wall, block, Friction::hard(PUSH_FRICTION));

    let mut world = engine.world(&scene);
    let force = (push * libm::sin(angle) - normal * libm::cos(angle)) * FORCE;
    world.push(block, force, Vector3::zeros());
    build::advance(world.as_mut(), PUSH_RESTING)?;
    let steps = build::steps(world.as_ref(), AVERAGING);
    let mut sum = Vector3::zeros();
    for _ in 0..steps {
        world.step()?;
        // On the block, and against what is said to act on the wall.
        sum += world.contact(wall, block).net - world.contact(block, wall).net;
    }
    let mean = sum / (2.0 * steps as f64);
    Ok(Vector3::new(mean.dot(&normal), -mean.dot(&push), mean.dot(&normal.cross(&push))))
}
