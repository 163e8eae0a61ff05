//! One task: its fingers, their simulated ranges and their measurements.

use super::bench::{Bench, Observation, Simulator};
use super::emulator::{CalibrationError, Emulator, most};
use super::process::StiffnessPoint;
use super::simulation::Simulation;
use crate::experiments::Experiment;
use ask_tell::process::distance2;
use ask_tell::statistics::Moments;
use ask_tell::{Grid, GridPoint, SobolSequence};
use insertion::evaluation::template::Template;
use insertion::outcome::FailureClass;
use insertion::space::{Design, Space, Variable, is_of_task};
use parameters::Parameter;
use std::collections::BTreeSet;

/// Largest space of which all fingers are predicted; of a larger one a designed set is.
const MOST_FINGERS: u64 = 4000;
/// Number of predicted strategies, over all printed fingers.
const STRATEGIES: usize = 500;
/// Number of nearest measured fingers from which the failure of a finger is predicted.
const NEAR: usize = 3;

pub struct Subject {
    pub task: String,
    /// The fingers: first those of the space, then other measured or published ones.
    pub designs: Vec<Design>,
    pub of_space: usize,
    pub emulator: Emulator,
    /// Measurements on this task, each with the number of its finger.
    pub experiments: Vec<(usize, Experiment)>,
    places: Vec<StiffnessPoint>,
    /// Shares of the space, as the emulator takes them.
    shares: Vec<Vec<f64>>,
    /// Parameters of its simulation, in order.
    pub parameters: Vec<Parameter>,
}

impl Subject {
    /// Returns the fingers of a space, those measured and those of `more` on a task.
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
        let lines = lines.map(|line| Ok((whole(space, template, line)?, line)));
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
        let shares = designs.iter().map(|design| shares(space, design)).collect();
        let places = standardised(&stiffness, of_space);
        let parameters = simulation.parameters.iter().copied().cloned().collect();
        Ok(Subject { task, designs, of_space, emulator, experiments, places, shares, parameters })
    }

    pub fn finger(&self, design: &Design) -> Option<usize> {
        self.designs.iter().position(|known| known == design)
    }

    pub fn measured(&self) -> BTreeSet<usize> {
        self.experiments.iter().map(|(number, _)| *number).collect()
    }

    /// Returns the designs whose finger was printed: they differ from a measured one by numbers of the task alone.
    pub fn printed(&self) -> BTreeSet<usize> {
        let shape = |number: usize| shape(&self.designs[number]);
        let known: Vec<Design> = self.measured().into_iter().map(shape).collect();
        (0..self.designs.len()).filter(|&number| known.contains(&shape(number))).collect()
    }

    /// Returns the measured fingers without a range: they insert from no start.
    pub fn not_measurable(&self) -> BTreeSet<usize> {
        let told = |number: &usize| {
            self.experiments.iter().any(|(of, line)| of == number && line.extent().is_some())
        };
        self.measured().into_iter().filter(|number| !told(number)).collect()
    }

    /// Returns its bench; `parameters` are the coordinates of its parameters, `first` is the first one of its
    /// hyperparameters.
    pub fn bench(&self, parameters: Vec<usize>, first: usize) -> Bench<'_> {
        let observation = |&(finger, ref line): &(usize, Experiment)| {
            let (range_mm, at_least) = line.extent()?;
            Some(Observation { finger, range_mm, at_least, repeats: line.repeats })
        };
        Bench {
            simulator: self,
            places: &self.places,
            observations: self.experiments.iter().filter_map(observation).collect(),
            scale_mm: self.emulator.mean_mm.max(1.0),
            error_mm: self.emulator.error_mm,
            parameters,
            first,
        }
    }

    /// Returns the failure at either end: the most frequent of the nearest measured fingers, else of the nearest
    /// simulations.
    pub fn failures(&self, finger: usize) -> [Option<FailureClass>; 2] {
        let distance = |(number, _): &(usize, Experiment)| {
            distance2(&self.places[finger], &self.places[*number])
        };
        let mut nearest: Vec<_> = self.experiments.iter().collect();
        nearest.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        let simulated = self.emulator.failures(&self.shares[finger], 4 * NEAR);
        [0, 1].map(|end| {
            let class = |line: &Experiment| [line.failure_negative, line.failure_positive][end];
            let known = nearest.iter().filter_map(|(_, line)| class(line));
            most(known.take(NEAR)).or(simulated[end])
        })
    }
}

impl Simulator for Subject {
    fn ranges_mm(&self, fingers: &[usize], shares: &[f64]) -> Vec<f64> {
        let range =
            |&finger: &usize| self.emulator.range_mm(&[&self.shares[finger], shares].concat());
        fingers.iter().map(range).collect()
    }
}

/// Returns the designs of a space, or of a large one a designed set.
fn fingers(space: &Space) -> Vec<Design> {
    // Reversed, so that the first parameter changes first.
    let grid = Grid::new(space.levels().into_iter().rev().collect());
    if grid.size() > MOST_FINGERS {
        return designed(space, MOST_FINGERS as usize / 2, "fingers");
    }
    let design = |point: GridPoint| space.design(&GridPoint(point.0.into_iter().rev().collect()));
    grid.points().map(design).collect()
}

/// Returns strategies for each printed finger, if the space changes the task: a designed set.
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
    let with = |shape: &Design, mut design: Design| {
        design.0.extend(shape.0.clone());
        design
    };
    fingers.iter().flat_map(|shape| set.iter().cloned().map(move |one| with(shape, one))).collect()
}

/// Returns a design without its numbers of the task.
fn shape(design: &Design) -> Design {
    let of_finger = design.0.iter().filter(|(key, _)| !is_of_task(key));
    Design(of_finger.map(|(key, value)| (key.clone(), *value)).collect())
}

/// Returns a designed set of `count` designs; `purpose` names its random stream.
fn designed(space: &Space, count: usize, purpose: &str) -> Vec<Design> {
    let grid = Grid::new(space.levels());
    let set = SobolSequence::new(grid.dimension(), 0, 0, purpose).take(count);
    set.map(|shares| space.design(&grid.cell(&shares))).collect()
}

/// Returns a measured design with all parameters of the space; missing ones are as in the task file.
pub fn whole(
    space: &Space,
    template: &Template,
    line: &Experiment,
) -> Result<Design, CalibrationError> {
    let name = &space.name;
    let fault = |words: String| Err(CalibrationError::Measured(line.line, words));
    let known = |key: &String| space.parameters.iter().any(|parameter| parameter.key == *key);
    if let Some(key) = line.design.0.keys().find(|key| !known(key)) {
        return fault(format!(
            "{key}: the space `{name}` has no such parameter; give --space FILE with it"
        ));
    }
    let mut design = Design::default();
    for Variable { key, low, high, .. } in &space.parameters {
        let value = line.design.get(key).or_else(|| template.numbers.number(key));
        let value = value.unwrap_or((low + high) / 2.0);
        if !(*low..=*high).contains(&value) {
            return fault(format!(
                "{key}: {value} lies outside {low} .. {high} of the space `{name}`; give a wider \
                 --space FILE"
            ));
        }
        design.0.insert(key.to_string(), value);
    }
    Ok(design)
}

fn shares(space: &Space, design: &Design) -> Vec<f64> {
    let share = |parameter: &Variable| {
        let value = design.get(&parameter.key).unwrap_or(parameter.low);
        let width = parameter.high - parameter.low;
        if width > 0.0 { (value - parameter.low) / width } else { 0.5 }
    };
    space.parameters.iter().map(share).collect()
}

/// Standardises rows by mean and standard deviation of the first `reference` ones.
fn standardised(rows: &[[f64; 2]], reference: usize) -> Vec<StiffnessPoint> {
    let scale = [0, 1].map(|axis| {
        let moments = Moments::of(rows.iter().take(reference).map(|row| row[axis]));
        (moments.mean, moments.deviation().max(f64::MIN_POSITIVE))
    });
    rows.iter().map(|row| [0, 1].map(|axis| (row[axis] - scale[axis].0) / scale[axis].1)).collect()
}
