//! A slope on plateaus. Windows are measured on a grid of 0.1 mm, so many designs have
//! the same range, and all whose nominal start fails have none. Optimizers are told where
//! within the last grid step the outcome turns, too; the study's values stay on the grid.

use super::{Goals, Measure};
use crate::evaluation::{Evaluation, OFFSET_STEP_MM};
use crate::outcome::Outcome;

impl Goals {
    /// Values for an optimizer of a design evaluated on each task: as of
    /// [`score`](Goals::score), larger being better, with the slope. `None` if there is no score.
    pub fn told(&self, tasks: &[&Evaluation]) -> Option<Vec<f64>> {
        let of = |&measure: &Measure| {
            let values: Option<Vec<f64>> = tasks
                .iter()
                .map(|task| Some(measure.value(task)? + slope(measure, task)))
                .collect();
            Some(measure.sense() * self.aggregate.of(measure.sense(), &values?))
        };
        self.objectives.measures().iter().map(of).collect()
    }
}

/// Less than one grid step, so that of two different ranges the larger stays the larger:
/// at each end half of the step's share that still inserts; below 0, by how clearly the
/// nominal start fails, where it does. 0 for what is not taken on the grid.
fn slope(measure: Measure, evaluation: &Evaluation) -> f64 {
    if !matches!(measure, Measure::Range | Measure::CentredRange) {
        return 0.0;
    }
    let (window, [below, above]) = (&evaluation.window, evaluation.end_shares);
    if window.nominal != Outcome::Inserted {
        return OFFSET_STEP_MM * below.min(0.0);
    }
    let share = match (measure, -window.negative_steps - window.positive_steps) {
        (Measure::CentredRange, smaller_below) if smaller_below < 0 => below,
        (Measure::CentredRange, smaller_above) if smaller_above > 0 => above,
        (Measure::CentredRange, _) => below.min(above),
        _ => (below + above) / 2.0,
    };
    OFFSET_STEP_MM * share
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::tolerance::{self, Search};
    use crate::fixtures::finger;
    use crate::trial::fake::FakeRig;

    fn told(measure: Measure, evaluation: &Evaluation) -> f64 {
        Goals::of(measure).told(&[evaluation]).unwrap()[0]
    }

    fn measured(compliance: f64, assembly: f64) -> Evaluation {
        tolerance::evaluate(&FakeRig::default(), &finger(compliance, assembly), Search::Strides)
    }

    /// -3.333 and 1.400 mm in the closed form: 0.033 and nothing beyond the grid.
    #[test]
    fn the_slope_is_half_of_what_the_grid_cuts_off() {
        let evaluation = measured(3.0, 20.0);
        let beyond = told(Measure::Range, &evaluation) - 4.7;
        assert!((beyond - 0.033_333 / 2.0).abs() < 1e-5, "{beyond}");
        let centred = told(Measure::CentredRange, &evaluation) - 2.8;
        assert!(centred.abs() < 1e-5, "{centred}");
        assert_eq!(told(Measure::PeakForce, &evaluation), -evaluation.peak_force_n);
    }

    #[test]
    fn plateaus_have_a_slope_and_the_order_of_ranges_stays() {
        let fingers = (0..200).map(|i| measured(3.0, 20.0 + 0.05 * f64::from(i)));
        let found: Vec<(f64, f64)> = fingers
            .map(|evaluation| (evaluation.window.range_mm(), told(Measure::Range, &evaluation)))
            .collect();
        assert!(found.windows(2).filter(|pair| pair[0].0 == pair[1].0).count() > 150);
        for pair in found.windows(2) {
            assert!(pair[0].1 < pair[1].1 + 1e-9, "{pair:?}");
        }
    }

    #[test]
    fn the_nearer_to_inserting_the_better_where_the_nominal_start_fails() {
        let failed = |share: f64| {
            let mut evaluation = measured(3.0, 20.0);
            evaluation.window.nominal = Outcome::Failed(crate::outcome::FailureClass::Jammed);
            evaluation.end_shares = [share; 2];
            told(Measure::Range, &evaluation)
        };
        assert!(failed(-1.0) < failed(-0.2) && failed(-0.2) < 0.0 && failed(-1.0) >= -0.1);
    }
}
