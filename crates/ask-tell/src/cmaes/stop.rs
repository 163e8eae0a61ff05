//! Named reasons to end a run: appendix B.3 of the tutorial.

use std::fmt;

/// Why a run ended, in the tutorial's names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The values of the last generation and the best values of the recent ones lie within
    /// [`Tolerances::fun`].
    TolFun,
    /// The best values of the recent generations lie within [`Tolerances::fun_hist`].
    TolFunHist,
    /// More than a third of a generation shares its best value, several times.
    EqualFunValues,
    /// All standard deviations and steps of the path are below [`Tolerances::x`].
    TolX,
    /// A standard deviation grew by more than [`Tolerances::x_up`]: the step size was far too
    /// small or the function has no minimum.
    TolXUp,
    /// The condition number of C is above 1e14.
    ConditionCov,
    /// A tenth of a standard deviation along a principal axis does not change the mean.
    NoEffectAxis,
    /// A fifth of a standard deviation in a coordinate does not change the mean.
    NoEffectCoord,
    /// Neither best nor median values have improved for long.
    Stagnation,
    /// The limit of generations set by the caller was reached.
    MaxGenerations,
    /// The state is no longer finite.
    NotFinite,
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self:?}")
    }
}

/// Limits of the stop reasons; the defaults are pycma's.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerances {
    /// [`Stop::TolFun`], in objective units.
    pub fun: f64,
    /// [`Stop::TolFunHist`], in objective units.
    pub fun_hist: f64,
    /// [`Stop::TolX`], in units of x.
    pub x: f64,
    /// [`Stop::TolXUp`], a factor on the initial step size.
    pub x_up: f64,
    /// [`Stop::MaxGenerations`]; `None` for no limit.
    pub max_generations: Option<u64>,
}

impl Default for Tolerances {
    fn default() -> Self {
        Tolerances { fun: 1e-11, fun_hist: 1e-12, x: 1e-11, x_up: 1e3, max_generations: None }
    }
}

/// The values that the stop reasons look back on.
#[derive(Debug, Clone, Default)]
pub(super) struct History {
    /// Best value of each generation, oldest first.
    best: Vec<f64>,
    /// Median value of each generation, oldest first.
    median: Vec<f64>,
    /// Consecutive generations with a flat best third.
    flat: u32,
    last_range: f64,
}

impl History {
    /// Takes in a generation's values, sorted ascending.
    pub(super) fn push(&mut self, sorted: &[f64]) {
        let (Some(&best), Some(&worst)) = (sorted.first(), sorted.last()) else { return };
        self.best.push(best);
        self.median.push(sorted[sorted.len() / 2]);
        self.last_range = range(&[best, worst]);
        let third = sorted[(sorted.len() / 3 + 1).min(sorted.len() - 1)];
        self.flat = if best == third { self.flat + 1 } else { 0 };
    }

    /// The stop reason that the values alone give.
    pub(super) fn stop(&self, n: usize, lambda: usize, tol: &Tolerances) -> Option<Stop> {
        let recent_length = 10 + (30 * n).div_ceil(lambda);
        let recent = &self.best[self.best.len().saturating_sub(recent_length)..];
        // Some history is needed, or one generation on a plateau would end a run.
        if recent.len() > 9 && self.last_range < tol.fun && range(recent) < tol.fun {
            return Some(Stop::TolFun);
        }
        if recent.len() > 9 && range(recent) < tol.fun_hist {
            return Some(Stop::TolFunHist);
        }
        if self.flat > 3 {
            return Some(Stop::EqualFunValues);
        }
        self.stagnated(n, lambda).then_some(Stop::Stagnation)
    }

    /// The tutorial's rule: the medians of the newest and the oldest 30 % of a window of the
    /// last `max(120 + 30 n / lambda, 20 % of the run)` generations, at most 20000, are compared.
    fn stagnated(&self, n: usize, lambda: usize) -> bool {
        let length = (120 + 30 * n / lambda).max(self.best.len() / 5).min(20_000);
        if self.best.len() <= length {
            return false;
        }
        let part = length * 3 / 10;
        let worse = |values: &[f64]| {
            let window = &values[values.len() - length..];
            median(&window[length - part..]) >= median(&window[..part])
        };
        worse(&self.best) && worse(&self.median)
    }
}

/// Largest minus smallest; two equal infinities count as no range.
fn range(values: &[f64]) -> f64 {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if low == high { 0.0 } else { high - low }
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_and_infinite_values_are_named() {
        let tol = Tolerances { fun: 0.0, fun_hist: 0.0, ..Tolerances::default() };
        for value in [1.0, f64::INFINITY] {
            let mut history = History::default();
            for _ in 0..4 {
                history.push(&[value; 6]);
            }
            assert_eq!(history.stop(2, 6, &tol), Some(Stop::EqualFunValues));
        }
    }

    #[test]
    fn getting_no_better_is_stagnation() {
        let mut history = History::default();
        for generation in 0..200 {
            let wave = f64::from(generation % 7);
            history.push(&[wave, wave + 1.0, wave + 2.0, wave + 3.0]);
        }
        assert_eq!(history.stop(2, 6, &Tolerances::default()), Some(Stop::Stagnation));
    }
}
