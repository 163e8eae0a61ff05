//! Subject of a calibration: a task with its fingers, their emulated ranges and their measurements.

use super::bench::{Bench, Observation, Simulator};
use super::emulator::{CalibrationError, Emulator, most_frequent};
use super::process::StiffnessPoint;
use super::simulation::Simulation;
use crate::experiments::Experiment;
use ask_tell::process::distance2;
use ask_tell::statistics::Moments;
use ask_tell::{Grid, GridPoint, SobolSequence};
use insertion::space::is_of_task;
use insertion::{Design, FailureClass, Space, Template, Variable};
use parameters::Parameter;
use std::collections::BTreeSet;

/// Largest number of designs of a space that are all predicted; of a larger space, half as many Sobol points are.
const MAX_FINGERS: u64 = 4000;
/// Number of predicted strategies in total, shared equally among the printed fingers.
const STRATEGIES: usize = 500;
/// Number of nearest measured fingers from which the failure of a finger is predicted.
const NEAREST: usize = 3;

/// Task with its fingers and measurements.
pub struct Subject {
    pub task: String,
    /// Designs of the fingers: first those of the space, then other measured or published ones.
    pub designs: Vec<Design>,
    /// Number of fingers of the space, which come first in `designs`.
    pub of_space: usize,
    pub emulator: Emulator,
    /// Measurements on this task, each with the index of its finger.
    pub experiments: Vec<(usize, Experiment)>,
    /// Point of each finger in the process of the discrepancy.
    places: Vec<StiffnessPoint>,
    /// Position of each finger in the unit cube of the space, for the emulator.
    unit: Vec<Vec<f64>>,
    /// Parameters of its simulation, in order.
    pub parameters: Vec<Parameter>,
}

impl Subject {
    /// Collects the fingers of a space, the fingers measured on the task of the simulation, and those of `more`.
    pub fn new(
        simulation: &Simulation<'_>,
        space: &Space,
        emulator: Emulator,
        experiments: &[Experiment],
        more: &[Design],
    ) -> Result<Self, CalibrationError> {
        let Simulation { evaluator, template, .. } = simulation;
        let task = template.task.name.clone();
        let lines = experiments.iter().filter(|line| line.task == task);
        let lines = lines.map(|line| Ok((completed(space, template, line)?, line)));
        let lines = lines.collect::<Result<Vec<_>, CalibrationError>>()?;
        let mut designs = fingers(space);
        designs.extend(strategies(space, lines.iter().map(|(design, _)| design)));
        let of_space = designs.len();
        let mut numbered = |design: Design| {
            designs.iter().position(|known| *known == design).unwrap_or_else(|| {
                designs.push(design);
                designs.len() - 1
            })
        };
        let lines = lines.into_iter().map(|(design, line)| (numbered(design), line.clone()));
        let experiments = lines.collect();
        for design in more {
            numbered(design.clone());
        }
        let stiffness = |design: &Design| {
            let predicted = evaluator.predict(design)?;
            Ok([1.0 / predicted.compliance.mean, predicted.assembly.mean])
        };
        let stiffness =
            designs.iter().map(stiffness).collect::<Result<Vec<_>, CalibrationError>>()?;
        let unit = designs.iter().map(|design| space.shares(design)).collect();
        // Each column standardised by mean and standard deviation of the fingers of the space.
        let scale = [0, 1].map(|axis| {
            let moments =
                Moments::of(stiffness.iter().take(of_space).map(|row: &[f64; 2]| row[axis]));
            (moments.mean, moments.deviation().max(f64::MIN_POSITIVE))
        });
        let place = |row: &[f64; 2]| [0, 1].map(|axis| (row[axis] - scale[axis].0) / scale[axis].1);
        let places = stiffness.iter().map(place).collect();
        let parameters = simulation.parameters.iter().copied().cloned().collect();
        Ok(Subject { task, designs, of_space, emulator, experiments, places, unit, parameters })
    }

    /// Returns the index of a design.
    pub fn finger(&self, design: &Design) -> Option<usize> {
        self.designs.iter().position(|known| known == design)
    }

    /// Returns the indices of the measured fingers.
    pub fn measured(&self) -> BTreeSet<usize> {
        self.experiments.iter().map(|(number, _)| *number).collect()
    }

    /// Returns the indices of the designs whose finger is printed: they differ from a measured design at most in
    /// parameters of the task.
    pub fn printed(&self) -> BTreeSet<usize> {
        let shape = |number: usize| shape(&self.designs[number]);
        let known: Vec<Design> = self.measured().into_iter().map(shape).collect();
        (0..self.designs.len()).filter(|&number| known.contains(&shape(number))).collect()
    }

    /// Returns the indices of the measured fingers without a range, which inserted from no start.
    pub fn not_measurable(&self) -> BTreeSet<usize> {
        let has_range = |number: &usize| {
            self.experiments.iter().any(|(of, line)| of == number && line.extent().is_some())
        };
        self.measured().into_iter().filter(|number| !has_range(number)).collect()
    }

    /// Returns the bench of the task, given the indices of the coordinates of its parameters and of the first
    /// coordinate of its hyperparameters in a posterior sample.
    pub fn bench(&self, parameters: Vec<usize>, first: usize) -> Bench<'_> {
        let observation = |&(finger, ref line): &(usize, Experiment)| {
            let (range_mm, at_least) = line.extent()?;
            Some(Observation { finger, range_mm, at_least, repeats: line.repeats })
        };
        let places = &self.places;
        let observations = self.experiments.iter().filter_map(observation).collect();
        let (scale_mm, error_mm) = (self.emulator.mean_mm.max(1.0), self.emulator.error_mm);
        Bench { simulator: self, places, observations, scale_mm, error_mm, parameters, first }
    }

    /// Returns the predicted failure at each end of the window: the most frequent one of the nearest measured fingers,
    /// else of the nearest simulations.
    pub fn failures(&self, finger: usize) -> [Option<FailureClass>; 2] {
        let distance = |(number, _): &(usize, Experiment)| {
            distance2(&self.places[finger], &self.places[*number])
        };
        let mut nearest: Vec<_> = self.experiments.iter().collect();
        nearest.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        let simulated = self.emulator.failures(&self.unit[finger], 4 * NEAREST);
        [0, 1].map(|end| {
            let class = |line: &Experiment| [line.failure_negative, line.failure_positive][end];
            let known = nearest.iter().filter_map(|(_, line)| class(line));
            most_frequent(known.take(NEAREST)).or(simulated[end])
        })
    }
}

impl Simulator for Subject {
    fn range_mm(&self, finger: usize, levels: &[f64]) -> f64 {
        self.emulator.range_mm(&[&self.unit[finger], levels].concat())
    }
}

/// Returns all designs of a space, or Sobol points of a large one.
fn fingers(space: &Space) -> Vec<Design> {
    // Reversed, so that the first parameter changes first.
    let grid = Grid::new(space.levels().into_iter().rev().collect());
    if grid.size() > MAX_FINGERS {
        return designed(space, MAX_FINGERS as usize / 2, "fingers");
    }
    let design = |point: GridPoint| space.design(&GridPoint(point.0.into_iter().rev().collect()));
    grid.points().map(design).collect()
}

/// Returns designs that combine each printed finger with Sobol points of the strategy; none if the space does not
/// change the task.
fn strategies<'a>(space: &Space, printed: impl Iterator<Item = &'a Design>) -> Vec<Design> {
    if !space.changes_task() {
        return Vec::new();
    }
    let mut fingers: Vec<Design> = Vec::new();
    for shape in printed.map(shape) {
        if !fingers.contains(&shape) {
            fingers.push(shape);
        }
    }
    let set = designed(space, STRATEGIES / fingers.len().max(1), "strategies");
    let with = |shape: &Design, one: &Design| {
        Design(one.0.clone().into_iter().chain(shape.0.clone()).collect())
    };
    fingers.iter().flat_map(|shape| set.iter().map(move |one| with(shape, one))).collect()
}

/// Returns a design without the parameters of the task: the finger alone.
fn shape(design: &Design) -> Design {
    let of_finger = design.0.iter().filter(|(key, _)| !is_of_task(key));
    Design(of_finger.map(|(key, value)| (key.clone(), *value)).collect())
}

/// Returns `count` designs at Sobol points of the space; `purpose` names the random stream.
fn designed(space: &Space, count: usize, purpose: &str) -> Vec<Design> {
    let grid = Grid::new(space.levels());
    let set = SobolSequence::new(grid.dimension(), 0, 0, purpose).take(count);
    set.map(|unit| space.design(&grid.cell(&unit))).collect()
}

/// Returns a measured design with all parameters of the space; missing values are those of the task file, else the
/// middle of the bounds.
pub fn completed(
    space: &Space,
    template: &Template,
    line: &Experiment,
) -> Result<Design, CalibrationError> {
    let name = &space.name;
    let fault = |words: String| Err(CalibrationError::Outside(line.line, words));
    let known = |key: &String| space.parameters.iter().any(|parameter| parameter.key == *key);
    if let Some(key) = line.design.0.keys().find(|key| !known(key)) {
        return fault(format!(
            "{key}: not a parameter of the space `{name}`; give a space that has it with --space FILE"
        ));
    }
    let mut design = Design::default();
    for Variable { key, low, high, .. } in &space.parameters {
        let value = line.design.get(key).or_else(|| template.numbers.number(key));
        let value = value.unwrap_or((low + high) / 2.0);
        if !(*low..=*high).contains(&value) {
            return fault(format!(
                "{key}: {value} is not within {low} .. {high}, the bounds of the space `{name}`; give a \
                 wider space with --space FILE"
            ));
        }
        design.0.insert(key.to_string(), value);
    }
    Ok(design)
}
