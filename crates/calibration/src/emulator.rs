//! Emulator of the simulator: a Gaussian process over design and parameters, fitted to a designed set
//! of simulations (Sacks et al. 1989, doi:10.1214/ss/1177012413). Its error is measured on held-out
//! simulations.

use super::simulation::Simulation;
use ask_tell::SobolSequence;
use ask_tell::gp::{FitEffort, Gp, fit_until};
use ask_tell::process::distance2;
use ask_tell::statistics::Moments;
use insertion::evaluation::template::Impossible;
use insertion::outcome::{FailureClass, Outcome};
use insertion::space::{Design, Space, Variable};
use rayon::prelude::*;
use std::sync::atomic::Ordering;

/// One simulation in this many is held out to measure the error.
const FRESH: usize = 8;
/// A window's ends stand on a grid of 0.1 mm: the standard deviation of its width's rounding.
const ROUNDING_MM: f64 = 0.04;
/// Evaluations of the likelihood per start of the fit.
const EVALUATIONS: usize = 30;

#[derive(Debug, Clone)]
struct Run {
    /// Shares of the space, then of the parameters' priors.
    at: Vec<f64>,
    range_mm: f64,
    failures: [Option<FailureClass>; 2],
}

pub struct Emulator {
    process: Gp,
    /// Mean range over the simulations, mm.
    pub mean_mm: f64,
    sd_mm: f64,
    runs: Vec<Run>,
    pub simulations: usize,
    /// Simulations its error was measured on.
    pub fresh: usize,
    pub error_mm: f64,
}

#[derive(Debug, thiserror::Error)]
pub enum CalibrationError {
    #[error(transparent)]
    Impossible(#[from] Impossible),
    #[error("{0}: no process goes through the {1} simulations; ask for more")]
    NoFit(String, usize),
    /// The measured finger of a line does not lie in the space.
    #[error("line {0}: {1}")]
    Measured(u64, String),
}

impl Emulator {
    /// Runs `count` simulations and fits the emulator to seven in eight of them; the others measure its error.
    /// `done` is called after each simulation.
    pub fn new(
        simulation: &Simulation<'_>,
        space: &Space,
        count: usize,
        seed: u64,
        done: &(dyn Fn() + Sync),
    ) -> Result<Self, CalibrationError> {
        let dimension = space.parameters.len() + simulation.parameters.len();
        let points: Vec<Vec<f64>> =
            SobolSequence::new(dimension, seed, 0, "emulator").take(count).collect();
        let simulations = count - count / FRESH;
        let task = &simulation.template.task.name;
        let no_fit = || CalibrationError::NoFit(task.clone(), simulations);
        let run = |at: Vec<f64>| {
            if simulation.stop.load(Ordering::SeqCst) {
                // The caller that set the flag ignores this error.
                return Err(no_fit());
            }
            let (of_space, shares) = at.split_at(space.parameters.len());
            let value = |(parameter, share): (&Variable, &f64)| {
                (
                    parameter.key.to_string(),
                    parameter.low + share * (parameter.high - parameter.low),
                )
            };
            let design = Design(space.parameters.iter().zip(of_space).map(value).collect());
            let evaluation = simulation.window(&design, shares)?;
            done();
            let window = &evaluation.window;
            let class = |end: Option<Outcome>| FailureClass::try_from(end?.failure()?).ok();
            Ok(Run {
                range_mm: window.range_mm(),
                failures: [class(window.end_negative), class(window.end_positive)],
                at,
            })
        };
        let runs =
            points.into_par_iter().map(run).collect::<Result<Vec<Run>, CalibrationError>>()?;
        let stopped = || simulation.stop.load(Ordering::SeqCst);
        Emulator::fitted(runs, simulations, &stopped).ok_or_else(no_fit)
    }

    fn fitted(runs: Vec<Run>, simulations: usize, stopped: &dyn Fn() -> bool) -> Option<Self> {
        let (known, fresh) = runs.split_at(simulations.min(runs.len()));
        let moments = Moments::of(known.iter().map(|run| run.range_mm));
        let (mean_mm, sd_mm) = (moments.mean, moments.deviation().max(ROUNDING_MM));
        let x: Vec<Vec<f64>> = known.iter().map(|run| run.at.clone()).collect();
        let y: Vec<f64> = known.iter().map(|run| (run.range_mm - mean_mm) / sd_mm).collect();
        let floor = (ROUNDING_MM / sd_mm).powi(2);
        let effort = FitEffort { evaluations: EVALUATIONS, restarts: true };
        let process = Gp::new(&x, &y, floor, &fit_until(&x, &y, floor, None, (effort, stopped)))?;
        let mut emulator = Emulator {
            process,
            mean_mm,
            sd_mm,
            simulations,
            fresh: fresh.len(),
            error_mm: 0.0,
            runs: Vec::new(),
        };
        let square = |run: &Run| (emulator.range_mm(&run.at) - run.range_mm).powi(2);
        let squares: f64 = fresh.iter().map(square).sum();
        emulator.error_mm = (squares / (fresh.len().max(1)) as f64).sqrt().max(ROUNDING_MM);
        emulator.runs = runs;
        Some(emulator)
    }

    /// Returns the simulated range, mm, at shares of the space and quantiles of the parameters' priors.
    pub fn range_mm(&self, at: &[f64]) -> f64 {
        (self.mean_mm + self.sd_mm * self.process.mean(at)).max(0.0)
    }

    /// Returns the most frequent failure class at each end among the `count` simulations nearest to a design.
    pub fn failures(&self, design: &[f64], count: usize) -> [Option<FailureClass>; 2] {
        let distance = |run: &Run| distance2(&run.at, design);
        let mut nearest: Vec<&Run> = self.runs.iter().collect();
        nearest.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        [0, 1].map(|end| most(nearest.iter().take(count).filter_map(|run| run.failures[end])))
    }
}

/// Returns the most frequent class, of equally frequent ones the lowest.
pub(super) fn most(classes: impl Iterator<Item = FailureClass>) -> Option<FailureClass> {
    let mut counts = [0_usize; 4];
    classes.for_each(|class| counts[usize::from(class.number()) - 1] += 1);
    let met = FailureClass::ALL.into_iter().zip(counts).filter(|(_, count)| *count > 0);
    met.rev().max_by_key(|(_, count)| *count).map(|(class, _)| class)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_on_fresh_simulations_is_what_the_process_leaves() {
        let range = |at: &[f64]| 5.0 + 2.0 * at[0] - 3.0 * at[1] * at[2];
        let runs: Vec<Run> = SobolSequence::new(3, 0, 0, "test")
            .take(60)
            .map(|at| Run {
                range_mm: range(&at),
                failures: [Some(FailureClass::Jammed), None],
                at,
            })
            .collect();
        let emulator = Emulator::fitted(runs, 52, &|| false).unwrap();
        assert!(emulator.error_mm < 0.15, "{}", emulator.error_mm);
        let at = [0.3, 0.6, 0.2];
        assert!((emulator.range_mm(&at) - range(&at)).abs() < 0.3);
        assert_eq!(emulator.failures(&at[..2], 5), [Some(FailureClass::Jammed), None]);
    }
}
