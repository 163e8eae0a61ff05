//! All tasks together: which coordinate is what, the posterior, and what it says.

use super::bench::{Bench, sampled};
use super::loo::{LeftOut, leave_one_out};
use super::predict::{Of, Predicted, draws, predict};
use super::prior::Parameter;
use super::process::COORDINATES;
use super::sampler::Settings;
use super::subject::Subject;
use ask_tell::stream::stream;

/// Joint draws per sample of the posterior.
const DRAWS: usize = 3;

#[derive(Debug, Clone)]
pub struct Coordinate {
    pub parameter: Parameter,
    /// The task it belongs to; `None` if they share it.
    pub task: Option<String>,
}

/// Meaning of a sample's coordinates: the parameters, then each task's hyperparameters.
#[derive(Debug, Clone)]
pub struct Layout {
    pub coordinates: Vec<Coordinate>,
    /// The coordinates of each task's parameters, in its simulation's order.
    of_task: Vec<Vec<usize>>,
}

impl Layout {
    /// Of the tasks and the parameters that each of them has.
    pub fn new(tasks: &[(String, Vec<&Parameter>)]) -> Self {
        let mut coordinates: Vec<Coordinate> = Vec::new();
        let mut number = |parameter: &Parameter, task: &str| {
            let task = (!parameter.shared).then(|| task.to_owned());
            let same = |c: &Coordinate| c.parameter.name == parameter.name && c.task == task;
            coordinates.iter().position(same).unwrap_or_else(|| {
                coordinates.push(Coordinate { parameter: parameter.clone(), task });
                coordinates.len() - 1
            })
        };
        let of_task = tasks
            .iter()
            .map(|(task, parameters)| parameters.iter().map(|p| number(p, task)).collect())
            .collect();
        Layout { coordinates, of_task }
    }

    pub fn dimension(&self) -> usize {
        self.coordinates.len() + COORDINATES * self.of_task.len()
    }

    pub fn benches<'a>(&self, subjects: &'a [Subject]) -> Vec<Bench<'a>> {
        let bench = |(i, subject): (usize, &'a Subject)| {
            subject.bench(self.of_task[i].clone(), self.coordinates.len() + COORDINATES * i)
        };
        subjects.iter().enumerate().map(bench).collect()
    }
}

#[derive(Debug, Clone)]
pub struct TaskResult {
    /// Each finger of the space, in the subject's order.
    pub predictions: Vec<Prediction>,
    /// The measured fingers, each predicted without it.
    pub left_out: Vec<LeftOut>,
}

#[derive(Debug, Clone, Copy)]
pub struct Prediction {
    pub finger: usize,
    pub range: Predicted,
    /// Probability of its being the best of the space, 0 to 1.
    pub best: f64,
}

pub struct Calibration {
    pub layout: Layout,
    pub posterior: Vec<Vec<f64>>,
    pub tasks: Vec<TaskResult>,
}

impl Calibration {
    /// Calibrates the subjects, and leaves out each measured finger in turn.
    pub fn new(layout: Layout, subjects: &[Subject], settings: &Settings<'_>) -> Self {
        let benches = layout.benches(subjects);
        let dimension = layout.dimension();
        let mut random = stream(settings.seed, 0, "calibrate");
        let posterior = sampled(&benches, dimension, settings, &mut random);
        let task = |(i, subject): (usize, &Subject)| {
            let mut random = stream(settings.seed, i as u64, "draws");
            let fingers: Vec<usize> = (0..subject.of_space).collect();
            let ranges = predict(&benches[i], &posterior, &fingers, Of::Truth);
            let drawn = draws(&benches[i], &posterior, &fingers, DRAWS, &mut random);
            let each = ranges.into_iter().zip(shares_best(&drawn, fingers.len())).enumerate();
            TaskResult {
                predictions: each
                    .map(|(finger, (range, best))| Prediction { finger, range, best })
                    .collect(),
                left_out: leave_one_out(&benches, i, dimension, settings),
            }
        };
        let tasks = subjects.iter().enumerate().map(task).collect();
        Calibration { layout, posterior, tasks }
    }
}

/// Share of the draws in which each finger is the best, 0 to 1.
fn shares_best(drawn: &[Vec<f64>], fingers: usize) -> Vec<f64> {
    let mut counts = vec![0_u32; fingers];
    for draw in drawn {
        if let Some((best, _)) = draw.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)) {
            counts[best] += 1;
        }
    }
    counts.iter().map(|&count| f64::from(count) / drawn.len().max(1) as f64).collect()
}
