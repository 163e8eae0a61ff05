//! The tolerance window of one finger: which shifted starts insert.

use crate::evaluation::{Evaluation, OFFSET_STEP_MM, OffsetStep, Window};
use crate::finger::Finger;
use crate::outcome::Outcome;
use crate::trial::{Conditions, Grasped, Rig, Trial};
use input::units::MM;

/// Farthest offset tried, in grid steps: well beyond any published window (9 mm).
pub const OFFSET_LIMIT_STEPS: OffsetStep = 150;

/// How the window's ends are looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Search {
    /// Step by step outward to the first failure: the paper's way.
    Walk,
    /// In strides of 0.5 mm outward to the first failure, then by bisection
    /// between the last two: a third of the trials. It finds the end that the
    /// walk finds unless a gap in the window is narrower than a stride; so it is on 43 of
    /// the 44 pairs of task and measured finger (`docs/notes/performance.md`).
    #[default]
    Strides,
}

impl Search {
    fn stride(self) -> OffsetStep {
        match self {
            Search::Strides => 5,
            Search::Walk => 1,
        }
    }
}

/// Measures one finger: its window, and what all trials on the way reported.
///
/// The start is shifted outward on the 0.1 mm grid in both directions until
/// the first trial that does not insert (the paper, Sec. "Robot Movement").
pub fn evaluate(rig: &dyn Rig, finger: &Finger, search: Search) -> Evaluation {
    evaluate_in(rig, finger, &Conditions::NOMINAL, search)
}

/// The same under other conditions than those of the task file.
pub fn evaluate_in(
    rig: &dyn Rig,
    finger: &Finger,
    conditions: &Conditions,
    search: Search,
) -> Evaluation {
    let grasped = rig.grasp_in(finger, conditions);
    let nominal = grasped.trial(0.0);
    let mut log = Log::default();
    log.add(&nominal);
    if nominal.outcome != Outcome::Inserted {
        let window = Window {
            nominal: nominal.outcome,
            negative_steps: 0,
            positive_steps: 0,
            end_negative: Some(nominal.outcome),
            end_positive: Some(nominal.outcome),
        };
        return log.evaluation(window, [nominal.margin; 2]);
    }
    let ((negative, log_negative), (positive, log_positive)) = rayon::join(
        || find_end(&*grasped, nominal.margin, -1, search.stride()),
        || find_end(&*grasped, nominal.margin, 1, search.stride()),
    );
    log.merge(&log_negative);
    log.merge(&log_positive);
    let window = Window {
        nominal: nominal.outcome,
        negative_steps: -negative.step,
        positive_steps: positive.step,
        end_negative: negative.failure,
        end_positive: positive.failure,
    };
    log.evaluation(window, [negative.share, positive.share])
}

/// One end of a window.
struct End {
    /// The last inserting step.
    step: OffsetStep,
    /// What the next one did.
    failure: Option<Outcome>,
    /// Where between the two the outcome turns, 0 to 1.
    share: f64,
}

/// A step that was tried: where, how it ended and how clearly.
#[derive(Clone, Copy)]
struct Tried {
    step: OffsetStep,
    outcome: Outcome,
    margin: f64,
}

/// One end, looked for from the nominal start, of that margin, outward.
fn find_end(
    grasped: &dyn Grasped,
    nominal_margin: f64,
    sign: OffsetStep,
    stride: OffsetStep,
) -> (End, Log) {
    let mut log = Log::default();
    let mut inside = Tried { step: 0, outcome: Outcome::Inserted, margin: nominal_margin };
    let mut outside: Option<Tried> = None;
    loop {
        let step = match outside {
            None if inside.step >= OFFSET_LIMIT_STEPS => break,
            None => (inside.step + stride).min(OFFSET_LIMIT_STEPS),
            Some(outside) if outside.step - inside.step <= 1 => break,
            Some(outside) => (inside.step + outside.step) / 2,
        };
        let trial = grasped.trial(offset(sign * step));
        log.add(&trial);
        let tried = Tried { step, outcome: trial.outcome, margin: trial.margin };
        match tried.outcome {
            Outcome::Inserted => inside = tried,
            Outcome::Failed(_) | Outcome::Diverged => outside = Some(tried),
        }
    }
    let share = outside.map_or(0.0, |outside| share(inside.margin, outside.margin));
    (End { step: inside.step, failure: outside.map(|outside| outside.outcome), share }, log)
}

/// Where a line from a margin of 0 or above to one of 0 or below crosses 0, from 0 to 1.
fn share(inside: f64, outside: f64) -> f64 {
    let drop = inside - outside;
    if drop > 0.0 { inside / drop } else { 0.0 }
}

/// The offset of a grid step, m.
pub fn offset(step: OffsetStep) -> f64 {
    f64::from(step) * OFFSET_STEP_MM * MM
}

#[derive(Default)]
struct Log {
    failure_counts: [u32; 4],
    diverged: u32,
    trials: u32,
    peak_force_n: f64,
    slip_mm: f64,
    simulated_s: f64,
}

impl Log {
    fn add(&mut self, trial: &Trial) {
        self.trials += 1;
        self.simulated_s += trial.simulated_s;
        match trial.outcome {
            Outcome::Inserted => {
                self.peak_force_n = self.peak_force_n.max(trial.peak_force_n);
                self.slip_mm = self.slip_mm.max(trial.slip_mm);
            }
            Outcome::Failed(class) => self.failure_counts[class as usize] += 1,
            Outcome::Diverged => self.diverged += 1,
        }
    }

    fn merge(&mut self, other: &Log) {
        for (mine, theirs) in self.failure_counts.iter_mut().zip(other.failure_counts) {
            *mine += theirs;
        }
        self.diverged += other.diverged;
        self.trials += other.trials;
        self.peak_force_n = self.peak_force_n.max(other.peak_force_n);
        self.slip_mm = self.slip_mm.max(other.slip_mm);
        self.simulated_s += other.simulated_s;
    }

    fn evaluation(self, window: Window, end_shares: [f64; 2]) -> Evaluation {
        Evaluation {
            window,
            failure_counts: self.failure_counts,
            diverged: self.diverged,
            trials: self.trials,
            peak_force_n: self.peak_force_n,
            slip_mm: self.slip_mm,
            simulated_s: self.simulated_s,
            end_shares,
            taught: None,
            success: None,
            robust: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::finger;
    use crate::outcome::FailureClass;
    use crate::trial::Grasp;
    use crate::trial::fake::{Altered, FakeRig};

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
            assert!(
                found == from - 1 || (found == 20 && width < 5),
                "{width} from {from}: {found}"
            );
            over += usize::from(found == 20);
        }
        assert!(over > 0, "no gap was stepped over");
    }
}
