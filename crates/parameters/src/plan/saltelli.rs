//! First-order and total Sobol indices of a function, with bootstrap intervals.
//!
//! [`Sample::points`] returns the points of the unit cube to evaluate, which can be done in any
//! order and in parallel; [`Sample::indices`] takes the values in the order of the points.
//!
//! Estimators of Jansen (Comput. Phys. Commun. 117 (1999) 35, doi:10.1016/S0010-4655(98)00154-4) on
//! the design of Saltelli et al. (Comput. Phys. Commun. 181 (2010) 259,
//! doi:10.1016/j.cpc.2009.09.018): two independent samples A and B, and for each input A with that
//! input from B.

use ask_tell::SobolSequence;
use ask_tell::statistics::{Moments, quantile, sorted};
use ask_tell::stream::stream;
use rand::RngExt;
use serde::Serialize;

/// Number of bootstrap resamples: enough for the ends of a 95 % interval.
const RESAMPLES: usize = 1000;
/// Tail probability on each side of a 95 % interval.
const TAIL: f64 = 0.025;

/// Sobol indices of an input, dimensionless, each with the ends of its 95 % percentile bootstrap interval. Estimates may
/// lie outside 0 .. 1 by sampling error. The fields are the keys of `--json`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Indices {
    /// First-order index S_i: share of the variance due to this input alone.
    pub first: f64,
    /// Lower end of its interval.
    pub first_low: f64,
    /// Upper end.
    pub first_high: f64,
    /// Total index S_Ti: share of the variance due to this input and all its interactions.
    pub total: f64,
    /// Lower end of its interval.
    pub total_low: f64,
    /// Upper end.
    pub total_high: f64,
}

/// Sample of the unit cube for estimating Sobol indices.
#[derive(Debug, Clone)]
pub struct Sample {
    a: Vec<Vec<f64>>,
    b: Vec<Vec<f64>>,
    seed: u64,
}

impl Sample {
    /// Draws `rows` pairs of points of `dimension` inputs from a scrambled Sobol sequence of twice
    /// the dimension.
    pub fn new(dimension: usize, rows: usize, seed: u64) -> Self {
        let sequence = SobolSequence::new(2 * dimension, seed, 0, "sensitivity sample");
        let halves = |row: Vec<f64>| (row[..dimension].to_vec(), row[dimension..].to_vec());
        let (a, b) = sequence.take(rows).map(halves).unzip();
        Sample { a, b, seed }
    }

    /// Returns the points to evaluate: `rows * (dimension + 2)`, coordinates in 0 .. 1.
    pub fn points(&self) -> Vec<Vec<f64>> {
        let mut points = [self.a.clone(), self.b.clone()].concat();
        for input in 0..self.a.first().map_or(0, Vec::len) {
            points.extend(self.a.iter().zip(&self.b).map(|(a, b)| {
                let mut mixed = a.clone();
                mixed[input] = b[input];
                mixed
            }));
        }
        points
    }

    /// Estimates the indices of each input from the values at [`Sample::points`], in their order; `None` if the
    /// variance of the values is at most [`f64::EPSILON`].
    pub fn indices(&self, values: &[f64]) -> Option<Vec<Indices>> {
        let rows = self.a.len();
        let (of_a, rest) = values.split_at(rows);
        let (of_b, mixed) = rest.split_at(rows);
        let every: Vec<usize> = (0..rows).collect();
        if variance(of_a, of_b, &every) <= f64::EPSILON {
            return None;
        }
        let of = |(input, mixed): (usize, &[f64])| {
            let seed = self.seed.wrapping_add(input as u64);
            let half_mean_square = |from: &[f64], rows: &[usize]| {
                let sum: f64 = rows.iter().map(|&row| (from[row] - mixed[row]).powi(2)).sum();
                sum / (2.0 * rows.len() as f64)
            };
            let share = |from, rows: &[usize]| {
                half_mean_square(from, rows) / variance(of_a, of_b, rows).max(f64::MIN_POSITIVE)
            };
            let [first, first_low, first_high] =
                bootstrap(rows, seed, |rows| 1.0 - share(of_b, rows));
            let [total, total_low, total_high] = bootstrap(rows, seed, |rows| share(of_a, rows));
            Indices { first, first_low, first_high, total, total_low, total_high }
        };
        Some(mixed.chunks(rows).enumerate().map(of).collect())
    }
}

/// Returns the pooled variance of both samples over the given rows.
fn variance(of_a: &[f64], of_b: &[f64], rows: &[usize]) -> f64 {
    Moments::of(rows.iter().flat_map(|&row| [of_a[row], of_b[row]])).sample_variance()
}

/// Computes `statistic` over all rows, and the ends of its interval by resampling the rows.
fn bootstrap(rows: usize, seed: u64, statistic: impl Fn(&[usize]) -> f64) -> [f64; 3] {
    let every: Vec<usize> = (0..rows).collect();
    let mut random = stream(seed, rows as u64, "sensitivity bootstrap");
    let mut resample =
        || -> Vec<usize> { every.iter().map(|_| random.random_range(0..rows)).collect() };
    let found = sorted((0..RESAMPLES).map(|_| statistic(&resample())));
    let at = |share: f64| quantile(&found, share).unwrap_or(f64::NAN);
    [statistic(&every), at(TAIL), at(1.0 - TAIL)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn indices(dimension: usize, rows: usize, f: impl Fn(&[f64]) -> f64) -> Vec<Indices> {
        let sample = Sample::new(dimension, rows, 7);
        let values: Vec<f64> = sample.points().iter().map(|at| f(at)).collect();
        sample.indices(&values).unwrap()
    }

    fn close(found: &[Indices], first: &[f64], total: &[f64], error: f64) {
        for (i, found) in found.iter().enumerate() {
            assert!((found.first - first[i]).abs() < error, "{i}: {found:?}");
            assert!((found.total - total[i]).abs() < error, "{i}: {found:?}");
            assert!(found.total_low <= found.total && found.total <= found.total_high);
        }
    }

    /// sin x1 + a sin^2 x2 + b x3^4 sin x1 on -pi .. pi (Ishigami and Homma 1990), a = 7, b = 0.1.
    #[test]
    fn ishigami_has_its_closed_form() {
        let (a, b) = (7.0, 0.1);
        let found = indices(3, 4096, |u| {
            let x: Vec<f64> = u.iter().map(|u| PI * (2.0 * u - 1.0)).collect();
            libm::sin(x[0]) + a * libm::sin(x[1]).powi(2) + b * x[2].powi(4) * libm::sin(x[0])
        });
        let v1 = 0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2);
        let v2 = a * a / 8.0;
        let v13 = b * b * PI.powi(8) * (1.0 / 18.0 - 1.0 / 50.0);
        let v = v1 + v2 + v13;
        close(&found, &[v1 / v, v2 / v, 0.0], &[(v1 + v13) / v, v2 / v, v13 / v], 0.02);
    }

    /// Product of (|4 u - 2| + a) / (1 + a) (Saltelli and Sobol 1995).
    #[test]
    fn the_g_function_has_its_closed_form() {
        let a = [0.0, 1.0, 4.5, 9.0, 99.0, 99.0];
        let found = indices(6, 4096, |u| {
            u.iter().zip(a).map(|(u, a)| ((4.0 * u - 2.0).abs() + a) / (1.0 + a)).product()
        });
        let alone = a.map(|a: f64| 1.0 / (3.0 * (1.0 + a).powi(2)));
        let v = alone.iter().map(|v| 1.0 + v).product::<f64>() - 1.0;
        let first = alone.map(|own| own / v);
        let total = alone.map(|own| own * (v + 1.0) / (1.0 + own) / v);
        close(&found, &first, &total, 0.03);
    }

    /// Over many small samples, the coverage of a 95 % interval is about 95 %.
    #[test]
    fn intervals_cover_the_true_value() {
        let held = (0..60).filter(|&seed| {
            let sample = Sample::new(2, 128, seed);
            let values: Vec<f64> = sample.points().iter().map(|u| u[0] + 0.5 * u[1]).collect();
            let found = sample.indices(&values).unwrap()[0];
            found.total_low <= 0.8 && 0.8 <= found.total_high
        });
        assert!(held.count() >= 53);
    }

    #[test]
    fn a_constant_has_no_shares() {
        let sample = Sample::new(3, 16, 0);
        assert_eq!(sample.indices(&vec![2.5; sample.points().len()]), None);
    }
}
