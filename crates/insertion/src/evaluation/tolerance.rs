//! Search for the tolerance window of a finger: the range of shifted starts that insert.

use crate::evaluation::OFFSET_STEP_MM;
use crate::trial::Grasped;
use crate::{Evaluation, Finger, Grasp, OffsetStep, Outcome, Rig, Trial, Window};
use input::units::MM;

/// Largest offset tried, in grid steps: 15 mm, well beyond the widest published window (9 mm).
pub const OFFSET_LIMIT_STEPS: OffsetStep = 150;

/// Search for the ends of a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Search {
    /// Outward in single grid steps to the first failure, as in the paper.
    Walk,
    /// Outward in strides of 0.5 mm to the first failure, then by bisection: a third of the trials of the walk.
    /// The result equals that of the walk unless the window has a gap (offsets that fail between offsets that insert)
    /// narrower than a stride; on all 44 pairs of task and measured finger it does (`docs/notes/performance.md`).
    #[default]
    Strides,
}

/// Measures the window of one finger and counts the results of all trials of the search.
///
/// The start is shifted outward on the 0.1 mm grid in both directions until
/// the first trial that does not insert (the paper, Sec. "Robot Movement").
pub fn evaluate(rig: &dyn Rig, finger: &Finger, search: Search) -> Evaluation {
    evaluate_grasp(rig, Grasp::of(finger), search)
}

/// Measures the window of one grasp as [`evaluate`] does. The result is invalid once the stop flag of the grasp is set.
pub fn evaluate_grasp(rig: &dyn Rig, grasp: Grasp, search: Search) -> Evaluation {
    let grasped = rig.grasp(grasp);
    let nominal = [grasped.trial(0.0)];
    let Trial { outcome, margin, .. } = nominal[0];
    let ((negative, below), (positive, above)) = if outcome == Outcome::Inserted {
        // Distance between the offsets tried until the first failure, in grid steps.
        let stride = if search == Search::Walk { 1 } else { 5 };
        let end = |sign| find_end(&*grasped, margin, sign, stride);
        rayon::join(|| end(-1), || end(1))
    } else {
        let end = End { step: 0, failure: Some(outcome), share: margin };
        ((end, vec![]), (end, vec![]))
    };
    let window = Window {
        nominal: outcome,
        negative_steps: -negative.step,
        positive_steps: positive.step,
        end_negative: negative.failure,
        end_positive: positive.failure,
    };
    let mut evaluation = Evaluation::of(window, [negative.share, positive.share]);
    for trials in [&nominal[..], &below, &above] {
        evaluation.count(trials);
    }
    evaluation
}

/// End of a window.
#[derive(Clone, Copy)]
struct End {
    /// Number of grid steps from the nominal start to the last inserting offset, 0 or above.
    step: OffsetStep,
    /// Outcome at the next offset outward; `None` at [`OFFSET_LIMIT_STEPS`].
    failure: Option<Outcome>,
    /// Position of the outcome change between these two offsets, 0 to 1; if the nominal start fails, its margin.
    share: f64,
}

/// Searches outward from the nominal start for one end of the window; returns the end and the trials.
fn find_end(
    grasped: &dyn Grasped,
    nominal_margin: f64,
    sign: OffsetStep,
    stride: OffsetStep,
) -> (End, Vec<Trial>) {
    let mut trials = Vec::new();
    let (mut step, mut margin) = (0, nominal_margin);
    // Step, outcome and margin of the innermost failing offset.
    let mut outside: Option<(OffsetStep, Outcome, f64)> = None;
    loop {
        let next = match outside {
            None if step >= OFFSET_LIMIT_STEPS => break,
            None => (step + stride).min(OFFSET_LIMIT_STEPS),
            Some((outside, ..)) if outside - step <= 1 => break,
            Some((outside, ..)) => (step + outside) / 2,
        };
        let trial = grasped.trial(offset(sign * next));
        match trial.outcome {
            Outcome::Inserted => (step, margin) = (next, trial.margin),
            failure => outside = Some((next, failure, trial.margin)),
        }
        trials.push(trial);
    }
    // Between the two offsets, the margin falls linearly and is 0 at this share of the step.
    let drop = outside.map_or(0.0, |(_, _, beyond)| margin - beyond);
    let share = if drop > 0.0 { margin / drop } else { 0.0 };
    (End { step, failure: outside.map(|(_, failure, _)| failure), share }, trials)
}

/// Returns the offset of a grid step, m.
pub fn offset(step: OffsetStep) -> f64 {
    f64::from(step) * OFFSET_STEP_MM * MM
}

impl Evaluation {
    /// Returns an evaluation with this window and no trials.
    pub(super) fn of(window: Window, end_shares: [f64; 2]) -> Self {
        Evaluation {
            window,
            failure_counts: [0; 4],
            diverged: 0,
            robot_stops: 0,
            trials: 0,
            // There is no largest value before a trial inserts.
            peak_force_n: f64::NAN,
            slip_mm: f64::NAN,
            simulated_s: 0.0,
            end_shares,
            taught: None,
            success: None,
            robust: None,
        }
    }

    /// Adds the results of trials.
    fn count(&mut self, trials: &[Trial]) {
        self.trials += trials.len() as u32;
        self.simulated_s += trials.iter().map(|trial| trial.simulated_s).sum::<f64>();
        for trial in trials {
            self.robot_stops += u32::from(trial.robot_stopped);
            match trial.outcome {
                Outcome::Inserted => {
                    self.peak_force_n = self.peak_force_n.max(trial.peak_force_n);
                    self.slip_mm = self.slip_mm.max(trial.slip_mm);
                }
                Outcome::Failed(class) => self.failure_counts[class as usize] += 1,
                Outcome::Diverged => self.diverged += 1,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::FailureClass;
    use crate::tests::fake::{Altered, FakeRig};
    use crate::tests::fixtures::finger;

    #[test]
    fn both_searches_find_the_window_of_the_closed_form() {
        // -(2 + 4/3) = -3.33 and 1 + 20/50 = 1.4 mm.
        let finger = finger(3.0, 20.0);
        let walk = evaluate(&FakeRig::default(), &finger, Search::Walk);
        assert_eq!((walk.window.negative_mm(), walk.window.positive_mm()), (-3.3, 1.4));
        assert_eq!(walk.window.range_mm(), 4.7);
        assert_eq!(walk.window.end_negative, Some(Outcome::Failed(FailureClass::Jammed)));
        assert_eq!(walk.window.end_positive, Some(Outcome::Failed(FailureClass::PlugMissed)));
        assert_eq!(walk.failure_counts, [0, 1, 1, 0]);
        assert_eq!(walk.trials, 1 + 34 + 15);
        let strides = evaluate(&FakeRig::default(), &finger, Search::Strides);
        assert_eq!(strides.window, walk.window);
        assert!(strides.trials < walk.trials / 2, "{} trials", strides.trials);
    }

    #[test]
    fn the_two_searches_agree_over_the_designs() {
        for k in 1..40 {
            let finger = finger(f64::from(k) * 0.1, f64::from(k));
            let [a, b] = [Search::Walk, Search::Strides]
                .map(|search| evaluate(&FakeRig::default(), &finger, search).window);
            assert_eq!(a, b, "{finger:?}");
        }
    }

    #[test]
    fn the_walk_stops_at_a_gap_and_strides_may_step_over_a_narrow_one() {
        let finger = finger(1.0, 1.0);
        let mut over = 0;
        for (width, from) in (1..8).flat_map(|width| (1..20).map(move |from| (width, from))) {
            // Inserts up to 2 mm either way, but for some steps on the positive side.
            let gap = Altered(|_: &Grasp, offset: f64, trial: Trial| {
                let step = (offset / (OFFSET_STEP_MM * MM)).round() as OffsetStep;
                let inserts = step.abs() <= 20 && !(from..from + width).contains(&step);
                let failed = Outcome::Failed(FailureClass::Jammed);
                Trial { outcome: if inserts { Outcome::Inserted } else { failed }, ..trial }
            });
            let end = |search| evaluate(&gap, &finger, search).window.positive_steps;
            assert_eq!(end(Search::Walk), from - 1);
            let found = end(Search::Strides);
            // Whatever it steps over, it ends where one start inserts and the next does not.
            let over_it = found == 20 && width < 5;
            assert!(found == from - 1 || over_it, "{width} from {from}: {found}");
            over += usize::from(found == 20);
        }
        assert!(over > 0, "no gap was stepped over");
    }
}
