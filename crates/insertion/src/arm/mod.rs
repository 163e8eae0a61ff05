//! Six-joint arm with position servos, and its reduced model at the TCP.
//!
//! Each joint is a servo `tau = k (q_command - q) - c dq/dt`: the arm lags its command by c/k, and a
//! blocked arm pushes with its springs alone. With velocity feed-forward the damper acts on the rate of
//! the error, `c d/dt (q_command - q)`. Gravity on the links is compensated.
//!
//! With six joints and six directions at the TCP, displacements `x = J q` are another set of
//! coordinates: near a pose the arm is equivalent to one body at the TCP with the coupled 6x6 spring,
//! damper and mass of [`Reduced`]. Changes of `J` with the pose are neglected.

mod kinematics;
mod reduced;

pub use kinematics::{Posture, displacement};
pub use reduced::Reduced;

use crate::task::geometry::Axis;
use contact::scene::{Inertia, Pose};
use input::units::read::{deg, mm};
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
    /// The start is out of reach; remaining error of the inverse kinematics, mm and degrees.
    #[error(
        "the arm does not reach the start from its home_deg: it misses by {0:.1} mm and {1:.1} \
         degrees; give home_deg near the start, with the tool pointing down"
    )]
    Unreachable(f64, f64),
    /// There is a direction in which no joint moves the TCP.
    #[error("the arm is in a singular pose at the start: choose another home_deg")]
    Singular,
}

/// Arm in a robot file; SI units.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawArm {
    #[serde(rename = "home_deg", deserialize_with = "deg")]
    home: [f64; JOINTS],
    velocity_feed_forward: bool,
    assembly_force_n: f64,
    #[serde(rename = "tool_mm", deserialize_with = "mm")]
    tool: [f64; 3],
    #[serde(rename = "tool_turn_deg", deserialize_with = "deg")]
    tool_turn: [f64; 3],
    joint: Vec<RawJoint>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawJoint {
    name: String,
    #[serde(rename = "offset_mm", deserialize_with = "mm")]
    offset: [f64; 3],
    #[serde(rename = "turn_deg", deserialize_with = "deg")]
    turn: [f64; 3],
    axis: Axis,
    stiffness_nm_per_rad: f64,
    damping_nms_per_rad: f64,
    limit_nm: f64,
    link_mass_kg: f64,
    #[serde(rename = "link_centre_mm", deserialize_with = "mm")]
    link_centre: [f64; 3],
    link_inertia_kg_m2: [f64; 3],
}

impl RawArm {
    pub fn arm(self, check: Check<'_>) -> Result<Arm, InputError> {
        let count = self.joint.len();
        let joints: Vec<Joint> = self.joint.into_iter().map(Joint::from).collect();
        let Ok(joints) = <[Joint; JOINTS]>::try_from(joints) else {
            return check.fail("joint", format!("there are {count}; an arm has six [[joint]]"));
        };
        Ok(Arm {
            joints,
            tool: frame(self.tool, self.tool_turn),
            home: Angles::from(self.home),
            feed_forward: self.velocity_feed_forward,
            assembly_force: self.assembly_force_n,
        })
    }
}

impl From<RawJoint> for Joint {
    fn from(raw: RawJoint) -> Self {
        Joint {
            name: raw.name,
            frame: frame(raw.offset, raw.turn),
            axis: Vector3::ith_axis(raw.axis as usize),
            stiffness: raw.stiffness_nm_per_rad,
            damping: raw.damping_nms_per_rad,
            limit: raw.limit_nm,
            link: Inertia {
                mass: raw.link_mass_kg,
                centre: Point3::from(raw.link_centre),
                moments: Vector3::from(raw.link_inertia_kg_m2),
            },
        }
    }
}

/// Returns the frame with this origin, m, turned about x, then y, then z, rad.
fn frame([x, y, z]: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Pose {
    let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Pose::from_parts(Translation3::new(x, y, z), turn)
}
