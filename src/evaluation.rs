//! What a trial, a window search and an evaluation report.

use serde::{Deserialize, Serialize};

/// How a trial failed; the numbers are the paper's (Table "Failure Cases").
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(into = "u8", try_from = "u8")]
pub enum FailureClass {
    /// 1: the part left the grasp before the search began.
    ContactLossBeforeSearch,
    /// 2: the leading edge never entered the opening before the assembly push.
    PlugMissed,
    /// 3: entered, not seated, still held.
    Jammed,
    /// 4: the part left the grasp, or slipped beyond the limit, in search or insertion.
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

    /// The paper's number, 1 to 4.
    pub fn number(self) -> u8 {
        self as u8 + 1
    }

    /// A short name for tables and plots.
    pub fn label(self) -> &'static str {
        match self {
            FailureClass::ContactLossBeforeSearch => "contact loss before search",
            FailureClass::PlugMissed => "plug missed",
            FailureClass::Jammed => "jammed",
            FailureClass::ContactLossInInsertion => "contact loss in insertion",
        }
    }
}

impl From<FailureClass> for u8 {
    fn from(class: FailureClass) -> u8 {
        class.number()
    }
}

impl TryFrom<u8> for FailureClass {
    type Error = String;
    fn try_from(number: u8) -> Result<Self, String> {
        Self::ALL
            .into_iter()
            .find(|class| class.number() == number)
            .ok_or_else(|| format!("failure class {number} is not one of 1, 2, 3, 4"))
    }
}

/// How one trial ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Seated: deep enough and upright enough.
    Inserted,
    /// Not seated, for a physical reason.
    Failed(FailureClass),
    /// The simulation left the finite numbers; says nothing about the design.
    Diverged,
}

/// A shift of the start position along y, as a number of 0.1 mm grid steps.
pub type OffsetStep = i32;

/// Width of the offset grid: the paper shifts the start by 0.1 mm.
pub const OFFSET_STEP_MM: f64 = 0.1;

/// The offsets that insert around the nominal start, on the 0.1 mm grid, and
/// what stopped the search at each end.
///
/// Invariant of a window with `nominal == Inserted`: `negative_steps <= 0 <=
/// positive_steps`, and every grid offset between them was found to insert.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Window {
    /// Outcome at the nominal start; anything but inserted makes the range 0.
    pub nominal: Outcome,
    /// Most negative inserting offset, in grid steps.
    pub negative_steps: OffsetStep,
    /// Most positive inserting offset, in grid steps.
    pub positive_steps: OffsetStep,
    /// What the first failing offset below `negative_steps` did; `None` if the
    /// search reached its limit without a failure.
    pub end_negative: Option<Outcome>,
    /// The same above `positive_steps`.
    pub end_positive: Option<Outcome>,
}

impl Window {
    /// Width in mm: 0 when the nominal start fails.
    pub fn range_mm(&self) -> f64 {
        if self.nominal != Outcome::Inserted {
            return 0.0;
        }
        grid_mm(self.positive_steps - self.negative_steps)
    }

    /// Most negative inserting offset in mm (0 or below).
    pub fn negative_mm(&self) -> f64 {
        grid_mm(self.negative_steps)
    }

    /// Most positive inserting offset in mm (0 or above).
    pub fn positive_mm(&self) -> f64 {
        grid_mm(self.positive_steps)
    }
}

/// A number of grid steps in mm, without the rounding noise of `n * 0.1`.
pub fn grid_mm(steps: OffsetStep) -> f64 {
    f64::from(steps) / 10.0
}

/// Everything measured for one design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// The tolerance window.
    pub window: Window,
    /// Trials that failed with class 1 to 4, over all trials run.
    pub failure_counts: [u32; 4],
    /// Trials that diverged.
    pub diverged: u32,
    /// Trials run.
    pub trials: u32,
    /// Largest contact force between plug and socket over the inserted trials, N.
    pub peak_force_n: f64,
    /// Largest slip of the part in the grasp over the inserted trials, mm.
    pub slip_mm: f64,
    /// Simulated time over all trials, s.
    pub simulated_s: f64,
}
