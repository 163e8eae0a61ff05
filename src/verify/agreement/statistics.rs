//! How well two columns of ranges and failure classes agree.

use super::{Row, Source};
use crate::input::published::{Origin, of_task};

/// Agreement of one source with another (the reference) over the designs of a task.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// What is compared.
    pub source: Source,
    /// What it is compared with.
    pub reference: Source,
    /// Designs for which both give a range; the next four values rest on them.
    pub designs: usize,
    /// Mean of `|range - reference|`, mm; `None` without designs.
    pub mean_absolute_error_mm: Option<f64>,
    /// Mean of `range - reference`, mm: an offset common to all designs.
    pub mean_error_mm: Option<f64>,
    /// Mean of [`deviation_percent`].
    pub mean_deviation_percent: Option<f64>,
    /// Rank correlation, -1 to 1; see [`spearman`].
    pub spearman: Option<f64>,
    /// Window ends at which both name the same failure class.
    pub matched_ends: usize,
    /// Window ends for which the reference names a class.
    pub ends: usize,
}

impl Agreement {
    /// Compares two columns of a task's rows.
    ///
    /// An end at which the source names no class (a divergence, no failure up to
    /// the search limit, or no window at all) counts as not matched.
    pub fn of(rows: &[Row], source: Source, reference: Source) -> Self {
        let readings: Vec<_> = rows
            .iter()
            .filter_map(|row| Some((row.reading(source)?, row.reading(reference)?)))
            .collect();
        let pairs: Vec<(f64, f64)> =
            readings.iter().filter_map(|(a, b)| Some((a.range_mm?, b.range_mm?))).collect();
        let ends = || {
            let both = readings.iter().flat_map(|(a, b)| a.failures.into_iter().zip(b.failures));
            both.filter(|(_, reference)| reference.is_some())
        };
        Agreement {
            source,
            reference,
            designs: pairs.len(),
            mean_absolute_error_mm: mean(pairs.iter().map(|(a, b)| (a - b).abs())),
            mean_error_mm: mean(pairs.iter().map(|(a, b)| a - b)),
            mean_deviation_percent: mean(pairs.iter().map(|&(a, b)| deviation_percent(a, b))),
            spearman: spearman(&pairs),
            matched_ends: ends().filter(|(a, b)| a == b).count(),
            ends: ends().count(),
        }
    }

    /// Failure match score, percent: the paper's, over both ends of all windows.
    pub fn match_percent(&self) -> Option<f64> {
        (self.ends > 0).then(|| 100.0 * self.matched_ends as f64 / self.ends as f64)
    }
}

/// The paper's deviation: `|range - reference| / reference`, in percent.
///
/// It gives the last column of the paper's bench tables from the simulated
/// and the bench range, to the 0.1 % by which those are rounded.
pub fn deviation_percent(range: f64, reference: f64) -> f64 {
    100.0 * (range - reference).abs() / reference
}

/// Spearman's rank correlation of pairs: Pearson's, of ranks of which equals
/// share the mean. `None` below 3 pairs or if one side does not vary.
pub fn spearman(pairs: &[(f64, f64)]) -> Option<f64> {
    let first = ranks(&pairs.iter().map(|p| p.0).collect::<Vec<_>>());
    let second = ranks(&pairs.iter().map(|p| p.1).collect::<Vec<_>>());
    let middle = (pairs.len() as f64 - 1.0) / 2.0;
    let sum = |a: &[f64], b: &[f64]| -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - middle) * (b - middle)).sum()
    };
    let scale = (sum(&first, &first) * sum(&second, &second)).sqrt();
    (pairs.len() >= 3 && scale > 0.0).then(|| sum(&first, &second) / scale)
}

/// Ranks from 0; equals share the mean of their ranks.
fn ranks(values: &[f64]) -> Vec<f64> {
    let rank = |v: &f64| {
        let below = values.iter().filter(|other| *other < v).count() as f64;
        let equal = values.iter().filter(|other| *other == v).count() as f64;
        below + (equal - 1.0) / 2.0
    };
    values.iter().map(rank).collect()
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> Option<f64> {
    let n = values.len();
    (n > 0).then(|| values.sum::<f64>() / n as f64)
}

/// Spearman's rank correlation between published simulation and bench ranges
/// of a task, and the number of designs it rests on; `None` below 3 designs or
/// if all ranges are equal.
pub fn rank_correlation(task: &str) -> Option<(f64, usize)> {
    let bench = of_task(task, Origin::Bench);
    let pairs: Vec<(f64, f64)> = of_task(task, Origin::Simulation)
        .iter()
        .filter_map(|a| {
            let b = bench.iter().find(|b| b.design == a.design)?;
            Some((a.tolerable_range_mm?, b.tolerable_range_mm?))
        })
        .collect();
    Some((spearman(&pairs)?, pairs.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_values_share_their_rank() {
        assert_eq!(ranks(&[3.0, 1.0, 3.0]), vec![1.5, 0.0, 1.5]);
    }

    #[test]
    fn rank_correlations_by_hand() {
        // Ranks 0 1 2 3 against 1 0 3 2: 1 - 6 * 4 / (4 * 15) = 0.6.
        let close = |found: Option<f64>, r: f64| (found.unwrap() - r).abs() < 1e-12;
        assert!(close(spearman(&[(1.0, 20.0), (2.0, 10.0), (3.0, 40.0), (9.0, 30.0)]), 0.6));
        // Centred ranks -1 0 1 against 0.5 0.5 -1: -1.5 / sqrt(2 * 1.5).
        assert!(close(spearman(&[(1.0, 5.0), (2.0, 5.0), (3.0, 4.0)]), -0.75f64.sqrt()));
        assert_eq!(spearman(&[(1.0, 1.0), (2.0, 1.0), (3.0, 1.0)]), None);
        assert_eq!(spearman(&[(1.0, 1.0), (2.0, 2.0)]), None);
    }

    #[test]
    fn the_deviation_is_that_of_the_published_tables() {
        // (simulated mm, bench mm, printed deviation %): rows of all four tables.
        for (simulated, bench, printed) in [
            (7.2, 7.6, 5.2),
            (4.4, 7.8, 43.5),
            (4.5, 7.8, 42.3),
            (4.6, 6.6, 30.3),
            (3.5, 3.2, 9.4),
            (3.7, 1.5, 146.7),
            (9.0, 4.7, 91.5),
            (6.3, 6.1, 3.3),
        ] {
            let deviation = deviation_percent(simulated, bench);
            assert!((deviation - printed).abs() < 0.1, "{deviation} is printed as {printed}");
        }
    }
}
