//! What the commands that calibrate have in common.

use super::setup::{Setup, SetupArguments, find};
use super::{Failure, measure, say};
use crate::calibration::calibrate::Layout;
use crate::calibration::emulator::{Emulator, EmulatorError};
use crate::calibration::prior::{Parameter, Priors};
use crate::calibration::sampler::{Effort, Settings};
use crate::calibration::simulation::Simulation;
use crate::calibration::subject::{Subject, SubjectError};
use crate::evaluation::template::Impossible;
use crate::evaluation::template::Template;
use crate::input::experiments::Experiment;
use crate::input::shipped::PRIORS;
use crate::input::space::Design;
use clap::Args;
use rayon::prelude::*;
use std::path::PathBuf;

/// Folder of the cache unless another is named: that of the studies.
const CACHE: &str = "results/.cache";

/// How a calibration is computed.
#[derive(Debug, Clone, Args)]
pub struct CalibrationArguments {
    /// What nobody measured, and its bounds: bench, or the path of a file
    #[arg(long, value_name = "NAME", default_value = "bench")]
    pub priors: String,
    /// Simulations per task that the emulator is made of; one in eight measures its error
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u16).range(16..=4096))]
    pub simulations: u16,
    /// Samples of the posterior
    #[arg(long, value_name = "N", default_value_t = 300, value_parser = clap::value_parser!(u16).range(20..=20000))]
    pub samples: u16,
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
        let effort = Effort { warm_up: WARM_UP, samples: usize::from(self.samples), thin: THIN };
        Settings { effort, seed: self.seed }
    }

    /// Where simulations are kept, if they are.
    fn cache(&self, setup: &Setup) -> Option<PathBuf> {
        // A closed formula is faster than a file.
        let default = setup.evaluator.engine.simulates().then(|| PathBuf::from(CACHE));
        self.cache.clone().or(default).filter(|_| !self.no_cache)
    }

    /// The priors' file.
    pub fn priors(&self) -> Result<Priors, Failure> {
        let source = find("file of priors", PRIORS, &self.priors)?;
        Priors::parse(&source.text, &source.file).map_err(Failure::input)
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
        let names: Vec<&str> = setup
            .evaluator
            .templates
            .iter()
            .map(|template| template.task().name.as_str())
            .collect();
        let experiments = measure::read(measurements, &names)?;
        let priors = self.priors()?;
        let cache = self.cache(&setup);
        let (subjects, layout) = self
            .subjects(&setup, &priors.parameters, &experiments, more, quiet)
            .map_err(|error| match error {
                SubjectError::Emulator(EmulatorError::NoFit { .. }) => {
                    Failure::running(error.to_string())
                }
                SubjectError::Emulator(_) => Failure::input(error),
                _ => Failure::usage(format!("{measurements}: {error}")),
            })?;
        Ok(Prepared { setup, subjects, layout, cache })
    }

    /// The tasks' fingers and their parameters.
    fn subjects<'a>(
        &self,
        setup: &'a Setup,
        parameters: &'a [Parameter],
        experiments: &[Experiment],
        more: &[Design],
        quiet: bool,
    ) -> Result<(Vec<Subject>, Layout), SubjectError> {
        let evaluator = &setup.evaluator;
        let simulation = |template: &'a Template| {
            Simulation::new(evaluator, template, parameters, self.cache(setup))
        };
        let subject = |template: &'a Template| {
            let (task, count) = (&template.task().name, usize::from(self.simulations));
            if !quiet && evaluator.engine.simulates() {
                say(&format!("{task}: {count} simulations, or their cache .."));
            }
            let emulator =
                Emulator::new(&simulation(template), &setup.space, task, count, self.seed)?;
            Subject::new(evaluator, template, &setup.space, emulator, experiments, more)
        };
        let subjects = evaluator.templates.iter().map(subject).collect::<Result<Vec<_>, _>>()?;
        let of_task = |template: &'a Template| {
            (template.task().name.clone(), simulation(template).parameters().to_vec())
        };
        let of_tasks: Vec<_> = evaluator.templates.iter().map(of_task).collect();
        Ok((subjects, Layout::new(&of_tasks)))
    }
}
