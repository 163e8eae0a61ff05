//! The share of trials that insert.

use crate::evaluation::SuccessRate;
use crate::evaluation::uncertainty::{Draw, SuccessSettings};
use crate::finger::Finger;
use crate::outcome::Outcome;
use crate::trial::Rig;
use rayon::prelude::*;

/// Runs one trial for each finger and draw.
pub fn measure(rig: &dyn Rig, drawn: &[(Finger, Draw)], settings: &SuccessSettings) -> SuccessRate {
    let trial = |(finger, draw): &(Finger, Draw)| {
        rig.grasp_in(finger, &draw.conditions).trial(draw.offset).outcome
    };
    let outcomes: Vec<Outcome> = drawn.par_iter().map(trial).collect();
    let mut success = SuccessRate {
        inserted: 0,
        failure_counts: [0; 4],
        diverged: 0,
        confidence: settings.confidence,
    };
    for outcome in outcomes {
        match outcome {
            Outcome::Inserted => success.inserted += 1,
            Outcome::Failed(class) => success.failure_counts[class as usize] += 1,
            Outcome::Diverged => success.diverged += 1,
        }
    }
    success
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::robustness::tests::drawn;
    use crate::trial::fake::{FakeRig, window_in_mm};
    use input::units::MM;

    #[test]
    fn every_trial_ends_as_its_own_window_says() {
        let (typical, drawn) = drawn(20.0, 300);
        let found = measure(&FakeRig::default(), &drawn, &typical.success);
        let (mut below, mut above) = (0, 0);
        for (finger, draw) in &drawn {
            let (low, high) = window_in_mm(finger, &draw.conditions);
            let offset = draw.offset / MM;
            // A window that errors closed jams on the whole of its lower side.
            below += u32::from(offset < low);
            above += u32::from(offset >= low && offset > high);
        }
        assert!(below > 5 && above > 20, "{below} and {above}");
        assert_eq!(found.failure_counts, [0, above, below, 0]);
        assert_eq!((found.inserted, found.counted()), (300 - below - above, 300));
    }
}
