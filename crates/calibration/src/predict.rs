//! Predicted ranges of fingers, given posterior samples: means, intervals, joint draws.

use super::bench::Bench;
use super::process::{Conditioned, Finger, Hyperparameters, TERMS};
use ask_tell::normal::{StandardNormal, chi_squared};
use ask_tell::statistics::{mean, normal_cdf, sorted};
use ask_tell::stream::stream;
use rand::{Rng, RngExt};
use rayon::prelude::*;

/// Nominal coverage of the intervals.
pub const INTERVAL: f64 = 0.8;
/// Probability beyond either end of an interval.
const TAIL: f64 = (1.0 - INTERVAL) / 2.0;
/// Number of random Fourier features of a draw of the process.
const FEATURES: usize = 64;
/// Largest number of draws until one satisfies the lower bounds of the ranges; the last draw is kept in any case.
const TRIES: usize = 20;
/// Degrees of freedom of the Matern 5/2 kernel's spectrum, a Student t.
const FREEDOM: f64 = 5.0;
/// Draws per sample of the posterior if there is no closed form.
const DRAWS_PER_SAMPLE: usize = 5;

/// Predicted range of a finger: mean and 80 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Predicted {
    pub mean_mm: f64,
    pub low_mm: f64,
    pub high_mm: f64,
    /// Emulated range without the discrepancy, averaged over the posterior.
    pub simulated_mm: f64,
}

/// Quantity that an interval covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IntervalKind {
    /// The range that many measurements would give on average.
    Truth,
    /// The range of one more measurement, with its noise.
    Measurement,
}

/// Returns mean and interval of the range of each finger over the posterior; `numbers` are the indices of the fingers.
pub fn predict(
    bench: &Bench<'_>,
    posterior: &[Vec<f64>],
    numbers: &[usize],
    kind: IntervalKind,
) -> Vec<Predicted> {
    if bench.observations.iter().any(|observation| observation.at_least) {
        return from_draws(bench, posterior, numbers, kind);
    }
    let states: Vec<(&Vec<f64>, Conditioned)> =
        posterior.iter().filter_map(|state| Some((state, bench.at(state)?))).collect();
    let one = |number: &usize| {
        let part = |(state, at): &(&Vec<f64>, Conditioned)| {
            let finger = bench.fingers(&[*number], state)[0];
            let (mean, sd) = at.predict(&finger);
            let noise = match kind {
                IntervalKind::Truth => 0.0,
                IntervalKind::Measurement => at.hyperparameters.noise,
            };
            [mean, libm::hypot(sd, noise), finger.simulated].map(|value| value * bench.scale_mm)
        };
        let parts: Vec<[f64; 3]> = states.iter().map(part).collect();
        let mean = |i: usize| mean(parts.iter().map(|part| part[i])).unwrap_or(0.0);
        Predicted {
            mean_mm: mean(0).max(0.0),
            low_mm: quantile(&parts, TAIL).max(0.0),
            high_mm: quantile(&parts, 1.0 - TAIL).max(0.0),
            simulated_mm: mean(2),
        }
    };
    numbers.par_iter().map(one).collect()
}

/// Returns the predictions of [`predict`] from joint draws, since lower bounds of ranges leave no closed form.
fn from_draws(
    bench: &Bench<'_>,
    posterior: &[Vec<f64>],
    numbers: &[usize],
    kind: IntervalKind,
) -> Vec<Predicted> {
    let mut random = stream(0, numbers.len() as u64, "predict from draws");
    let mut drawn = draws(bench, posterior, numbers, DRAWS_PER_SAMPLE, &mut random);
    if kind == IntervalKind::Measurement {
        let states =
            posterior.iter().flat_map(|state| std::iter::repeat_n(state, DRAWS_PER_SAMPLE));
        for (draw, state) in drawn.iter_mut().zip(states) {
            let noise = bench.hyperparameters(state).noise * bench.scale_mm;
            draw.iter_mut().for_each(|value| *value += noise * normal(&mut random));
        }
    }
    let simulated = |number: &usize| {
        let one = |state: &Vec<f64>| bench.fingers(&[*number], state)[0].simulated * bench.scale_mm;
        mean(posterior.iter().map(one)).unwrap_or(0.0)
    };
    let one = |(i, number): (usize, &usize)| {
        let values = sorted(drawn.iter().map(|draw| draw[i]));
        let at =
            |level: f64| values.get((level * values.len() as f64) as usize).copied().unwrap_or(0.0);
        let (mean_mm, high_mm) = (mean(&values).unwrap_or(0.0), at(1.0 - TAIL).max(0.0));
        Predicted { mean_mm, low_mm: at(TAIL).max(0.0), high_mm, simulated_mm: simulated(number) }
    };
    numbers.iter().enumerate().map(one).collect()
}

/// Returns a quantile of a mixture of normal distributions, by bisection; each part is mean, standard deviation,
/// unused.
fn quantile(parts: &[[f64; 3]], probability: f64) -> f64 {
    let wide = |sign: f64| parts.iter().map(move |[mean, sd, _]| mean + sign * 8.0 * sd);
    let mut low = wide(-1.0).fold(f64::INFINITY, f64::min);
    let mut high = wide(1.0).fold(f64::NEG_INFINITY, f64::max);
    for _ in 0..50 {
        let middle = (low + high) / 2.0;
        let below = |[mean, sd, _]: &[f64; 3]| normal_cdf((middle - mean) / sd.max(1e-9));
        let cdf = mean(parts.iter().map(below));
        *(if cdf.is_some_and(|cdf| cdf < probability) { &mut low } else { &mut high }) = middle;
    }
    (low + high) / 2.0
}

/// Returns joint draws of the true ranges, mm, of the fingers with indices `numbers`: `each` vectors per posterior
/// sample.
pub fn draws(
    bench: &Bench<'_>,
    posterior: &[Vec<f64>],
    numbers: &[usize],
    each: usize,
    random: &mut impl Rng,
) -> Vec<Vec<f64>> {
    let mut all = Vec::new();
    for state in posterior {
        let Some(at) = bench.at(state) else { continue };
        let fingers = bench.fingers(numbers, state);
        let bounded: Vec<Finger> =
            fingers.iter().copied().chain(at.bounds.iter().map(|b| b.0)).collect();
        for _ in 0..each {
            let kept = |drawn: &Vec<f64>| {
                drawn[fingers.len()..].iter().zip(&at.bounds).all(|(value, b)| *value >= b.1)
            };
            let found = (1..TRIES).map(|_| draw(&at, &bounded, random)).find(kept);
            let mut drawn = found.unwrap_or_else(|| draw(&at, &bounded, random));
            drawn.truncate(fingers.len());
            all.push(drawn.into_iter().map(|value| (value * bench.scale_mm).max(0.0)).collect());
        }
    }
    all
}

/// Draws true ranges from the posterior, in units of the scale: a draw of the prior, conditioned on the measurements.
fn draw(at: &Conditioned, fingers: &[Finger], random: &mut impl Rng) -> Vec<f64> {
    let prior = Discrepancy::drawn(&at.hyperparameters, random);
    let measured = at.fingers.iter().zip(&at.noises);
    let known: Vec<f64> =
        measured.map(|(finger, noise)| prior.at(finger) + noise * normal(random)).collect();
    let prior: Vec<f64> = fingers.iter().map(|finger| prior.at(finger)).collect();
    at.update(fingers, &prior, &known)
}

/// Draws from the standard normal distribution.
fn normal(random: &mut impl Rng) -> f64 {
    random.sample(StandardNormal)
}

/// Prior draw of the discrepancy between bench and simulation: linear trends, and random Fourier features of the
/// kernel (Rahimi and Recht 2007, Random features for large-scale kernel machines).
struct Discrepancy {
    /// Coefficients of the linear terms.
    terms: [f64; TERMS],
    /// Amplitude of each feature.
    amplitude: f64,
    /// Wave number along each axis, and phase of the cosine.
    features: Vec<[f64; 3]>,
}

impl Discrepancy {
    fn drawn(hyperparameters: &Hyperparameters, random: &mut impl Rng) -> Self {
        let terms = hyperparameters.terms.map(|sd| sd * normal(random));
        let mut feature = || {
            let [a, b]: [f64; 2] = std::array::from_fn(|_| normal(random));
            let stretch = (chi_squared(FREEDOM, random) / FREEDOM).sqrt();
            let length = hyperparameters.length_scale * stretch;
            [a / length, b / length, random.random::<f64>() * std::f64::consts::TAU]
        };
        let amplitude = hyperparameters.process * (2.0 / FEATURES as f64).sqrt();
        Discrepancy { terms, amplitude, features: (0..FEATURES).map(|_| feature()).collect() }
    }

    fn at(&self, finger: &Finger) -> f64 {
        let [x, y] = finger.place;
        let linear: f64 = self.terms.iter().zip(finger.terms()).map(|(a, b)| a * b).sum();
        let feature = |[a, b, phase]: &[f64; 3]| libm::cos(a * x + b * y + phase);
        linear + self.amplitude * self.features.iter().map(feature).sum::<f64>()
    }
}
