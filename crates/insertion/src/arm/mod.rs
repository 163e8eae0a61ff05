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
mod raw;
mod reduced;

pub use kinematics::{Posture, displacement};
pub(crate) use raw::{RawArm, arm};
pub use reduced::Reduced;

use contact::scene::{Inertia, Pose};
use nalgebra::{Unit, Vector3};

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
