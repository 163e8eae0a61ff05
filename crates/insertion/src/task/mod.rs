//! Tasks: plug, socket, grip, friction, search strategy and success, from one TOML file.

pub(crate) mod duration;
mod edges;
pub mod finger;
pub mod geometry;
mod latch;
mod mating_force;
pub mod parts_file;
mod raw;
mod raw_part;
mod rounded;

pub use geometry::{Part, Solid};
pub use latch::Latch;
pub use mating_force::MatingForce;
pub use raw::{checked_name, is_of_name};
pub use raw_part::MAX_PARTS;
pub use rounded::Rounded;

use crate::task::finger::FingerModel;
use input::units::read::{deg, mm};
use nalgebra::{Vector2, Vector3};
use serde::Deserialize;

/// A checked task, in SI units, in the task frame: origin at the centre of the socket's opening on
/// its top, z out of the socket, y the direction in which the jaws close and the start is shifted.
///
/// ```
/// use input::shipped::TASKS;
/// let task = insertion::task::Task::parse(TASKS[0].text, TASKS[0].file)?;
/// assert_eq!((task.name.as_str(), task.strategy.phases.len()), ("ket8", 6));
/// # Ok::<(), input::InputError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Task {
    /// Name in study folders.
    pub name: String,
    /// One-line description for lists.
    pub description: String,
    /// Rotation of the task frame about z in the robot's base frame, rad.
    pub turn: f64,
    /// Plug, in the plug frame (origin at the tip, z along its axis).
    pub plug: Plug,
    /// Socket, in the task frame.
    pub socket: Vec<Part>,
    /// Opening on the socket's top, m: interval in x and in y.
    pub opening: [[f64; 2]; 2],
    /// Grasp of the plug.
    pub grip: Grip,
    /// Coefficients of friction of the contact pairs.
    pub friction: Friction,
    /// Properties of the fingers besides the measured stiffness.
    pub finger: FingerModel,
    /// Start and moves of the search strategy.
    pub strategy: Strategy,
    /// Criterion of an insertion.
    pub success: Success,
    /// Loads that the connector withstands; no trial depends on them.
    pub limits: Limits,
    /// Parts of plug and of socket that do not collide, since the drawing shows them where the other body is: contact
    /// springs, for example.
    pub left_out: [Vec<Part>; 2],
    /// Force of the contact springs, if the file gives it.
    pub mating_force: Option<MatingForce>,
}

impl Task {
    /// Returns the largest force of the contact springs, N, if the file gives it.
    pub fn largest_mating_force(&self) -> Option<f64> {
        let force = self.mating_force.as_ref()?;
        Some(force.iter().map(|[_, force]| *force).fold(0.0, f64::max))
    }
}

/// The connector half that the fingers hold.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Plug {
    /// Convex parts, m.
    pub parts: Vec<Part>,
    /// Total mass, kg; spread evenly over the volume of the parts.
    pub mass: f64,
    /// Latch, if the plug has one.
    pub latch: Option<Latch>,
}

impl Plug {
    /// Returns the parts outside the latch, which are one rigid body.
    pub fn rigid(&self) -> impl Iterator<Item = &Part> {
        let in_latch = |i: &usize| self.latch.as_ref().is_some_and(|latch| latch.parts.contains(i));
        self.parts.iter().enumerate().filter(move |(i, _)| !in_latch(i)).map(|(_, part)| part)
    }

    /// Returns the parts of the latch.
    pub fn latch_parts(&self) -> impl Iterator<Item = &Part> {
        let parts = self.latch.iter().flat_map(|latch| &latch.parts);
        parts.filter_map(|&i| self.parts.get(i))
    }
}

/// Grasp of the plug, plug frame.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grip {
    /// Height of the grasp point (TCP) on the plug's axis, m.
    #[serde(rename = "tcp_z_mm", deserialize_with = "mm")]
    pub tcp_z: f64,
    /// Height of the shoulder on which the finger's roof pushes, m.
    #[serde(rename = "shoulder_z_mm", deserialize_with = "mm")]
    pub shoulder_z: f64,
    /// Gripped faces, m: y of the face at -y and at +y.
    #[serde(rename = "faces_y_mm", deserialize_with = "mm")]
    pub faces_y: [f64; 2],
    /// Force with which the jaws close, N.
    #[serde(rename = "force_n")]
    pub force: f64,
    /// Phases in which the jaws are held.
    pub hold: Hold,
    /// Slip of the part in the grasp that counts as contact lost, m.
    #[serde(rename = "slip_limit_mm", deserialize_with = "mm")]
    pub slip_limit: f64,
}

impl Grip {
    /// Returns the height of the shoulder above the TCP, m.
    pub fn shoulder(&self) -> f64 {
        self.shoulder_z - self.tcp_z
    }
}

/// Phases in which the jaws keep their position, as with a non-backdrivable gear; otherwise they press
/// with the grasp force and yield.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Hold {
    /// From the grasp on.
    #[default]
    Always,
    /// During the assembly move only, as in the published simulation.
    Assembly,
}

/// Coefficients of friction of the contact pairs.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// Friction between finger and plug.
    pub finger_plug: f64,
    /// Resistance of a pad to rotation of the plug about the pad's normal.
    #[serde(rename = "finger_plug_torsion_mm")]
    pub finger_torsion: PadTorsion,
    /// Friction between plug and socket, unless a part sets its own.
    pub plug_socket: f64,
}

/// Torsional friction of a pad about its normal.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", expecting = "a number of mm, or \"patch\"")]
pub enum PadTorsion {
    /// Friction of the contact patch only.
    Patch,
    /// Moment per unit of normal force at each contact point, m; the friction forces at the points add to it.
    #[serde(untagged)]
    Points(#[serde(deserialize_with = "mm")] f64),
}

/// Search strategy: start and moves.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Strategy<P = Phase> {
    /// Tilt of the plug about x during the search, rad.
    #[serde(rename = "tilt_deg", deserialize_with = "deg")]
    pub tilt: f64,
    /// TCP at the nominal start, m.
    #[serde(rename = "start_mm", deserialize_with = "mm")]
    pub start: [f64; 3],
    /// Rule for the nominal start.
    #[serde(rename = "start", default)]
    pub rule: StartRule,
    /// Moves, each from the target of the previous one.
    #[serde(rename = "phase")]
    pub phases: Vec<P>,
}

/// Rule for the nominal start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum StartRule {
    /// The start of the task file
    #[default]
    Given,
    /// The middle of the finger's nearest tolerance window
    Taught,
}

/// Stage of the trial to which a phase belongs; decides the failure class.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// Motion through the air without contact.
    Approach,
    /// Descent to the socket's surface, and search moves along it.
    Search,
    /// The push into the socket.
    Assembly,
}

/// Condition that ends a move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ending {
    /// When every coordinate of the TCP is within this distance of the target, m.
    Tolerance(f64),
    /// When this time has passed since the commanded motion ended, s.
    Duration(f64),
    /// When the plug touches the socket; the command then continues by the preload.
    Touch {
        /// Distance beyond the position of the touch, m.
        preload: f64,
        /// Detection of the touch.
        detection: TouchDetection,
    },
}

/// Detection of a touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TouchDetection {
    /// Threshold of the sum of the normal forces, N.
    pub force: f64,
    /// Time for which the move continues after the threshold is reached, s.
    pub latency: f64,
}

impl TouchDetection {
    /// Detection at first contact, without delay.
    pub const FIRST: TouchDetection = TouchDetection { force: 0.05, latency: 0.0 };
}

/// One move of the TCP.
#[derive(Debug, Clone, PartialEq)]
pub struct Phase {
    /// Name for reports.
    pub name: String,
    /// Stage of the trial.
    pub stage: Stage,
    /// Displacement from the previous target, m.
    pub displacement: [f64; 3],
    /// Mean speed of the commanded motion, m/s.
    pub speed: f64,
    /// Condition that ends the move.
    pub ending: Ending,
}

/// Largest loads of a connector, from its data sheet.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    /// Contact force between plug and socket, N.
    #[serde(rename = "force_n")]
    pub force: Option<f64>,
    /// Speed of a phase, m/s.
    #[serde(rename = "speed_mm_per_s", deserialize_with = "mm")]
    pub speed: Option<f64>,
}

impl Limits {
    /// Returns these limits, with missing ones taken from `others`.
    pub fn or(self, others: Limits) -> Limits {
        let Limits { force, speed } = others;
        Limits { force: self.force.or(force), speed: self.speed.or(speed) }
    }
}

/// Criterion of an insertion.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Success {
    /// Depth of the tip below the socket's top, m.
    #[serde(rename = "depth_mm", deserialize_with = "mm")]
    pub depth: f64,
    /// Largest angle between the plug's axis and z, rad.
    #[serde(rename = "tilt_deg", deserialize_with = "deg")]
    pub tilt: f64,
    /// Mated pose from which the lateral position of the plug is checked; without it, the tip must lie in the opening.
    #[serde(default)]
    pub mated: Option<Mated>,
}

/// Mated pose of an upright plug.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mated {
    /// Tip of the plug in the task frame, m.
    #[serde(rename = "tip_mm", deserialize_with = "mm")]
    pub tip: [f64; 3],
    /// Largest lateral distance of an inserted plug's tip from the mated tip, m.
    #[serde(rename = "lateral_mm", deserialize_with = "mm")]
    pub lateral: f64,
}

impl Mated {
    /// Returns the lateral distance of a tip, task frame, from the mated tip, m.
    pub fn distance_to(&self, tip: &Vector3<f64>) -> f64 {
        (tip.xy() - Vector2::new(self.tip[0], self.tip[1])).norm()
    }
}
