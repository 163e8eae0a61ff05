//! T1 and T7: the springs of a finger, loaded directly.
//!
//! T1, Hooke: at rest a force F displaces the finger by F/k, a moment T turns
//! it by T/k. T7, remote centre of compliance (Whitney 1982, J. Dyn. Sys. Meas.
//! Control 104:65): a force through the centre displaces a held part without
//! turning it; along a line at a distance L from it, it also turns it by F L/k.

use super::build::{self, Measured};
use super::{CheckRow, Tolerance};
use contact::Engine;
use contact::scene::{Body, BodyId, Motion, Pose, Scene};
use input::units::{GRAM, MM, N_PER_MM};
use insertion::finger::{self, Finger};
use nalgebra::{Point3, Vector3};

/// Force of T1, N: as in a grasp.
const FORCE: f64 = 5.0;
/// Moment of T1, N m: turns the softest axis by about one degree.
const MOMENT: f64 = 0.02;
const SIDE_FORCE: f64 = 0.5;
/// Distance of the force of T7 from the remote centre, m.
const OFFSET: f64 = 10.0 * MM;
/// Part in the finger of T7, kg and m.
const PART_MASS: f64 = 5.0 * GRAM;
const PART_SIZE: f64 = 12.0 * MM;

/// Returns the time to come to rest, s: twenty time constants of the slowest axis, a rotation (20 ms).
fn rest_time(finger: &Finger) -> f64 {
    let slowest = finger.springs().map(|s| s.damping / s.stiffness).into_iter().fold(0.0, f64::max);
    20.0 * slowest
}

/// Returns the finger of the middle of the measured range.
fn finger() -> Finger {
    Finger::new(2.0 * N_PER_MM, 40.0 * N_PER_MM)
}

pub fn t1(engine: &dyn Engine) -> Vec<CheckRow> {
    let finger = finger();
    let names = ["x", "y", "z"];
    let row = |axis: usize| {
        let turns = axis >= 3;
        let name = names[axis % 3];
        let spring = finger.springs()[axis];
        let load = if turns { MOMENT } else { FORCE };
        let (kind, unit, scale) =
            if turns { ("rotation about", "rad", 1.0) } else { ("deflection along", "mm", MM) };
        let measured = deflection(engine, &finger, axis, load).map(|by| by / scale);
        let expected = load / spring.stiffness / scale;
        let quantity = format!("{kind} {name} of a finger");
        CheckRow::new("T1", quantity, expected, measured, unit, Tolerance::Relative(1e-6))
    };
    (0..6).map(row).collect()
}

fn deflection(engine: &dyn Engine, finger: &Finger, axis: usize, load: f64) -> Measured {
    let (scene, body) = mounted(finger);
    let mut world = engine.world(&scene);
    let mut wrench = [Vector3::zeros(); 2];
    wrench[axis / 3][axis % 3] = load;
    world.push(body, wrench[0], wrench[1]);
    build::advance(world.as_mut(), rest_time(finger))?;
    let moved = centre_moved(&world.pose(body), finger);
    Ok([moved.translation.vector, moved.rotation.scaled_axis()][axis / 3][axis % 3])
}

/// Weightless finger on a fixed jaw, its pad in the origin.
fn mounted(finger: &Finger) -> (Scene, BodyId) {
    let mut scene = Scene::default();
    let jaw = scene.body(build::fixed("jaw", Pose::identity(), Vec::new()));
    let body = scene.body(Body {
        name: "finger".into(),
        motion: Motion::Free(finger::inertia(finger, -1.0)),
        pose: Pose::identity(),
        geoms: Vec::new(),
    });
    let centre = remote_centre(finger);
    let springs = finger.springs().map(Some);
    build::joint(&mut scene, "springs", [jaw, body], [centre; 2], springs);
    (scene, body)
}

fn remote_centre(finger: &Finger) -> Pose {
    Pose::translation(0.0, 0.0, -finger.rcc)
}

/// Returns the motion of the frame in the remote centre.
fn centre_moved(pose: &Pose, finger: &Finger) -> Pose {
    let centre = remote_centre(finger);
    centre.inverse() * pose * centre
}

pub fn t7(engine: &dyn Engine) -> Vec<CheckRow> {
    let finger = finger();
    let spring = |axis: usize| finger.springs()[axis].stiffness;
    // A force along y turns about x, one along x about y.
    let rows = [(1, 0, "y"), (0, 1, "x")].map(|(along, about, name)| {
        let turn = SIDE_FORCE * OFFSET / spring(3 + about);
        let way = SIDE_FORCE / spring(along) / MM;
        let [through, beside] = [0.0, OFFSET].map(|above| held_part(engine, &finger, along, above));
        let moved = |at: Measured<Pose>| at.map(|moved| moved.translation.vector[along] / MM);
        let turned = |at: Measured<Pose>| at.map(|moved| moved.rotation.scaled_axis()[about].abs());
        let row = |text: &str, expected, measured, unit, tolerance| {
            let quantity = format!("{text}, along {name}");
            CheckRow::new("T7", quantity, expected, measured, unit, tolerance)
        };
        // A rotation of zero is judged by the rotation of the offset force.
        let none = Tolerance::Absolute(0.01 * turn);
        let close = Tolerance::Relative(0.01);
        [
            row("deflection, force through centre", way, moved(through), "mm", close),
            row("rotation, force through centre", 0.0, turned(through), "rad", none),
            row("rotation, force 10 mm beside", turn, turned(beside), "rad", close),
            row("deflection, force 10 mm beside", way, moved(beside), "mm", close),
        ]
    });
    rows.concat()
}

/// Returns the motion of the remote centre when a held part is pushed at a height above it, m.
fn held_part(engine: &dyn Engine, finger: &Finger, along: usize, above: f64) -> Measured<Pose> {
    let (mut scene, holder) = mounted(finger);
    let size = Vector3::repeat(PART_SIZE);
    let part = scene.body(build::block("part", PART_MASS, size, Pose::identity()));
    let rigid = [None; 6];
    build::joint(&mut scene, "grasp", [holder, part], [Pose::identity(); 2], rigid);
    let mut world = engine.world(&scene);
    let load = [Vector3::ith(along, SIDE_FORCE), Vector3::zeros()];
    let line = Point3::new(0.0, 0.0, above - finger.rcc);
    for _ in 0..build::steps(world.as_ref(), rest_time(finger)) {
        build::push(world.as_mut(), part, Point3::origin(), line, load);
        world.step()?;
    }
    Ok(centre_moved(&world.pose(holder), finger))
}
