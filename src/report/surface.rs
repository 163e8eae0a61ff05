//! A model of the first objective over the space, for the report alone: a Gaussian process
//! through the evaluations, as the optimizer `gp` has one.

use crate::study::StudyRecord;
use ask_tell::gp::{FitEffort, Gp, fit};
use insertion::space::{Parameter, label};
use serde_json::{Value, json};

/// Most evaluations that the model goes through; of more, evenly taken ones.
const MOST: usize = 300;
/// Smallest standard deviation of a value, in its unit: what a step of 0.1 rounds off.
const NOISE: f64 = 0.03;
/// Most cells along an axis of the surface.
const CELLS: u32 = 41;
/// Points over the other parameters for the share of one.
const SAMPLES: u32 = 48;
/// Values of one parameter for its share.
const LEVELS: u32 = 9;

/// The process of a study, fitted once a page.
pub(super) struct Model {
    gp: Gp,
    mean: f64,
    sd: f64,
}

impl Model {
    /// `None` with too few evaluations, or if their values are all alike.
    pub(super) fn of(record: &StudyRecord) -> Option<Self> {
        let parameters = &record.config.space.parameters;
        let known: Vec<(Vec<f64>, f64)> = record
            .current()
            .iter()
            .filter_map(|recorded| {
                let x = parameters.iter().map(|p| Some(unit(p, recorded.design.get(&p.key)?)));
                Some((x.collect::<Option<Vec<f64>>>()?, recorded.known_value()?))
            })
            .collect();
        let every = known.len().div_ceil(MOST).max(1);
        let (x, y): (Vec<Vec<f64>>, Vec<f64>) = known.into_iter().step_by(every).unzip();
        let count = y.len() as f64;
        let mean = y.iter().sum::<f64>() / count;
        let sd = (y.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / count).sqrt();
        if y.len() < 5 || sd.is_nan() || sd < 1e-9 {
            return None;
        }
        let values: Vec<f64> = y.iter().map(|y| (y - mean) / sd).collect();
        let floor = (NOISE / sd).powi(2);
        let theta = fit(&x, &values, floor, None, FitEffort::for_observations(x.len()));
        Some(Model { gp: Gp::new(&x, &values, floor, &theta)?, mean, sd })
    }

    /// Mean and standard deviation at a point of the unit cube, in the unit of the value.
    fn at(&self, x: &[f64]) -> (f64, f64) {
        let (mean, variance) = self.gp.predict(x);
        (self.mean + self.sd * mean, self.sd * variance.max(0.0).sqrt())
    }
}

fn unit(parameter: &Parameter, value: f64) -> f64 {
    let span = parameter.high - parameter.low;
    if span > 0.0 { (value - parameter.low) / span } else { 0.5 }
}

/// The surface over the two parameters that matter most, the others as recommended; nothing for
/// one parameter or too few evaluations.
pub(super) fn to_json(record: &StudyRecord, model: &Model) -> Option<Value> {
    let parameters = &record.config.space.parameters;
    if parameters.len() < 2 {
        return None;
    }
    let best = record.recommended()?;
    let base: Vec<f64> =
        parameters.iter().map(|p| unit(p, best.design.get(&p.key).unwrap_or(p.low))).collect();
    let shares = shares(model, parameters.len());
    let mut axes: Vec<usize> = (0..parameters.len()).collect();
    axes.sort_by(|&a, &b| shares[b].total_cmp(&shares[a]).then(a.cmp(&b)));
    axes.truncate(2);
    axes.sort_unstable();
    let levels = |parameter: &Parameter| -> Vec<f64> {
        let cells = parameter.levels().clamp(2, CELLS);
        let step = (parameter.high - parameter.low) / f64::from(cells - 1);
        (0..cells).map(|k| round(parameter.low + f64::from(k) * step)).collect()
    };
    let (p, q) = (&parameters[axes[0]], &parameters[axes[1]]);
    let (xs, ys) = (levels(p), levels(q));
    let (mut mean, mut sd) = (Vec::new(), Vec::new());
    for y in &ys {
        for x in &xs {
            let mut point = base.clone();
            (point[axes[0]], point[axes[1]]) = (unit(p, *x), unit(q, *y));
            let found = model.at(&point);
            mean.push(round(found.0));
            sd.push(round(found.1));
        }
    }
    Some(json!({"axes": axes, "x": xs, "y": ys, "mean": mean, "sd": sd}))
}

/// The share of the variance over the space that each parameter makes by itself (Sobol's first
/// order index, I. M. Sobol 2001, Math. Comput. Simul. 55:271) by the model's mean; by name.
pub(super) fn importance(record: &StudyRecord, model: &Model) -> Vec<(String, f64)> {
    let parameters = &record.config.space.parameters;
    if parameters.len() < 2 {
        return Vec::new();
    }
    let names = parameters.iter().map(|parameter| label(&parameter.key).0);
    let mut named: Vec<(String, f64)> = names.zip(shares(model, parameters.len())).collect();
    named.sort_by(|a, b| b.1.total_cmp(&a.1));
    named
}

fn shares(model: &Model, parameters: usize) -> Vec<f64> {
    let points: Vec<Vec<f64>> = (1..=SAMPLES).map(|i| spread(i, parameters)).collect();
    let variance = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64
    };
    let one = |axis: usize| {
        let (mut means, mut all) = (Vec::new(), Vec::new());
        for level in 0..LEVELS {
            let at = (f64::from(level) + 0.5) / f64::from(LEVELS);
            let values: Vec<f64> = points
                .iter()
                .map(|point| {
                    let mut point = point.clone();
                    point[axis] = at;
                    model.at(&point).0
                })
                .collect();
            means.push(values.iter().sum::<f64>() / values.len() as f64);
            all.extend(values);
        }
        let whole = variance(&all);
        if whole > 0.0 { variance(&means) / whole } else { 0.0 }
    };
    (0..parameters).map(one).collect()
}

/// The i-th of evenly spread points of the unit cube (Kronecker's sequence of square roots of primes).
fn spread(i: u32, parameters: usize) -> Vec<f64> {
    const PRIMES: [f64; 8] = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0];
    (0..parameters)
        .map(|k| (f64::from(i) * (PRIMES[k % 8] + (k / 8) as f64 * 23.0).sqrt()).fract())
        .collect()
}

fn round(value: f64) -> f64 {
    (value * 1e4).round() / 1e4 + 0.0
}
