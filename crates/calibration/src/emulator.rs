//! Emulator of the simulator: a Gaussian process over design and parameters, fitted to simulations at
//! Sobol points (Sacks et al. 1989, doi:10.1214/ss/1177012413). Its error is measured on held-out
//! simulations.

use super::simulation::Simulation;
use ask_tell::SobolSequence;
use ask_tell::gp::{FitEffort, Gp, fit};
use ask_tell::process::distance2;
use ask_tell::statistics::Moments;
use insertion::{Design, DesignError, FailureClass, Outcome, Space, Variable};
use rayon::prelude::*;
use std::sync::atomic::Ordering;

/// One of this many simulations is held out to measure the error.
const HELD_OUT: usize = 8;
/// Standard deviation of the rounding of a range, mm: the ends of a window are on a grid of 0.1 mm.
const ROUNDING_MM: f64 = 0.04;
/// Evaluations of the likelihood per start of the fit.
const EVALUATIONS: usize = 30;

/// Result of a simulation.
#[derive(Debug, Clone)]
struct Point {
    /// Position of the design in the unit cube of the space, then quantile levels of the priors of the parameters.
    at: Vec<f64>,
    range_mm: f64,
    /// Failures below and above the window.
    failures: [Option<FailureClass>; 2],
    /// Whether the robot stopped in most insertions.
    stopped: bool,
}

/// Emulator of the range on one task.
pub struct Emulator {
    process: Gp,
    /// Mean range over the simulations, mm.
    pub mean_mm: f64,
    sd_mm: f64,
    points: Vec<Point>,
    /// Number of simulations to which it was fitted.
    pub simulations: usize,
    /// Number of held-out simulations.
    pub held_out: usize,
    /// Root mean square error on the held-out simulations, mm.
    pub error_mm: f64,
}

#[derive(Debug, thiserror::Error)]
pub enum CalibrationError {
    #[error(transparent)]
    Impossible(#[from] DesignError),
    #[error("{0}: no Gaussian process fits the {1} simulations; increase --simulations")]
    NoFit(String, usize),
    /// Measured finger outside of the space: its line and the reason.
    #[error("line {0}: {1}")]
    Outside(u64, String),
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
        let simulations = count - count / HELD_OUT;
        let task = &simulation.template.task.name;
        let no_fit = || CalibrationError::NoFit(task.clone(), simulations);
        let run = |at: Vec<f64>| {
            if simulation.stop.load(Ordering::SeqCst) {
                // The caller that set the flag ignores this error.
                return Err(no_fit());
            }
            let (of_space, levels) = at.split_at(space.parameters.len());
            let value = |(parameter, unit): (&Variable, &f64)| {
                let Variable { key, low, high, .. } = parameter;
                (key.to_string(), low + unit * (high - low))
            };
            let design = Design(space.parameters.iter().zip(of_space).map(value).collect());
            let evaluation = simulation.window(&design, levels)?;
            done();
            let window = &evaluation.window;
            let failures =
                [window.end_negative, window.end_positive].map(|end| end.and_then(Outcome::class));
            let (range_mm, stopped) = (window.range_mm(), evaluation.mostly_stopped());
            Ok(Point { range_mm, failures, stopped, at })
        };
        let points =
            points.into_par_iter().map(run).collect::<Result<Vec<Point>, CalibrationError>>()?;
        let stopped = || simulation.stop.load(Ordering::SeqCst);
        Emulator::fitted(points, simulations, &stopped).ok_or_else(no_fit)
    }

    fn fitted(points: Vec<Point>, simulations: usize, stopped: &dyn Fn() -> bool) -> Option<Self> {
        let (fitted, held_out) = points.split_at(simulations.min(points.len()));
        let moments = Moments::of(fitted.iter().map(|point| point.range_mm));
        let (mean_mm, sd_mm) = (moments.mean, moments.deviation().max(ROUNDING_MM));
        let x: Vec<Vec<f64>> = fitted.iter().map(|point| point.at.clone()).collect();
        let y: Vec<f64> = fitted.iter().map(|point| (point.range_mm - mean_mm) / sd_mm).collect();
        let floor = (ROUNDING_MM / sd_mm).powi(2);
        let effort = FitEffort { evaluations: EVALUATIONS, restarts: true };
        let mut emulator = Emulator {
            process: Gp::new(&x, &y, floor, &fit(&x, &y, floor, None, (effort, stopped)))?,
            mean_mm,
            sd_mm,
            simulations,
            held_out: held_out.len(),
            error_mm: 0.0,
            points: Vec::new(),
        };
        let square = |point: &Point| (emulator.range_mm(&point.at) - point.range_mm).powi(2);
        let squares: f64 = held_out.iter().map(square).sum();
        emulator.error_mm = (squares / held_out.len().max(1) as f64).sqrt().max(ROUNDING_MM);
        emulator.points = points;
        Some(emulator)
    }

    /// Returns the emulated range, mm, at a design in the unit cube of the space and quantile levels of the priors.
    pub fn range_mm(&self, at: &[f64]) -> f64 {
        (self.mean_mm + self.sd_mm * self.process.mean(at)).max(0.0)
    }

    /// Returns the number of simulations with a robot stop in most insertions, and of all simulations.
    pub fn stopped(&self) -> [usize; 2] {
        [self.points.iter().filter(|point| point.stopped).count(), self.points.len()]
    }

    /// Returns the most frequent failure class at each end of the window among the `count` simulations nearest to a
    /// design in the unit cube of the space.
    pub fn failures(&self, design: &[f64], count: usize) -> [Option<FailureClass>; 2] {
        let distance = |point: &Point| distance2(&point.at, design);
        let mut nearest: Vec<_> = self.points.iter().collect();
        nearest.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.truncate(count);
        [0, 1].map(|end| most_frequent(nearest.iter().filter_map(|point| point.failures[end])))
    }
}

/// Returns the most frequent class; among equally frequent classes, the lowest.
pub(super) fn most_frequent(classes: impl Iterator<Item = FailureClass>) -> Option<FailureClass> {
    let mut counts = [0_usize; 4];
    classes.for_each(|class| counts[usize::from(class.number()) - 1] += 1);
    let occurring = FailureClass::ALL.into_iter().zip(counts).filter(|(_, count)| *count > 0);
    occurring.rev().max_by_key(|(_, count)| *count).map(|(class, _)| class)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_is_measured_on_held_out_simulations() {
        let range = |at: &[f64]| 5.0 + 2.0 * at[0] - 3.0 * at[1] * at[2];
        let points: Vec<Point> = SobolSequence::new(3, 0, 0, "test")
            .take(60)
            .map(|at| Point {
                range_mm: range(&at),
                failures: [Some(FailureClass::Jammed), None],
                stopped: at[0] < 0.5,
                at,
            })
            .collect();
        let emulator = Emulator::fitted(points, 52, &|| false).unwrap();
        assert!(emulator.error_mm < 0.15, "{}", emulator.error_mm);
        let at = [0.3, 0.6, 0.2];
        assert!((emulator.range_mm(&at) - range(&at)).abs() < 0.3);
        assert_eq!(emulator.failures(&at[..2], 5), [Some(FailureClass::Jammed), None]);
        let [stopped, all] = emulator.stopped();
        assert!(all == 60 && (25..=35).contains(&stopped), "{stopped} of {all}");
    }
}
