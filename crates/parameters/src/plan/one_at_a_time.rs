//! One-at-a-time plan: each parameter alone is moved from its current value to either bound.

use crate::Parameter;

/// Number of steps between the current value and a bound; the farthest feasible step is used.
const STEPS: u32 = 100;

/// Returns the result of `evaluate` at a bound of the parameter (the upper one if `upper`) or, if that is infeasible, at
/// the farthest feasible step towards it, found by bisection; `None` if the current value is infeasible, too.
///
/// `number` is the current value in the files; a bound on the wrong side of it is replaced by it. `evaluate` returns
/// `None` for an infeasible value.
pub fn farthest<T>(
    parameter: &Parameter,
    number: f64,
    upper: bool,
    evaluate: impl Fn(f64) -> Option<T>,
) -> Option<T> {
    let neutral = parameter.neutral(number);
    let Parameter { low, high, .. } = parameter;
    let bound = if upper { high.max(neutral) } else { low.min(neutral) };
    let at_step =
        |steps: u32| evaluate(neutral + f64::from(steps) / f64::from(STEPS) * (bound - neutral));
    if let Some(found) = at_step(STEPS) {
        return Some(found);
    }
    let (mut feasible, mut infeasible) = (0, STEPS);
    while infeasible - feasible > 1 {
        let middle = (feasible + infeasible) / 2;
        if at_step(middle).is_some() { feasible = middle } else { infeasible = middle }
    }
    at_step(feasible)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Path, Transform};

    #[test]
    fn the_result_is_that_of_the_bound_or_of_the_farthest_feasible_step() {
        let path = Path::new("task.grip.force_n").unwrap();
        let force = Parameter::uniform(path, [2.0, 10.0]);
        let below = |most: f64| move |value: f64| (value <= most).then_some(value);
        assert_eq!(farthest(&force, 5.0, true, below(99.0)), Some(10.0));
        assert_eq!(farthest(&force, 5.0, false, below(99.0)), Some(2.0));
        // Steps of 0.05 from 5 up.
        let found = farthest(&force, 5.0, true, below(7.02)).unwrap();
        assert!((found - 7.0).abs() < 1e-12, "{found}");
        assert_eq!(farthest(&force, 5.0, true, below(4.0)), None);
        let outside = Parameter { low: 6.0, ..force.clone() };
        assert_eq!(farthest(&outside, 5.0, false, below(99.0)), Some(5.0), "unchanged");
        let factor = Parameter { transform: Transform::Factor, low: 0.5, high: 2.0, ..force };
        assert_eq!(farthest(&factor, 5.0, false, below(99.0)), Some(0.5));
    }
}
