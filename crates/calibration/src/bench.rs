//! Benches: emulated and measured ranges of a task each, and posterior samples given those of all tasks.

use super::process::{COORDINATES, Conditioned, Finger, Hyperparameters, StiffnessPoint};
use ask_tell::normal::StandardNormal;
use ask_tell::statistics::normal_cdf;
use rand::{Rng, RngExt};
use std::cell::RefCell;
use std::sync::atomic::{AtomicBool, Ordering};

/// Simulated ranges of a task as a function of the uncertain parameters.
pub trait Simulator: Sync {
    /// Returns the range of a finger, mm; `levels` are those of the quantiles of the parameters' priors, 0 to 1.
    fn range_mm(&self, finger: usize, levels: &[f64]) -> f64;
}

/// Measured range of a finger, or lower bound of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Index of the finger.
    pub finger: usize,
    pub range_mm: f64,
    /// Whether the range is only a lower bound.
    pub at_least: bool,
    /// Number of measurements averaged into the range.
    pub repeats: u32,
}

/// Bench of a task: its simulator and its observations. A posterior sample is a vector of coordinates with standard
/// normal priors.
#[derive(Clone)]
pub struct Bench<'a> {
    pub simulator: &'a dyn Simulator,
    /// Points of all fingers in the process of the discrepancy.
    pub places: &'a [StiffnessPoint],
    pub observations: Vec<Observation>,
    /// Unit of the process, mm: the mean simulated range of the task.
    pub scale_mm: f64,
    /// Root mean square error of the emulator, mm; it is added to the discrepancy.
    pub error_mm: f64,
    /// Indices of the coordinates of the simulator's parameters in a sample.
    pub parameters: Vec<usize>,
    /// Index of the first coordinate of the bench's hyperparameters in a sample.
    pub first: usize,
}

impl Bench<'_> {
    /// Returns the levels of the quantiles of the parameters' priors at a sample, 0 to 1.
    pub fn levels(&self, state: &[f64]) -> Vec<f64> {
        self.parameters.iter().map(|&coordinate| normal_cdf(state[coordinate])).collect()
    }

    /// Returns the fingers of these indices with their simulated ranges at a sample.
    pub fn fingers(&self, numbers: &[usize], state: &[f64]) -> Vec<Finger> {
        let levels = self.levels(state);
        let range_mm = |number: usize| self.simulator.range_mm(number, &levels);
        numbers.iter().map(|&number| self.finger(number, range_mm(number))).collect()
    }

    fn finger(&self, number: usize, range_mm: f64) -> Finger {
        Finger { place: self.places[number], simulated: range_mm / self.scale_mm }
    }

    /// Returns the hyperparameters at a sample.
    pub fn hyperparameters(&self, state: &[f64]) -> Hyperparameters {
        let own = &state[self.first..self.first + COORDINATES];
        Hyperparameters::from_coordinates(own, self.error_mm / self.scale_mm)
    }

    /// Returns the simulated range of the finger of each observation, mm.
    fn simulated_mm(&self, levels: &[f64]) -> Vec<f64> {
        self.observations.iter().map(|one| self.simulator.range_mm(one.finger, levels)).collect()
    }

    /// Conditions the process on the observations at a sample; `None` if their covariance is not positive definite.
    pub fn at(&self, state: &[f64]) -> Option<Conditioned> {
        self.conditioned(state, &self.simulated_mm(&self.levels(state)))
    }

    /// Conditions the process on the observations, given their simulated ranges.
    fn conditioned(&self, state: &[f64], ranges_mm: &[f64]) -> Option<Conditioned> {
        let (mut known, mut bounds) = (Vec::new(), Vec::new());
        for (observation, &simulated) in self.observations.iter().zip(ranges_mm) {
            let finger = self.finger(observation.finger, simulated);
            let value = observation.range_mm / self.scale_mm;
            match observation.at_least {
                true => bounds.push((finger, value)),
                false => known.push((finger, value, f64::from(observation.repeats))),
            }
        }
        Conditioned::new(self.hyperparameters(state), &known, bounds)
    }
}

/// Samples the posterior of parameters and hyperparameters as vectors of `dimension` coordinates.
pub fn sampled(
    benches: &[Bench<'_>],
    dimension: usize,
    settings: &Settings<'_>,
    random: &mut impl Rng,
) -> Vec<Vec<f64>> {
    let mut parts = vec![Vec::new(); dimension];
    for (part, bench) in benches.iter().enumerate() {
        let own = bench.first..bench.first + COORDINATES;
        bench.parameters.iter().copied().chain(own).for_each(|c| parts[c].push(part));
    }
    // Caches the last simulated ranges of each bench, since most coordinates do not change them.
    let cached: Vec<RefCell<(Vec<f64>, Vec<f64>)>> =
        benches.iter().map(|_| RefCell::default()).collect();
    let log_likelihood = |part: usize, state: &[f64]| {
        let bench = &benches[part];
        let levels = bench.levels(state);
        let mut cached = cached[part].borrow_mut();
        if cached.0 != levels || cached.1.len() != bench.observations.len() {
            let ranges = bench.simulated_mm(&levels);
            *cached = (levels, ranges);
        }
        bench.conditioned(state, &cached.1).map_or(f64::NEG_INFINITY, |at| at.log_likelihood())
    };
    sample(&parts, &log_likelihood, settings, random)
}

/// Settings of the sampler.
#[derive(Clone, Copy)]
pub struct Settings<'a> {
    /// Number of sweeps over all coordinates before the first sample is kept.
    pub warm_up: usize,
    /// Number of samples.
    pub samples: usize,
    /// Number of sweeps from one sample to the next.
    pub thin: usize,
    pub seed: u64,
    /// Cancellation flag; once it is set, results are invalid.
    pub stop: &'a AtomicBool,
    /// Progress callback of the leave-one-out calibrations: number done, and total number.
    pub done: &'a (dyn Fn([usize; 2]) + Sync),
}

/// Number of sweeps between adaptations of the step sizes.
const BATCH: usize = 25;
/// Target acceptance rate, optimal for a single coordinate.
const ACCEPTED: f64 = 0.44;

/// Draws Metropolis samples, one coordinate at a time, with step sizes that adapt during the warm-up (Metropolis et
/// al. 1953; Roberts and Rosenthal 2009, doi:10.1198/jcgs.2009.06134).
///
/// The prior of each coordinate is standard normal. The log-likelihood is a sum over parts; `parts[c]` lists the
/// parts that depend on coordinate `c`.
fn sample(
    parts: &[Vec<usize>],
    log_likelihood: &dyn Fn(usize, &[f64]) -> f64,
    settings: &Settings<'_>,
    random: &mut impl Rng,
) -> Vec<Vec<f64>> {
    let Settings { warm_up, samples, thin, stop, .. } = *settings;
    let dimension = parts.len();
    let count = parts.iter().flatten().max().map_or(0, |last| last + 1);
    let mut state = vec![0.0; dimension];
    let mut current: Vec<f64> = (0..count).map(|part| log_likelihood(part, &state)).collect();
    let mut step = vec![1.0_f64; dimension];
    let mut accepted = vec![0_usize; dimension];
    let mut kept = Vec::with_capacity(samples);
    for sweep in 0..warm_up + samples * thin {
        if stop.load(Ordering::SeqCst) {
            return vec![state];
        }
        for c in 0..dimension {
            let old = state[c];
            state[c] = old + step[c] * random.sample::<f64, _>(StandardNormal);
            let new: Vec<f64> = parts[c].iter().map(|&part| log_likelihood(part, &state)).collect();
            let before: f64 = parts[c].iter().map(|&part| current[part]).sum();
            let gain = new.iter().sum::<f64>() - before - 0.5 * (state[c] * state[c] - old * old);
            let chance: f64 = random.random();
            if libm::log(chance) < gain {
                parts[c].iter().zip(new).for_each(|(&part, value)| current[part] = value);
                accepted[c] += 1;
            } else {
                state[c] = old;
            }
        }
        if sweep < warm_up && (sweep + 1).is_multiple_of(BATCH) {
            for (step, accepted) in step.iter_mut().zip(&mut accepted) {
                let rate = *accepted as f64 / BATCH as f64;
                *step = (*step * libm::exp(1.5 * (rate - ACCEPTED))).clamp(0.05, 4.0);
                *accepted = 0;
            }
        }
        if sweep >= warm_up && (sweep - warm_up + 1).is_multiple_of(thin) {
            kept.push(state.clone());
        }
    }
    kept
}
