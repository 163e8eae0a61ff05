//! A race for the success rate: who cannot reach the best design before it stops early.
//!
//! All designs meet the same draws, so this is exact and no matter of statistics: a design has lost
//! once its rate would stay below the bar if every draw that is left inserted. Where it ends follows
//! from its own outcomes, the bar and the order alone.

use crate::evaluation::SuccessRate;
use crate::outcome::Outcome;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Target of a design and the order of its draws.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Race {
    /// Success rate to be reached, 0 to 1. With several tasks it holds on each of them: the worst
    /// counts.
    pub bar_share: f64,
    /// How many draws there are.
    pub draws: u32,
    /// The draws that come first, by number from 0; the others follow in their order.
    pub first: Vec<u32>,
}

impl Race {
    /// All of so many draws in the order in which they are met.
    pub fn order(&self, draws: u32) -> Vec<u32> {
        let mut place = vec![usize::MAX; draws as usize];
        for (at, &draw) in self.first.iter().enumerate() {
            if let Some(place) = place.get_mut(draw as usize) {
                *place = at;
            }
        }
        let mut order: Vec<u32> = (0..draws).collect();
        // Stable: the others stay in their order.
        order.sort_by_key(|&draw| place[draw as usize]);
        order
    }

    /// Whether what is left cannot make up for what has failed.
    pub fn is_lost_by(&self, success: &SuccessRate) -> bool {
        success.at_most().is_some_and(|rate| rate < self.bar_share)
    }

    /// Whether a design can have ended so: lost with the last draw that it had and not before, or
    /// with none left. Whoever measured it may be somebody else.
    pub fn can_end_in(&self, success: &SuccessRate) -> bool {
        let tried = success.tried();
        if u64::from(tried) + u64::from(success.spared) != u64::from(self.draws) {
            return false;
        }
        let order = self.order(self.draws);
        let (met, _) = order.split_at(tried as usize);
        let failed: BTreeSet<&u32> = success.failed_draws.iter().collect();
        let all = failed.len() as u64 == u64::from(success.counted() - success.inserted)
            && failed.is_subset(&met.iter().collect());
        let lost = success.spared == 0 || self.is_lost_by(success);
        all && lost && !self.is_lost_by(&before(success, met.last()))
    }
}

/// The outcomes of so many draws, in the order of the race up to the first one with which it is lost.
/// How many are tried at a time changes nothing: what comes after that one is not counted.
pub fn run(
    draws: u32,
    confidence: f64,
    race: Option<&Race>,
    outcome: impl Fn(u32) -> Outcome + Sync,
) -> SuccessRate {
    let mut success = SuccessRate { confidence, spared: draws, ..SuccessRate::default() };
    let order = race.map_or((0..draws).collect(), |race| race.order(draws));
    let at_a_time = race.map_or(order.len(), |_| rayon::current_num_threads());
    'race: for draws in order.chunks(at_a_time.max(1)) {
        let ended: Vec<Outcome> = draws.par_iter().map(|&draw| outcome(draw)).collect();
        for (&draw, outcome) in draws.iter().zip(ended) {
            success.count(draw, outcome);
            if race.is_some_and(|race| race.is_lost_by(&success)) {
                break 'race;
            }
        }
    }
    success.failed_draws.sort_unstable();
    success
}

/// The counts before the last draw: it failed, else it diverged if any did. Had it inserted instead,
/// nothing would have been lost with it.
fn before(success: &SuccessRate, last: Option<&u32>) -> SuccessRate {
    let mut before = success.clone();
    let failed = last.is_some_and(|last| success.failed_draws.contains(last));
    let counts = before.failure_counts.iter_mut().find(|count| **count > 0);
    match counts.filter(|_| failed) {
        Some(count) => *count -= 1,
        None if before.diverged > 0 => before.diverged -= 1,
        None if before.inserted > 0 => before.inserted -= 1,
        None => return before,
    }
    before.spared += 1;
    before
}
