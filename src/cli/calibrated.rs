//! What the commands that calibrate have in common.

use super::setup::{Setup, SetupArguments, find};
use super::{Failure, measure, measured, say};
use crate::calibration::calibrate::Layout;
use crate::calibration::emulator::{Emulator, EmulatorError};
use crate::calibration::experiments::Experiment;
use crate::calibration::prior::Parameter;
use crate::calibration::sampler::{Effort, Settings};
use crate::calibration::simulation::Simulation;
use crate::calibration::subject::{Subject, SubjectError};
use crate::study::BenchEffort;
use clap::Args;
use input::shipped::PRIORS;
use insertion::evaluation::template::Impossible;
use insertion::evaluation::template::Template;
use insertion::space::Design;
use rayon::prelude::*;
use std::path::PathBuf;

/// Folder of the cache unless another is named: that of the studies.
const CACHE: &str = "results/.cache";
/// Priors unless others are named.
pub const DEFAULT_PRIORS: &str = "bench";

/// How much is computed.
#[derive(Debug, Clone, Copy, Args)]
pub struct EffortArguments {
    /// Simulations per task that the emulator of a bench prediction is made of; one in eight
    /// measures its error [default: 200, or as the study has it]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(16..=4096))]
    simulations: Option<u16>,
    /// Samples of a bench prediction's posterior [default: 300, or as the study has it]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(20..=20000))]
    samples: Option<u16>,
}

/// How much is computed unless the user says otherwise.
pub const EFFORT: BenchEffort = BenchEffort { simulations: 200, samples: 300 };

/// How a calibration is computed.
#[derive(Debug, Clone, Args)]
pub struct CalibrationArguments {
    /// What nobody measured, and its bounds: bench, or the path of a file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_PRIORS)]
    pub priors: String,
    #[command(flatten)]
    pub effort: EffortArguments,
    /// Seed; the same seed gives the same answer
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Folder of simulations shared with studies; safe to delete [default: results/.cache]
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Simulate anew, and keep nothing
    #[arg(long, conflicts_with = "cache")]
    no_cache: bool,
}

/// Sweeps before sampling, and from one sample to the next.
const WARM_UP: usize = 300;
const THIN: usize = 4;

impl EffortArguments {
    /// What was asked for, or else this.
    pub fn or(self, other: BenchEffort) -> BenchEffort {
        BenchEffort {
            simulations: self.simulations.unwrap_or(other.simulations),
            samples: self.samples.unwrap_or(other.samples),
        }
    }
}

/// How to sample.
pub fn settings(effort: BenchEffort, seed: u64) -> Settings {
    let effort = Effort { warm_up: WARM_UP, samples: usize::from(effort.samples), thin: THIN };
    Settings { effort, seed }
}

/// Tasks with all that is needed to calibrate them.
pub struct Prepared {
    setup: Setup,
    /// The tasks' fingers, in order.
    pub subjects: Vec<Subject>,
    /// What each coordinate is.
    pub layout: Layout,
    cache: Option<PathBuf>,
}

impl Prepared {
    /// Ranges of a task's fingers with all as the files say, mm.
    pub fn simulate(&self, task: usize, fingers: &[usize]) -> Result<Vec<f64>, Failure> {
        let (evaluator, subject) = (&self.setup.evaluator, &self.subjects[task]);
        let simulation =
            Simulation::new(evaluator, &evaluator.templates[task], &[], self.cache.clone());
        let range = |&finger: &usize| {
            Ok(simulation.window(&subject.designs[finger], None)?.window.range_mm())
        };
        let ranges = fingers.par_iter().map(range).collect::<Result<_, Impossible>>();
        ranges.map_err(Failure::input)
    }
}

impl CalibrationArguments {
    /// How to sample.
    pub fn settings(&self) -> Settings {
        settings(self.effort.or(EFFORT), self.seed)
    }

    /// Where simulations are kept, if they are.
    fn cache(&self, setup: &Setup) -> Option<PathBuf> {
        // A closed formula is faster than a file.
        let default = setup.evaluator.engine.simulates().then(|| PathBuf::from(CACHE));
        self.cache.clone().or(default).filter(|_| !self.no_cache)
    }

    /// Simulates the tasks, and reads what was measured on them; `more` are fingers that are
    /// asked for beside those of the space.
    pub fn prepare(
        &self,
        setup: &SetupArguments,
        measurements: &str,
        more: &[Design],
        quiet: bool,
    ) -> Result<Prepared, Failure> {
        let setup = Setup::from_arguments(setup)?;
        let experiments = measure::read(measurements, &setup.task_names())?;
        let priors = measured::priors(&find("file of priors", PRIORS, &self.priors)?)?;
        let cache = self.cache(&setup);
        let ground = Ground {
            setup: &setup,
            parameters: &priors.parameters,
            simulations: usize::from(self.effort.or(EFFORT).simulations),
            seed: self.seed,
            cache: cache.clone(),
            quiet,
        };
        let (subjects, layout) = ground.subjects(measurements, &experiments, more)?;
        Ok(Prepared { setup, subjects, layout, cache })
    }
}

/// What a calibration simulates with.
pub struct Ground<'a> {
    /// Tasks, robot, fingers, space.
    pub setup: &'a Setup,
    /// What nobody measured.
    pub parameters: &'a [Parameter],
    /// Simulations per task.
    pub simulations: usize,
    /// Names their set.
    pub seed: u64,
    /// Where they are kept, if they are.
    pub cache: Option<PathBuf>,
    /// Whether to say nothing.
    pub quiet: bool,
}

impl<'a> Ground<'a> {
    fn simulation(&self, template: &'a Template) -> Simulation<'a> {
        let evaluator = &self.setup.evaluator;
        Simulation::new(evaluator, template, self.parameters, self.cache.clone())
    }

    /// The tasks' fingers and their parameters; `measurements` is the file's name.
    pub fn subjects(
        &self,
        measurements: &str,
        experiments: &[Experiment],
        more: &[Design],
    ) -> Result<(Vec<Subject>, Layout), Failure> {
        let templates = &self.setup.evaluator.templates;
        let subjects = templates.iter().map(|template| self.subject(template, experiments, more));
        let subjects = subjects.collect::<Result<Vec<_>, _>>().map_err(|error| match error {
            SubjectError::Emulator(EmulatorError::NoFit { .. }) => {
                Failure::running(error.to_string())
            }
            SubjectError::Emulator(_) => Failure::input(error),
            _ => Failure::usage(format!("{measurements}: {error}")),
        })?;
        let of_task = |template: &'a Template| {
            (template.task().name.clone(), self.simulation(template).parameters().to_vec())
        };
        let of_tasks: Vec<_> = templates.iter().map(of_task).collect();
        Ok((subjects, Layout::new(&of_tasks)))
    }

    fn subject(
        &self,
        template: &'a Template,
        experiments: &[Experiment],
        more: &[Design],
    ) -> Result<Subject, SubjectError> {
        let (evaluator, space) = (&self.setup.evaluator, &self.setup.space);
        let (task, count) = (&template.task().name, self.simulations);
        if !self.quiet && evaluator.engine.simulates() {
            say(&format!("{task}: {count} simulations, or their cache .."));
        }
        let emulator = Emulator::new(&self.simulation(template), space, task, count, self.seed)?;
        Subject::new(evaluator, template, space, emulator, experiments, more)
    }
}
