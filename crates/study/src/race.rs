//! The race of a study for the success rate: which studies have one, and what it is for the next design.

use super::config::StudyConfig;
use super::folder::Study;
use super::record::{Recorded, best, first_current};
use insertion::evaluation::objective::{Aggregate, Measure};
use insertion::evaluation::robustness::race::Race;
use std::cmp::Reverse;
use std::collections::BTreeMap;

impl StudyConfig {
    /// Whether a race is exact. Of several tasks only the worst may count: a design that stays below the
    /// bar on one of them has then lost, which says nothing of a mean. Beside other objectives, or
    /// under a limit of its own, a success rate must be known, not its bound. Robust ranges are not
    /// raced.
    pub fn can_race(&self) -> bool {
        let limited = self.constraints.iter().any(|limit| limit.measure == Measure::SuccessRate);
        let worst = matches!(self.aggregate, None | Some(Aggregate::Min));
        self.objective.single() == Some(Measure::SuccessRate) && worst && !limited
    }
}

impl Recorded {
    /// Whether its success rate is an upper bound: it was out of the race with draws left.
    pub fn raced(&self) -> bool {
        self.tasks.iter().flat_map(|task| &task.success).any(|success| success.raced().is_some())
    }

    /// The value of the first objective, unless it is but an upper bound.
    pub fn known_value(&self) -> Option<f64> {
        self.value().filter(|_| !self.raced())
    }
}

impl Study {
    /// The race of a design that is proposed after so many evaluations were told, a function of the
    /// journal alone: against the best of those of the present model. First come the draws that failed
    /// for that one, and of these and of the others those in which most designs failed.
    pub(super) fn race(&self, told: usize) -> Option<Race> {
        let first = first_current(self.segments()) as usize;
        let told = self.evaluations.get(first..told).filter(|_| self.config.race)?;
        let best = best(&self.config.goals(), told)?;
        let success = best.tasks.first()?.success.as_ref()?;
        let (hardest, mut failures) = (told.len() + 1, BTreeMap::<u32, usize>::new());
        for (recorded, weight) in told.iter().map(|told| (told, 1)).chain([(best, hardest)]) {
            let drawn = recorded.tasks.iter().flat_map(|task| &task.success);
            drawn
                .flat_map(|success| &success.failed_draws)
                .for_each(|draw| *failures.entry(*draw).or_default() += weight);
        }
        let mut first: Vec<u32> = failures.keys().copied().collect();
        first.sort_by_key(|draw| Reverse(failures[draw]));
        Some(Race { bar_share: best.value()?, draws: success.tried(), first })
    }
}
