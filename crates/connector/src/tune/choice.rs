//! Choice of a strategy among those that were tried.

use super::{Step, Tuned};
use insertion::evaluation::INDIFFERENCE_MM;

/// Smallest share by which the peak force of a gentler strategy is smaller.
const GENTLER: f64 = 0.1;

impl Tuned {
    /// Returns index and range, mm, of the steps that insert; without the given start, if the taught one is centred in an
    /// equally wide window.
    pub(super) fn inserting(&self) -> Vec<(usize, f64)> {
        let centred = self.steps.get(1).is_some_and(|Step { tried, .. }| {
            let given = &self.steps[0].tried;
            tried.inserts()
                && tried.side_mm() >= given.side_mm() + INDIFFERENCE_MM
                && tried.score >= given.score - INDIFFERENCE_MM
        });
        let steps = self.steps.iter().enumerate().skip(usize::from(centred));
        let steps = steps.filter(|(_, step)| step.tried.inserts());
        steps.map(|(place, step)| (place, step.tried.score)).collect()
    }

    /// Returns the recommended one of steps, given by index and range, mm: of those that are narrower than the widest by
    /// less than [`INDIFFERENCE_MM`], the one with the smallest force. If forces differ by less than [`GENTLER`], the first
    /// of the earliest stage.
    pub(super) fn recommended(&self, ranges: &[(usize, f64)]) -> Option<usize> {
        let widest = ranges.iter().map(|(_, mm)| *mm).fold(f64::NEG_INFINITY, f64::max);
        // Ranges are multiples of 0.1 mm, with rounding errors.
        let tied = || ranges.iter().filter(|(_, mm)| widest - mm < INDIFFERENCE_MM - 1e-9);
        let force = |place: usize| self.steps[place].tried.force_n;
        let least = tied().map(|(place, _)| force(*place)).fold(f64::INFINITY, f64::min);
        let gentle = tied().map(|(place, _)| *place);
        let gentle = gentle.filter(|place| force(*place) * (1.0 - GENTLER) <= least);
        gentle.min_by_key(|place| self.steps[*place].stage)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Candidate, Stage};
    use super::*;
    use input::shipped::TASKS;
    use insertion::task::Task;

    /// Returns the index of the recommended strategy of some with these stages, ranges, mm, and forces, N.
    fn recommended(steps: &[(Stage, f64, f64)]) -> Option<usize> {
        let strategy = Task::parse(TASKS[0].text, TASKS[0].file).unwrap().strategy;
        let step = |&(stage, score, force_n): &(Stage, f64, f64)| {
            let (strategy, windows) = (strategy.clone(), Vec::new());
            let tried = Candidate { strategy, windows, force_n, score, nearest: None, cost: 3 };
            Step { stage, change: String::new(), tried, turned_mm: None }
        };
        let steps = steps.iter().map(step).collect();
        let tuned = Tuned { steps, best: 0, robustness: Vec::new(), windows: 0 };
        tuned.recommended(&tuned.inserting())
    }

    #[test]
    fn of_strategies_of_similar_range_the_gentler_is_recommended_whatever_their_stages() {
        let (given, families, search) = (Stage::AsItIs, Stage::Families, Stage::Search);
        let gentle = (families, 5.0, 80.0);
        for wider in [(families, 5.1, 98.0), (search, 5.2, 98.0), (given, 5.2, 98.0)] {
            assert_eq!(recommended(&[wider, gentle]), Some(1));
            assert_eq!(recommended(&[gentle, wider]), Some(0));
        }
        assert_eq!(recommended(&[gentle, (search, 5.3, 98.0)]), Some(1), "0.3 mm wider");
        // About as gentle: the earlier stage, then the first.
        assert_eq!(recommended(&[(search, 5.2, 76.0), gentle]), Some(1));
        assert_eq!(recommended(&[(families, 5.1, 82.0), gentle]), Some(0));
        assert_eq!(recommended(&[(given, -0.1, 160.0)]), None, "it does not insert");
    }
}
