//! Model of the first objective over the space for the explorer: a Gaussian process fitted to the evaluations, like
//! that of the optimizer `gp`.

use crate::answer::Answer;
use crate::answer::words::rounded;
use ask_tell::gp::{FitEffort, Gp, fit};
use ask_tell::statistics::{Moments, span};
use insertion::Variable;
use serde_json::{Value, json};
use study::{Recorded, StudyRecord};

/// Largest number of evaluations to which the model is fitted; of more, every n-th is used.
const MAX_EVALUATIONS: usize = 300;
/// Smallest standard deviation of the noise of a value, in its unit: that of rounding to 0.1.
const NOISE: f64 = 0.03;
/// Largest number of points along an axis of the surface.
const CELLS: u32 = 41;
/// Number of steps along an axis over which its influence is determined.
const LEVELS: u32 = 20;

/// Fits the Gaussian process of a study. Returns the function from a point of the unit cube to mean and standard
/// deviation, in the unit of the value; `None` for fewer than 5 evaluations or equal values.
pub(super) fn model(record: &StudyRecord) -> Option<impl Fn(&[f64]) -> (f64, f64)> {
    let parameters = &record.config.space.parameters;
    let known = |recorded: &Recorded| {
        let x = parameters.iter().map(|p| Some(p.share(recorded.design.get(&p.key)?)));
        Some((x.collect::<Option<Vec<f64>>>()?, recorded.known_value()?))
    };
    let known: Vec<(Vec<f64>, f64)> = record.current().iter().filter_map(known).collect();
    let every = known.len().div_ceil(MAX_EVALUATIONS).max(1);
    let (x, y): (Vec<Vec<f64>>, Vec<f64>) = known.into_iter().step_by(every).unzip();
    let moments = Moments::of(&y);
    let (mean, sd) = (moments.mean, moments.deviation());
    if y.len() < 5 || sd.is_nan() || sd < 1e-9 {
        return None;
    }
    let values: Vec<f64> = y.iter().map(|y| (y - mean) / sd).collect();
    let floor = (NOISE / sd).powi(2);
    let theta = fit(&x, &values, floor, None, (FitEffort::for_observations(x.len()), &|| false));
    let gp = Gp::new(&x, &values, floor, &theta)?;
    Some(move |x: &[f64]| {
        let (scaled, variance) = gp.predict(x);
        (mean + sd * scaled, sd * variance.max(0.0).sqrt())
    })
}

/// Returns the model over the two most influential parameters as JSON: their indices (`axes`), grid values, and mean
/// and standard deviation, row by row; the other parameters have their recommended values. `None` for a single
/// parameter.
pub(super) fn of(answer: &Answer, model: &impl Fn(&[f64]) -> (f64, f64)) -> Option<Value> {
    let space = &answer.record.config.space;
    let parameters = &space.parameters;
    if parameters.len() < 2 {
        return None;
    }
    let base = space.shares(&answer.recommended.as_ref()?.design.design);
    let mut axes: Vec<usize> = (0..parameters.len()).collect();
    axes.sort_by(|&a, &b| {
        influence(model, &base, b).total_cmp(&influence(model, &base, a)).then(a.cmp(&b))
    });
    axes.truncate(2);
    axes.sort_unstable();
    let levels = |parameter: &Variable| -> Vec<f64> {
        let cells = parameter.levels().clamp(2, CELLS);
        let step = (parameter.high - parameter.low) / f64::from(cells - 1);
        (0..cells).map(|k| rounded(parameter.low + f64::from(k) * step, 4)).collect()
    };
    let (p, q) = (&parameters[axes[0]], &parameters[axes[1]]);
    let (xs, ys) = (levels(p), levels(q));
    let at = |(y, x): (&f64, &f64)| {
        let mut point = base.clone();
        (point[axes[0]], point[axes[1]]) = (p.share(*x), q.share(*y));
        let (mean, sd) = model(&point);
        (rounded(mean, 4), rounded(sd, 4))
    };
    let points = ys.iter().flat_map(|y| xs.iter().map(move |x| (y, x)));
    let (mean, sd): (Vec<f64>, Vec<f64>) = points.map(at).unzip();
    Some(json!({"axes": axes, "x": xs, "y": ys, "mean": mean, "sd": sd}))
}

/// Returns the difference between the largest and the smallest mean of the model along an axis through a point.
fn influence(model: &impl Fn(&[f64]) -> (f64, f64), base: &[f64], axis: usize) -> f64 {
    let along = (0..=LEVELS).map(|level| {
        let mut point = base.to_vec();
        point[axis] = f64::from(level) / f64::from(LEVELS);
        model(&point).0
    });
    let [low, high] = span(along);
    high - low
}
