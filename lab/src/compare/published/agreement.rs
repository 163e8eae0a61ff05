//! Agreement of two columns of ranges and failure classes.

use super::{DesignRow, RangeSource};
use finger_opt::calibration::statistics::{mean, spearman};
use serde::Serialize;

/// Agreement of one source with another (the reference) over the designs of a task.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Agreement {
    #[serde(rename = "compared")]
    pub source: RangeSource,
    pub reference: RangeSource,
    /// Designs for which both give a range; the next four values rest on them.
    pub designs: usize,
    /// Mean of `|range - reference|`, mm; `None` without designs.
    pub mean_absolute_error_mm: Option<f64>,
    /// Mean of `range - reference`, mm: an offset common to all designs.
    pub mean_error_mm: Option<f64>,
    /// Mean of `|range - reference|` over the reference, percent.
    pub mean_deviation_percent: Option<f64>,
    /// Rank correlation, -1 to 1; see [`spearman`].
    pub spearman: Option<f64>,
    /// Window ends at which both name the same failure class.
    pub matched_ends: usize,
    /// Window ends for which the reference names a class.
    pub ends: usize,
    /// Failure match score, percent: the paper's, over both ends of all windows.
    pub match_percent: Option<f64>,
}

impl Agreement {
    /// Compares two columns of a task's rows.
    ///
    /// An end at which the source names no class (a divergence, no failure up to
    /// the search limit, or no window at all) counts as not matched.
    pub fn of(rows: &[DesignRow], source: RangeSource, reference: RangeSource) -> Self {
        let readings: Vec<_> = rows
            .iter()
            .filter_map(|row| Some((row.reading(source)?, row.reading(reference)?)))
            .collect();
        let pairs: Vec<(f64, f64)> =
            readings.iter().filter_map(|(a, b)| Some((a.range_mm?, b.range_mm?))).collect();
        let ends = || {
            let both = readings.iter().flat_map(|(a, b)| {
                [(a.failure_negative, b.failure_negative), (a.failure_positive, b.failure_positive)]
            });
            both.filter(|(_, reference)| reference.is_some())
        };
        let over = |measure: &dyn Fn(f64, f64) -> f64| {
            mean(&pairs.iter().map(|&(a, b)| measure(a, b)).collect::<Vec<_>>())
        };
        let matched_ends = ends().filter(|(a, b)| a == b).count();
        Agreement {
            source,
            reference,
            designs: pairs.len(),
            mean_absolute_error_mm: over(&|a, b| (a - b).abs()),
            mean_error_mm: over(&|a, b| a - b),
            mean_deviation_percent: over(&deviation_percent),
            spearman: spearman(&pairs),
            matched_ends,
            ends: ends().count(),
            match_percent: match ends().count() {
                0 => None,
                ends => Some(100.0 * matched_ends as f64 / ends as f64),
            },
        }
    }
}

/// The paper's deviation: `|range - reference| / reference`, percent.
pub fn deviation_percent(range: f64, reference: f64) -> f64 {
    100.0 * (range - reference).abs() / reference
}
