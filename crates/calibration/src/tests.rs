//! Tests on synthetic benches, whose true ranges and parameters are known.

use super::bench::{Bench, Observation, Settings, Simulator, sampled};
use super::predict::{IntervalKind, Predicted, draws, predict};
use super::process::{COORDINATES, StiffnessPoint};
use ask_tell::normal::StandardNormal;
use ask_tell::statistics::{Moments, normal_cdf};
use ask_tell::stream::stream;
use insertion::trial::NEVER;
use rand::{Rng, RngExt};

const FINGERS: usize = 20;
const SCALE_MM: f64 = 5.0;
const SETTINGS: Settings<'_> =
    Settings { warm_up: 200, samples: 150, thin: 3, seed: 0, stop: &NEVER, done: &|_| () };

/// Simulator with two parameters; the first can reverse the order of the fingers.
struct MadeUp {
    places: Vec<StiffnessPoint>,
}

impl Simulator for MadeUp {
    fn range_mm(&self, finger: usize, levels: &[f64]) -> f64 {
        let [x, y] = self.places[finger];
        let (a, b) = (levels[0], levels[1]);
        5.0 + 1.5 * (a - 0.5) * x + 2.0 * (b - 0.5) + 0.5 * y * (1.0 - a)
    }
}

impl MadeUp {
    fn new() -> Self {
        let place = |i: usize| [(i % 5) as f64 * 0.8 - 1.6, (i / 5) as f64 * 0.9 - 1.35];
        MadeUp { places: (0..FINGERS).map(place).collect() }
    }

    fn bench(&self, observations: Vec<Observation>) -> Bench<'_> {
        Bench {
            simulator: self,
            places: &self.places,
            observations,
            scale_mm: SCALE_MM,
            error_mm: 0.0,
            parameters: vec![0, 1],
            first: 2,
        }
    }
}

fn posterior(bench: &Bench<'_>, random: &mut impl Rng) -> Vec<Vec<f64>> {
    sampled(std::slice::from_ref(bench), 2 + COORDINATES, &SETTINGS, random)
}

/// Result of the calibration of one synthetic bench.
struct Outcome {
    hidden: [f64; 2],
    posterior: Vec<Vec<f64>>,
    truth: Vec<f64>,
    /// Fingers that were not measured, with their predictions.
    predicted: Vec<(usize, Predicted)>,
}

/// Calibrates a synthetic bench on every other finger. `discrepancy` and `noise` are standard deviations in units of
/// the scale; the discrepancy is an offset, a trend and a sine wave, which the simulator does not have.
fn calibrated(number: u64, discrepancy: f64, noise: f64) -> Outcome {
    let simulator = MadeUp::new();
    let mut random = stream(number, 0, "truth");
    let mut normal = || -> f64 { random.sample(StandardNormal) };
    let hidden = [normal(), normal()];
    let [a, b, c] = [normal(), normal(), 0.5 * normal()].map(|sd| SCALE_MM * discrepancy * sd);
    let all: Vec<usize> = (0..FINGERS).collect();
    let levels = hidden.map(normal_cdf);
    let beside = |[x, y]: StiffnessPoint| a + b * x + c * libm::sin(2.0 * y);
    let of = |&i: &usize| simulator.range_mm(i, &levels) + beside(simulator.places[i]);
    let truth: Vec<f64> = all.iter().map(of).collect();
    let measured = |i: &usize| i % 2 == (number % 2) as usize;
    let mut observation = |finger: usize| {
        let range_mm = truth[finger] + SCALE_MM * noise * normal();
        Observation { finger, range_mm, at_least: false, repeats: 1 }
    };
    let observations = all.iter().copied().filter(measured).map(&mut observation).collect();
    let bench = simulator.bench(observations);
    let posterior = posterior(&bench, &mut stream(number, 1, "posterior"));
    let rest: Vec<usize> = all.into_iter().filter(|i| !measured(i)).collect();
    let predicted = predict(&bench, &posterior, &rest, IntervalKind::Truth);
    let predicted = rest.into_iter().zip(predicted).collect();
    Outcome { hidden, posterior, truth, predicted }
}

fn moments(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let moments = Moments::of(values.collect::<Vec<_>>());
    (moments.mean, moments.deviation())
}

/// Returns the percentage of the unmeasured fingers whose true range lies in the interval.
fn coverage_percent(outcomes: &[Outcome]) -> f64 {
    let all =
        || outcomes.iter().flat_map(|o| o.predicted.iter().map(move |(i, p)| (o.truth[*i], p)));
    let inside = all().filter(|(truth, p)| (p.low_mm..=p.high_mm).contains(truth)).count();
    100.0 * inside as f64 / all().count() as f64
}

#[test]
fn the_simulator_with_hidden_parameters_is_found_again() {
    let outcomes: Vec<Outcome> = (0..30).map(|number| calibrated(number, 0.0, 0.1)).collect();
    let coverage = coverage_percent(&outcomes);
    assert!((75.0..=85.0).contains(&coverage), "{coverage} % of the truths inside");
    let beyond = |outcome: &Outcome, i: usize| {
        let (mean, sd) = moments(outcome.posterior.iter().map(|state| state[i]));
        (mean - outcome.hidden[i]).abs() > 2.0 * sd
    };
    let far = outcomes.iter().flat_map(|o| [beyond(o, 0), beyond(o, 1)]).filter(|far| *far).count();
    // Of 60 parameters 3 are expected beyond two standard deviations; 8 or more have a probability of 1 in 150.
    assert!(far < 8, "{far} of 60 hidden parameters beyond two standard deviations");
}

#[test]
fn a_discrepancy_outside_the_model_is_predicted_better_than_by_simulation() {
    let simulator = MadeUp::new();
    let outcomes: Vec<Outcome> = (0..30).map(|number| calibrated(number, 0.12, 0.05)).collect();
    let errors = |o: &Outcome| {
        let of = |(finger, predicted): &(usize, Predicted)| {
            let nominal = simulator.range_mm(*finger, &[0.5, 0.5]);
            let truth = o.truth[*finger];
            [(predicted.mean_mm - truth).abs(), (nominal - truth).abs()]
        };
        o.predicted.iter().map(of).collect::<Vec<_>>()
    };
    let all: Vec<[f64; 2]> = outcomes.iter().flat_map(errors).collect();
    let [ours, simulation] = [0, 1].map(|i| all.iter().map(|error| error[i]).sum::<f64>());
    assert!(ours < 0.3 * simulation, "{ours} and {simulation}");
    let coverage = coverage_percent(&outcomes);
    assert!((75.0..=85.0).contains(&coverage), "{coverage} % of the truths inside");
}

/// All true ranges are equal, with noise of a fifth: the posterior of the parameters stays as wide as the prior, and no
/// interval is narrower than the standard error of ten measurements allows.
#[test]
fn pure_noise_narrows_nothing() {
    let simulator = MadeUp::new();
    let mut spreads = Vec::new();
    for number in 0..6 {
        let mut random = stream(number, 2, "noise");
        let mut observation = |finger: usize| {
            let normal: f64 = random.sample(StandardNormal);
            let range_mm = SCALE_MM * (1.0 + 0.2 * normal);
            Observation { finger, range_mm, at_least: false, repeats: 1 }
        };
        let bench = simulator.bench((0..FINGERS).step_by(2).map(&mut observation).collect());
        let posterior = posterior(&bench, &mut stream(number, 3, "posterior"));
        spreads.extend((0..2).map(|i| moments(posterior.iter().map(|s| s[i])).1));
        let (_, scatter) = moments(bench.observations.iter().map(|one| one.range_mm));
        let interval = predict(&bench, &posterior, &[7], IntervalKind::Truth)[0];
        let least = 0.9 * 2.0 * 1.28 * scatter / 10_f64.sqrt();
        assert!(interval.high_mm - interval.low_mm > least, "{interval:?}");
    }
    // The standard deviation of the prior is 1.
    let (spread, _) = moments(spreads.into_iter());
    assert!(spread > 0.85, "standard deviations of the parameters became {spread}");
}

#[test]
fn a_range_known_from_below_lifts_its_finger_and_draws_keep_to_it() {
    let simulator = MadeUp::new();
    let known = |finger, range_mm, at_least| Observation { finger, range_mm, at_least, repeats: 1 };
    let mut mean = [0.0; 2];
    for (mean, more) in mean.iter_mut().zip([vec![], vec![known(12, 6.5, true)]]) {
        let bench =
            simulator.bench([vec![known(0, 5.0, false), known(4, 5.2, false)], more].concat());
        let posterior = posterior(&bench, &mut stream(0, 0, "bound"));
        *mean = predict(&bench, &posterior, &[12], IntervalKind::Truth)[0].mean_mm;
        let drawn = draws(&bench, &posterior, &[12], 1, &mut stream(0, 1, "bound"));
        let (average, _) = moments(drawn.iter().map(|draw| draw[0]));
        if bench.observations.len() == 3 {
            assert!(average > 6.3, "{average}");
        }
    }
    assert!(mean[1] > mean[0] + 0.1, "{mean:?}");
}

/// Draws given the measurements have the mean and the standard deviation of the closed form.
#[test]
fn draws_agree_with_the_formulas() {
    let simulator = MadeUp::new();
    let known = |finger, range_mm| Observation { finger, range_mm, at_least: false, repeats: 2 };
    let bench = simulator.bench(vec![known(0, 4.0), known(7, 5.0), known(19, 7.0)]);
    let state = [0.3, -0.4, 0.0, 0.5, 0.2, -0.3, 0.0];
    let posterior = vec![state.to_vec()];
    let fingers = [1, 7, 13];
    let drawn = draws(&bench, &posterior, &fingers, 4000, &mut stream(5, 0, "draws"));
    let at = bench.at(&state).unwrap();
    for (i, finger) in bench.fingers(&fingers, &state).iter().enumerate() {
        let (mean, sd) = at.predict(finger);
        let (drawn_mean, drawn_sd) = moments(drawn.iter().map(|draw| draw[i] / SCALE_MM));
        assert!((drawn_mean - mean).abs() < 0.08 * sd, "{i}: {drawn_mean} {mean} ± {sd}");
        assert!((drawn_sd / sd - 1.0).abs() < 0.06, "{i}: {drawn_sd} {sd}");
    }
}
