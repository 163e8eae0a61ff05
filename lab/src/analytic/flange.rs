//! T13: a servo-compliant flange whose command sets off.
//!
//! Spring `k` and critical damper act between the command and the flange of mass `m`. If the command
//! sets off at the speed `V`, `z'' + 2 w z' + w^2 z = 0` with `z(0) = 0`, `z'(0) = -V` and `w^2 =
//! k/m`: the flange trails by `V t exp(-w t)`, most at `t = 1/w`, and then by nothing.

use super::build;
use super::{CheckRow, Tolerance};
use contact::scene::{Pose, Scene};
use contact::{Diverged, Engine};
use input::units::{MM, N_PER_MM};
use insertion::robot::{Flange, Servo};
use insertion::trial::cell;
use nalgebra::Vector3;

/// Flange like that of the shipped robot `servo`, from which the expected values are computed.
const SERVO: Servo = Servo {
    stiffness: [10.0 * N_PER_MM, 10.0 * N_PER_MM, 20.0 * N_PER_MM],
    rotational_stiffness: [400.0; 3],
    mass: 2.0,
    inertia: 0.01,
    damping_ratio: 1.0,
};
const SPEED: f64 = 100.0 * MM;

pub fn t13(engine: &dyn Engine) -> Vec<CheckRow> {
    let rows = [(1, "y"), (2, "z")].map(|(axis, name)| {
        let frequency = (SERVO.stiffness[axis] / SERVO.mass).sqrt();
        let most = SPEED / (frequency * std::f64::consts::E) / MM;
        let row = |text, time, expected, tolerance| {
            let measured = trails(engine, axis, time).map(|by| by / MM);
            let quantity = format!("flange trails its command along {name}, {text}");
            CheckRow::new("T13", quantity, expected, measured, "mm", tolerance)
        };
        [
            row("most", 1.0 / frequency, most, Tolerance::Relative(0.05)),
            row("later", 20.0 / frequency, 0.0, Tolerance::Absolute(0.001)),
        ]
    });
    rows.concat()
}

fn trails(engine: &dyn Engine, axis: usize, time: f64) -> Result<f64, Diverged> {
    let mut scene = Scene::default();
    let (command, flange) = cell::flange(&mut scene, &Flange::Servo(SERVO), Pose::identity());
    let mut world = engine.world(&scene);
    let mut at = Vector3::zeros();
    for _ in 0..build::steps(world.as_ref(), time) {
        at[axis] += SPEED * world.step_s();
        world.drive(command, Pose::translation(at.x, at.y, at.z));
        world.step()?;
    }
    Ok(at[axis] - world.pose(flange).translation.vector[axis])
}
