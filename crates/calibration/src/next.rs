//! Which finger to print next: the one with the largest expected gain of the best known range.
//!
//! Over joint draws of the true ranges the gain is what a finger has more than the best measured
//! one (expected improvement with an unknown incumbent; Jones et al. 1998,
//! doi:10.1023/A:1008306431147). Of several prints each is chosen with those before it counted as
//! known, draw by draw (Ginsbourger et al. 2010, the multi-points criterion).

use super::bench::Bench;
use super::predict::{INTERVAL, draws};
use super::process::Place;
use ask_tell::statistics::{mean, quantile, sorted};
use rand::Rng;
use std::collections::BTreeSet;

#[derive(Debug, Clone, PartialEq)]
pub struct Print {
    pub finger: usize,
    pub expected_mm: f64,
    pub low_mm: f64,
    pub high_mm: f64,
    /// Expected gain of the best known range by this print and those before it, less theirs.
    pub expected_gain_mm: f64,
    pub reason: String,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    pub next: Vec<Print>,
    /// Expected range of the best measured finger, mm; `None` if none was measured.
    pub best_known_mm: Option<f64>,
    /// Whether no finger is expected to gain as much as its print costs.
    pub stop: bool,
}

/// Joint draws per sample of the posterior.
const DRAWS: usize = 4;

/// Which of `among` to print, `count` at a time; a print must promise a gain of `cost_mm`.
pub fn advise(
    bench: &Bench<'_>,
    posterior: &[Vec<f64>],
    among: &[usize],
    count: usize,
    cost_mm: f64,
    random: &mut impl Rng,
) -> Advice {
    let measured: BTreeSet<usize> = bench.observations.iter().map(|one| one.finger).collect();
    let new = among.iter().filter(|finger| !measured.contains(finger));
    let all: Vec<usize> = measured.iter().chain(new).copied().collect();
    let drawn = draws(bench, posterior, &all, DRAWS, random);
    let known = measured.len();
    let expected = |column: usize| mean(drawn.iter().map(|draw| draw[column])).unwrap_or(0.0);
    // Without a measured finger there is nothing to lose.
    let mut best: Vec<f64> =
        drawn.iter().map(|draw| draw[..known].iter().copied().fold(0.0, f64::max)).collect();
    let best_known_mm = (0..known).map(expected).reduce(f64::max);
    let mut left: Vec<usize> = (known..all.len()).collect();
    let mut next: Vec<Print> = Vec::new();
    while next.len() < count && !left.is_empty() {
        let gain = |column: usize| {
            let more = drawn.iter().zip(&best).map(|(draw, best)| (draw[column] - best).max(0.0));
            mean(more).unwrap_or(0.0)
        };
        let gains: Vec<f64> = left.iter().map(|&column| gain(column)).collect();
        let first = (0..gains.len()).rev().max_by(|&a, &b| gains[a].total_cmp(&gains[b]));
        let Some(at) = first else { break };
        let (column, gain) = (left.remove(at), gains[at]);
        let values = sorted(drawn.iter().map(|draw| draw[column]));
        let tail = |share: f64| quantile(&values, share).unwrap_or(0.0);
        let (low_mm, high_mm) = (tail((1.0 - INTERVAL) / 2.0), tail((1.0 + INTERVAL) / 2.0));
        let expected_mm = expected(column);
        let tried = measured.iter().copied().chain(next.iter().map(|print| print.finger));
        let tried: Vec<Place> = tried.map(|finger| bench.places[finger]).collect();
        let reason = reason(bench.places[all[column]], &tried, expected_mm, high_mm, best_known_mm);
        best.iter_mut().zip(&drawn).for_each(|(best, draw)| *best = best.max(draw[column]));
        next.push(Print {
            finger: all[column],
            expected_mm,
            low_mm,
            high_mm,
            expected_gain_mm: gain,
            reason,
        });
    }
    let stop = next.first().is_none_or(|print| print.expected_gain_mm < cost_mm);
    Advice { next, best_known_mm, stop }
}

/// A finger this far from all others, in standard deviations of the space, tells something new.
const FAR: f64 = 0.7;

/// Why a finger at this place is printed after those tried.
fn reason(
    own: Place,
    tried: &[Place],
    expected_mm: f64,
    high_mm: f64,
    best_mm: Option<f64>,
) -> String {
    if tried.is_empty() {
        return "the widest that the simulation expects".to_owned();
    }
    let news = news(own, tried);
    let Some(best_mm) = best_mm else {
        return format!("wide as simulated, and {}", news.as_deref().unwrap_or("near the first"));
    };
    match (expected_mm - best_mm, news) {
        (gain, Some(news)) if gain > 0.0 => {
            format!("expected {gain:.1} mm wider than the best measured, and {news}")
        }
        (gain, None) if gain > 0.0 => format!("expected {gain:.1} mm wider than the best measured"),
        (_, Some(news)) => format!("{news}; may reach {high_mm:.1} mm"),
        (_, None) if high_mm > best_mm => {
            format!("may reach {high_mm:.1} mm, more than the best measured")
        }
        (_, None) => "near those measured, and hardly wider than the best of them".to_owned(),
    }
}

/// News that no finger tried before tells.
fn news(own: Place, tried: &[Place]) -> Option<String> {
    let difference = |axis: usize| {
        let by = tried.iter().map(|other| own[axis] - other[axis]);
        by.min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0)
    };
    let (axis, name) = match difference(0).abs() > difference(1).abs() {
        true => (0, "compliance"),
        false => (1, "assembly"),
    };
    let more = |other: &Place| own[axis] > other[axis];
    // The first axis is 1 / ky: more of it is softer.
    let way = match (tried.iter().all(more), tried.iter().any(more), axis) {
        (true, _, 0) | (_, false, 1) => "softer than any tried",
        (true, ..) | (_, false, _) => "stiffer than any tried",
        _ => "between those tried",
    };
    (difference(axis).abs() > FAR).then(|| format!("tells soft from stiff in {name} ({way})"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_says_on_which_side_of_the_tried_fingers_one_lies() {
        let all = [[-1.0, 0.0], [1.0, 0.0], [2.0, 0.0], [-2.0, 0.0], [0.0, 0.1], [1.1, 0.0]];
        let news = |finger: usize| news(all[finger], &all[..2]).unwrap_or_default();
        // More of 1 / ky is softer.
        for (finger, words) in [(2, "(softer than"), (3, "(stiffer than"), (4, "(between those")] {
            assert!(news(finger).contains(words), "{finger}: {}", news(finger));
        }
        assert_eq!(news(5), "");
        let reason = |high_mm| reason(all[5], &all[..2], 7.0, high_mm, Some(7.9));
        assert!(reason(7.5).contains("hardly wider"));
        assert!(reason(8.5).contains("may reach 8.5 mm"));
    }
}
