//! Export of scenes as MJCF, the model format of MuJoCo (<https://mujoco.readthedocs.io>), for its
//! viewer and for the engine `mujoco`.
//!
//! | scene | MJCF |
//! | --- | --- |
//! | fixed body | `mocap` body, so that it can be moved |
//! | driven body | a heavy body on three slides and three hinges, with position actuators; `gravcomp` |
//! | free, carried body | free joint, unless it is the child of a joint; `gravcomp` if carried |
//! | joint | the child inside the parent, a slide or hinge for each axis that is not locked |
//! | spring, servo | the joint's own stiffness and damping; a `position` actuator with its limit |
//! | contacts of two bodies | a `pair` for each pair of their geoms, and no others |
//! | friction along an axis | a tendon, whose `frictionloss` has to be set in each step |
//!
//! The rotations of a joint are successive rotations about x, y and z, where those of a scene are a
//! rotation vector: both agree for rotation about one axis, and to first order in general.

mod body;
mod contact;
mod xml;

use super::unsupported_parts;
use crate::direct::Direct;
use crate::scene::{AxialFriction, Body, Joint, Motion, Scene, Spring, Springs};
use xml::Element;

/// Settings of the simulation in MuJoCo.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct MjcfSettings {
    /// Length of a step, s: that of the published simulation. In MuJoCo a contact begins when the surfaces overlap;
    /// with twice the step, a light plug under a sudden force of 70 N penetrates too far (check T10).
    pub step_s: f64,
    /// Stiffness of a contact point, N/m: that of the engine `direct`.
    pub contact_stiffness: f64,
    /// Damping of a contact point, N s/m: that of the engine `direct`.
    pub contact_damping: f64,
    /// Damping of a sticking point, N s/m: that of the engine `direct`.
    pub stick_damping: f64,
    /// Mass that a contact point adds to its bodies, `1/R` in `contact.rs`, kg: small enough for check T10. With less,
    /// the contact's damper would be too stiff for a step, beyond about `damping * step / mass = 1`.
    pub contact_mass: f64,
    /// Rate at which the tangential velocity of a sticking point decays, `b_f` in `contact.rs`, 1/s. With a higher rate
    /// a sliding point floats higher (check T12); with a lower one, more of the penetration of the contact appears as
    /// sliding (T10).
    pub friction_rate: f64,
    /// Tolerance of MuJoCo's solver, dimensionless.
    pub tolerance: f64,
    /// MuJoCo's `multiccd`: whether two meshes may touch at several points. At a rim the normals of these points are
    /// wrong; without this option, the face of a mesh is supported at one point only.
    pub multiccd: bool,
}

impl Default for MjcfSettings {
    fn default() -> Self {
        let Direct { contact_stiffness, contact_damping, stick_damping, .. } = Direct::default();
        MjcfSettings {
            step_s: 5e-5,
            contact_stiffness,
            contact_damping,
            stick_damping,
            contact_mass: 0.1,
            friction_rate: 3000.0,
            tolerance: 1e-10,
            multiccd: true,
        }
    }
}

/// Mass and moments of inertia of a driven body, kg, kg m2: in a step of 50 us a force of 100 N moves it by 0.25 nm.
pub const HEAVY: f64 = 1000.0;
/// Natural frequency, 1/s, at which a driven body follows its actuators in MuJoCo's viewer.
const VIEWER_FREQUENCY: f64 = 100.0;

/// Error of a scene that needs a feature that MJCF lacks.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{part}` cannot be written as MJCF, which does not support {feature}")]
pub struct NotMjcf {
    /// Name of the body or joint.
    pub part: String,
    /// Missing feature.
    pub feature: &'static str,
}

/// Checks that a scene can be written.
///
/// # Errors
/// If it has a feature that MJCF lacks.
pub fn supports(scene: &Scene) -> Result<(), NotMjcf> {
    let refuse = |part: &str, feature| Err(NotMjcf { part: part.to_owned(), feature });
    if let Some((part, feature)) = unsupported_parts(scene).next_back() {
        return refuse(part, feature);
    }
    for (i, joint) in scene.joints.iter().enumerate() {
        let child = &scene.bodies[joint.child.0];
        if matches!(child.motion, Motion::Fixed | Motion::Driven) {
            return refuse(&joint.name, "joints that carry a fixed or driven body");
        }
        if scene.joints[..i].iter().any(|other| other.child == joint.child) {
            return refuse(&joint.name, "bodies on two joints");
        }
        if !body::at_zero(scene, joint) {
            return refuse(&joint.name, "joints with nonzero initial coordinates");
        }
    }
    Ok(())
}

/// Returns the scene as MJCF text; `name` is shown by viewers.
///
/// # Errors
/// See [`supports`].
pub fn write(scene: &Scene, name: &str, settings: &MjcfSettings) -> Result<String, NotMjcf> {
    supports(scene)?;
    let g = scene.gravity;
    // A diverged state must remain visible and not be reset.
    let flags = Element::new("flag").with("autoreset", "disable");
    let flags = if settings.multiccd { flags } else { flags.with("multiccd", "disable") };
    let option = Element::new("option")
        .with("timestep", settings.step_s)
        .numbers("gravity", [g.x, g.y, g.z])
        // Springs and dampers are solved for together with the contacts.
        .with("integrator", "discrete")
        .with("cone", "elliptic")
        // Ratio of frictional to normal constraint impedance, for all pairs.
        .with("impratio", settings.stick_damping / (settings.friction_rate * settings.contact_mass))
        .with("solver", "Newton")
        .with("tolerance", settings.tolerance)
        .with_children([flags]);
    let geom = Element::new("geom").with("contype", 0).with("conaffinity", 0);
    let model = Element::new("mujoco").with("model", name).with_children([
        Element::new("compiler").with("angle", "radian").with("autolimits", "true"),
        option,
        Element::new("visual").with_children([Element::new("map").with("znear", 0.01)]),
        Element::new("statistic").numbers("center", [0.0; 3]).with("extent", 0.15),
        // Only the listed pairs touch.
        Element::new("default").with_children([geom]),
        body::assets(scene),
        body::world(scene),
        contact::pairs(scene, settings),
        actuators(scene),
    ]);
    let tendon = |friction| tendon(friction, settings.step_s);
    let model = model.with_children(scene.axial_friction.iter().flat_map(tendon));
    let units = "<!-- Lengths in m, masses in kg, forces in N, angles in rad. -->\n";
    Ok(units.to_owned() + &model.text(0))
}

/// Name of the tendon with the axial friction, and of its end on the plug.
pub(crate) const MATING_FORCE: &str = "mating force";
/// Name of the other end of that tendon.
const ANCHOR: &str = "anchor of the mating force";
/// Distance of the anchor below the socket's origin, m: a lateral offset of 1 mm inclines the tendon by 0.1 mrad.
const FAR: f64 = 10.0;
/// Constraint impedance of the axial friction: the largest that MuJoCo accepts.
const STICKING: f64 = 0.9999;

/// Returns the tendon of an axial friction and, as custom numbers, depths, m, with the largest force there, N: MJCF has
/// no friction that depends on position, so `frictionloss` has to be set in each step.
fn tendon(friction: &AxialFriction, step_s: f64) -> [Element; 2] {
    let site = |name| Element::new("site").with("site", name);
    let spatial = Element::new("spatial")
        .with("name", MATING_FORCE)
        .numbers("rgba", [0.0; 4])
        .with("frictionloss", 0)
        // As stiff as the step allows, like a sticking contact point.
        .numbers("solreffriction", [2.0 * step_s, 1.0])
        .numbers("solimpfriction", [STICKING, STICKING, 1e-3])
        .with_children([site(ANCHOR), site(MATING_FORCE)]);
    let numeric = |name: &str, column: usize| {
        let name = format!("{MATING_FORCE}: {name}");
        let values = friction.force.iter().map(|row| row[column]);
        Element::new("numeric").with("name", name).numbers("data", values)
    };
    let table = [numeric("depth of the tip", 0), numeric("frictionloss", 1)];
    [Element::new("tendon").with_children([spatial]), Element::new("custom").with_children(table)]
}

/// Returns the actuators of the driven bodies and of the servos.
fn actuators(scene: &Scene) -> Element {
    let driven = scene.bodies.iter().filter(|body| body.motion == Motion::Driven);
    let stiffness = HEAVY * VIEWER_FREQUENCY * VIEWER_FREQUENCY;
    let damping = 2.0 * HEAVY * VIEWER_FREQUENCY;
    let follows = Spring::new(stiffness, damping);
    // The limits, 0.1 m and 0.5 rad, are those of the sliders in a viewer.
    let command =
        |body, i| actuator(&driven_axis_name(body, i), &follows, if i < 3 { 0.1 } else { 0.5 });
    let commands = driven.flat_map(|body| (0..6).map(move |axis| command(body, axis)));
    let servo = |joint, i| Some(actuator(&axis_name(joint, i), servo(joint, i)?, 0.02));
    let servos = scene.joints.iter().flat_map(|joint| (0..6).filter_map(move |i| servo(joint, i)));
    Element::new("actuator").with_children(commands).with_children(servos)
}

fn actuator(joint: &str, spring: &Spring, reach: f64) -> Element {
    let element = Element::new("position").with("name", joint).with("joint", joint);
    let element = element.with("kp", spring.stiffness).with("kv", spring.damping);
    let element = element.numbers("ctrlrange", [-reach, reach]);
    if spring.limit.is_infinite() {
        return element;
    }
    element.numbers("forcerange", [-spring.limit, spring.limit])
}

/// Returns the spring of an axis that is a servo: one with a limit.
pub(crate) fn servo(joint: &Joint, axis: usize) -> Option<&Spring> {
    let Springs::Axes(axes) = &joint.springs else { return None };
    axes[axis].as_ref().filter(|spring| spring.limit.is_finite())
}

/// Names of the axes of a joint, in the order of [`Springs::Axes`].
const AXES: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];

/// Returns the name of an axis of a joint, and of its servo.
pub(crate) fn axis_name(joint: &Joint, axis: usize) -> String {
    format!("{} {}", joint.name, AXES[axis])
}

/// Returns the name of a joint of a driven body, and of its actuator.
pub(crate) fn driven_axis_name(body: &Body, axis: usize) -> String {
    format!("drive {} {}", body.name, AXES[axis])
}

/// Returns the names of all geoms by body, each unique in the scene.
pub fn geom_names(scene: &Scene) -> Vec<Vec<String>> {
    let of_body = |body: &Body| {
        let mut names: Vec<String> = Vec::new();
        for geom in &body.geoms {
            let name = format!("{}: {}", body.name, geom.name);
            let unique = (2..).map(|n| format!("{name} {n}"));
            let mut unique = std::iter::once(name.clone()).chain(unique);
            names.extend(unique.find(|name| !names.contains(name)));
        }
        names
    };
    scene.bodies.iter().map(of_body).collect()
}

fn mesh_name(geom: &str) -> String {
    format!("hull of {geom}")
}
