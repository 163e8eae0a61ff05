//! Searches that settle, on recorded landscapes.

use super::Landscape;
use ask_tell::gp::{Advice, Confirmed, DEFAULT_NOISE_FLOOR, Gain, Outlook};
use ask_tell::{Observation, OptimizerKind, build};
use rayon::prelude::*;

/// Evaluations at a time.
const BATCH: usize = 4;
/// Evaluations after which a search ends, settled or not.
const BUDGET: usize = 500;
/// Points confirmed at a time.
const AT_ONCE: usize = 2;
/// What counts as a gain.
const GAIN: Gain =
    Gain { least: 0.3, probability: 0.02, noise_floor: DEFAULT_NOISE_FLOOR, floor: 0.0 };

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

/// Searches of a landscape with the optimizer `gp`, one for each seed from 0.
pub fn settle(landscape: &Landscape, seeds: u64) -> Vec<Settled> {
    (0..seeds).into_par_iter().map(|seed| one(landscape, seed)).collect()
}

fn one(landscape: &Landscape, seed: u64) -> Settled {
    let axes = landscape.grid.dimension();
    // Evaluations before which it does not settle, and in a row for which no gain is expected.
    let (least, enough) = (20 + 4 * axes, 12 * axes);
    let mut optimizer = build(OptimizerKind::Gp, landscape.grid.clone(), seed);
    let (mut told, mut confirmed): (Vec<Observation>, Vec<Confirmed>) = (Vec::new(), Vec::new());
    let (mut quiet, mut settled) = (0, false);
    while told.len() < BUDGET && !settled {
        let points = optimizer.ask(BATCH.min(BUDGET - told.len()));
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
        if told.len() >= least {
            let calm = confirm(landscape, &told, &mut confirmed, true);
            quiet = if calm { quiet + count } else { 0 };
            settled = quiet >= enough;
        }
    }
    confirm(landscape, &told, &mut confirmed, false);
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
    searching: bool,
) -> bool {
    let rank: Vec<usize> = (0..told.len()).collect();
    loop {
        let outlook = Outlook::new(&landscape.grid, told, confirmed, GAIN);
        let advice = match searching {
            true => outlook.advise(&rank, AT_ONCE),
            false => outlook.confirm_only(&rank, AT_ONCE),
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
