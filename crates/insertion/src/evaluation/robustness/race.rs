//! Racing on the success rate: the trials of a design stop early if it can no longer reach the best design.
//!
//! All designs are evaluated under the same draws, so the criterion is exact: a design is eliminated (has lost the
//! race) once its rate would stay below the target rate even if all remaining draws inserted. The point of
//! elimination depends only on its own outcomes, the target rate and the order of the draws.

use crate::Outcome;
use crate::evaluation::SuccessRate;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Target rate of a design and the order of its draws.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Race {
    /// Target: success rate of the best design so far, 0 to 1. With several tasks, each must reach it.
    pub bar_share: f64,
    /// Number of draws of the best design.
    pub draws: u32,
    /// Indices of the draws to evaluate first; the others follow in ascending order.
    pub first: Vec<u32>,
}

/// Evaluates the draws in the order of the race and counts their outcomes until the target rate is out of reach. Draws
/// beyond that point are not counted, so the result does not depend on the number of threads.
pub fn run(
    draws: u32,
    confidence: f64,
    race: Option<&Race>,
    outcome: impl Fn(u32) -> Outcome + Sync,
) -> SuccessRate {
    let mut success = SuccessRate { confidence, skipped: draws, ..SuccessRate::default() };
    let mut order: Vec<u32> = (0..draws).collect();
    if let Some(race) = race {
        let place = |draw: &u32| race.first.iter().rposition(|first| first == draw);
        // Stable: the others stay in their order.
        order.sort_by_cached_key(|draw| place(draw).unwrap_or(usize::MAX));
    }
    let at_a_time = race.map_or(order.len(), |_| rayon::current_num_threads());
    'race: for draws in order.chunks(at_a_time.max(1)) {
        let ended: Vec<Outcome> = draws.par_iter().map(|&draw| outcome(draw)).collect();
        for (&draw, outcome) in draws.iter().zip(ended) {
            success.count(draw, outcome);
            // Out of reach even if all remaining draws insert.
            if race.zip(success.max_rate()).is_some_and(|(race, rate)| rate < race.bar_share) {
                break 'race;
            }
        }
    }
    success.failed_draws.sort_unstable();
    success
}
