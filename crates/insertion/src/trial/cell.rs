//! Scene of a trial: robot flange, jaws, fingers, plug, socket.
//!
//! Frames: the world is the task frame. The flange frame is the TCP. The plug
//! stands upright at its pick-up pose, vertically above the start of the search.

use crate::robot::{Flange, MountedRobot, Servo};
use crate::task::{Latch, PadTorsion, geometry};
use crate::{Finger, Part, Task, finger};
use contact::scene::{
    AxialFriction, Body, BodyId, Friction, Geom, Inertia, Joint, JointId, Motion, Pose, Scene,
    Shape, Spring, Springs, Torsion,
};
use input::units::MM;
use nalgebra::{Matrix6, Point3, Translation3, UnitQuaternion, Vector3};

/// Acceleration of gravity, m/s2.
pub const GRAVITY: f64 = 9.81;

/// Height of the pick-up pose above the start pose, m.
const PICK_UP_HEIGHT: f64 = 10.0 * MM;
/// Gap between each pad and the plug before the grasp, m.
const PAD_GAP: f64 = 0.5 * MM;
/// Mass of a jaw, kg.
const JAW_MASS: f64 = 0.05;
/// Gain of the jaw's position servo, N/m (paper, Table "Simulation Inputs").
const JAW_GAIN: f64 = 1000.0;
/// Damping of the jaw's servo, N s/m: two jaws of 50 g close without bouncing.
const JAW_DAMPING: f64 = 30.0;
/// Speed at which a jaw's target closes, m/s.
const CLOSING_SPEED: f64 = 0.1;
/// Largest travel of a jaw's target, m: covers the deflections of the softest finger and of the servo.
const CLOSING_STROKE: f64 = 0.02;
/// Damping ratio of a latch: low enough to snap, high enough to come to rest before the next move.
const LATCH_DAMPING: f64 = 0.1;
/// Stiffness of a held jaw, N/m: a non-backdrivable gear.
const HOLD_GAIN: f64 = 1e7;

/// A scene and the handles that a trial needs.
#[derive(Debug, Clone)]
pub struct WorkCell {
    /// Bodies, joints and contact pairs.
    pub scene: Scene,
    /// Commanded body: the flange itself, or the target of its servo.
    pub command: BodyId,
    /// Robot flange, at the TCP.
    pub flange: BodyId,
    /// Jaw and finger at -y, and at +y.
    pub hands: [Hand; 2],
    /// Plug without its latch.
    pub plug: BodyId,
    /// Latch of the plug, if it has one.
    pub latch: Option<BodyId>,
    /// Fixed connector half.
    pub socket: BodyId,
    /// Stand of the plug until it is grasped.
    pub stand: BodyId,
}

/// One jaw with its finger.
#[derive(Debug, Clone, Copy)]
pub struct Hand {
    /// Jaw that the robot's gripper drives.
    pub jaw: BodyId,
    /// Finger on the jaw.
    pub finger: BodyId,
    /// The jaw's slide; axis 1 (y) is the servo.
    pub slide: JointId,
    /// y of the jaw in the flange frame at position 0 of the slide, m.
    pub zero_y: f64,
}

/// Builds the scene for one pair of fingers; the jaws are open.
pub fn build(task: &Task, robot: &MountedRobot, finger: &Finger) -> WorkCell {
    let mut scene = Scene { gravity: Vector3::new(0.0, 0.0, -GRAVITY), ..Scene::default() };
    let [x, y, z] = task.strategy.start;
    let tcp = Pose::translation(x, y, z + PICK_UP_HEIGHT);
    let plug_pose = tcp * Pose::translation(0.0, 0.0, -task.grip.tcp_z);
    let (command, flange) = add_flange(&mut scene, &robot.flange, tcp);
    let plug = scene.body(plug_body(task, plug_pose));
    let geoms = task.socket.iter().flat_map(Part::geoms).collect();
    let socket = scene.body(body("socket", Motion::Fixed, Pose::identity(), geoms));
    let stand = scene.body(stand_body(task, plug_pose));
    let hands = [-1.0, 1.0].map(|side| add_hand(&mut scene, task, finger, flange, side));
    let latch = task.plug.latch.as_ref().map(|latch| add_latch(&mut scene, task, latch, plug));
    let socket_friction = Friction::hard(task.friction.plug_socket);
    scene.contact(plug, socket, socket_friction);
    scene.contact(plug, stand, socket_friction);
    if let Some(latch) = latch {
        scene.contact(latch, socket, socket_friction);
    }
    scene.axial_friction = task.mating_force.as_ref().map(|force| AxialFriction {
        parent: socket,
        child: plug,
        region: task.opening,
        force: force.clone(),
    });
    let pad_friction = pad_friction(task);
    for hand in &hands {
        scene.contact(hand.finger, plug, pad_friction);
    }
    WorkCell { command, flange, hands, plug, latch, socket, stand, scene }
}

/// Returns the servo setting of a jaw (0 at -y, 1 at +y) that has been closing for `time` seconds. The target moves
/// at constant speed until the servo is at its limit; a step of the target would drive the jaw into its stop.
pub fn closing(side: usize, force: f64, time: f64) -> Spring {
    let inward = if side == 0 { 1.0 } else { -1.0 };
    let target = inward * (time * CLOSING_SPEED).min(CLOSING_STROKE);
    Spring { stiffness: JAW_GAIN, damping: JAW_DAMPING, target, limit: force }
}

/// Returns the servo setting that holds a jaw at a position.
pub fn holding(position: f64) -> Spring {
    Spring { stiffness: HOLD_GAIN, damping: 1e4, target: position, limit: f64::INFINITY }
}

/// Adds the commanded body and the flange that follows it; both are one body if it follows exactly.
pub fn add_flange(scene: &mut Scene, model: &Flange, tcp: Pose) -> (BodyId, BodyId) {
    let command = scene.body(body("command", Motion::Driven, tcp, Vec::new()));
    let (motion, springs) = match model {
        Flange::Ideal => return (command, command),
        Flange::Servo(servo) => servo_flange(servo),
        Flange::Arm(arm) => (Motion::Mechanism(arm.mass), arm.servo()),
    };
    let flange = scene.body(body("flange", motion, tcp, Vec::new()));
    scene.joint(joint("servo", [command, flange], [Pose::identity(); 2], springs));
    if let Flange::Arm(arm) = model
        && !arm.feed_forward
    {
        // Without velocity feed-forward the damper is between flange and world, along the axes of the tilted TCP.
        let damper = Springs::Coupled { stiffness: Matrix6::zeros(), damping: arm.damping };
        let base = scene.body(body("base", Motion::Fixed, tcp, Vec::new()));
        let tilt = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), arm.tilt);
        let frames = [Pose::from_parts(Translation3::identity(), tilt), Pose::identity()];
        scene.joint(joint("brake", [base, flange], frames, damper));
    }
    (command, flange)
}

fn servo_flange(servo: &Servo) -> (Motion, Springs) {
    let moments = Vector3::repeat(servo.inertia);
    let inertia = Inertia { mass: servo.mass, centre: Point3::origin(), moments };
    let spring = |k: f64, m: f64| Some(Spring::new(k, 2.0 * servo.damping_ratio * (k * m).sqrt()));
    let [x, y, z] = servo.stiffness.map(|k| spring(k, servo.mass));
    let [rx, ry, rz] = servo.rotational_stiffness.map(|k| spring(k, servo.inertia));
    (Motion::Carried(inertia), Springs::Axes([x, y, z, rx, ry, rz]))
}

fn pad_friction(task: &Task) -> Friction {
    let coefficient = task.friction.finger_plug;
    let torsion = match task.friction.finger_torsion {
        PadTorsion::Patch => Torsion::Patch,
        PadTorsion::Points(moment) if coefficient > 0.0 => Torsion::Radius(moment / coefficient),
        // Without friction there is no torsional friction.
        PadTorsion::Points(_) => Torsion::Radius(0.0),
    };
    Friction { coefficient, torsion }
}

fn plug_body(task: &Task, pose: Pose) -> Body {
    let mass = task.plug.mass - latch_mass(task);
    let inertia = geometry::inertia(task.plug.rigid(), mass);
    body("plug", Motion::Free(inertia), pose, task.plug.rigid().flat_map(Part::geoms).collect())
}

fn latch_mass(task: &Task) -> f64 {
    let volume = |part: &Part| geometry::volume(&part.solid);
    let latch: f64 = task.plug.latch_parts().map(volume).sum();
    task.plug.mass * (latch / task.plug.parts.iter().map(volume).sum::<f64>())
}

/// Adds the latch on its hinge: a separate body, whose frame equals that of the plug while the latch is not bent.
fn add_latch(scene: &mut Scene, task: &Task, latch: &Latch, plug: BodyId) -> BodyId {
    let inertia = geometry::inertia(task.plug.latch_parts(), latch_mass(task));
    let pose = scene.bodies[plug.0].pose;
    let geoms = task.plug.latch_parts().flat_map(Part::geoms).collect();
    let body = scene.body(body("latch", Motion::Free(inertia), pose, geoms));
    let mut arm = inertia.centre - latch.hinge;
    arm[latch.axis] = 0.0;
    let about_hinge = inertia.moments[latch.axis] + inertia.mass * arm.norm_squared();
    let damping = 2.0 * LATCH_DAMPING * (latch.stiffness * about_hinge).sqrt();
    let mut axes = [None; 6];
    axes[3 + latch.axis] = Some(Spring::new(latch.stiffness, damping));
    let hinge = Pose::from_parts(Translation3::from(latch.hinge.coords), nalgebra::one());
    scene.joint(joint("hinge of the latch", [plug, body], [hinge; 2], Springs::Axes(axes)));
    body
}

fn stand_body(task: &Task, plug: Pose) -> Body {
    let corners = task.plug.rigid().flat_map(|part| part.solid.corners());
    let bottom = corners.map(|p| p.z).fold(f64::INFINITY, f64::min);
    let half = Vector3::new(20.0, 20.0, 1.0) * MM;
    let pose = plug * Pose::translation(0.0, 0.0, bottom - half.z);
    let geom = Geom {
        name: "stand".into(),
        shape: Shape::Box { half },
        pose: Pose::identity(),
        friction: None,
    };
    body("stand", Motion::Fixed, pose, vec![geom])
}

/// Adds a jaw on its slide and a finger on its six springs; `side` is -1 or +1.
fn add_hand(scene: &mut Scene, task: &Task, finger: &Finger, flange: BodyId, side: f64) -> Hand {
    let label = if side < 0.0 { "-y" } else { "+y" };
    let face = if side < 0.0 { task.grip.faces_y[0] } else { task.grip.faces_y[1] };
    // Jaw and finger frames lie on the pad's surface at the height of the TCP.
    let zero_y = face + side * PAD_GAP;
    let in_flange = Pose::translation(0.0, zero_y, 0.0);
    let inertia =
        Inertia { mass: JAW_MASS, centre: Point3::origin(), moments: Vector3::repeat(1e-4) };
    let pose = scene.bodies[flange.0].pose * in_flange;
    let jaw = scene.body(body(format!("jaw {label}"), Motion::Carried(inertia), pose, Vec::new()));
    let mut axes = [None; 6];
    axes[1] = Some(Spring { limit: task.grip.force, ..Spring::new(JAW_GAIN, JAW_DAMPING) });
    let frames = [in_flange, Pose::identity()];
    let slide =
        scene.joint(joint(format!("slide {label}"), [flange, jaw], frames, Springs::Axes(axes)));
    let motion = Motion::Free(finger::inertia(finger, side));
    let geoms = finger.pad.geoms(task.grip.shoulder(), side);
    let body = scene.body(body(format!("finger {label}"), motion, pose, geoms));
    let rcc = Pose::from_parts(Translation3::from(finger.centre(side).coords), nalgebra::one());
    let springs = finger.jaw_springs(side);
    scene.joint(joint(format!("springs {label}"), [jaw, body], [rcc; 2], springs));
    Hand { jaw, finger: body, slide, zero_y }
}

fn body(name: impl Into<String>, motion: Motion, pose: Pose, geoms: Vec<Geom>) -> Body {
    Body { name: name.into(), motion, pose, geoms }
}

fn joint(
    name: impl Into<String>,
    [parent, child]: [BodyId; 2],
    [in_parent, in_child]: [Pose; 2],
    springs: Springs,
) -> Joint {
    Joint { name: name.into(), parent, child, in_parent, in_child, springs }
}
