//! Misfit of the simulated curves, per phase of an attempt, and validation by a held-out attempt.

use super::question::{Compared, Identified};
use ask_tell::statistics::mean;
use input::units::MM;
use serde::Serialize;

/// Names of the components of the force.
const FORCES: [&str; 3] = ["fx", "fy", "fz"];

/// Misfit of a phase and component of the force: root mean square of the residuals (measured minus simulated) of all
/// attempts, in standard deviations of the data, which include model error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Misfit {
    /// Phase of the attempt: search or push.
    pub phase: &'static str,
    /// Component of the force.
    pub axis: &'static str,
    /// Misfit with the values of the input files.
    pub before: f64,
    /// Misfit with the identified values.
    pub after: f64,
}

/// Ratio of the misfit of the held-out attempt to that of the fitted attempts above which the fit is doubtful.
pub const WARNING: f64 = 1.5;

/// Misfit of the held-out attempt and of the fitted attempts with the identified values: root mean squares over the
/// phases and the components of the force, in standard deviations of the data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Validation {
    /// File of the attempt's log.
    pub log: String,
    /// Shift of the attempt's start along y, mm.
    pub offset_mm: f64,
    /// Outcome on the robot.
    pub outcome: &'static str,
    /// Outcome in the identified cell.
    pub outcome_predicted: &'static str,
    /// Misfit of the held-out attempt.
    pub misfit: f64,
    /// Misfit of the fitted attempts.
    pub misfit_fitted: f64,
}

impl Validation {
    /// Returns the validation by the held-out attempt, if there is one.
    pub fn of(found: &Identified) -> Option<Self> {
        let held_out = found.held_out.as_ref()?;
        let after = |compared: &[Compared]| {
            let squares = misfits(compared).into_iter().map(|one| one.after * one.after);
            mean(squares).map_or(0.0, f64::sqrt)
        };
        Some(Validation {
            log: held_out.logged.file.clone(),
            offset_mm: held_out.logged.offset / MM,
            outcome: held_out.logged.outcome.word(),
            outcome_predicted: held_out.after.1.word(),
            misfit: after(std::slice::from_ref(held_out)),
            misfit_fitted: after(&found.compared),
        })
    }

    /// Returns whether the cell predicts the held-out attempt considerably worse than it fits the others.
    pub fn is_doubtful(&self) -> bool {
        self.misfit > WARNING * self.misfit_fitted
    }
}

/// Returns the misfit of each phase and component of the force.
pub fn misfits(compared: &[Compared]) -> Vec<Misfit> {
    let axes = |phase| FORCES.into_iter().enumerate().map(move |axis| (phase, axis));
    let each = ["search", "push"].into_iter().flat_map(axes);
    each.map(|(phase, (axis, force))| {
        let mut sums = [(0.0, 0.0); 2];
        for one in compared {
            let data = one.logged.data();
            for (sum, replayed) in sums.iter_mut().zip([&one.before.0, &one.after.0]) {
                let predicted = one.logged.predicted(replayed);
                let all = data.iter().zip(predicted).zip(one.logged.phases()).enumerate();
                for (i, ((datum, predicted), of)) in all {
                    if of == phase
                        && i % one.logged.data_per_bin() == axis
                        && let Some(predicted) = predicted
                    {
                        sum.0 += ((datum.value - predicted) / datum.sd).powi(2);
                        sum.1 += 1.0;
                    }
                }
            }
        }
        let [before, after] = sums.map(|(squares, count)| (squares / f64::max(count, 1.0)).sqrt());
        Misfit { phase, axis: force, before, after }
    })
    .collect()
}
