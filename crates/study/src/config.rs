//! The resolved configuration of a study, as `study.toml` keeps it.

use super::differences::differences;
use super::provenance::Provenance;
use ask_tell::OptimizerKind;
use insertion::evaluation::INDIFFERENCE_MM;
use insertion::evaluation::objective::{Aggregate, Constraint, Goals, Measure, Objectives};
use insertion::finger::model::FingerModelKind;
use insertion::space::Space;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Most evaluations of a study, and of a polish.
pub const LARGEST_BUDGET: u64 = 1_000_000;
/// Most designs proposed at a time.
pub const LARGEST_BATCH: u64 = 10_000;

/// Everything that decides what a study measures. The number of threads is not
/// part of it: it changes no result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyConfig {
    /// Names of the tasks, at least one.
    pub tasks: Vec<String>,
    pub robot: String,
    /// Where the springs of a finger come from that were not measured.
    #[serde(default, skip_serializing_if = "is_default")]
    pub finger_model: FingerModelKind,
    pub optimizer: String,
    pub objective: Objectives,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub constraints: Vec<Constraint>,
    /// How the values of several tasks become one; there are several if it is there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aggregate: Option<Aggregate>,
    /// Name of the distribution of errors, if the goals need one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<String>,
    /// Whether designs race for the success rate; studies from before there were races do not.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub race: bool,
    /// Seed of every random stream of the study.
    pub seed: u64,
    /// Difference of ranges that no bench tells apart, mm: what gains less is as good.
    #[serde(default = "indifference", skip_serializing_if = "is_indifference")]
    pub indifference_mm: f64,
    /// Evaluations that the optimizer has; the one field that may be raised later, unless
    /// there is a polish.
    pub budget: u64,
    /// Whether the search ends before, once no design is expected to gain.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub settles: bool,
    /// How designs are chosen to be confirmed.
    #[serde(default, skip_serializing_if = "is_default")]
    pub confirmation: Confirmation,
    /// Most evaluations of the polish that follows.
    #[serde(default, skip_serializing_if = "is_default")]
    pub polish: u64,
    /// Designs the optimizer proposes at a time; of an asynchronous study, that are measured at
    /// a time.
    pub batch: u64,
    /// Whether each result is told as it comes, and one more design asked for.
    #[serde(rename = "async", default, skip_serializing_if = "std::ops::Not::not")]
    pub asynchronous: bool,
    #[serde(default, skip_serializing_if = "is_default")]
    pub conclusion: Conclusion,
    /// Provenance at the beginning of the study.
    pub provenance: Provenance,
    /// The search space in full.
    pub space: Space,
}

/// How designs are chosen to be confirmed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Confirmation {
    /// The first nine are repeated, the first three of these walked: up to version 0.3.0.
    #[default]
    NineAndThree,
    /// Whichever is expected to be the best, until none is expected to gain.
    Expected,
}

/// How much a prediction computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BenchEffort {
    /// Simulations, those that measure the error of the simulator's stand-in with them.
    pub simulations: u16,
    /// Samples of the posterior.
    pub samples: u16,
}

/// How a study ends. It changes no evaluation, so it may be settled anew.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Conclusion {
    /// Whether what is recommended stays unconfirmed.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub no_confirm: bool,
    /// How much is computed for the bench, if there are measurements.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bench: Option<BenchEffort>,
    /// The measurement file, as it was given; unknown in folders up to version 0.4.0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measurements: Option<String>,
    /// Names of the task files in messages, in the order of the tasks: their paths, as they were given.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub task_files: Vec<String>,
}

impl StudyConfig {
    /// The study's name: its default folder under `results/`, and its name in Optuna.
    pub fn name(&self) -> String {
        study_name(&self.task_name(), &self.method(), self.seed)
    }

    /// Names of all tasks, in their order.
    pub fn tasks(&self) -> impl Iterator<Item = &str> {
        self.tasks.iter().map(String::as_str)
    }

    /// Whether there is more than one task.
    pub fn several_tasks(&self) -> bool {
        self.tasks.len() > 1
    }

    /// The tasks in one word: `usb+rj45`.
    pub fn task_name(&self) -> String {
        self.tasks().collect::<Vec<_>>().join("+")
    }

    /// Whether it can be run as it is, whoever wrote it; if not, the field that is wrong.
    pub fn check(&self) -> Result<(), String> {
        for (key, value, [least, most]) in [
            ("budget", self.budget, [1, LARGEST_BUDGET]),
            ("polish", self.polish, [0, LARGEST_BUDGET]),
            ("batch", self.batch, [1, LARGEST_BATCH]),
        ] {
            if !(least..=most).contains(&value) {
                return Err(format!("{key}: is {value}; it must lie in {least} .. {most}"));
            }
        }
        if !INDIFFERENCES_MM.contains(&self.indifference_mm) {
            let [least, most] = [INDIFFERENCES_MM.start(), INDIFFERENCES_MM.end()];
            let given = self.indifference_mm;
            return Err(format!("indifference_mm: is {given}; it must lie in {least} .. {most}"));
        }
        let kind: OptimizerKind =
            self.optimizer.parse().map_err(|error| format!("optimizer: {error}"))?;
        if self.objective.single().is_none() && !kind.takes_several_objectives() {
            return Err(format!("optimizer: {kind} knows one objective only"));
        }
        if self.settles && !self.can_settle() {
            return Err("settles: goes with gp over range or centred-range alone".to_owned());
        }
        if self.objective.single().is_none() && self.polish > 0 {
            return Err("polish: knows one objective only".to_owned());
        }
        if self.tasks.is_empty() || self.several_tasks() != self.aggregate.is_some() {
            return Err("tasks: needs one, or several and an aggregate".to_owned());
        }
        if let Some(Aggregate::Weighted(weights)) = &self.aggregate {
            Aggregate::weighted(weights.clone(), self.tasks.len())
                .map_err(|error| format!("aggregate: {error}"))?;
        }
        if self.uncertainty.is_some() != self.goals().need_draws() {
            return Err("uncertainty: goes with success-rate and robust-range".to_owned());
        }
        if self.race && !self.can_race() {
            return Err(
                "race: goes with the one objective success-rate, of several tasks the worst, \
                        and without a constraint on it; leave it out"
                    .to_owned(),
            );
        }
        self.provenance.check()
    }

    /// Whether a search for this can tell when it is settled: the process knows one objective, in mm,
    /// without constraints.
    pub fn can_settle(&self) -> bool {
        let widths =
            matches!(self.objective.single(), Some(Measure::Range | Measure::CentredRange));
        let process = self.optimizer.parse() == Ok(OptimizerKind::Gp);
        widths && process && self.constraints.is_empty() && self.polish == 0
    }

    /// Of a search that settles: evaluations before which it does not, and in a row after which no gain
    /// has to be expected. Chosen on recorded landscapes (`docs/notes/optimizers.md`).
    pub fn settling(&self) -> Option<[usize; 2]> {
        let free = self.space.levels().into_iter().filter(|&levels| levels > 1).count();
        self.settles.then_some([20 + 4 * free, 12 * free.max(1)])
    }

    /// Evaluations to be expected: of a search that settles as many as it needs at the least, which
    /// most do not exceed by much.
    pub fn expected_evaluations(&self) -> u64 {
        let least = self.settling().map(|[least, quiet]| (least + quiet) as u64);
        least.unwrap_or(u64::MAX).min(self.evaluations())
    }

    /// `24 of 200 evaluations`, or, of a search that settles, `24 evaluations`.
    pub fn counted(&self, done: usize) -> String {
        match self.settles {
            true => format!("{done} evaluations"),
            false => format!("{done} of {} evaluations", self.evaluations()),
        }
    }

    pub fn goals(&self) -> Goals {
        Goals {
            objectives: self.objective.clone(),
            constraints: self.constraints.clone(),
            aggregate: self.aggregate.clone().unwrap_or_default(),
        }
    }

    /// The optimizer with its polish, if it has one: `gp`, `gp+polish20`.
    pub fn method(&self) -> String {
        match self.polish {
            0 => self.optimizer.clone(),
            polish => format!("{}+polish{polish}", self.optimizer),
        }
    }

    /// Evaluations in all, if the polish takes all of its own.
    pub fn evaluations(&self) -> u64 {
        self.budget.saturating_add(self.polish)
    }

    /// The fields in which a study on disk differs from what is asked for now,
    /// one line each. A budget that was raised does not count, unless a polish follows it, nor one that
    /// is given to a study that settles; whether there is a race, and the confirmation, stay as they
    /// were.
    /// Provenance is compared by [`Provenance::differences`].
    pub fn differences(&self, asked: &StudyConfig) -> Option<String> {
        let may_rise = asked.polish == 0 && (asked.budget > self.budget || self.settles);
        let budget = if may_rise { asked.budget } else { self.budget };
        let provenance = asked.provenance.clone();
        let conclusion = asked.conclusion.clone();
        let &StudyConfig { race, settles, confirmation, .. } = asked;
        let kept = StudyConfig { race, settles, confirmation, ..self.clone() };
        let raised = StudyConfig { budget, provenance, conclusion, ..kept };
        differences(&raised, asked, ["the study", "now"])
    }
}

/// Differences that may be indifferent, mm: of the grid of windows at the least.
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

/// `<task>-<optimizer>-seed<seed>`.
pub fn study_name(task: &str, optimizer: &str, seed: u64) -> String {
    format!("{task}-{optimizer}-seed{seed}")
}
