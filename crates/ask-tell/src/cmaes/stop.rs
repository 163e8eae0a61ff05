//! Termination criteria on objective values: appendix B.3 of the tutorial.

use crate::statistics::{median, span};

/// Termination tolerances of a run; the defaults are pycma's. Names as in the tutorial.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerances {
    /// TolFun: range of the last generation and of the best recent values.
    pub fun: f64,
    /// TolFunHist: range of the best recent values.
    pub fun_hist: f64,
    /// TolX: largest standard deviation and step of the path, in units of x.
    pub x: f64,
    /// TolXUp: largest growth of a standard deviation, as a factor on the initial step size.
    pub x_up: f64,
}

impl Default for Tolerances {
    fn default() -> Self {
        Tolerances { fun: 1e-11, fun_hist: 1e-12, x: 1e-11, x_up: 1e3 }
    }
}

/// History of values for the termination criteria.
#[derive(Debug, Clone, Default)]
pub(super) struct History {
    /// Best value of each generation, oldest first.
    best: Vec<f64>,
    /// Median value of each generation, oldest first.
    median: Vec<f64>,
    /// Consecutive generations whose best third has equal values.
    flat: u32,
    /// Range of the values of the last generation.
    last_range: f64,
}

impl History {
    /// Records a generation's values, sorted ascending.
    pub(super) fn push(&mut self, sorted: &[f64]) {
        let (Some(&best), Some(&worst)) = (sorted.first(), sorted.last()) else { return };
        self.best.push(best);
        self.median.push(sorted[sorted.len() / 2]);
        self.last_range = range(&[best, worst]);
        let third = sorted[(sorted.len() / 3 + 1).min(sorted.len() - 1)];
        self.flat = if best == third { self.flat + 1 } else { 0 };
    }

    /// Returns whether TolFun, TolFunHist, EqualFunValues or Stagnation of the tutorial applies.
    pub(super) fn ended(&self, n: usize, lambda: usize, tol: &Tolerances) -> bool {
        let recent_length = 10 + (30 * n).div_ceil(lambda);
        let recent = &self.best[self.best.len().saturating_sub(recent_length)..];
        let (small, recent_range) = (self.last_range < tol.fun, range(recent));
        // Requires some history; otherwise one generation on a plateau would end a run.
        let unmoved = small && recent_range < tol.fun || recent_range < tol.fun_hist;
        recent.len() > 9 && unmoved || self.flat > 3 || self.stagnated(n, lambda)
    }

    /// Returns whether the run stagnates by the rule of the tutorial, which compares the medians of the newest and the
    /// oldest 30 % of the last `max(120 + 30 n / lambda, 20 % of the run)` generations, at most 20000.
    fn stagnated(&self, n: usize, lambda: usize) -> bool {
        let length = (120 + 30 * n / lambda).max(self.best.len() / 5).min(20_000);
        if self.best.len() <= length {
            return false;
        }
        let part = length * 3 / 10;
        let worse = |values: &[f64]| {
            let window = &values[values.len() - length..];
            let [old, new] =
                [0..part, length - part..length].map(|part| window[part].iter().copied());
            median(new) >= median(old)
        };
        worse(&self.best) && worse(&self.median)
    }
}

/// Returns the largest minus the smallest value; 0 if all are the same infinity.
fn range(values: &[f64]) -> f64 {
    let [low, high] = span(values);
    if low == high { 0.0 } else { high - low }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_and_infinite_values_end_a_run() {
        let tol = Tolerances { fun: 0.0, fun_hist: 0.0, ..Tolerances::default() };
        for value in [1.0, f64::INFINITY] {
            let mut history = History::default();
            for generation in 0..4 {
                assert!(!history.ended(2, 6, &tol), "{generation}");
                history.push(&[value; 6]);
            }
            assert!(history.ended(2, 6, &tol));
        }
    }

    #[test]
    fn getting_no_better_is_stagnation() {
        let mut history = History::default();
        for generation in 0..200 {
            let wave = f64::from(generation % 7);
            history.push(&[wave, wave + 1.0, wave + 2.0, wave + 3.0]);
        }
        assert!(history.ended(2, 6, &Tolerances::default()));
    }
}
