//! The benches of one or several tasks: simulated, measured, and what follows from both.

use super::process::{COORDINATES, Conditioned, Finger, Hyperparameters, Place};
use super::sampler::{Settings, sample};
use rand::Rng;
use std::cell::RefCell;

/// Simulated ranges as a function of the uncertain parameters.
pub trait Simulator: Sync {
    /// Ranges of these fingers, by their numbers, mm; `shares` are those of the priors, 0 to 1.
    fn ranges_mm(&self, fingers: &[usize], shares: &[f64]) -> Vec<f64>;
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    pub finger: usize,
    pub range_mm: f64,
    pub at_least: bool,
    /// Measurements that this is the mean of.
    pub repeats: u32,
}

#[derive(Clone)]
pub struct Bench<'a> {
    pub simulator: &'a dyn Simulator,
    pub places: &'a [Place],
    pub observations: Vec<Observation>,
    /// mm to one unit of the process.
    pub scale_mm: f64,
    /// Error of the simulator's stand-in, mm: a difference that no parameter explains.
    pub error_mm: f64,
    /// Coordinates of a sample that are the simulator's parameters.
    pub parameters: Vec<usize>,
    /// Its first coordinate of the hyperparameters.
    pub first: usize,
}

/// The share of the prior below a standard normal coordinate.
pub fn share(coordinate: f64) -> f64 {
    0.5 * libm::erfc(-coordinate * std::f64::consts::FRAC_1_SQRT_2)
}

impl Bench<'_> {
    pub fn shares(&self, state: &[f64]) -> Vec<f64> {
        self.parameters.iter().map(|&coordinate| share(state[coordinate])).collect()
    }

    pub fn fingers(&self, numbers: &[usize], state: &[f64]) -> Vec<Finger> {
        let ranges_mm = self.simulator.ranges_mm(numbers, &self.shares(state));
        numbers.iter().zip(ranges_mm).map(|(&number, range)| self.finger(number, range)).collect()
    }

    fn finger(&self, number: usize, range_mm: f64) -> Finger {
        Finger { place: self.places[number], simulated: range_mm / self.scale_mm }
    }

    pub fn hyperparameters(&self, state: &[f64]) -> Hyperparameters {
        let own = &state[self.first..self.first + COORDINATES];
        Hyperparameters::from_coordinates(own, self.error_mm / self.scale_mm)
    }

    fn measured(&self) -> Vec<usize> {
        self.observations.iter().map(|observation| observation.finger).collect()
    }

    /// The bench at a sample; `None` where the process cannot be computed.
    pub fn at(&self, state: &[f64]) -> Option<Conditioned> {
        let ranges_mm = self.simulator.ranges_mm(&self.measured(), &self.shares(state));
        self.conditioned(state, &ranges_mm)
    }

    /// The same with the measured fingers' simulated ranges.
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

/// Samples of parameters and hyperparameters: `dimension` standard normal coordinates each.
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
    // Most coordinates leave the simulated ranges as they were.
    let known: Vec<RefCell<(Vec<f64>, Vec<f64>)>> =
        benches.iter().map(|_| RefCell::default()).collect();
    let log_likelihood = |part: usize, state: &[f64]| {
        let bench = &benches[part];
        let shares = bench.shares(state);
        let mut known = known[part].borrow_mut();
        if known.0 != shares || known.1.len() != bench.observations.len() {
            let ranges = bench.simulator.ranges_mm(&bench.measured(), &shares);
            *known = (shares, ranges);
        }
        bench.conditioned(state, &known.1).map_or(f64::NEG_INFINITY, |at| at.log_likelihood())
    };
    sample(&parts, &log_likelihood, settings, random)
}
