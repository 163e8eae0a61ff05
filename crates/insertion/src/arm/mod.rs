//! A six-joint arm with position servos, and what it feels like at its TCP.
//!
//! Each joint is a servo `tau = k (q_command - q) - c dq/dt`: the arm trails its command by c/k,
//! and a blocked one pushes with its spring alone. With the commanded speed fed forward the damper
//! acts on the error's rate, `c d/dt (q_command - q)`. The links carry their own weight.
//!
//! With six joints and six directions at the TCP, displacements `x = J q` are only another set of
//! coordinates: near a pose the arm *is* one body at the TCP with the coupled 6x6 spring, damper
//! and mass of [`Reduced`]. What that leaves out is how `J` changes with the pose.

mod kinematics;
mod reduced;

pub use kinematics::{Posture, displacement};
pub use reduced::Reduced;

use crate::robot::Kind;
use crate::task::geometry::Axis;
use contact::scene::{Inertia, Pose};
use input::units::{DEG, MM};
use input::{Check, InputError};
use nalgebra::{Point3, Translation3, Unit, UnitQuaternion, Vector3};
use serde::Deserialize;

/// Number of joints of an arm.
pub const JOINTS: usize = 6;

/// Angles of the joints from base to tool, rad.
pub type Angles = nalgebra::SVector<f64, JOINTS>;

/// Six-axis arm model of a robot file, SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    /// Joints from the base to the tool.
    pub joints: [Joint; JOINTS],
    /// The TCP in the last link's frame.
    pub tool: Pose,
    /// Angles with the TCP at the nominal start of a task.
    pub home: Angles,
    /// Whether the servos' dampers act on the error's rate, not on the joint's speed.
    pub feed_forward: bool,
    /// Force with which the assembly move ends on a part that does not give way, N.
    pub assembly_force: f64,
}

/// One joint and the link that it moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name for messages.
    pub name: String,
    /// Joint frame in the frame of the link before.
    pub frame: Pose,
    /// Axis of rotation in that frame.
    pub axis: Unit<Vector3<f64>>,
    /// Gain of its servo, N m/rad.
    pub stiffness: f64,
    /// Damping of its servo, N m s/rad.
    pub damping: f64,
    /// Largest torque, N m.
    pub limit: f64,
    /// Mass properties of its link, in the frame that turns with it.
    pub link: Inertia,
}

/// Error of an arm that cannot work at a pose.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ArmError {
    /// The inverse kinematics ends so far away, mm and degrees.
    #[error(
        "the arm does not reach the start from its home_deg: it misses by {0:.1} mm and {1:.1} \
         degrees; give home_deg near the start, with the tool pointing down"
    )]
    Unreachable(f64, f64),
    /// A direction in which no joint moves the TCP.
    #[error("the arm is in a singular pose at the start: choose another home_deg")]
    Singular,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawArm {
    #[serde(rename = "kind")]
    _kind: Kind,
    pub name: String,
    pub description: String,
    pub stop_force_n: f64,
    home_deg: [f64; JOINTS],
    velocity_feed_forward: bool,
    assembly_force_n: f64,
    tool_mm: [f64; 3],
    tool_turn_deg: [f64; 3],
    joint: Vec<RawJoint>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawJoint {
    name: String,
    offset_mm: [f64; 3],
    turn_deg: [f64; 3],
    axis: Axis,
    stiffness_nm_per_rad: f64,
    damping_nms_per_rad: f64,
    limit_nm: f64,
    link_mass_kg: f64,
    link_centre_mm: [f64; 3],
    link_inertia_kg_m2: [f64; 3],
}

pub(crate) fn arm(check: Check<'_>, raw: &RawArm) -> Result<Arm, InputError> {
    let joints = raw.joint.iter().map(|raw| joint(check, raw)).collect::<Result<Vec<_>, _>>()?;
    let count = joints.len();
    let Ok(joints) = <[Joint; JOINTS]>::try_from(joints) else {
        return check.fail("joint", format!("there are {count}; an arm has six [[joint]]"));
    };
    Ok(Arm {
        joints,
        tool: frame(check, ["tool_mm", "tool_turn_deg"], raw.tool_mm, raw.tool_turn_deg)?,
        home: Angles::from(check.each("home_deg", raw.home_deg, Check::finite)?) * DEG,
        feed_forward: raw.velocity_feed_forward,
        assembly_force: check.positive("assembly_force_n", raw.assembly_force_n)?,
    })
}

fn joint(check: Check<'_>, raw: &RawJoint) -> Result<Joint, InputError> {
    let at = |field: &str| format!("joint \"{}\" {field}", raw.name);
    let moments = check.each(&at("link_inertia_kg_m2"), raw.link_inertia_kg_m2, Check::positive)?;
    let centre = check.each(&at("link_centre_mm"), raw.link_centre_mm, Check::finite)?;
    let [offset, turn] = ["offset_mm", "turn_deg"].map(at);
    Ok(Joint {
        name: raw.name.clone(),
        frame: frame(check, [&offset, &turn], raw.offset_mm, raw.turn_deg)?,
        axis: Vector3::ith_axis(raw.axis as usize),
        stiffness: check.positive(&at("stiffness_nm_per_rad"), raw.stiffness_nm_per_rad)?,
        damping: check.not_negative(&at("damping_nms_per_rad"), raw.damping_nms_per_rad)?,
        limit: check.positive(&at("limit_nm"), raw.limit_nm)?,
        link: Inertia {
            mass: check.positive(&at("link_mass_kg"), raw.link_mass_kg)?,
            centre: Point3::from(centre.map(|v| v * MM)),
            moments: Vector3::from(moments),
        },
    })
}

/// A frame by its origin (mm) and its turns about x, then y, then z (degrees).
fn frame(
    check: Check<'_>,
    [origin_key, turn_key]: [&str; 2],
    origin_mm: [f64; 3],
    turn_deg: [f64; 3],
) -> Result<Pose, InputError> {
    let [x, y, z] = check.each(origin_key, origin_mm, Check::finite)?.map(|v| v * MM);
    let [roll, pitch, yaw] = check.each(turn_key, turn_deg, Check::finite)?.map(|v| v * DEG);
    let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Ok(Pose::from_parts(Translation3::new(x, y, z), turn))
}
