//! Success rate and tolerance windows under random errors.

pub mod firm;
pub mod race;
pub mod repeat;

use crate::evaluation::uncertainty::{Draw, RobustSettings, SuccessSettings, Uncertainty, draws};
use crate::evaluation::{RobustRange, SuccessRate, tolerance};
use crate::{Evaluation, Finger, Grasp, Outcome, Prediction, Priors, Rig, Search};
use race::Race;
use rayon::prelude::*;

/// Plan of the trials under random errors, in addition to the window search: their settings, and the draws, which all
/// designs of a study share.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Plan {
    success: Option<(Vec<Draw>, SuccessSettings)>,
    robust: Option<(Vec<Draw>, RobustSettings)>,
    /// Early stop of the success-rate trials of designs that cannot be the best.
    race: Option<Race>,
    /// Cell whose parameters are drawn, and their values in each draw.
    pub(super) cells: Option<(Priors, Vec<Vec<f64>>)>,
}

/// Rig and nominal finger of one draw of the cell's parameters.
pub type Drawn = (Box<dyn Rig>, Finger);
/// A draw's rig, grasp and offset, m.
type Insertion<'a> = (&'a dyn Rig, Grasp<'a>, f64);

impl Plan {
    /// Plan of the window search alone.
    pub const WINDOW: Plan = Plan { success: None, robust: None, race: None, cells: None };

    /// Returns the plan for success rates, robust ranges or both; `seed` is the seed of the draws.
    pub fn new(uncertainty: &Uncertainty, seed: u64, success: bool, robust: bool) -> Self {
        let draws = |count| draws(uncertainty, seed, count);
        let (rate, range) = (uncertainty.success, uncertainty.robust);
        Plan {
            success: success.then(|| (draws(rate.trials), rate)),
            robust: robust.then(|| (draws(range.samples), range)),
            race: None,
            cells: uncertainty.cell.as_ref().map(|cell| {
                let rate = if success { rate.trials } else { 0 };
                let count = if robust { rate.max(range.samples) } else { rate };
                (cell.clone(), parameters::draws(&cell.parameters, seed, count))
            }),
        }
    }

    /// Returns the plan with this race for the success rate.
    pub fn against(&self, race: Option<&Race>) -> Plan {
        Plan { race: race.cloned(), ..self.clone() }
    }
}

/// Measures a grasp according to a plan; `predicted` is the stiffness of the fingers. `cells` has the rig and finger of
/// each draw of the cell's parameters; draws without an entry use `rig` and the finger of `grasp`.
pub fn evaluate(
    rig: &dyn Rig,
    grasp: Grasp,
    predicted: &Prediction,
    search: Search,
    plan: &Plan,
    cells: &[Drawn],
) -> Evaluation {
    let mut evaluation = tolerance::evaluate_grasp(rig, grasp, search);
    let drawn = |draws: &[Draw]| -> Vec<_> {
        let one = |(i, draw): (usize, &Draw)| {
            let own = cells.get(i).map(|(rig, finger)| (&**rig, *finger));
            let (rig, finger) = own.unwrap_or((rig, grasp.finger));
            (rig, draw.grasp(Grasp { finger, ..grasp }, predicted), draw.offset)
        };
        draws.iter().enumerate().map(one).collect()
    };
    if let Some((draws, settings)) = &plan.success {
        evaluation.success =
            Some(success_rate(&drawn(draws), settings.confidence, plan.race.as_ref()));
    }
    if let Some((draws, settings)) = &plan.robust {
        evaluation.robust = Some(robust_range(&drawn(draws), settings));
    }
    evaluation
}

fn success_rate(drawn: &[Insertion], confidence: f64, race: Option<&Race>) -> SuccessRate {
    race::run(drawn.len() as u32, confidence, race, |draw| {
        let (rig, grasp, offset) = drawn[draw as usize];
        rig.grasp(grasp).trial(offset).outcome
    })
}

/// Returns the ranges of the windows of all draws. Drawn offsets are ignored, since a window spans the offsets.
fn robust_range(drawn: &[Insertion], settings: &RobustSettings) -> RobustRange {
    let window =
        |&(rig, grasp, _): &Insertion| tolerance::evaluate_grasp(rig, grasp, settings.search);
    let windows: Vec<Evaluation> = drawn.par_iter().map(window).collect();
    let valid = windows.iter().filter(|draw| draw.window.nominal != Outcome::Diverged);
    let ranges_mm: Vec<f64> = valid.map(|draw| draw.window.range_mm()).collect();
    let diverged = (windows.len() - ranges_mm.len()) as u32;
    let trials = windows.iter().map(|draw| draw.trials).sum();
    let mut robust = RobustRange { ranges_mm, diverged, trials, value_mm: None };
    robust.value_mm = (robust.ranges_mm.len() > 1)
        .then(|| robust.mean_mm() - settings.sd_factor * robust.sd_mm());
    robust
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::grid_mm;
    use crate::tests::fake::{FakeRig, window_mm};
    use crate::tests::fixtures::{finger, predicted, typical};
    use input::units::MM;

    /// Draws, from the shipped distribution, of a finger with 3 N/mm and this assembly stiffness, N/mm.
    fn drawn(rig: &dyn Rig, assembly: f64, count: u32) -> (Uncertainty, Vec<Insertion<'_>>) {
        let predicted = predicted([3.0, 1.0], [assembly, 2.0]);
        let nominal = Grasp::of(&finger(3.0, assembly));
        let drawn = draws(&typical(), 5, count).into_iter();
        let drawn = drawn.map(|draw| (rig, draw.grasp(nominal, &predicted), draw.offset)).collect();
        (typical(), drawn)
    }

    #[test]
    fn every_trial_ends_as_its_own_window_predicts() {
        let rig = FakeRig::default();
        let (typical, drawn) = drawn(&rig, 20.0, 300);
        let found = success_rate(&drawn, typical.success.confidence, None);
        let (mut below, mut above) = (0, 0);
        for (_, grasp, offset) in &drawn {
            let (low, high) = window_mm(&grasp.finger, &grasp.conditions);
            let offset = offset / MM;
            // If the errors close the window, the plug jams at all offsets below `low`.
            below += u32::from(offset < low);
            above += u32::from(offset >= low && offset > high);
        }
        assert!(below > 5 && above > 20, "{below} and {above}");
        assert_eq!(found.failure_counts, [0, above, below, 0]);
        assert_eq!((found.inserted, found.counted()), (300 - below - above, 300));
        assert_eq!((found.failed_draws.len() as u32, found.skipped), (below + above, 0));
    }

    #[test]
    fn each_range_is_that_of_its_own_window() {
        let rig = FakeRig::default();
        let (typical, drawn) = drawn(&rig, 60.0, 12);
        let settings = RobustSettings { search: Search::Strides, sd_factor: 1.5, ..typical.robust };
        let found = robust_range(&drawn, &settings);
        let expected: Vec<f64> = drawn
            .iter()
            .map(|(_, grasp, _)| {
                let (low, high) = window_mm(&grasp.finger, &grasp.conditions);
                if low > 0.0 || high < 0.0 {
                    return 0.0;
                }
                grid_mm((high * 10.0).floor() as i32 - (low * 10.0).ceil() as i32)
            })
            .collect();
        assert_eq!(found.ranges_mm, expected);
        assert!(found.sd_mm() > 0.3, "{found:?}");
        assert_eq!(found.value_mm, Some(found.mean_mm() - 1.5 * found.sd_mm()));
        assert_eq!(robust_range(&drawn[..1], &settings).value_mm, None);
    }
}
