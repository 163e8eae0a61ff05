//! Post hoc choice of prints among fingers of known range: prints until the best is found.

use ask_tell::stream::stream;
use finger_opt::calibration::bench::{Bench, Observation, Posterior, Simulator};
use finger_opt::calibration::next::{Question, advise};
use finger_opt::calibration::process::COORDINATES;
use finger_opt::calibration::sampler::Settings;
use finger_opt::calibration::statistics::mean;
use rand::seq::SliceRandom;
use rayon::prelude::*;

/// Number of prints after each of which the regret is reported.
pub const TOLD: usize = 4;
/// Orders of equal fingers over which simulation alone is averaged.
const ORDERS: u64 = 50;
/// Prior mean of the range for a process without simulation, mm: connectors tolerate some
/// millimetres.
const UNKNOWN_MM: f64 = 5.0;

/// Result of a way of choosing prints, averaged over its arbitrary choices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Replayed {
    /// Number of prints until the best finger is among them.
    pub prints_to_best: f64,
    /// Shortfall of the best printed finger to the best of all after 1 to 4 prints, percent.
    pub regret_percent_after: [f64; TOLD],
}

impl Replayed {
    /// Result of an order of printing.
    fn of(order: &[usize], ranges: &[f64]) -> Self {
        let best = ranges.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let after = |count: usize| {
            let printed = order.iter().take(count).map(|&finger| ranges[finger]);
            100.0 * (best - printed.fold(0.0, f64::max)) / best
        };
        let found = order.iter().position(|&finger| ranges[finger] >= best);
        Replayed {
            prints_to_best: found.map_or(ranges.len() as f64, |at| at as f64 + 1.0),
            regret_percent_after: std::array::from_fn(|i| after(i + 1)),
        }
    }

    /// Mean of results; `None` without any.
    pub fn averaged(all: &[Replayed]) -> Option<Self> {
        let over =
            |value: &dyn Fn(&Replayed) -> f64| mean(&all.iter().map(value).collect::<Vec<_>>());
        let mut regret_percent_after = [0.0; TOLD];
        for (i, regret) in regret_percent_after.iter_mut().enumerate() {
            *regret = over(&|one| one.regret_percent_after[i])?;
        }
        Some(Replayed { prints_to_best: over(&|one| one.prints_to_best)?, regret_percent_after })
    }
}

/// Mean over all orders: the largest of `k` of `n` ranges is the `j`-th smallest
/// in `C(j - 1, k - 1)` of `C(n, k)` cases.
pub fn random(ranges: &[f64]) -> Replayed {
    let mut sorted = ranges.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    let best = sorted.last().copied().unwrap_or(f64::MIN_POSITIVE);
    let ties = sorted.iter().filter(|range| **range >= best).count();
    let choose =
        |n: usize, k: usize| (0..k).map(|i| (n - i) as f64 / (k - i) as f64).product::<f64>();
    let after = |count: usize| {
        let k = count.min(n);
        let largest = (k..=n).map(|j| sorted[j - 1] * choose(j - 1, k - 1) / choose(n, k));
        100.0 * (best - largest.sum::<f64>()) / best
    };
    Replayed {
        prints_to_best: (n + 1) as f64 / (ties + 1) as f64,
        regret_percent_after: std::array::from_fn(|i| after(i + 1)),
    }
}

/// Mean over the orders of falling simulated range.
pub fn by_simulation(simulated: &[f64], ranges: &[f64]) -> Option<Replayed> {
    let one = |seed: u64| {
        let mut order: Vec<usize> = (0..ranges.len()).collect();
        order.shuffle(&mut stream(seed, 0, "order of equals"));
        order.sort_by(|&a, &b| simulated[b].total_cmp(&simulated[a]));
        Replayed::of(&order, ranges)
    };
    Replayed::averaged(&(0..ORDERS).map(one).collect::<Vec<_>>())
}

/// Mean over seeds of the orders that [`advise`] gives; `fingers` are the bench's numbers of the
/// fingers with these ranges.
pub fn advised(
    bench: &Bench<'_>,
    dimension: usize,
    fingers: &[usize],
    ranges: &[f64],
    settings: &Settings,
    seeds: u64,
) -> Option<Replayed> {
    let one = |seed: u64| {
        let settings = Settings { seed: settings.seed.wrapping_add(seed), ..*settings };
        let order = order(bench, dimension, fingers, ranges, &settings, None);
        Replayed::of(&order, ranges)
    };
    Replayed::averaged(&(0..seeds).into_par_iter().map(one).collect::<Vec<_>>())
}

/// Mean over every first print of the orders by a process without simulation.
pub fn without_simulation(
    bench: &Bench<'_>,
    fingers: &[usize],
    ranges: &[f64],
    settings: &Settings,
) -> Option<Replayed> {
    let blind = Bench {
        simulator: &Blind,
        scale_mm: UNKNOWN_MM,
        error_mm: 0.0,
        parameters: Vec::new(),
        first: 0,
        ..bench.clone()
    };
    let one = |first: usize| {
        let order = order(&blind, COORDINATES, fingers, ranges, settings, Some(first));
        Replayed::of(&order, ranges)
    };
    Replayed::averaged(&(0..fingers.len()).into_par_iter().map(one).collect::<Vec<_>>())
}

/// Simulator that predicts the same range for all fingers.
struct Blind;

impl Simulator for Blind {
    fn ranges_mm(&self, fingers: &[usize], _: &[f64]) -> Vec<f64> {
        vec![UNKNOWN_MM; fingers.len()]
    }
}

/// Order of printing until the best is among the prints, and four at least.
fn order(
    bench: &Bench<'_>,
    dimension: usize,
    fingers: &[usize],
    ranges: &[f64],
    settings: &Settings,
    first: Option<usize>,
) -> Vec<usize> {
    let best = ranges.iter().copied().fold(0.0, f64::max);
    let mut order: Vec<usize> = first.into_iter().collect();
    let found = |order: &[usize]| order.iter().any(|&i| ranges[i] >= best);
    while order.len() < ranges.len() && (order.len() < TOLD || !found(&order)) {
        let observation = |&i: &usize| {
            let (finger, range_mm) = (fingers[i], ranges[i]);
            Observation { finger, range_mm, at_least: false, repeats: 1 }
        };
        let observations = order.iter().map(observation).collect();
        let bench = [Bench { observations, ..bench.clone() }];
        let mut random = stream(settings.seed, order.len() as u64, "replay");
        let posterior = Posterior::sampled(&bench, dimension, settings.effort, &mut random);
        let question = Question { among: fingers, count: 1, cost_mm: 0.0, draws: 5 };
        let advice = advise(&bench[0], &posterior, &question, &mut random);
        let chosen =
            advice.next.first().and_then(|print| fingers.iter().position(|f| *f == print.finger));
        // There is one as long as fingers are left.
        match chosen {
            Some(chosen) => order.push(chosen),
            None => break,
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three of 1, 2 and 4 mm: the first print lacks 3, 2 or 0 of 4 mm.
    #[test]
    fn any_order_is_counted_exactly() {
        let found = random(&[2.0, 4.0, 1.0]);
        let regret = found.regret_percent_after;
        assert!((regret[0] - 100.0 * 5.0 / 12.0).abs() < 1e-9, "{regret:?}");
        // Of two prints the pair without the best lacks 2 mm, one time in three.
        assert!((regret[1] - 100.0 * 2.0 / 12.0).abs() < 1e-9, "{regret:?}");
        assert!(regret[2].abs() < 1e-9 && regret[3].abs() < 1e-9);
        assert_eq!(found.prints_to_best, 2.0);
        assert_eq!(random(&[3.0, 3.0]).prints_to_best, 1.0);
    }

    #[test]
    fn simulation_alone_goes_by_its_order_and_shares_ties() {
        let found = by_simulation(&[1.0, 3.0, 2.0], &[5.0, 4.0, 3.0]).unwrap();
        assert_eq!(found.prints_to_best, 3.0);
        assert_eq!(found.regret_percent_after, [20.0, 20.0, 0.0, 0.0]);
        let tied = by_simulation(&[1.0, 1.0], &[5.0, 4.0]).unwrap();
        assert!(tied.prints_to_best > 1.2 && tied.prints_to_best < 1.8, "{tied:?}");
    }
}
