//! How far each physical mean carries: errors on designs, directions and densities left out, and
//! with one, two or three fingers measured.

use super::loo::Data;
use super::{Computed, ModelKind};
use crate::finger::printed::FingerError;
use crate::input::stiffness::{Axis, Measurement};
use rayon::prelude::*;

/// Which designs a model had to predict without having seen them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LeftOut {
    /// Each in turn.
    One,
    /// All of one direction, degrees.
    Direction(f64),
    /// All of one density, percent.
    Density(f64),
    /// All but so many, every choice of those.
    AllBut(usize),
}

/// Error of one model on designs left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The axis.
    pub axis: Axis,
    /// The model.
    pub model: ModelKind,
    /// What it did not see.
    pub left_out: LeftOut,
    /// Mean absolute error, percent; not a number if the rest cannot be fitted.
    pub mean_absolute_percent: f64,
    /// Smallest and largest of that, over the choices of fingers.
    pub range_percent: [f64; 2],
}

/// What leave-one-out says of the best model with the computed stiffness and the best without.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// The axis.
    pub axis: Axis,
    /// The best model with the computed stiffness.
    pub computed: ModelKind,
    /// By how much its mean absolute error is smaller, percentage points.
    pub gain_percent: f64,
    /// Standard error of that, from the differences of the designs.
    pub standard_error_percent: f64,
}

impl Verdict {
    /// Whether the difference is more than chance: two standard errors.
    pub fn is_clear(&self) -> bool {
        self.gain_percent.abs() > 2.0 * self.standard_error_percent
    }
}

/// Models compared: the old mean, the new one, both, and the scale alone.
const COMPARED: [ModelKind; 4] = [
    ModelKind::GaussianProcess,
    ModelKind::ComputedProcess,
    ModelKind::ComputedLamina,
    ModelKind::ComputedScale,
];
/// Fewest fingers that say anything of another material.
const FEW: [usize; 3] = [1, 2, 3];

/// Compares the models on both axes, assembly first.
///
/// # Errors
/// If a measured finger cannot be computed.
pub fn compare(
    measurements: &[Measurement],
    computed: &Computed,
) -> Result<(Vec<Comparison>, Vec<Verdict>), FingerError> {
    let cases = cases(measurements);
    let (mut comparisons, mut verdicts) = (Vec::new(), Vec::new());
    for axis in Axis::ALL {
        let ratios = Data::ratios(axis, measurements, computed)?;
        let plain = Data::measured(axis, measurements);
        let of = |kind: ModelKind| if kind.is_computed() { &ratios } else { &plain };
        let asked: Vec<_> = COMPARED
            .iter()
            .flat_map(|&kind| cases.iter().map(move |case| (kind, case)))
            .filter(|(kind, (left_out, _))| {
                !matches!(left_out, LeftOut::AllBut(_)) || *kind == ModelKind::ComputedScale
            })
            .collect();
        let row = |&(kind, (left_out, groups)): &(ModelKind, &Case)| {
            let errors = groups.iter().map(|group| of(kind).leave_out(kind, group)).collect();
            (kind, *left_out, errors)
        };
        let rows: Vec<(ModelKind, LeftOut, Vec<Vec<f64>>)> = asked.par_iter().map(row).collect();
        verdicts.extend(verdict(axis, &rows));
        comparisons.extend(rows.iter().map(|row| comparison(axis, row)));
    }
    Ok((comparisons, verdicts))
}

/// What is left out, and each group of designs (by index) that then is.
type Case = (LeftOut, Vec<Vec<usize>>);

fn cases(measurements: &[Measurement]) -> Vec<Case> {
    let count = measurements.len();
    let levels = |of: fn(&Measurement) -> f64, name: fn(f64) -> LeftOut| {
        let mut levels: Vec<f64> = measurements.iter().map(of).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        let group = move |level: f64| {
            (0..count).filter(|&i| of(&measurements[i]) == level).collect::<Vec<_>>()
        };
        let several = move |level| Some((name(level), vec![group(level)]));
        // One design of a level is left out by itself already.
        levels.into_iter().filter_map(several).filter(|(_, groups)| groups[0].len() > 1)
    };
    let mut cases = vec![(LeftOut::One, (0..count).map(|i| vec![i]).collect())];
    cases.extend(levels(|m| m.direction_deg, LeftOut::Direction));
    cases.extend(levels(|m| m.density_percent, LeftOut::Density));
    let few = FEW.into_iter().filter(|&few| few < count);
    cases.extend(few.map(|few| (LeftOut::AllBut(few), all_but(count, few))));
    cases
}

/// Every choice of `few` of `count`, as what it leaves out.
fn all_but(count: usize, few: usize) -> Vec<Vec<usize>> {
    let mut chosen: Vec<Vec<usize>> = vec![Vec::new()];
    for _ in 0..few {
        let longer = |seen: &Vec<usize>| {
            let seen = seen.clone();
            let first = seen.last().map_or(0, |last| last + 1);
            (first..count).map(move |next| seen.iter().copied().chain([next]).collect())
        };
        chosen = chosen.iter().flat_map(longer).collect();
    }
    let rest = |kept: &Vec<usize>| (0..count).filter(|i| !kept.contains(i)).collect();
    chosen.iter().map(rest).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn comparison(
    axis: Axis,
    (model, left_out, errors): &(ModelKind, LeftOut, Vec<Vec<f64>>),
) -> Comparison {
    let means: Vec<f64> = errors.iter().map(|errors| mean(errors)).collect();
    let range = |[low, high]: [f64; 2], &mean: &f64| [low.min(mean), high.max(mean)];
    Comparison {
        axis,
        model: *model,
        left_out: *left_out,
        mean_absolute_percent: mean(&means),
        range_percent: means.iter().fold([f64::INFINITY, f64::NEG_INFINITY], range),
    }
}

/// `None` where a model has no error.
fn verdict(axis: Axis, rows: &[(ModelKind, LeftOut, Vec<Vec<f64>>)]) -> Option<Verdict> {
    let one = |(kind, left_out, errors): &(ModelKind, LeftOut, Vec<Vec<f64>>)| {
        let errors = errors.concat();
        (*left_out == LeftOut::One && mean(&errors).is_finite()).then_some((*kind, errors))
    };
    let (computed, plain): (Vec<_>, Vec<_>) =
        rows.iter().filter_map(one).partition(|(kind, _)| kind.is_computed());
    let best = |rows: Vec<(ModelKind, Vec<f64>)>| {
        rows.into_iter().min_by(|a, b| mean(&a.1).total_cmp(&mean(&b.1)))
    };
    let ((computed, with), (_, without)) = (best(computed)?, best(plain)?);
    let gains: Vec<f64> = without.iter().zip(&with).map(|(a, b)| a - b).collect();
    let gain_percent = mean(&gains);
    let squares = gains.iter().map(|gain| (gain - gain_percent).powi(2)).sum::<f64>();
    let count = gains.len() as f64;
    let standard_error_percent = (squares / (count - 1.0) / count).sqrt();
    Some(Verdict { axis, computed, gain_percent, standard_error_percent })
}
