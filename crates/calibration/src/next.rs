//! Selection of the fingers to print next: those whose measurement is expected to improve the final choice most.
//!
//! Joint draws of the true ranges give their means and covariances. The value of a print is the sum of two expected
//! gains: of the largest expected range of all fingers (knowledge gradient; Frazier et al. 2009,
//! doi:10.1287/ijoc.1080.0314), since any of them can be printed next, and of the printed fingers alone, in case this
//! print is the last. Both are exact for normally distributed ranges. Of several prints each is selected as if
//! the measurements of those before it had been the expected ranges (kriging believer; Ginsbourger et al. 2010).

use super::bench::Bench;
use super::predict::{INTERVAL, IntervalKind, draws, predict};
use super::process::StiffnessPoint;
use ask_tell::statistics::{mean, normal_cdf, normal_pdf, quantile, sorted};
use insertion::space::Design;
use rand::Rng;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Finger to print; the fields are the keys of `--json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Print {
    #[serde(flatten)]
    pub design: Design,
    /// Expected range, mm.
    pub expected_mm: f64,
    /// Lower end of its 80 % interval, mm.
    pub low_mm: f64,
    /// Upper end of its 80 % interval, mm.
    pub high_mm: f64,
    /// Expected increase of the largest expected range of all fingers by measuring this one, mm.
    pub expected_gain_mm: f64,
    /// Expected increase of the largest expected range of the printed fingers, those listed before this one included, by
    /// printing and measuring it, mm: what printing gains for use; its expected range if none was printed.
    pub gain_in_use_mm: f64,
    /// Probability that its range is larger than that of the best measured finger; `None` if none was measured.
    pub probability_better: Option<f64>,
    /// Whether the finger has to be printed; otherwise it exists, and only the strategy is new.
    pub needs_print: bool,
    pub reason: String,
}

/// Finger with the largest expected range; the fields are the keys of `--json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Choice {
    #[serde(flatten)]
    pub design: Design,
    /// Expected range, mm.
    pub expected_mm: f64,
    /// Lower end of its 80 % interval, mm.
    pub low_mm: f64,
    /// Upper end of its 80 % interval, mm.
    pub high_mm: f64,
    pub measured: bool,
}

/// Finger with the largest measured range; the fields are the keys of `--json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BestMeasured {
    #[serde(rename = "values")]
    pub design: Design,
    /// Its measured range, mm: the mean of its measurements.
    pub range_mm: f64,
    /// Whether the range is only a lower bound.
    pub at_least: bool,
    /// Number of fingers with a measured range.
    pub fingers: usize,
}

impl BestMeasured {
    /// Returns the finger with the largest mean of its measured ranges, mm, of which some may be lower bounds; of equal
    /// ones, one without a bound.
    pub fn of<'a>(measured: impl Iterator<Item = (&'a Design, f64, bool)>) -> Option<Self> {
        let mut all: BTreeMap<String, (&Design, Vec<f64>, bool)> = BTreeMap::new();
        for (design, range_mm, at_least) in measured {
            let own = all.entry(design.labelled()).or_insert((design, Vec::new(), false));
            own.1.push(range_mm);
            own.2 |= at_least;
        }
        let fingers = all.len();
        let one = |(design, own, at_least): (_, Vec<f64>, _)| Some((design, mean(own)?, at_least));
        let best = all.into_values().filter_map(one);
        let best = best.max_by(|a, b| a.1.total_cmp(&b.1).then(b.2.cmp(&a.2)))?;
        let (design, range_mm, at_least): (&Design, f64, bool) = best;
        Some(BestMeasured { design: design.clone(), range_mm, at_least, fingers })
    }
}

/// Recommended prints; the fields are the keys of `--json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Advice {
    /// The finger to use now; `None` if none was measured.
    pub use_now: Option<BestMeasured>,
    /// Expected range of the best measured finger, mm; `None` if none was measured.
    pub best_known_mm: Option<f64>,
    pub next: Vec<Print>,
    /// The finger to use if nothing more is printed; `None` without fingers.
    pub choice: Option<Choice>,
    /// Whether both expected gains of every print are below its cost.
    pub stop: bool,
}

/// Joint draws per sample of the posterior.
const DRAWS: usize = 4;

/// Fingers to choose from.
#[derive(Debug, Clone, Copy)]
pub struct Fingers<'a> {
    /// Designs of all fingers; the other fields hold indices into it.
    pub designs: &'a [Design],
    /// Fingers that may be printed.
    pub printable: &'a [usize],
    /// Printed fingers that inserted from no start; their range counts as 0 mm.
    pub failed: &'a BTreeSet<usize>,
    /// Fingers that need no print: they differ from a printed finger in the strategy only.
    pub printed: &'a BTreeSet<usize>,
}

/// Returns the `count` fingers to print next. A print costs as much as `cost_mm` of range gains; another strategy for a
/// printed finger costs nothing.
pub fn advise(
    bench: &Bench<'_>,
    posterior: &[Vec<f64>],
    Fingers { designs, printable, failed, printed: at_hand }: Fingers<'_>,
    count: usize,
    cost_mm: f64,
    random: &mut impl Rng,
) -> Advice {
    let measured: BTreeSet<usize> = bench.observations.iter().map(|one| one.finger).collect();
    let known: BTreeSet<usize> = measured.union(failed).copied().collect();
    let new = printable.iter().filter(|finger| !known.contains(finger));
    let unmeasured = failed.difference(&measured);
    let all: Vec<usize> = measured.iter().chain(unmeasured).chain(new).copied().collect();
    let drawn = draws(bench, posterior, &all, DRAWS, random);
    let noises = posterior.iter().map(|state| bench.hyperparameters(state).noise * bench.scale_mm);
    let mut ranges = Ranges::new(&drawn, mean(noises.map(|noise| noise * noise)).unwrap_or(0.0));
    (measured.len()..known.len()).for_each(|column| ranges.observe(column, 0.0));
    let given = ranges.clone();
    let mut printed: Vec<usize> = (0..known.len()).collect();
    // In closed form, as a study predicts them, so that both choose the same finger; without failed fingers, which
    // `predict` ignores.
    let closed_form = || predict(bench, posterior, &all, IntervalKind::Truth).into_iter();
    let expected: Vec<[f64; 3]> = match failed.is_empty() {
        true => closed_form().map(|range| [range.mean_mm, range.low_mm, range.high_mm]).collect(),
        false => (0..all.len()).map(|column| given.expected(column)).collect(),
    };
    let best = |columns: &[usize]| {
        columns.iter().rev().copied().max_by(|&a, &b| expected[a][0].total_cmp(&expected[b][0]))
    };
    let best_known_mm = best(&printed[..measured.len()]).map(|column| expected[column][0]);
    let ranges_mm =
        bench.observations.iter().map(|one| (&designs[one.finger], one.range_mm, one.at_least));
    let use_now = BestMeasured::of(ranges_mm);
    let in_use = use_now
        .as_ref()
        .and_then(|best| (0..measured.len()).find(|column| designs[all[*column]] == best.design));
    let in_use_mm = in_use.map(|column| expected[column][0]);
    let insert = (0..measured.len()).chain(known.len()..all.len());
    let choice = best(&insert.collect::<Vec<_>>()).map(|column| {
        let ([mean_mm, low_mm, high_mm], design) = (expected[column], designs[all[column]].clone());
        let (expected_mm, measured) = (mean_mm.max(0.0), column < measured.len());
        Choice { design, expected_mm, low_mm, high_mm, measured }
    });
    let mut next: Vec<Print> = Vec::new();
    let mut stop = true;
    while next.len() < count {
        let gains = ranges.gains(&printed);
        let needs_print = |column: usize| !at_hand.contains(&all[column]);
        let net = |gain: &Gain| {
            gain.choice_mm + gain.use_mm - if needs_print(gain.column) { cost_mm } else { 0.0 }
        };
        let first = gains.iter().rev().max_by(|a, b| net(a).total_cmp(&net(b)));
        let Some(&Gain { column, choice_mm, use_mm }) = first else { break };
        let small = |gain: &Gain| gain.choice_mm.max(gain.use_mm) < cost_mm;
        stop &= !next.is_empty() || gains.iter().all(small);
        let [mean_mm, low_mm, high_mm] = expected[column];
        let expected_mm = mean_mm.max(0.0);
        let tried: Vec<StiffnessPoint> =
            printed.iter().map(|&column| bench.places[all[column]]).collect();
        let design = designs[all[column]].clone();
        let reason = match &choice {
            Some(widest) if tried.is_empty() && widest.design != design => {
                "its range is the most informative about the others".to_owned()
            }
            _ => reason(bench.places[all[column]], &tried, expected_mm, high_mm, in_use_mm),
        };
        next.push(Print {
            design,
            expected_mm,
            low_mm,
            high_mm,
            expected_gain_mm: choice_mm,
            gain_in_use_mm: use_mm,
            probability_better: in_use.map(|best| given.probability_above(column, best)),
            needs_print: needs_print(column),
            reason,
        });
        ranges.condition(column);
        printed.push(column);
    }
    Advice { use_now, best_known_mm, next, choice, stop }
}

/// Joint distribution of the fingers' true ranges, mm.
#[derive(Clone)]
struct Ranges {
    means: Vec<f64>,
    /// Deviations from the means, a vector for each draw.
    deviations: Vec<Vec<f64>>,
    /// Noise variance of a measurement, mm^2.
    noise2: f64,
}

/// Expected gains by printing and measuring a finger, mm.
struct Gain {
    column: usize,
    /// Increase of the largest expected range of all fingers.
    choice_mm: f64,
    /// Increase of the largest expected range of the printed fingers.
    use_mm: f64,
}

impl Ranges {
    fn new(drawn: &[Vec<f64>], noise2: f64) -> Self {
        let columns = drawn.first().map_or(0, Vec::len);
        let average = |column| mean(drawn.iter().map(|draw| draw[column])).unwrap_or(0.0);
        let means: Vec<f64> = (0..columns).map(average).collect();
        let deviation = |draw: &Vec<f64>| draw.iter().zip(&means).map(|(a, b)| a - b).collect();
        let deviations = drawn.iter().map(deviation).collect();
        Ranges { means, deviations, noise2 }
    }

    /// Returns mean and 80 % interval of a finger's range, mm.
    fn expected(&self, column: usize) -> [f64; 3] {
        let mean = self.means[column];
        let values = sorted(self.deviations.iter().map(|draw| mean + draw[column]));
        let tail = |level: f64| quantile(&values, level).unwrap_or(0.0).max(0.0);
        [mean, tail((1.0 - INTERVAL) / 2.0), tail((1.0 + INTERVAL) / 2.0)]
    }

    /// Returns the probability that the range of a finger is larger than that of another.
    fn probability_above(&self, column: usize, other: usize) -> f64 {
        let by = self.means[column] - self.means[other];
        let above = |draw: &Vec<f64>| f64::from(by + draw[column] > draw[other]);
        mean(self.deviations.iter().map(above)).unwrap_or(0.0)
    }

    /// Returns the increase of each finger's mean by a measurement one standard deviation above its own mean.
    fn slopes(&self, column: usize) -> Vec<f64> {
        let mut slopes = vec![0.0; self.means.len()];
        for draw in &self.deviations {
            slopes.iter_mut().zip(draw).for_each(|(sum, other)| *sum += draw[column] * other);
        }
        let count = self.deviations.len() as f64;
        let sd = (slopes[column] / count + self.noise2).sqrt().max(f64::MIN_POSITIVE);
        slopes.iter_mut().for_each(|sum| *sum /= count * sd);
        slopes
    }

    /// Returns the gains by printing each finger that is not printed.
    fn gains(&self, printed: &[usize]) -> Vec<Gain> {
        let gain = |column: usize| {
            let slopes = self.slopes(column);
            let of = |columns: &[usize]| {
                expected_maximum(columns.iter().map(|&i| (slopes[i], self.means[i])).collect())
            };
            let largest =
                |columns: &[usize]| columns.iter().map(|&i| self.means[i]).fold(0.0, f64::max);
            let all: Vec<usize> = (0..self.means.len()).collect();
            let choice_mm = (of(&all) - largest(&all)).max(0.0);
            let with_own = of(&[printed, &[column]].concat());
            Gain { column, choice_mm, use_mm: with_own - largest(printed) }
        };
        let left = (0..self.means.len()).into_par_iter().filter(|column| !printed.contains(column));
        left.map(gain).collect()
    }

    /// Conditions the ranges on a measurement, mm.
    fn observe(&mut self, column: usize, measured_mm: f64) {
        let sd = (self.variance(column) + self.noise2).sqrt().max(f64::MIN_POSITIVE);
        let by = (measured_mm - self.means[column]) / sd;
        let slopes = self.slopes(column);
        self.means.iter_mut().zip(&slopes).for_each(|(mean, slope)| *mean += slope * by);
        self.condition(column);
    }

    /// Conditions the ranges on a measurement equal to its expected value.
    fn condition(&mut self, column: usize) {
        let slopes = self.slopes(column);
        let own = slopes[column].max(f64::MIN_POSITIVE);
        // Scales the component along the measured range so that the covariances become those given the measurement.
        let left = 1.0 - (self.noise2 / (self.noise2 + self.variance(column))).sqrt();
        for draw in &mut self.deviations {
            let part = draw[column] / own * left;
            draw.iter_mut().zip(&slopes).for_each(|(value, slope)| *value -= slope * part);
        }
    }

    fn variance(&self, column: usize) -> f64 {
        mean(self.deviations.iter().map(|draw| draw[column].powi(2))).unwrap_or(0.0)
    }
}

/// Returns `E max(mean + slope Z)` over lines `(slope, mean)` and a standard normal `Z`, along their upper envelope.
fn expected_maximum(mut lines: Vec<(f64, f64)>) -> f64 {
    lines.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    // Lines of the envelope, each with the left end of its segment.
    let mut envelope: Vec<((f64, f64), f64)> = Vec::new();
    for line in lines {
        let mut from = f64::NEG_INFINITY;
        while let Some(&(last, begin)) = envelope.last() {
            from = (last.1 - line.1) / (line.0 - last.0);
            // Parallel lines are sorted by their means.
            if line.0 > last.0 && from > begin {
                break;
            }
            envelope.pop();
            from = f64::NEG_INFINITY;
        }
        envelope.push((line, from));
    }
    let ends = envelope.iter().skip(1).map(|(_, from)| *from).chain([f64::INFINITY]);
    let part = |(&((slope, mean), from), to): (&((f64, f64), f64), f64)| {
        mean * (normal_cdf(to) - normal_cdf(from)) + slope * (normal_pdf(from) - normal_pdf(to))
    };
    envelope.iter().zip(ends).map(part).sum()
}

/// Smallest difference of a stiffness from those of all tried fingers at which a finger is informative, in standard
/// deviations over the space.
const INFORMATIVE: f64 = 0.7;

/// Returns the reason to print a finger of stiffness `own` after those tried.
fn reason(
    own: StiffnessPoint,
    tried: &[StiffnessPoint],
    expected_mm: f64,
    high_mm: f64,
    best_mm: Option<f64>,
) -> String {
    if tried.is_empty() {
        return "the largest simulated range".to_owned();
    }
    let side = side(own, tried);
    let gain = best_mm.map_or(0.0, |best_mm| expected_mm - best_mm);
    let wider = format!("expected {gain:.1} mm wider than the best measured");
    match (side, best_mm) {
        (Some(side), _) if gain > 0.0 => format!("{wider}, and {side}"),
        (None, _) if gain > 0.0 => wider,
        (Some(side), _) => format!("{side}; may reach {high_mm:.1} mm"),
        (None, None) => format!("close to an earlier one, but may reach {high_mm:.1} mm"),
        (None, Some(best_mm)) if high_mm > best_mm => {
            format!("may reach {high_mm:.1} mm, more than the best measured")
        }
        (None, Some(_)) => {
            "close to those measured, and hardly wider than the best of them".to_owned()
        }
    }
}

/// Returns the side of the tried fingers on which a finger lies, in words; `None` if it is close to one of them.
fn side(own: StiffnessPoint, tried: &[StiffnessPoint]) -> Option<String> {
    let difference = |axis: usize| {
        let by = tried.iter().map(|other| own[axis] - other[axis]);
        by.min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0)
    };
    let (axis, name) = match difference(0).abs() > difference(1).abs() {
        true => (0, "compliance"),
        false => (1, "assembly"),
    };
    let more = |other: &StiffnessPoint| own[axis] > other[axis];
    // The first axis is 1 / ky: more of it is softer.
    let way = match (tried.iter().all(more), tried.iter().any(more), axis) {
        (true, _, 0) | (_, false, 1) => "softer than all before",
        (true, ..) | (_, false, _) => "stiffer than all before",
        _ => "between earlier ones",
    };
    (difference(axis).abs() > INFORMATIVE).then(|| format!("informative about {name} ({way})"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ask_tell::normal::StandardNormal;
    use ask_tell::statistics::normal_quantile;
    use ask_tell::stream::stream;
    use rand::RngExt;

    /// Compares with the closed form for two lines, and with a sum over many quantiles for six.
    #[test]
    fn the_expected_maximum_is_that_of_the_upper_envelope() {
        let two = expected_maximum(vec![(0.0, 1.0), (2.0, 0.5)]);
        let u = -0.25;
        assert!((two - (1.0 + 2.0 * (u * normal_cdf(u) + normal_pdf(u)))).abs() < 1e-12, "{two}");
        let lines = vec![(1.0, 0.2), (-0.5, 0.4), (0.3, 0.9), (0.3, 0.1), (-2.0, -1.0), (0.1, 0.3)];
        let n = 200_000;
        let highest = |k: usize| {
            let z = normal_quantile((k as f64 + 0.5) / n as f64);
            lines.iter().map(|(slope, mean)| mean + slope * z).fold(f64::NEG_INFINITY, f64::max)
        };
        let sum: f64 = (0..n).map(highest).sum();
        assert!((expected_maximum(lines.clone()) - sum / n as f64).abs() < 1e-4);
    }

    /// The ranges of fingers 1 and 2, counted from 0, differ by an unknown `x`; that of finger 3 is small for any `x`,
    /// but varies by `2 x`.
    #[test]
    fn a_narrow_finger_that_decides_between_two_is_printed_first() {
        let mut random = stream(0, 0, "two fingers");
        let drawn: Vec<Vec<f64>> = (0..4000)
            .map(|_| {
                let x: f64 = random.sample(StandardNormal);
                vec![5.0, 5.0 + 0.5 * x, 5.0 - 0.5 * x, 1.0 + 2.0 * x.clamp(-1.5, 1.5)]
            })
            .collect();
        let mut ranges = Ranges::new(&drawn, 1.0);
        let gains = ranges.gains(&[0]);
        let value = |gains: &[Gain], column| {
            gains.iter().find(|gain| gain.column == column).map_or(0.0, |gain| gain.choice_mm)
        };
        assert!(value(&gains, 3) > 1.5 * value(&gains, 1), "{}", value(&gains, 1));
        // Of joint ranges: finger 1 is above 2 for any x > 0, finger 3 for x > 2.
        let above = |column| ranges.probability_above(column, 2);
        assert!((above(1) - 0.5).abs() < 0.03 && (above(3) - 0.023).abs() < 0.01, "{}", above(3));
        // Once finger 3 is measured, the others are worth little.
        let variance = ranges.variance(1);
        ranges.condition(3);
        assert!((ranges.variance(1) / variance - 0.25).abs() < 0.1, "{}", ranges.variance(1));
        let after = ranges.gains(&[0, 3]);
        assert!(value(&after, 1) < 0.5 * value(&gains, 1), "{}", value(&after, 1));
        // A range of 0 mm lowers the means of correlated fingers by their regression.
        let mut ranges = Ranges::new(&drawn, 0.0);
        let before = ranges.means.clone();
        ranges.observe(1, 0.0);
        let pulled = [1, 2].map(|column| ranges.means[column] - before[column]);
        assert!((pulled[0] + before[1]).abs() < 1e-9 && (pulled[0] + pulled[1]).abs() < 1e-9);
        assert_eq!(ranges.means[0], before[0]);
    }

    /// The mean of several days counts, and of equal ranges a measured one before a lower bound, in any order.
    #[test]
    fn the_best_measured_finger_has_the_largest_mean_range() {
        let [a, b, c] = [10.0, 20.0, 30.0].map(|density| Design::infill(density, 0.0));
        let mut lines = [(&a, 5.0, false), (&b, 7.0, false), (&b, 2.0, false), (&c, 5.0, true)];
        for _ in 0..2 {
            let best = BestMeasured::of(lines.iter().copied()).unwrap();
            assert_eq!((&best.design, best.range_mm, best.at_least), (&a, 5.0, false));
            assert_eq!(best.fingers, 3);
            lines.reverse();
        }
        let best = BestMeasured::of([(&a, 5.0, false), (&c, 5.1, true)].into_iter()).unwrap();
        assert_eq!((best.design, best.at_least), (c, true));
        assert_eq!(BestMeasured::of([].into_iter()), None);
    }

    #[test]
    fn a_reason_says_on_which_side_of_the_tried_fingers_one_lies() {
        let all = [[-1.0, 0.0], [1.0, 0.0], [2.0, 0.0], [-2.0, 0.0], [0.0, 0.1], [1.1, 0.0]];
        let side = |finger: usize| side(all[finger], &all[..2]).unwrap_or_default();
        for (finger, words) in [(2, "(softer than"), (3, "(stiffer than"), (4, "(between earlier")]
        {
            assert!(side(finger).contains(words), "{finger}: {}", side(finger));
        }
        assert_eq!(side(5), "");
        let after = |high_mm, best_mm| reason(all[5], &all[..2], 7.0, high_mm, best_mm);
        assert!(after(7.5, Some(7.9)).contains("hardly wider"));
        assert!(after(8.5, Some(7.9)).contains("may reach 8.5 mm, more than the best"));
        // Without a measured range, for example after a finger that was not measurable.
        assert_eq!(after(8.5, None), "close to an earlier one, but may reach 8.5 mm");
    }
}
