//! T14: the net force of a contact, by which a trial's force stop and peak force go.
//!
//! A weightless block is pushed against a wall by a force F at the angle a to the wall's normal.
//! While it sticks, tan a < mu, the wall holds F cos a along the normal and F sin a along the wall;
//! once it slides, it rubs with mu F cos a (Coulomb). Nothing acts across the push. Wall and block
//! stand askew, so that axes which are taken for others show.

use super::build;
use super::{CheckRow, Tolerance};
use contact::scene::{Friction, Pose, Scene};
use contact::{Diverged, Engine};
use input::units::{DEG, GRAM, MM};
use nalgebra::{Translation3, UnitQuaternion, Vector3};

/// Force of the push, N: as in a grasp.
const FORCE: f64 = 5.0;
/// Friction of block and wall: of the two parts of the force, neither hides in the other.
const FRICTION: f64 = 0.5;
/// The push along the wall per push against it, as shares of the friction.
const CASES: [(&str, f64); 2] = [("sticks", 0.8), ("slides", 1.2)];
/// The wall's turn about the world's axes, and direction of the push in the wall, degrees.
const WALL: [f64; 3] = [40.0, -25.0, 70.0];
const HEADING: f64 = 37.0;
/// Block, kg and m: flat, so that it does not tip.
const MASS: f64 = 50.0 * GRAM;
const SIZE: [f64; 3] = [20.0 * MM, 12.0 * MM, 8.0 * MM];
/// Time for the contacts to come to rest, s, and time over which the force is averaged.
const RESTING: f64 = 0.03;
const WATCHING: f64 = 0.03;
/// Largest error, as a share of the friction at which the block begins to slide. rapier's
/// friction stands 1.4 degrees askew to the way of a block that is longer than wide, 2.5 %.
const ALLOWED: f64 = 0.03;

/// Components of a contact's net force, T14 rows.
pub fn t14(engine: &dyn Engine) -> Vec<CheckRow> {
    CASES.into_iter().flat_map(|(case, share)| rows(engine, case, share)).collect()
}

fn rows(engine: &dyn Engine, case: &str, share: f64) -> Vec<CheckRow> {
    let angle = (share * FRICTION).atan();
    let normal = FORCE * angle.cos();
    let along = normal * FRICTION * share.min(1.0);
    let found = net_force(engine, angle);
    let parts = [("normal force", normal), ("friction", along), ("across", 0.0)];
    let row = |(axis, (part, expected)): (usize, (&str, f64))| {
        let quantity = format!("wall on a block that {case}, {part}");
        let allowed = Tolerance::Absolute(ALLOWED * FRICTION * normal);
        CheckRow::new("T14", quantity, expected, found.map(|force| force[axis]), "N", allowed)
    };
    parts.into_iter().enumerate().map(row).collect()
}

/// Mean force of the wall on the block, N: normal, against the push along it, and across.
fn net_force(engine: &dyn Engine, angle: f64) -> Result<Vector3<f64>, Diverged> {
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
    scene.contact(wall, block, Friction::hard(FRICTION));

    let mut world = engine.world(&scene);
    let force = (push * angle.sin() - normal * angle.cos()) * FORCE;
    world.push(block, force, Vector3::zeros());
    build::advance(world.as_mut(), RESTING)?;
    let steps = build::steps(world.as_ref(), WATCHING);
    let mut sum = Vector3::zeros();
    for _ in 0..steps {
        world.step()?;
        // On the block, and against what is said to act on the wall.
        sum += world.contact(wall, block).net - world.contact(block, wall).net;
    }
    let mean = sum / (2.0 * steps as f64);
    Ok(Vector3::new(mean.dot(&normal), -mean.dot(&push), mean.dot(&normal.cross(&push))))
}
