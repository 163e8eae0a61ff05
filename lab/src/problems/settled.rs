//! Searches that settle, on recorded landscapes.

use super::Landscape;
use ask_tell::gp::{Advice, Confirmed, DEFAULT_NOISE_FLOOR, Gain, Outlook};
use ask_tell::{Observation, OptimizerKind, build};
use rayon::prelude::*;

/// Evaluations at a time.
const BATCH: usize = 4;

/// Limits of a search that settles.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Evaluations after which it ends, settled or not.
    pub budget: usize,
    /// Evaluations before which it does not settle, and in a row for which no gain is expected.
    pub least: usize,
    pub quiet: usize,
    /// Points confirmed at a time.
    pub at_once: usize,
    /// What counts as a gain.
    pub gain: Gain,
}

/// How one search ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settled {
    pub evaluations: usize,
    /// Whether it settled within the budget.
    pub settled: bool,
    pub repeated: usize,
    pub walked: usize,
    /// Firm range of the recommended design, mm.
    pub firm_mm: f64,
}

impl Limits {
    /// Of a space with so many axes; with a budget it does not settle before.
    pub fn of(dimension: usize, budget: Option<usize>) -> Self {
        let gain =
            Gain { least: 0.3, probability: 0.02, noise_floor: DEFAULT_NOISE_FLOOR, floor: 0.0 };
        let least = budget.unwrap_or(20 + 4 * dimension);
        Limits { budget: budget.unwrap_or(500), least, quiet: 12 * dimension, at_once: 2, gain }
    }
}

/// Searches of a landscape with the optimizer `gp`, one for each seed from 0.
pub fn settle(landscape: &Landscape, limits: Limits, seeds: u64) -> Vec<Settled> {
    (0..seeds).into_par_iter().map(|seed| one(landscape, limits, seed)).collect()
}

fn one(landscape: &Landscape, limits: Limits, seed: u64) -> Settled {
    let mut optimizer = build(OptimizerKind::Gp, landscape.grid.clone(), seed);
    let (mut told, mut confirmed): (Vec<Observation>, Vec<Confirmed>) = (Vec::new(), Vec::new());
    let (mut quiet, mut settled) = (0, false);
    while told.len() < limits.budget && !settled {
        let points = optimizer.ask(BATCH.min(limits.budget - told.len()));
        if points.is_empty() {
            break;
        }
        let batch: Vec<Observation> = points
            .into_iter()
            .map(|point| Observation::new(point.clone(), landscape.value(&point)))
            .collect();
        optimizer.tell(&batch);
        let count = batch.len();
        told.extend(batch);
        if told.len() >= limits.least {
            let calm = confirm(landscape, &told, &mut confirmed, limits, true);
            quiet = if calm { quiet + count } else { 0 };
            settled = quiet >= limits.quiet;
        }
    }
    confirm(landscape, &told, &mut confirmed, limits, false);
    let last = confirmed.iter().filter(|confirmed| confirmed.last);
    Settled {
        evaluations: told.len(),
        settled,
        repeated: confirmed.len(),
        walked: last.clone().count(),
        firm_mm: last.map(|confirmed| confirmed.value).fold(0.0, f64::max),
    }
}

/// Confirms what is to be confirmed; whether no point is expected to gain then.
fn confirm(
    landscape: &Landscape,
    told: &[Observation],
    confirmed: &mut Vec<Confirmed>,
    limits: Limits,
    searching: bool,
) -> bool {
    let rank: Vec<usize> = (0..told.len()).collect();
    loop {
        let outlook = Outlook::new(&landscape.grid, told, confirmed, limits.gain);
        let advice = match searching {
            true => outlook.advise(&rank, limits.at_once),
            false => outlook.confirm_only(&rank, limits.at_once),
        };
        let Advice::Confirm(places) = advice else { return advice == Advice::Settled };
        for at in places {
            let [repeated, walked] = landscape.firm(&told[at].point).unwrap_or([0.0; 2]);
            match confirmed.iter_mut().find(|confirmed| confirmed.at == at) {
                Some(known) => (known.value, known.last) = (walked, true),
                None => confirmed.push(Confirmed { at, value: repeated, last: false }),
            }
        }
    }
}

/// A line for each search.
pub fn settled_markdown(name: &str, best_mm: f64, all: &[Settled]) -> String {
    let mut text = String::new();
    for (seed, found) in all.iter().enumerate() {
        let Settled { evaluations, settled, repeated, walked, firm_mm } = found;
        let settled = if *settled { "yes" } else { "no" };
        let short = best_mm - firm_mm;
        text += &format!(
            "| {name} | {seed} | {evaluations} | {settled} | {repeated} | {walked} | {firm_mm:.1} | {short:.1} |\n"
        );
    }
    text
}
