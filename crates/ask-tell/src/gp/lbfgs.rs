//! L-BFGS of argmin within a box.
//!
//! The substitution `x = middle + half sin(u)` of each coordinate makes the problem unconstrained and a minimum on a
//! face a stationary point.

use argmin::core::{CostFunction, Error, Executor, Gradient};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use std::cell::{Cell, RefCell};
use std::f64::consts::FRAC_PI_2;

/// Number of stored pairs of steps and gradient changes.
const MEMORY: usize = 8;
/// Length of the first step, in radians: without scaling it would be the norm of the gradient.
const FIRST_STEP: f64 = 0.3;
/// Smallest distance of the start from the faces, where the derivative of the sine is zero, in radians.
const FACE_CLEARANCE: f64 = 0.1;
/// Relative change of the value below which the run ends.
const MIN_GAIN: f64 = 1e-7;

/// A value and its gradient.
type ValueAndGradient = (f64, Vec<f64>);

/// Bounds and budget.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits<'a> {
    pub low: &'a [f64],
    pub high: &'a [f64],
    /// Largest number of joint evaluations of value and gradient.
    pub evaluations: usize,
}

/// Minimises `f` (value and gradient, `None` outside its domain) from `start`; returns the best
/// point evaluated and its value, or `None` if `f` has no value at the start.
pub(super) fn minimise(
    f: impl Fn(&[f64]) -> Option<ValueAndGradient>,
    start: &[f64],
    limits: &Limits,
) -> Option<(Vec<f64>, f64)> {
    let middle_and_half =
        |i: usize| (0.5 * (limits.low[i] + limits.high[i]), 0.5 * (limits.high[i] - limits.low[i]));
    let most = FRAC_PI_2 - FACE_CLEARANCE;
    let angle = |(i, x): (usize, &f64)| {
        let (middle, half) = middle_and_half(i);
        libm::asin(((x - middle) / half).clamp(-1.0, 1.0)).clamp(-most, most)
    };
    let start: Vec<f64> = start.iter().enumerate().map(angle).collect();
    let in_angles = |u: &[f64]| {
        let axes = || u.iter().enumerate().map(|(i, u)| (middle_and_half(i), u));
        let x: Vec<f64> = axes().map(|((middle, half), u)| middle + half * libm::sin(*u)).collect();
        let (value, g) = f(&x)?;
        let gradient = axes().zip(g).map(|(((_, half), u), g)| g * half * libm::cos(*u)).collect();
        Some((x, value, gradient))
    };
    let (x, value, gradient): (_, f64, Vec<f64>) = in_angles(&start)?;
    let norm = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
    let scale = FIRST_STEP / norm;
    if !scale.is_finite() {
        return Some((x, value));
    }
    let scaled = |value: f64, gradient: Vec<f64>| -> ValueAndGradient {
        (scale * value, gradient.iter().map(|g| scale * g).collect())
    };
    let tolerance = MIN_GAIN * scale * value.abs().max(1.0);
    let best = RefCell::new((x, value));
    // argmin evaluates value and gradient of a point separately.
    let last = RefCell::new((start.clone(), scaled(value, gradient)));
    let left = Cell::new(limits.evaluations.saturating_sub(1));
    let evaluate = |u: &[f64]| {
        if last.borrow().0 != u {
            left.set(left.get().checked_sub(1)?);
            let (x, value, gradient) = in_angles(u)?;
            if value < best.borrow().1 {
                best.replace((x, value));
            }
            last.replace((u.to_vec(), scaled(value, gradient)));
        }
        Some(last.borrow().1.clone())
    };
    let line_search = MoreThuenteLineSearch::new();
    let solver = LBFGS::new(line_search, MEMORY).with_tolerance_cost(tolerance).ok()?;
    // The run ends with an error when the budget is spent; the best point is stored outside of it.
    let _ = Executor::new(Scaled(&evaluate), solver)
        .configure(|state| state.param(start).max_iters(limits.evaluations as u64))
        .timer(false)
        .run();
    Some(best.into_inner())
}

/// Objective as a function of the angles, scaled so that its first gradient has the length of the first step;
/// `None` when the budget is spent or a point has no value.
struct Scaled<'a>(&'a dyn Fn(&[f64]) -> Option<ValueAndGradient>);

impl Scaled<'_> {
    fn at(&self, u: &[f64]) -> Result<ValueAndGradient, Error> {
        (self.0)(u).ok_or_else(|| Error::msg("end of the run"))
    }
}

impl CostFunction for Scaled<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, u: &Vec<f64>) -> Result<f64, Error> {
        Ok(self.at(u)?.0)
    }
}

impl Gradient for Scaled<'_> {
    type Param = Vec<f64>;
    type Gradient = Vec<f64>;

    fn gradient(&self, u: &Vec<f64>) -> Result<Vec<f64>, Error> {
        Ok(self.at(u)?.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rosenbrock(x: &[f64]) -> Option<(f64, Vec<f64>)> {
        let (a, b) = (1.0 - x[0], x[1] - x[0] * x[0]);
        Some((a * a + 100.0 * b * b, vec![-2.0 * a - 400.0 * x[0] * b, 200.0 * b]))
    }

    #[test]
    fn rosenbrock_is_minimised_and_a_bound_holds() {
        let mut limits = Limits { low: &[-5.0, -5.0], high: &[5.0, 5.0], evaluations: 300 };
        let (x, _) = minimise(rosenbrock, &[-1.2, 1.0], &limits).unwrap();
        assert!((x[0] - 1.0).abs() < 1e-3 && (x[1] - 1.0).abs() < 2e-3, "{x:?}");
        limits.high = &[0.5, 5.0];
        let (x, _) = minimise(rosenbrock, &[-1.2, 1.0], &limits).unwrap();
        assert!((x[0] - 0.5).abs() < 1e-3 && (x[1] - 0.25).abs() < 1e-3, "{x:?}");
    }

    #[test]
    fn it_keeps_to_its_budget() {
        for evaluations in 1..20 {
            let limits = Limits { low: &[-5.0, -5.0], high: &[5.0, 5.0], evaluations };
            let count = Cell::new(0);
            let counted = |x: &[f64]| {
                count.set(count.get() + 1);
                rosenbrock(x)
            };
            minimise(counted, &[-1.2, 1.0], &limits).unwrap();
            assert!(count.get() <= evaluations, "{} of {evaluations}", count.get());
        }
    }

    #[test]
    fn a_function_without_values_ends_at_once() {
        let limits = Limits { low: &[0.0], high: &[1.0], evaluations: 10 };
        assert!(minimise(|_| None, &[0.5], &limits).is_none());
    }
}
