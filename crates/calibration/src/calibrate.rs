//! Calibration of all tasks together: layout of the posterior samples, predictions, leave-one-out validation.

use super::bench::{Bench, Settings, sampled};
use super::predict::{IntervalKind, Predicted, draws, predict};
use super::process::COORDINATES;
use super::subject::Subject;
use super::verdict::Verdict;
use ask_tell::statistics::{mean, spearman};
use ask_tell::stream::stream;
use insertion::{Design, FailureClass};
use parameters::Parameter;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeSet;
use std::slice;
use std::sync::atomic::{AtomicUsize, Ordering};
use study::LeaveOneOut;

/// Joint draws per sample of the posterior.
const DRAWS: usize = 3;

/// Parameter of the simulation that is a coordinate of the posterior samples.
#[derive(Debug, Clone)]
pub struct Coordinate {
    pub parameter: Parameter,
    /// Task of the parameter; `None` if all tasks share it.
    pub task: Option<String>,
}

/// Meaning of the coordinates of a posterior sample: the parameters, then each task's hyperparameters.
#[derive(Debug, Clone)]
pub struct Layout {
    pub coordinates: Vec<Coordinate>,
    /// Indices of the coordinates of each task's parameters, in the order of its simulation.
    of_task: Vec<Vec<usize>>,
}

impl Layout {
    /// Returns the layout for these tasks with their parameters.
    pub fn new(subjects: &[Subject]) -> Self {
        let mut coordinates: Vec<Coordinate> = Vec::new();
        let mut number = |parameter: &Parameter, task: &str| {
            let task = (!parameter.shared).then(|| task.to_owned());
            let same = |c: &Coordinate| c.parameter.name == parameter.name && c.task == task;
            coordinates.iter().position(same).unwrap_or_else(|| {
                coordinates.push(Coordinate { parameter: parameter.clone(), task });
                coordinates.len() - 1
            })
        };
        let numbers = |Subject { task, parameters, .. }: &Subject| {
            parameters.iter().map(|parameter| number(parameter, task)).collect()
        };
        let of_task = subjects.iter().map(numbers).collect();
        Layout { coordinates, of_task }
    }

    /// Returns the number of coordinates.
    pub fn dimension(&self) -> usize {
        self.coordinates.len() + COORDINATES * self.of_task.len()
    }

    /// Returns samples of the posterior given all measurements, which are the same for the same inputs and seed.
    pub fn posterior(&self, benches: &[Bench<'_>], settings: &Settings<'_>) -> Vec<Vec<f64>> {
        let mut random = stream(settings.seed, 0, "calibrate");
        sampled(benches, self.dimension(), settings, &mut random)
    }

    /// Returns the bench of each task.
    pub fn benches<'a>(&self, subjects: &'a [Subject]) -> Vec<Bench<'a>> {
        let bench = |(i, subject): (usize, &'a Subject)| {
            subject.bench(self.of_task[i].clone(), self.coordinates.len() + COORDINATES * i)
        };
        subjects.iter().enumerate().map(bench).collect()
    }
}

/// Result of a calibration for one task.
#[derive(Debug, Clone)]
pub struct TaskResult {
    /// Prediction of each finger of the space, in the order of the subject's designs.
    pub predictions: Vec<Prediction>,
    /// Leave-one-out prediction of each finger with a measured range.
    pub left_out: Vec<LeftOut>,
}

/// Predicted range of a finger with its 80 % interval; the fields are the keys of `--json`.
#[derive(Debug, Clone, Serialize)]
pub struct Prediction {
    #[serde(flatten)]
    pub design: Design,
    /// Expected range.
    pub range_mm: f64,
    pub low_mm: f64,
    pub high_mm: f64,
    /// Probability that it has the largest range of the fingers of the space, 0 to 1.
    pub probability_best: f64,
    /// Emulated range without the discrepancy, averaged over the posterior.
    pub simulated_mm: f64,
    /// Failure below the window.
    pub failure_negative: Option<FailureClass>,
    /// Failure above the window.
    pub failure_positive: Option<FailureClass>,
}

/// Result of a calibration.
pub struct Calibration {
    pub layout: Layout,
    /// Posterior samples, each with the coordinates of the layout.
    pub posterior: Vec<Vec<f64>>,
    pub tasks: Vec<TaskResult>,
}

impl Calibration {
    /// Calibrates the subjects together, and validates each task by leaving out its measured fingers.
    pub fn new(layout: Layout, subjects: &[Subject], settings: &Settings<'_>) -> Self {
        let benches = layout.benches(subjects);
        let posterior = layout.posterior(&benches, settings);
        let task = |(i, subject): (usize, &Subject)| {
            let mut random = stream(settings.seed, i as u64, "draws");
            let fingers: Vec<usize> = (0..subject.of_space).collect();
            let ranges = predict(&benches[i], &posterior, &fingers, IntervalKind::Truth);
            // After cancellation the result is not used.
            let running = |_: &&Vec<f64>| !settings.stop.load(Ordering::SeqCst);
            let draw =
                |state| draws(&benches[i], slice::from_ref(state), &fingers, DRAWS, &mut random);
            let drawn: Vec<_> = posterior.iter().take_while(running).flat_map(draw).collect();
            let prediction = |(finger, (range, probability_best)): (usize, (Predicted, f64))| {
                let [failure_negative, failure_positive] = subject.failures(finger);
                Prediction {
                    design: subject.designs[finger].clone(),
                    range_mm: range.mean_mm,
                    low_mm: range.low_mm,
                    high_mm: range.high_mm,
                    probability_best,
                    simulated_mm: range.simulated_mm,
                    failure_negative,
                    failure_positive,
                }
            };
            let each =
                ranges.into_iter().zip(probabilities_best(&drawn, fingers.len())).enumerate();
            let left_out =
                leave_one_out((&benches, i), &subject.designs, layout.dimension(), settings);
            TaskResult { predictions: each.map(prediction).collect(), left_out }
        };
        let tasks = subjects.iter().enumerate().map(task).collect();
        Calibration { layout, posterior, tasks }
    }
}

/// Returns the fraction of the draws in which each finger has the largest range.
fn probabilities_best(drawn: &[Vec<f64>], fingers: usize) -> Vec<f64> {
    let mut counts = vec![0_u32; fingers];
    let best = |draw: &Vec<f64>| (0..fingers).max_by(|&a, &b| draw[a].total_cmp(&draw[b]));
    drawn.iter().filter_map(best).for_each(|best| counts[best] += 1);
    counts.iter().map(|&count| f64::from(count) / drawn.len().max(1) as f64).collect()
}

/// Leave-one-out prediction of the measured range of a finger; the fields are the keys of `--json`.
#[derive(Debug, Clone, Serialize)]
pub struct LeftOut {
    #[serde(flatten)]
    pub design: Design,
    /// Measured range of the finger, mm: the mean, if it was measured several times.
    pub measured_mm: f64,
    /// Predicted range.
    pub range_mm: f64,
    pub low_mm: f64,
    pub high_mm: f64,
}

impl LeftOut {
    /// Returns whether the predicted interval contains the measured range.
    pub fn inside(&self) -> bool {
        (self.low_mm..=self.high_mm).contains(&self.measured_mm)
    }
}

impl TaskResult {
    /// Returns the accuracy of the leave-one-out predictions; the given error of the emulator is passed on.
    pub fn accuracy(&self, emulator_error_mm: f64) -> LeaveOneOut {
        let left_out = &self.left_out;
        let pairs: Vec<(f64, f64)> =
            left_out.iter().map(|one| (one.range_mm, one.measured_mm)).collect();
        LeaveOneOut {
            fingers: left_out.len(),
            mean_deviation_percent: self.deviation_percent(|one| one.range_mm),
            spearman: spearman(&pairs),
            inside: left_out.iter().filter(|one| one.inside()).count(),
            emulator_error_mm,
        }
    }

    /// Returns the mean deviation, percent, of predicting each finger by the mean measured range of the others; `None`
    /// without others.
    pub fn mean_of_others_percent(&self) -> Option<f64> {
        let others = self.left_out.len().checked_sub(1).filter(|others| *others > 0)?;
        let total: f64 = self.left_out.iter().map(|one| one.measured_mm).sum();
        self.deviation_percent(|one| (total - one.measured_mm) / others as f64)
    }

    /// Returns the mean deviation of predictions from the measured ranges, percent, without fingers with a measured
    /// range of 0.
    fn deviation_percent(&self, predicted_mm: impl Fn(&LeftOut) -> f64) -> Option<f64> {
        let wide = self.left_out.iter().filter(|one| one.measured_mm > 0.0);
        mean(wide.map(|one| 100.0 * (predicted_mm(one) - one.measured_mm).abs() / one.measured_mm))
    }

    /// Returns the verdict on the predictions.
    pub fn verdict(&self) -> Verdict {
        Verdict::of(&self.accuracy(0.0), self.mean_of_others_percent())
    }
}

/// Largest number of leave-one-out calibrations of a task; with more measured fingers, several are left out together.
const MAX_FOLDS: usize = 20;

/// Predicts each finger with a measured range from the others' measurements, in at most `MAX_FOLDS` calibrations.
pub fn leave_one_out(
    (benches, task): (&[Bench<'_>], usize),
    designs: &[Design],
    dimension: usize,
    settings: &Settings<'_>,
) -> Vec<LeftOut> {
    let known = || benches[task].observations.iter().filter(|one| !one.at_least);
    let fingers: BTreeSet<usize> = known().map(|one| one.finger).collect();
    let fingers: Vec<usize> = fingers.into_iter().collect();
    let size = fingers.len().div_ceil(MAX_FOLDS).max(1);
    let (count, folds) = (AtomicUsize::new(0), fingers.len().div_ceil(size));
    let fold = |fold: &[usize]| -> Vec<LeftOut> {
        let mut benches = benches.to_vec();
        benches[task].observations.retain(|one| !fold.contains(&one.finger));
        let mut random = stream(settings.seed, fold[0] as u64, "leave one out");
        let posterior = sampled(&benches, dimension, settings, &mut random);
        let predicted = predict(&benches[task], &posterior, fold, IntervalKind::Measurement);
        let left_out = |(&finger, predicted): (&usize, Predicted)| {
            let own = known().filter(|one| one.finger == finger).map(|one| one.range_mm);
            let measured_mm = mean(own)?;
            let (design, range_mm) = (designs[finger].clone(), predicted.mean_mm);
            let Predicted { low_mm, high_mm, .. } = predicted;
            Some(LeftOut { design, measured_mm, range_mm, low_mm, high_mm })
        };
        (settings.done)([count.fetch_add(1, Ordering::Relaxed) + 1, folds]);
        fold.iter().zip(predicted).filter_map(left_out).collect()
    };
    fingers.par_chunks(size).flat_map_iter(fold).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::published::{BENCH, of_task};

    /// The mean of the other published usb fingers is 8.9 % off (docs/notes/bench.md).
    #[test]
    fn the_mean_of_the_others_is_compared_with_each_measured_range() {
        let left_out = |measured_mm: f64| LeftOut {
            design: Design::default(),
            measured_mm,
            range_mm: 0.0,
            low_mm: 0.0,
            high_mm: 0.0,
        };
        let of = |ranges: &[f64]| {
            let left_out = ranges.iter().copied().map(left_out).collect();
            TaskResult { predictions: Vec::new(), left_out }.mean_of_others_percent()
        };
        let usb: Vec<f64> = of_task("usb", BENCH).iter().filter_map(|one| one.range_mm).collect();
        assert!(of(&usb).is_some_and(|percent| (percent - 8.9).abs() < 0.05), "{:?}", of(&usb));
        assert_eq!((of(&[4.0, 2.0]), of(&[4.0, 0.0])), (Some(75.0), Some(100.0)));
        assert_eq!((of(&[4.0]), of(&[])), (None, None));
    }
}
