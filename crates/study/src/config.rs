//! Resolved configuration of a study: `study.toml`.

use super::Provenance;
use super::differences::differences;
use ask_tell::OptimizerKind;
use insertion::evaluation::INDIFFERENCE_MM;
use insertion::{Aggregate, Constraint, FingerModelKind, Goals, Measure, Objectives, Space};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Largest number of evaluations of a study, and of a polish.
pub const LARGEST_BUDGET: u64 = 1_000_000;
/// Largest number of designs proposed at a time.
pub const LARGEST_BATCH: u64 = 10_000;

/// Settings that determine the evaluations of a study (the number of threads does not).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyConfig {
    /// Names of the tasks, at least one.
    pub tasks: Vec<String>,
    /// Name of the robot.
    pub robot: String,
    /// Source of the finger stiffnesses that were not measured.
    #[serde(default, skip_serializing_if = "is_default")]
    pub finger_model: FingerModelKind,
    /// Name of the optimizer.
    pub optimizer: String,
    /// Objectives, one to three.
    pub objective: Objectives,
    /// Constraints on a design.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub constraints: Vec<Constraint>,
    /// Aggregation over several tasks; `None` for a single task.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aggregate: Option<Aggregate>,
    /// Name of the distribution of errors, if objective or constraints need one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<String>,
    /// Whether the draws of a design end once its success rate can no longer be the best (racing).
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub race: bool,
    /// Seed of every random stream of the study.
    pub seed: u64,
    /// Indifference: difference of ranges that a bench cannot resolve, mm.
    #[serde(default = "indifference", skip_serializing_if = "is_indifference")]
    pub indifference_mm: f64,
    /// Evaluations of the optimizer; may be raised later, unless there is a polish.
    pub budget: u64,
    /// Whether the search ends early once no design is expected to improve on the best.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub settles: bool,
    /// Method by which designs are selected for confirmation.
    pub confirmation: Confirmation,
    /// Largest number of evaluations of the polish, a local search by Nelder-Mead after the optimizer; 0 for none.
    #[serde(default, skip_serializing_if = "is_default")]
    pub polish: u64,
    /// Number of designs proposed at a time; in an asynchronous study, evaluated at the same time.
    pub batch: u64,
    /// Whether each result is passed to the optimizer at once, and one more design proposed.
    #[serde(rename = "async", default, skip_serializing_if = "std::ops::Not::not")]
    pub asynchronous: bool,
    /// Settings of the analyses after the search.
    #[serde(default, skip_serializing_if = "is_default")]
    pub conclusion: AnalysisSettings,
    /// Provenance at the beginning of the study.
    pub provenance: Provenance,
    /// Search space.
    pub space: Space,
}

/// Method by which designs are selected for confirmation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Confirmation {
    /// The design with the largest expected value is confirmed next, until none is expected to improve on the best
    /// confirmed one.
    #[default]
    Expected,
}

/// Effort of a bench prediction: of ranges on the real robot, by calibration to measurements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BenchEffort {
    /// Number of simulations, including those that validate the emulator.
    pub simulations: u16,
    /// Number of samples of the posterior.
    pub samples: u16,
}

/// Settings of the analyses after the search. They change no evaluation and may change when a study is
/// resumed.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnalysisSettings {
    /// Whether the confirmation of the best designs is skipped.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub no_confirm: bool,
    /// Effort of the bench prediction, if there are measurements on the real robot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bench: Option<BenchEffort>,
    /// Path of the measurement file, as given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measurements: Option<String>,
    /// Paths of the task files, as given, in the order of the tasks.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub task_files: Vec<String>,
    /// Path of the user's own robot file, as given; else empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub robot_file: String,
    /// Project file and the options set by it, as text, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub project: Option<String>,
}

impl StudyConfig {
    /// Returns the study's name: its default folder under `results/`, and its name in Optuna.
    pub fn name(&self) -> String {
        study_name(&self.task_name(), &self.method(), self.seed)
    }

    /// Returns the names of all tasks.
    pub fn tasks(&self) -> impl Iterator<Item = &str> {
        self.tasks.iter().map(String::as_str)
    }

    /// Returns whether there are several tasks.
    pub fn several_tasks(&self) -> bool {
        self.tasks.len() > 1
    }

    /// Returns the names of all tasks as one word: `usb+rj45`.
    pub fn task_name(&self) -> String {
        self.tasks().collect::<Vec<_>>().join("+")
    }

    /// Checks the configuration.
    ///
    /// # Errors
    /// The invalid field and its accepted values.
    pub fn check(&self) -> Result<(), String> {
        self.space.check("[space]").map_err(|error| error.to_string())?;
        for (key, value, accepted) in [
            ("budget", self.budget as f64, 1.0..=LARGEST_BUDGET as f64),
            ("polish", self.polish as f64, 0.0..=LARGEST_BUDGET as f64),
            ("batch", self.batch as f64, 1.0..=LARGEST_BATCH as f64),
            ("indifference_mm", self.indifference_mm, INDIFFERENCES_MM),
        ] {
            if !accepted.contains(&value) {
                let [least, most] = [accepted.start(), accepted.end()];
                return Err(format!("{key}: is {value}; it must lie in {least} .. {most}"));
            }
        }
        let kind: OptimizerKind =
            self.optimizer.parse().map_err(|error| format!("optimizer: {error}"))?;
        if self.objective.single().is_none() && !kind.takes_several_objectives() {
            let able = OptimizerKind::all().filter(|kind| kind.takes_several_objectives());
            let able = able.map(OptimizerKind::name).collect::<Vec<_>>().join(", ");
            return Err(format!("optimizer: {kind} accepts one objective only; several: {able}"));
        }
        if self.settles && !self.can_settle() {
            let needs = "the optimizer gp and the objective range or centred-range alone";
            return Err(format!("settles: needs {needs}"));
        }
        if self.objective.single().is_none() && self.polish > 0 {
            return Err("polish: accepts one objective only".to_owned());
        }
        if self.tasks.is_empty() || self.several_tasks() != self.aggregate.is_some() {
            return Err("tasks: must be one, or several with an aggregate".to_owned());
        }
        if let Some(Aggregate::Weighted(weights)) = &self.aggregate {
            Aggregate::weighted(weights.clone(), self.tasks.len())
                .map_err(|error| format!("aggregate: {error}"))?;
        }
        if self.uncertainty.is_some() != self.goals().needs_draws().contains(&true) {
            return Err("uncertainty: needed for success-rate and robust-range only".to_owned());
        }
        if self.race && !self.can_race() {
            let problem = "race: needs success-rate as the only objective, the aggregate min, and no \
                           constraint on success-rate; leave it out";
            return Err(problem.to_owned());
        }
        Ok(())
    }

    /// Returns whether the only objective is the width of a window; only such studies are confirmed.
    pub fn optimizes_windows(&self) -> bool {
        matches!(self.objective.single(), Some(Measure::Range | Measure::CentredRange))
    }

    /// Returns whether early stopping is available: for the optimizer `gp` with the width of a window as its only
    /// objective, without constraints and polish.
    pub fn can_settle(&self) -> bool {
        let gp = self.optimizer.parse() == Ok(OptimizerKind::Gp);
        self.optimizes_windows() && gp && self.constraints.is_empty() && self.polish == 0
    }

    /// Returns the settings of early stopping: evaluations before the first check, and patience
    /// (consecutive evaluations without an expected gain). Tuned on recorded landscapes
    /// (`docs/notes/optimizers.md`).
    pub fn early_stopping(&self) -> Option<[usize; 2]> {
        let free = self.space.levels().into_iter().filter(|&levels| levels > 1).count();
        self.settles.then_some([20 + 4 * free, 12 * free.max(1)])
    }

    /// Returns the expected number of evaluations; with early stopping the smallest possible number, which most
    /// studies exceed only slightly.
    pub fn expected_evaluations(&self) -> u64 {
        let least = self.early_stopping().map(|[least, patience]| (least + patience) as u64);
        least.unwrap_or(u64::MAX).min(self.evaluations())
    }

    /// Returns `24 of 200 evaluations`, or, with early stopping, `24 evaluations`.
    pub fn counted(&self, done: usize) -> String {
        match self.settles {
            true => format!("{done} evaluations"),
            false => format!("{done} of {} evaluations", self.evaluations()),
        }
    }

    /// Returns objectives, constraints and aggregation.
    pub fn goals(&self) -> Goals {
        Goals {
            objectives: self.objective.clone(),
            constraints: self.constraints.clone(),
            aggregate: self.aggregate.clone().unwrap_or_default(),
        }
    }

    /// Returns the name of the optimizer with its polish: `gp`, `gp+polish20`.
    pub fn method(&self) -> String {
        match self.polish {
            0 => self.optimizer.clone(),
            polish => format!("{}+polish{polish}", self.optimizer),
        }
    }

    /// Returns the largest number of evaluations, with those of the polish.
    pub fn evaluations(&self) -> u64 {
        self.budget.saturating_add(self.polish)
    }

    /// Returns the fields in which a study on disk differs from a new request, one line each; `None` if there are
    /// none. Ignored are a raised budget (unless there is a polish), any budget of a study with early stopping,
    /// `race`, `settles` and `conclusion`. Provenance is compared by [`Provenance::differences`].
    pub fn differences(&self, requested: &StudyConfig) -> Option<String> {
        let may_rise = requested.polish == 0 && (requested.budget > self.budget || self.settles);
        let budget = if may_rise { requested.budget } else { self.budget };
        let StudyConfig { provenance, conclusion, race, settles, .. } = requested.clone();
        let raised = StudyConfig { budget, provenance, conclusion, race, settles, ..self.clone() };
        differences(&raised, requested, ["the study", "now"])
    }
}

/// Accepted indifferences, mm; the smallest is the grid step of windows.
pub const INDIFFERENCES_MM: RangeInclusive<f64> = 0.1..=10.0;

fn indifference() -> f64 {
    INDIFFERENCE_MM
}

fn is_indifference(mm: &f64) -> bool {
    *mm == INDIFFERENCE_MM
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Returns `<task>-<optimizer>-seed<seed>`.
pub fn study_name(task: &str, optimizer: &str, seed: u64) -> String {
    format!("{task}-{optimizer}-seed{seed}")
}
