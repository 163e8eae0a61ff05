//! T11: deflection of the UR5e under a load at the TCP, on published servos and held in position.
//!
//! At rest a force F displaces the TCP by `J K^-1 J^T F`, with the Jacobian J of the six joints and
//! their gains K (Salisbury 1980, 19th IEEE Conf. Decision and Control). Once as in the trials, one
//! body on a coupled 6x6 spring; and once as six links with a sprung joint each (of the soft arm
//! alone: the hinges give 0.8 um/N across their axes, which is 3 % beside gears).
//!
//! T13: a servo-compliant flange whose command sets off.
//!
//! Spring `k` and critical damper act between the command and the flange of mass `m`. If the command
//! sets off at the speed `V`, `z'' + 2 w z' + w^2 z = 0` with `z(0) = 0`, `z'(0) = -V` and `w^2 =
//! k/m`: the flange trails by `V t exp(-w t)`, most at `t = 1/w`, and then by nothing.

use super::build::{self, Measured};
use super::{CheckRow, Tolerance};
use contact::Engine;
use contact::scene::{Body, BodyId, Motion, Pose, Scene, Spring};
use input::shipped::ROBOTS;
use input::units::{MM, N_PER_MM};
use insertion::arm::{Arm, JOINTS};
use insertion::robot::{Drive, Flange, MountedRobot, Robot, Servo};
use insertion::trial::cell;
use nalgebra::{Matrix6, Point3, Translation3, UnitQuaternion, Vector3};

/// Robot file of the arm on its published servos.
const SOFT: &str = "ur5e";
const FORCE: f64 = 5.0;
/// Time in which the servos come to rest, s: twelve times their damping over their gain.
const REST: f64 = 2.4;

/// Returns the deflections of the TCP along a force, T11 rows; none on an engine without coupled springs.
pub fn t11(engine: &dyn Engine) -> Vec<CheckRow> {
    // The shipped files are arms within their reach: tests see to it.
    let arms = [("UR5e", SOFT), ("UR5e held", "ur5e_position")];
    arms.into_iter().flat_map(|(words, file)| of_robot(engine, words, file)).collect()
}

fn of_robot(engine: &dyn Engine, words: &str, file: &str) -> Vec<CheckRow> {
    let Some((arm, mounted)) = shipped(file) else { return Vec::new() };
    let mut models = vec![("coupled spring", flange(&mounted))];
    if engine.supports(&models[0].1.scene).is_err() {
        return Vec::new();
    }
    if file == SOFT {
        models.push(("joint chain", chain(&arm)));
    }
    let mut rows = Vec::new();
    for (name, loaded) in models {
        for (axis, along) in ["x", "y", "z"].into_iter().enumerate() {
            let expected = compliance(&arm)[(axis, axis)] * FORCE / MM;
            let moved = loaded.moved(engine, axis, REST);
            let measured = moved.map(|path| path.last().map_or(f64::NAN, |by| by[axis]) / MM);
            let quantity = format!("{words}, {name}, TCP along {along}");
            let close = Tolerance::Relative(0.01);
            rows.push(CheckRow::new("T11", quantity, expected, measured, "mm", close));
        }
    }
    rows
}

/// Returns the shipped arm with the published servos, and its mount for an upright task that is not turned.
pub fn ur5e() -> Option<(Arm, MountedRobot)> {
    shipped(SOFT)
}

fn shipped(name: &str) -> Option<(Arm, MountedRobot)> {
    let file = ROBOTS.iter().find(|file| file.name == name)?;
    let robot = Robot::parse(file.text, file.file).ok()?;
    let mounted = robot.mount(0.0, 0.0).ok()?;
    match robot.drive {
        Drive::Arm(arm) => Some((*arm, mounted)),
        Drive::Ideal | Drive::Servo(_) => None,
    }
}

/// Returns the compliance `J K^-1 J^T` at home: m/N, rad/N, rad/(N m), base axes.
fn compliance(arm: &Arm) -> Matrix6<f64> {
    let jacobian = arm.posture(&arm.home).tcp_jacobian();
    let soft = nalgebra::SVector::from_fn(|i, _| 1.0 / arm.joints[i].stiffness);
    jacobian * Matrix6::from_diagonal(&soft) * jacobian.transpose()
}

/// Scene of the arm at home, without its tool's load.
pub struct Loaded {
    /// Scene in the base frame.
    pub scene: Scene,
    /// Body that carries the TCP.
    pub end: BodyId,
    /// TCP in that body's frame.
    pub tool: Pose,
    /// Centre of mass in that body's frame, m.
    pub centre: Point3<f64>,
}

impl Loaded {
    /// Returns the deflection of the TCP under a force along an axis after each step, m.
    ///
    /// # Errors
    /// If the simulation diverges.
    pub fn moved(
        &self,
        engine: &dyn Engine,
        axis: usize,
        time: f64,
    ) -> Measured<Vec<Vector3<f64>>> {
        let mut world = engine.world(&self.scene);
        let load = [Vector3::ith(axis, FORCE), Vector3::zeros()];
        let from = world.pose(self.end) * self.tool;
        let step = |_| {
            let tcp = world.pose(self.end) * self.tool;
            let at = tcp.translation.vector.into();
            build::push(world.as_mut(), self.end, self.centre, at, load);
            world.step()?;
            let tcp = world.pose(self.end) * self.tool;
            Ok(tcp.translation.vector - from.translation.vector)
        };
        (0..build::steps(engine.world(&self.scene).as_ref(), time)).map(step).collect()
    }
}

/// Returns the scene of a flange as in a trial.
pub fn flange(robot: &MountedRobot) -> Loaded {
    let mut scene = Scene::default();
    let (_, end) = cell::add_flange(&mut scene, &robot.flange, Pose::identity());
    Loaded { scene, end, tool: Pose::identity(), centre: Point3::origin() }
}

/// Returns the scene of a chain of six links, each on a sprung hinge.
pub fn chain(arm: &Arm) -> Loaded {
    let mut scene = Scene::default();
    let posture = arm.posture(&arm.home);
    let mut end = scene.body(build::fixed("base", Pose::identity(), Vec::new()));
    for (i, joint) in arm.joints.iter().enumerate() {
        let link = scene.body(Body {
            name: format!("link of {}", joint.name),
            motion: Motion::Carried(joint.link),
            pose: posture.links[i],
            geoms: Vec::new(),
        });
        let mut axes = [None; 6];
        axes[3 + joint.axis.iamax()] = Some(Spring::new(joint.stiffness, joint.damping));
        // The hinge's zero is the home angle.
        let turn = UnitQuaternion::from_axis_angle(&joint.axis, arm.home[i]);
        let hinge = joint.frame * Pose::from_parts(Translation3::identity(), turn);
        build::joint(&mut scene, &joint.name, [end, link], [hinge, Pose::identity()], axes);
        end = link;
    }
    Loaded { scene, end, tool: arm.tool, centre: arm.joints[JOINTS - 1].link.centre }
}

/// Flange like that of the shipped robot `servo`, from which the expected values are computed.
const SERVO: Servo = Servo {
    stiffness: [10.0 * N_PER_MM, 10.0 * N_PER_MM, 20.0 * N_PER_MM],
    rotational_stiffness: [400.0; 3],
    mass: 2.0,
    inertia: 0.01,
    damping_ratio: 1.0,
};
const SPEED: f64 = 100.0 * MM;

pub(super) fn t13(engine: &dyn Engine) -> Vec<CheckRow> {
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

fn trails(engine: &dyn Engine, axis: usize, time: f64) -> Measured {
    let mut scene = Scene::default();
    let (command, flange) = cell::add_flange(&mut scene, &Flange::Servo(SERVO), Pose::identity());
    let mut world = engine.world(&scene);
    let mut at = Vector3::zeros();
    for _ in 0..build::steps(world.as_ref(), time) {
        at[axis] += SPEED * world.step_s();
        world.drive(command, Pose::translation(at.x, at.y, at.z));
        world.step()?;
    }
    Ok(at[axis] - world.pose(flange).translation.vector[axis])
}
