//! Misfit of the simulated curves, per phase of an attempt, and validation by a held-out attempt.

use super::curves::Curves;
use super::question::{Compared, Identified};
use super::replay::Logged;
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
        let misfit = |replayed: fn(&Compared) -> &Curves| {
            let squares = |one: &Compared| squares(&one.logged, replayed(one), phase, axis);
            mean(compared.iter().flat_map(squares)).map_or(0.0, f64::sqrt)
        };
        let (before, after) = (misfit(|one| &one.before.0), misfit(|one| &one.after.0));
        Misfit { phase, axis: force, before, after }
    })
    .collect()
}

/// Returns the squared residuals of a component of the force in a phase, in standard deviations of the data.
fn squares(logged: &Logged, replayed: &Curves, phase: &str, axis: usize) -> Vec<f64> {
    let data = logged.data().into_iter().zip(logged.predicted(replayed)).zip(logged.phases());
    let own = data.skip(axis).step_by(logged.data_per_bin()).filter(|(_, of)| *of == phase);
    let residuals =
        own.filter_map(|((datum, predicted), _)| Some((datum.value - predicted?) / datum.sd));
    residuals.map(|residual| residual.powi(2)).collect()
}
