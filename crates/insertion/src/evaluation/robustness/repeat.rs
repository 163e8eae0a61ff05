//! Repeats of a trial under small random changes of friction and start.

use crate::evaluation::tolerance;
use crate::trial::{Conditions, Grasped};
use crate::{Grasp, OffsetStep, Outcome, Rig, Window, grid_mm};
use ask_tell::stream::stream;
use input::units::MM;
use rand::RngExt;
use rayon::prelude::*;
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};

/// Largest relative change of the two coefficients of friction, which vary independently.
pub const FRICTION_SHARE: f64 = 0.1;
/// Largest shift of the start along y, m.
pub const START_SHIFT: f64 = 0.02 * MM;
/// Name of the stream of random numbers.
const PURPOSE: &str = "repeat";
/// Largest distance from an end of a window to which the search for its [`Band`] extends, in grid steps.
const REACH: OffsetStep = 20;
/// Spacing of the offsets tried between the bands, in grid steps.
const INSIDE_STRIDE: OffsetStep = 5;

/// Repeated grasps of a finger under slightly different conditions.
pub struct Repeats<'a> {
    /// Grasp and shift of the start along y, m, of each repeat.
    runs: Vec<(Box<dyn Grasped + 'a>, f64)>,
    stop: &'a AtomicBool,
}

impl<'a> Repeats<'a> {
    /// Grasps `count` times with the friction varied by up to 10 % and the start by up to 0.02 mm (uniform), with the
    /// given rigs and grasps in turn; at least one is required.
    pub fn new(rigs: &[(&'a dyn Rig, Grasp<'a>)], seed: u64, count: u32) -> Self {
        let run = |index: u32| {
            let mut random = stream(seed, u64::from(index), PURPOSE);
            let mut around = |half_width: f64| half_width * random.random_range(-1.0..1.0);
            let [friction_finger, friction_socket] = [(); 2].map(|()| 1.0 + around(FRICTION_SHARE));
            let conditions = Conditions { friction_finger, friction_socket, ..Conditions::NOMINAL };
            let (rig, grasp) = rigs[index as usize % rigs.len()];
            (rig.grasp(Grasp { conditions, ..grasp }), around(START_SHIFT))
        };
        let stop = rigs[0].1.stop;
        Repeats { runs: (0..count).into_par_iter().map(run).collect(), stop }
    }

    /// Returns the outcome of each repeat with the start shifted by an additional `offset`, m.
    pub fn outcomes(&self, offset: f64) -> Vec<Outcome> {
        let trial = |(grasped, shift): &(Box<dyn Grasped + 'a>, f64)| {
            // Checked here, since even a cancelled trial copies its world first.
            let stopped = self.stop.load(Ordering::Relaxed);
            if stopped { Outcome::Diverged } else { grasped.trial(offset + shift).outcome }
        };
        self.runs.par_iter().map(trial).collect()
    }

    pub(super) fn count(&self) -> usize {
        self.runs.len()
    }

    /// Returns whether a repeat, by its index, inserts with its start shifted by a number of grid steps.
    pub(super) fn inserts(&self, run: usize, step: OffsetStep) -> bool {
        let (grasped, shift) = &self.runs[run];
        grasped.trial(tolerance::offset(step) + shift).outcome == Outcome::Inserted
    }

    /// Returns the number of repeats that insert with the start shifted by a number of grid steps.
    fn inserted(&self, step: OffsetStep) -> usize {
        let outcomes = self.outcomes(tolerance::offset(step));
        outcomes.iter().filter(|&&outcome| outcome == Outcome::Inserted).count()
    }

    /// Returns the band at the negative (`sign` -1) or positive (`sign` 1) end of a window, from the number of repeats
    /// that insert at an offset.
    fn band(&self, window: &Window, sign: OffsetStep, of: &dyn Fn(OffsetStep) -> usize) -> Band {
        let end = if sign < 0 { -window.negative_steps } else { window.positive_steps };
        let inserted = |step: OffsetStep| of(sign * step);
        let inward = (0..=REACH.min(end)).map(|away| end - away);
        // From outside, since some repeats may insert again beyond a gap.
        let outward = (1..=REACH).rev().map(|away| end + away);
        let mut still = outward.skip_while(|&step| inserted(step) == 0);
        let last = still.next().unwrap_or(end);
        Band {
            surely_inserts: inward.into_iter().find(|&step| inserted(step) == self.runs.len()),
            surely_fails: (last < end + REACH).then_some(last + 1),
        }
    }

    /// Returns both bands of a window, and the results of the offsets tried between them. Calls `progress` with the
    /// number of offsets tried so far and the one expected.
    pub fn bands(&self, window: &Window, progress: &dyn Fn([usize; 2])) -> Bands {
        let width = window.positive_steps.saturating_sub(window.negative_steps);
        let expected = (2 * REACH + width / INSIDE_STRIDE) as usize;
        let count = Cell::new(0);
        let inserted = |step: OffsetStep| {
            progress([count.get(), expected.max(count.get() + 1)]);
            count.set(count.get() + 1);
            self.inserted(step)
        };
        let [negative, positive] = [-1, 1].map(|sign| self.band(window, sign, &inserted));
        let inside = negative.surely_inserts.zip(positive.surely_inserts).into_iter();
        let tried = inside.flat_map(|(from, to)| (-from..=to).step_by(INSIDE_STRIDE as usize));
        let tried: Vec<OffsetStep> = tried.collect();
        let uncertain = |step: &&OffsetStep| inserted(**step) < self.runs.len();
        let uncertain_inside = tried.iter().filter(uncertain).map(|&step| grid_mm(step)).collect();
        Bands { negative, positive, tried_inside: tried.len(), uncertain_inside }
    }
}

/// Band of offsets at one end of a window whose outcome depends on small changes, in grid steps outward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// The outermost offset at which all repeats insert.
    surely_inserts: Option<OffsetStep>,
    /// The innermost offset at and beyond which no repeat inserts, as far as 2 mm beyond the end.
    surely_fails: Option<OffsetStep>,
}

impl Band {
    /// Returns the width, mm: 0.1 mm for each uncertain offset; `None` if the band extends farther than 2 mm from the
    /// end of the window.
    pub fn width_mm(&self) -> Option<f64> {
        Some(grid_mm(self.surely_fails? - self.surely_inserts? - 1))
    }
}

/// Bands at both ends of one window.
#[derive(Debug, Clone, PartialEq)]
pub struct Bands {
    /// Band at the negative end.
    pub negative: Band,
    /// Band at the positive end.
    pub positive: Band,
    /// Number of offsets tried between the bands, every 0.5 mm.
    pub tried_inside: usize,
    /// Offsets among them at which not all repeats insert, mm.
    pub uncertain_inside: Vec<f64>,
}

impl Bands {
    /// Returns the ends of the firm window, mm: the outermost offsets at which all repeats insert; `None` if a band
    /// extends farther than 2 mm inward.
    pub fn firm_mm(&self) -> Option<[f64; 2]> {
        let [below, above] = [self.negative, self.positive].map(|band| band.surely_inserts);
        Some([grid_mm(-below?), grid_mm(above?)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::tolerance::Search;
    use crate::tests::fake::FakeRig;
    use crate::tests::fixtures::finger;

    /// The lower end, -3.33 mm, moves by a tenth with friction; the upper one with the start alone.
    #[test]
    fn the_bands_are_as_wide_as_in_the_closed_form() {
        let rig = FakeRig::default();
        let repeats = Repeats::new(&[(&rig, Grasp::of(&finger(3.0, 20.0)))], 7, 200);
        let window = tolerance::evaluate(&rig, &finger(3.0, 20.0), Search::Walk).window;
        let bands = repeats.bands(&window, &|_| ());
        let below = bands.negative.width_mm().unwrap();
        assert!((0.5..=0.7).contains(&below), "{bands:?}");
        let above = bands.positive.width_mm().unwrap();
        assert!((0.0..=0.1).contains(&above), "{bands:?}");
        let [from, to] = bands.firm_mm().unwrap();
        assert!(grid_mm(window.negative_steps) <= from && from < -2.5);
        assert!(to <= grid_mm(window.positive_steps));
        assert_eq!(bands.uncertain_inside, Vec::<f64>::new());
        assert!(bands.tried_inside >= 8, "{bands:?}");
    }

    #[test]
    fn repeats_are_a_function_of_the_seed() {
        let rig = FakeRig::default();
        let grasp = Grasp::of(&finger(3.0, 20.0));
        let of = |seed| Repeats::new(&[(&rig, grasp)], seed, 60).outcomes(-3.33 * MM);
        assert_eq!(of(1), of(1));
        assert_ne!(of(1), of(2));
        let inserted = of(1).iter().filter(|&&outcome| outcome == Outcome::Inserted).count();
        assert!((15..45).contains(&inserted), "{inserted} of 60");
    }
}
