//! Each measured finger predicted by a calibration that never saw it.

use super::bench::{Bench, sampled};
use super::predict::{Of, Predicted, predict};
use super::sampler::Settings;
use crate::calibration::statistics::{mean, spearman};
use ask_tell::stream::stream;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// A measured finger, predicted without it.
#[derive(Debug, Clone, Copy)]
pub struct LeftOut {
    pub finger: usize,
    /// Its measured range, mm: the mean, if it was measured several times.
    pub measured_mm: f64,
    /// The range predicted for one more measurement.
    pub predicted: Predicted,
}

/// Accuracy of the predictions of left-out fingers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    pub fingers: usize,
    /// Mean of `|predicted - measured| / measured`, percent; `None` without fingers.
    pub mean_deviation_percent: Option<f64>,
    pub spearman: Option<f64>,
    /// Fingers whose measured range lies in its interval.
    pub inside: usize,
}

impl LeftOut {
    pub fn inside(&self) -> bool {
        (self.predicted.low_mm..=self.predicted.high_mm).contains(&self.measured_mm)
    }
}

impl Accuracy {
    /// Of these fingers. One that does not insert at all has no deviation in percent.
    pub fn of(left_out: &[LeftOut]) -> Self {
        let wide = left_out.iter().filter(|one| one.measured_mm > 0.0);
        let percent = |one: &LeftOut| {
            100.0 * (one.predicted.mean_mm - one.measured_mm).abs() / one.measured_mm
        };
        let deviations: Vec<f64> = wide.map(percent).collect();
        let pairs: Vec<(f64, f64)> =
            left_out.iter().map(|one| (one.predicted.mean_mm, one.measured_mm)).collect();
        Accuracy {
            fingers: left_out.len(),
            mean_deviation_percent: mean(&deviations),
            spearman: spearman(&pairs),
            inside: left_out.iter().filter(|one| one.inside()).count(),
        }
    }

    /// Share of the fingers inside their intervals, percent.
    pub fn coverage_percent(&self) -> Option<f64> {
        (self.fingers > 0).then(|| 100.0 * self.inside as f64 / self.fingers as f64)
    }
}

/// Most times that a calibration is repeated with fingers left out.
const MOST_FOLDS: usize = 20;

/// Leaves out each finger with a measured range on one of the benches; the others stay whole. Of more
/// than [`MOST_FOLDS`] fingers several are left out at a time.
pub fn leave_one_out(
    benches: &[Bench<'_>],
    task: usize,
    dimension: usize,
    settings: &Settings<'_>,
) -> Vec<LeftOut> {
    let known = || benches[task].observations.iter().filter(|one| !one.at_least);
    let fingers: BTreeSet<usize> = known().map(|one| one.finger).collect();
    let fingers: Vec<usize> = fingers.into_iter().collect();
    let fold = |fold: &[usize]| -> Vec<LeftOut> {
        let mut benches = benches.to_vec();
        benches[task].observations.retain(|one| !fold.contains(&one.finger));
        let mut random = stream(settings.seed, fold[0] as u64, "leave one out");
        let posterior = sampled(&benches, dimension, settings, &mut random);
        let predicted = predict(&benches[task], &posterior, fold, Of::Measurement);
        let left_out = |(&finger, predicted): (&usize, Predicted)| {
            let own = known().filter(|one| one.finger == finger).map(|one| one.range_mm);
            let measured_mm = mean(&own.collect::<Vec<f64>>())?;
            Some(LeftOut { finger, measured_mm, predicted })
        };
        fold.iter().zip(predicted).filter_map(left_out).collect()
    };
    let size = fingers.len().div_ceil(MOST_FOLDS).max(1);
    fingers.par_chunks(size).flat_map_iter(fold).collect()
}
