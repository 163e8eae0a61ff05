//! Six-joint arm with position servos, and its reduced model at the TCP.
//!
//! Each joint is a servo `tau = k (q_command - q) - c dq/dt`: the arm lags its command by c/k, and a
//! blocked arm pushes with its springs alone. With velocity feed-forward the damper acts on the rate of
//! the error, `c d/dt (q_command - q)`. Gravity on the links is compensated.
//!
//! Six joints move the TCP in six directions, so near a pose the displacements `x = J q` of the TCP can replace the
//! joint angles as coordinates: the arm is equivalent to one body at the TCP with the coupled 6x6 spring, damper and
//! mass of [`ReducedArm`]. Changes of `J` with the pose are neglected.

mod kinematics;
mod reduced;

pub use kinematics::Posture;
pub use reduced::ReducedArm;

use crate::task::geometry::Axis;
use contact::scene::{Inertia, Pose};
use input::units::read::{deg, mm};
use input::units::{DEG, MM};
use input::{Check, InputError, wrong_unit};
use nalgebra::{Point3, Translation3, Unit, UnitQuaternion, Vector3};
use serde::Deserialize;
use std::f64::consts::PI;

/// Range of the length of all links of an arm, mm.
const REACH_MM: [f64; 2] = [100.0, 10_000.0];

/// Number of joints of an arm.
pub const JOINTS: usize = 6;

/// Joint angles from base to tool, rad.
pub type Angles = nalgebra::SVector<f64, JOINTS>;

/// Model of a six-joint arm, SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    /// Joints from the base to the tool.
    pub joints: [Joint; JOINTS],
    /// Pose of the TCP in the frame of the last link.
    pub tool: Pose,
    /// Joint angles at which the TCP is at the nominal start of a task.
    pub home: Angles,
    /// Whether the servos use velocity feed-forward: the damper acts on the rate of the position error.
    pub feed_forward: bool,
    /// Force of the arm on an immovable part at the end of the assembly move, N.
    pub assembly_force: f64,
}

/// One joint and the link that it moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name for messages.
    pub name: String,
    /// Joint frame in the frame of the previous link.
    pub frame: Pose,
    /// Axis of rotation in the joint frame.
    pub axis: Unit<Vector3<f64>>,
    /// Position gain `k` of its servo, N m/rad.
    pub stiffness: f64,
    /// Damping `c` of its servo, N m s/rad.
    pub damping: f64,
    /// Largest torque, N m.
    pub limit: f64,
    /// Mass properties of its link, in the frame of the link.
    pub link: Inertia,
}

/// Error of an arm at the start of a task.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ArmError {
    /// The start is out of reach. Residual of the inverse kinematics, mm and degrees.
    #[error(
        "the arm does not reach the start from its home_deg: it misses by {0:.1} mm and {1:.1} \
         degrees; give home_deg near the start, with the tool pointing down"
    )]
    Unreachable(f64, f64),
    /// The Jacobian is singular at the start: no joint moves the TCP in some direction.
    #[error("the arm is in a singular pose at the start: choose another home_deg")]
    Singular,
}

/// Keys of a robot file of an arm, converted to SI units.
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
    /// Returns the arm after checking its units and that it has six joints.
    pub fn arm(self, check: Check<'_>) -> Result<Arm, InputError> {
        let joints: Vec<Joint> = self.joint.into_iter().map(Joint::from).collect();
        let joints = <[Joint; JOINTS]>::try_from(joints).or_else(|joints| {
            check.fail("joint", format!("there are {} [[joint]]; an arm has six", joints.len()))
        })?;
        let reach = joints.iter().map(|joint| joint.frame.translation.vector.norm()).sum::<f64>();
        check
            .unit("joint: all offset_mm together", wrong_unit::number("", reach / MM, REACH_MM))?;
        let arm = Arm {
            joints,
            tool: frame(self.tool, self.tool_turn),
            home: Angles::from(self.home),
            feed_forward: self.velocity_feed_forward,
            assembly_force: self.assembly_force_n,
        };
        let points_down = |home: Angles| (arm.posture(&home).tcp.rotation * Vector3::z()).z > 0.5;
        let within_a_turn = arm.home.iter().all(|angle| angle.abs() < 2.0 * PI * DEG);
        if within_a_turn && !points_down(arm.home) && points_down(arm.home / DEG) {
            // Whole numbers are degrees.
            let radians = |angle: f64| wrong_unit::angle(angle / DEG, [0.0, 360.0], 1.0);
            check.unit("home_deg", self.home.into_iter().find_map(radians))?;
        }
        Ok(arm)
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

/// Returns the frame with the given origin, m, rotated about x, then y, then z, rad.
fn frame([x, y, z]: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Pose {
    let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Pose::from_parts(Translation3::new(x, y, z), rotation)
}
