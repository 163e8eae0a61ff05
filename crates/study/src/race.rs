//! Race of the designs of a study for the success rate.

use super::record::first_current;
use super::{Recorded, Study, StudyConfig, best};
use insertion::{Aggregate, Measure, Race};
use std::cmp::Reverse;
use std::collections::BTreeMap;

impl StudyConfig {
    /// Returns whether a race is available, because it cannot change the best design. Of a design that loses, only
    /// an upper bound of the success rate is known, which is not enough with other objectives or with a constraint
    /// on the success rate. With several tasks the aggregate has to be the minimum, so that a design worse than the
    /// best one on any of them has lost.
    pub fn can_race(&self) -> bool {
        let limited = self.constraints.iter().any(|limit| limit.measure == Measure::SuccessRate);
        let worst = matches!(self.aggregate, None | Some(Aggregate::Min));
        self.objective.single() == Some(Measure::SuccessRate) && worst && !limited
    }
}

impl Recorded {
    /// Returns whether its success rate is only an upper bound because its draws ended early in the race.
    pub fn raced(&self) -> bool {
        self.tasks.iter().flat_map(|task| &task.success).any(|success| success.raced().is_some())
    }

    /// Returns the value of the first objective, unless it is an upper bound.
    pub fn known_value(&self) -> Option<f64> {
        self.value().filter(|_| !self.raced())
    }
}

impl Study {
    /// Returns the race of a design proposed after `told` evaluations against the best of the current evaluations;
    /// it depends on the journal alone. Draws in which the best design failed come first, then the others;
    /// both are sorted by the number of designs that failed in them.
    pub(super) fn race(&self, told: usize) -> Option<Race> {
        let first = first_current(&self.segments) as usize;
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
