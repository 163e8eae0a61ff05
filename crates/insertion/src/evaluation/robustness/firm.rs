//! Firm window: offsets that still insert under small variations of friction, start and time step.
//!
//! From each end of the tolerance window the search goes inward in steps of 0.1 mm to the first offset at which
//! all repeats insert. Offsets between the two ends are not repeated.

use super::repeat::Repeats;
use crate::{OffsetStep, Window, grid_mm};
use serde::{Deserialize, Serialize};

/// Number of repeats at each end of the window.
pub const REPEATS: u32 = 6;

/// Outermost offsets on either side at which all repeats insert, in grid steps from the nominal start.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FirmWindow {
    /// Offset at the negative end.
    pub negative_steps: OffsetStep,
    /// Offset at the positive end.
    pub positive_steps: OffsetStep,
}

/// Result of the repeats at both ends of a window.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FirmResult {
    /// Firm window; `None` if every offset on one side fails in some repeat.
    pub window: Option<FirmWindow>,
    /// Number of trials in all repeats.
    pub trials: u32,
}

impl FirmResult {
    /// Returns the firm range, mm; 0 without a firm window.
    pub fn range_mm(&self) -> f64 {
        self.window.map_or(0.0, |window| {
            grid_mm(window.positive_steps.saturating_sub(window.negative_steps))
        })
    }

    /// Returns the firm window, mm.
    pub fn window_mm(&self) -> Option<[f64; 2]> {
        self.window.map(|window| [window.negative_steps, window.positive_steps].map(grid_mm))
    }

    /// Returns the window with the ends of the firm window; both are 0 without one.
    pub fn narrowed(&self, window: &Window) -> Window {
        let FirmWindow { negative_steps, positive_steps } = self.window.unwrap_or_default();
        Window { negative_steps, positive_steps, ..window.clone() }
    }
}

/// Measures the firm window of a window whose nominal start inserts, by a search inward from both ends.
pub fn measure(repeats: &Repeats, window: &Window) -> FirmResult {
    let ((negative, below), (positive, above)) = rayon::join(
        || outermost_step(repeats, -window.negative_steps, -1),
        || outermost_step(repeats, window.positive_steps, 1),
    );
    let window = negative.zip(positive).map(|(negative, positive)| FirmWindow {
        negative_steps: -negative,
        positive_steps: positive,
    });
    FirmResult { window, trials: below + above }
}

/// Returns the outermost of the grid steps `from` to 0, in the direction `sign`, at which all repeats insert, and the
/// number of trials. The repeat that failed at one step is tried first at the next, where it is the likeliest to fail.
fn outermost_step(
    repeats: &Repeats,
    from: OffsetStep,
    sign: OffsetStep,
) -> (Option<OffsetStep>, u32) {
    let (count, mut doubtful, mut trials) = (repeats.count(), 0, 0);
    for step in (0..=from).rev() {
        let mut fails = |run: &usize| {
            trials += 1;
            !repeats.inserts(*run, sign * step)
        };
        match (0..count).map(|run| (doubtful + run) % count).find(|run| fails(run)) {
            None => return (Some(step), trials),
            Some(run) => doubtful = run,
        }
    }
    (None, trials)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::tolerance::{Search, evaluate, offset};
    use crate::outcome::Outcome;
    use crate::tests::fake::FakeRig;
    use crate::tests::fixtures::finger;
    use crate::trial::Grasp;

    /// The lower end, -3.33 mm, moves with friction to -3.03 mm; the upper with the start alone.
    #[test]
    fn the_firm_window_is_the_innermost_of_the_repeats() {
        let (rig, finger) = (FakeRig::default(), finger(3.0, 20.0));
        let window = evaluate(&rig, &finger, Search::Walk).window;
        let repeats = Repeats::new(&[(&rig, Grasp::of(&finger))], 0, 100);
        let found = measure(&repeats, &window);
        let firm = found.window.unwrap();
        assert!((-31..=-30).contains(&firm.negative_steps), "{firm:?}");
        assert_eq!(firm.positive_steps, 13);
        let all = |step| {
            repeats.outcomes(offset(step)).iter().all(|&outcome| outcome == Outcome::Inserted)
        };
        assert!(all(firm.negative_steps) && all(firm.positive_steps));
        assert!(!all(firm.negative_steps - 1) && !all(firm.positive_steps + 1));
        // Mostly one trial for each failing step, a hundred for each of the two steps that insert.
        assert!((200..320).contains(&found.trials), "{}", found.trials);
        let narrowed = found.narrowed(&window);
        assert_eq!(narrowed.negative_steps, firm.negative_steps);
        assert_eq!(narrowed.end_positive, window.end_positive);
    }
}
