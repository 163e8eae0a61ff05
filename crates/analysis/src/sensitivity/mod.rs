//! Sobol indices of a function on the unit cube: shares of its variance, with intervals.
//!
//! `Sample::points` gives the points to evaluate, in any order and in parallel; `Sample::indices`
//! takes the values in the order of the points.

pub mod factors;
pub mod sobol;

use ask_tell::stream::stream;
use rand::RngExt;

/// Resamples of a bootstrap: enough for the ends of a 95 % interval.
const RESAMPLES: usize = 1000;
/// Probability outside a 95 % interval on each side.
const TAIL: f64 = 0.025;

/// An estimate with its 95 % interval by the bootstrap (percentiles), in the unit of the values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Point estimate.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Bootstrap interval of `statistic` over independent rows.
fn bootstrap(rows: usize, seed: u64, statistic: impl Fn(&[usize]) -> f64) -> Interval {
    let every: Vec<usize> = (0..rows).collect();
    let mut random = stream(seed, rows as u64, "sensitivity bootstrap");
    let mut resample =
        || -> Vec<usize> { every.iter().map(|_| random.random_range(0..rows)).collect() };
    let mut found: Vec<f64> = (0..RESAMPLES).map(|_| statistic(&resample())).collect();
    found.sort_by(f64::total_cmp);
    let at = |share: f64| found[(share * (RESAMPLES - 1) as f64).round() as usize];
    Interval { value: statistic(&every), low: at(TAIL), high: at(1.0 - TAIL) }
}
