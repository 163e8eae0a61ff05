//! Metropolis sampling, one coordinate at a time, with steps that adapt while it warms up
//! (Metropolis et al. 1953; Roberts and Rosenthal 2009, doi:10.1198/jcgs.2009.06134).

use rand::{Rng, RngExt};
use rand_distr::StandardNormal;
use std::sync::atomic::{AtomicBool, Ordering};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Sweeps over all coordinates before the first sample is kept.
    pub warm_up: usize,
    pub samples: usize,
    /// Sweeps from one to the next.
    pub thin: usize,
}

#[derive(Debug, Clone, Copy)]
pub struct Settings<'a> {
    pub effort: Effort,
    pub seed: u64,
    /// Set when it is to end: what it gives is then worthless.
    pub stop: &'a AtomicBool,
}

/// Sweeps after which the steps adapt.
const BATCH: usize = 25;
/// Share of accepted steps that is aimed at: the best for one coordinate.
const ACCEPTED: f64 = 0.44;

/// Samples of a density over coordinates whose prior is standard normal. The likelihood is a
/// sum over parts; `parts[c]` names those that coordinate `c` touches.
pub fn sample(
    parts: &[Vec<usize>],
    log_likelihood: &dyn Fn(usize, &[f64]) -> f64,
    settings: &Settings<'_>,
    random: &mut impl Rng,
) -> Vec<Vec<f64>> {
    let effort = settings.effort;
    let dimension = parts.len();
    let count = parts.iter().flatten().max().map_or(0, |last| last + 1);
    let mut state = vec![0.0; dimension];
    let mut current: Vec<f64> = (0..count).map(|part| log_likelihood(part, &state)).collect();
    let mut step = vec![1.0_f64; dimension];
    let mut accepted = vec![0_usize; dimension];
    let mut kept = Vec::with_capacity(effort.samples);
    for sweep in 0..effort.warm_up + effort.samples * effort.thin {
        if settings.stop.load(Ordering::SeqCst) {
            return vec![state];
        }
        for c in 0..dimension {
            let old = state[c];
            let jump: f64 = random.sample(StandardNormal);
            state[c] = old + step[c] * jump;
            let new: Vec<f64> = parts[c].iter().map(|&part| log_likelihood(part, &state)).collect();
            let before: f64 = parts[c].iter().map(|&part| current[part]).sum();
            let gain = new.iter().sum::<f64>() - before - 0.5 * (state[c] * state[c] - old * old);
            let chance: f64 = random.random();
            if libm::log(chance) < gain {
                parts[c].iter().zip(new).for_each(|(&part, value)| current[part] = value);
                accepted[c] += 1;
            } else {
                state[c] = old;
            }
        }
        if sweep < effort.warm_up && (sweep + 1).is_multiple_of(BATCH) {
            for (step, accepted) in step.iter_mut().zip(&mut accepted) {
                let share = *accepted as f64 / BATCH as f64;
                *step = (*step * libm::exp(1.5 * (share - ACCEPTED))).clamp(0.05, 4.0);
                *accepted = 0;
            }
        }
        if sweep >= effort.warm_up && (sweep - effort.warm_up + 1).is_multiple_of(effort.thin) {
            kept.push(state.clone());
        }
    }
    kept
}
