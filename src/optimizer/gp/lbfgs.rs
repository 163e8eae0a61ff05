//! A small limited-memory BFGS minimiser in a box (Nocedal and Wright 2006, algorithm 7.4).

use super::linalg::dot;

const MEMORY: usize = 8;
/// Armijo's sufficient decrease.
const DECREASE: f64 = 1e-4;

/// The box and the budget.
pub(super) struct Limits<'a> {
    pub low: &'a [f64],
    pub high: &'a [f64],
    pub evaluations: usize,
    /// Ends when no component of the projected gradient is larger.
    pub gradient: f64,
}

/// Minimises `f` (value and gradient, `None` outside its domain) from `start`; returns the best
/// point and value, or `None` if `f` has no value at the start.
pub(super) fn minimise(
    mut f: impl FnMut(&[f64]) -> Option<(f64, Vec<f64>)>,
    start: &[f64],
    limits: &Limits,
) -> Option<(Vec<f64>, f64)> {
    let mut x = clamp(start, limits);
    let (mut value, mut gradient) = f(&x)?;
    let mut left = limits.evaluations.saturating_sub(1);
    let mut pairs: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    while left > 0 {
        let free = projected(&x, &gradient, limits);
        if free.iter().all(|g| g.abs() < limits.gradient) {
            break;
        }
        let mut direction = two_loop(&free, &pairs);
        // A component that would leave the box is dropped; so is a direction that climbs.
        direction.iter_mut().zip(&free).for_each(|(p, g)| {
            if *g == 0.0 {
                *p = 0.0;
            }
        });
        if dot(&direction, &free) >= 0.0 {
            pairs.clear();
            direction = free.iter().map(|g| -g).collect();
        }
        let longest = direction.iter().fold(0.0, |m: f64, p| m.max(p.abs()));
        // Without curvature known, and in log units, a step of one is large.
        let mut t =
            if pairs.is_empty() { (0.5 / longest).min(1.0) } else { (2.0 / longest).min(1.0) };
        let mut accepted = None;
        while left > 0 && accepted.is_none() {
            let along: Vec<f64> = x.iter().zip(&direction).map(|(x, p)| x + t * p).collect();
            let trial = clamp(&along, limits);
            left -= 1;
            let moved: Vec<f64> = trial.iter().zip(&x).map(|(a, b)| a - b).collect();
            if moved.iter().all(|m| m.abs() < 1e-10) {
                return Some((x, value));
            }
            accepted = f(&trial)
                .filter(|(v, _)| *v <= value + DECREASE * dot(&free, &moved))
                .map(|(v, g)| (trial, moved, v, g));
            t *= 0.3;
        }
        let Some((trial, moved, new_value, new_gradient)) = accepted else { break };
        let change: Vec<f64> = new_gradient.iter().zip(&gradient).map(|(a, b)| a - b).collect();
        if dot(&moved, &change) > 1e-10 * dot(&change, &change) {
            if pairs.len() == MEMORY {
                pairs.remove(0);
            }
            pairs.push((moved, change));
        }
        let gained = value - new_value;
        (x, value, gradient) = (trial, new_value, new_gradient);
        if gained < 1e-7 * value.abs().max(1.0) {
            break;
        }
    }
    Some((x, value))
}

fn clamp(x: &[f64], limits: &Limits) -> Vec<f64> {
    let bounds = limits.low.iter().zip(limits.high);
    x.iter().zip(bounds).map(|(x, (l, h))| x.max(*l).min(*h)).collect()
}

/// The gradient without the components that push against a bound.
fn projected(x: &[f64], gradient: &[f64], limits: &Limits) -> Vec<f64> {
    (0..x.len())
        .map(|i| {
            let g = gradient[i];
            let blocked = (x[i] <= limits.low[i] && g > 0.0) || (x[i] >= limits.high[i] && g < 0.0);
            if blocked || !g.is_finite() { 0.0 } else { g }
        })
        .collect()
}

/// Minus the inverse Hessian, as the pairs (step, change of gradient) know it, times `g`.
fn two_loop(g: &[f64], pairs: &[(Vec<f64>, Vec<f64>)]) -> Vec<f64> {
    let mut q = g.to_vec();
    let mut factors = Vec::new();
    for (s, y) in pairs.iter().rev() {
        let a = dot(s, &q) / dot(s, y);
        q.iter_mut().zip(y).for_each(|(q, y)| *q -= a * y);
        factors.push(a);
    }
    if let Some((s, y)) = pairs.last() {
        let scale = dot(s, y) / dot(y, y);
        q.iter_mut().for_each(|q| *q *= scale);
    }
    for ((s, y), a) in pairs.iter().zip(factors.iter().rev()) {
        let b = dot(y, &q) / dot(s, y);
        q.iter_mut().zip(s).for_each(|(q, s)| *q += (a - b) * s);
    }
    q.iter_mut().for_each(|q| *q = -*q);
    q
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
        let mut limits =
            Limits { low: &[-5.0, -5.0], high: &[5.0, 5.0], evaluations: 300, gradient: 1e-8 };
        let (x, _) = minimise(rosenbrock, &[-1.2, 1.0], &limits).unwrap();
        assert!((x[0] - 1.0).abs() < 1e-3 && (x[1] - 1.0).abs() < 2e-3, "{x:?}");
        limits.high = &[0.5, 5.0];
        let (x, _) = minimise(rosenbrock, &[-1.2, 1.0], &limits).unwrap();
        assert!((x[0] - 0.5).abs() < 1e-6 && (x[1] - 0.25).abs() < 1e-3, "{x:?}");
    }

    #[test]
    fn a_function_without_values_ends_at_once() {
        let limits = Limits { low: &[0.0], high: &[1.0], evaluations: 10, gradient: 1e-8 };
        assert!(minimise(|_| None, &[0.5], &limits).is_none());
    }
}
