//! The tolerance window of one finger: which shifted starts insert.

use crate::evaluation::{Evaluation, OFFSET_STEP_MM, OffsetStep, Outcome, Window};
use crate::finger::Finger;
use crate::trial::{Grasped, Rig, Trial};
use crate::units::MM;

/// Farthest offset tried, in grid steps: well beyond any published window (9 mm).
pub const OFFSET_LIMIT_STEPS: OffsetStep = 150;

/// Measures one finger: its window, and what all trials on the way reported.
///
/// The start is shifted outward in 0.1 mm steps in both directions until the
/// first trial that does not insert (the paper, Sec. "Robot Movement").
pub fn evaluate(rig: &dyn Rig, finger: &Finger) -> Evaluation {
    let grasped = rig.grasp(finger);
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
        return log.evaluation(window);
    }
    let ((negative, log_negative), (positive, log_positive)) =
        rayon::join(|| scan(&*grasped, -1), || scan(&*grasped, 1));
    log.merge(&log_negative);
    log.merge(&log_positive);
    log.evaluation(Window {
        nominal: nominal.outcome,
        negative_steps: -negative.0,
        positive_steps: positive.0,
        end_negative: negative.1,
        end_positive: positive.1,
    })
}

/// The last inserting step in one direction and what the next one did.
fn scan(grasped: &dyn Grasped, sign: OffsetStep) -> ((OffsetStep, Option<Outcome>), Log) {
    let mut log = Log::default();
    for step in 1..=OFFSET_LIMIT_STEPS {
        let trial = grasped.trial(offset(sign * step));
        log.add(&trial);
        if trial.outcome != Outcome::Inserted {
            return ((step - 1, Some(trial.outcome)), log);
        }
    }
    ((OFFSET_LIMIT_STEPS, None), log)
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

    fn evaluation(self, window: Window) -> Evaluation {
        Evaluation {
            window,
            failure_counts: self.failure_counts,
            diverged: self.diverged,
            trials: self.trials,
            peak_force_n: self.peak_force_n,
            slip_mm: self.slip_mm,
            simulated_s: self.simulated_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::FailureClass;
    use crate::trial::fake::FakeRig;
    use crate::units::N_PER_MM;

    #[test]
    fn the_window_of_the_closed_form_is_found_on_the_grid() {
        // -(2 + 4/3) = -3.33 and 1 + 20/50 = 1.4 mm.
        let finger = Finger::new(3.0 * N_PER_MM, 20.0 * N_PER_MM);
        let found = evaluate(&FakeRig::default(), &finger);
        assert_eq!((found.window.negative_mm(), found.window.positive_mm()), (-3.3, 1.4));
        assert_eq!(found.window.range_mm(), 4.7);
        assert_eq!(found.window.end_negative, Some(Outcome::Failed(FailureClass::Jammed)));
        assert_eq!(found.window.end_positive, Some(Outcome::Failed(FailureClass::PlugMissed)));
        assert_eq!(found.failure_counts, [0, 1, 1, 0]);
        assert_eq!(found.trials, 1 + 34 + 15);
    }
}
