//! Outcome of a trial.

use parameters::plan::grid::Traceable;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Failure class of a trial, numbered as in the paper (Table "Failure Cases").
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(into = "u8", try_from = "u8")]
pub enum FailureClass {
    /// 1: the part left the grasp before the search began.
    ContactLossBeforeSearch,
    /// 2: when the search ended, the leading edge was not inside the opening; or the part ended beside its mated
    /// pose.
    PlugMissed,
    /// 3: the leading edge was inside the opening, but the part is not seated; it did not leave the grasp.
    Jammed,
    /// 4: the part left the grasp, or slipped beyond the limit, during search or insertion; or it is seated, but not
    /// held by both fingers.
    ContactLossInInsertion,
}

impl FailureClass {
    /// All classes in the order of their numbers.
    pub const ALL: [FailureClass; 4] = [
        FailureClass::ContactLossBeforeSearch,
        FailureClass::PlugMissed,
        FailureClass::Jammed,
        FailureClass::ContactLossInInsertion,
    ];

    /// Returns the number in the paper, 1 to 4.
    pub fn number(self) -> u8 {
        self as u8 + 1
    }

    /// Returns the name for texts and tables.
    pub fn label(self) -> &'static str {
        let labels =
            ["contact loss before insertion", "plug missed", "jammed", "contact loss in insertion"];
        labels[self as usize]
    }

    /// Returns a short name for plots.
    pub fn short(self) -> &'static str {
        ["lost early", "missed", "jammed", "lost"][self as usize]
    }
}

/// Returns the words for a protective stop of the robot, to follow the outcome of the trial; empty without one.
pub fn stop_words(robot_stopped: bool) -> &'static str {
    if robot_stopped { ", robot stop at a limit of force or joint torque" } else { "" }
}

/// Advice on a protective stop of the robot, without a full stop.
pub const STOP_REMEDY: &str = "Shorten the push, lower the speed or the preload of the task's phases, or use a robot with higher limits";

impl From<FailureClass> for u8 {
    fn from(class: FailureClass) -> u8 {
        class.number()
    }
}

impl TryFrom<u8> for FailureClass {
    type Error = String;
    fn try_from(number: u8) -> Result<Self, String> {
        let class = Self::ALL.into_iter().find(|class| class.number() == number);
        class.ok_or_else(|| format!("failure class {number} is not one of 1, 2, 3, 4"))
    }
}

/// Outcome of one trial; serialized as `inserted`, `diverged` or the number of the failure class.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Seated (deep and upright enough) and held by both fingers.
    Inserted,
    /// Numerical divergence of the simulation; not a property of the design.
    Diverged,
    /// Not inserted, for a physical reason.
    #[serde(untagged)]
    Failed(FailureClass),
}

impl Outcome {
    /// Returns `inserted`, `failed` or `diverged`, as in files and JSON.
    pub fn word(self) -> &'static str {
        match self {
            Outcome::Inserted => "inserted",
            Outcome::Failed(_) => "failed",
            Outcome::Diverged => "diverged",
        }
    }

    /// Returns the name for texts; for a failure, the name of its class.
    pub fn label(self) -> &'static str {
        self.class().map_or(self.word(), FailureClass::label)
    }

    /// Returns a short name for plots.
    pub fn short(self) -> &'static str {
        self.class().map_or(self.word(), FailureClass::short)
    }

    /// Returns the failure class; `None` unless the trial failed.
    pub fn class(self) -> Option<FailureClass> {
        if let Outcome::Failed(class) = self { Some(class) } else { None }
    }

    /// Returns the number of the failure class, 1 to 4; `None` unless the trial failed.
    pub fn failure(self) -> Option<u8> {
        self.class().map(FailureClass::number)
    }
}

impl fmt::Display for Outcome {
    /// `inserted`, `diverged` or `failed: jammed (class 3)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(class) = self.class() else { return f.write_str(self.word()) };
        write!(f, "failed: {} (class {})", class.label(), class.number())
    }
}

impl Traceable for Outcome {
    fn inside(self) -> bool {
        self == Outcome::Inserted
    }
}
