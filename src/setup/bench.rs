//! Predictions of every finger from few measurements: simulations, measurements, priors together.

use super::files::find;
use super::request::SetupRequest;
use super::run::{CacheRequest, EffortRequest, settings};
use super::{Setup, measured};
use crate::context::Context;
use crate::failure::Failure;
use crate::progress::{Part, cost};
use calibration::bench::Settings;
use calibration::calibrate::Layout;
use calibration::emulator::{CalibrationError, Emulator, Set};
use calibration::experiments::Experiment;
use calibration::simulation::Simulation;
use calibration::subject::Subject;
use input::shipped::{PRIORS, Source};
use insertion::evaluation::cell::Priors;
use insertion::evaluation::template::Template;
use insertion::space::Design;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Priors unless others are named.
pub const DEFAULT_PRIORS: &str = "bench";

/// Fingers on the bench: of which tasks, and what was measured of them. Without tasks it is the one
/// that the measurements are of.
#[derive(Debug, Clone, clap::Args)]
#[command(mut_arg("tasks", |task| task.required(false).default_value("").hide_default_value(true).help(
    "Task: ket8, ket12, rj45, usb, or the path of a task file; several by commas [default: that of \
     the measurements, if they are of one]"
)))]
pub struct BenchRequest {
    /// Tasks, robot, space, finger model.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// Bench measurements: published, or the path of a file
    #[arg(long, value_name = "FILE")]
    pub measurements: String,
}

/// How a calibration is computed.
#[derive(Debug, Clone, clap::Args)]
#[command(mut_arg("cache", |cache| cache.help(
    "Folder of simulations shared with studies; safe to delete [default: results/.cache]"
)))]
#[command(mut_arg("no_cache", |off| off.help("Simulate anew, and keep nothing")))]
pub struct HowCalibrated {
    /// Priors of the parameters that were not measured: bench, or the path of a file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_PRIORS)]
    pub priors: String,
    /// How much is computed.
    #[command(flatten)]
    pub effort: EffortRequest,
    /// Seed; the same seed gives the same answer
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Where simulations are kept.
    #[command(flatten)]
    pub cache: CacheRequest,
}

pub(crate) struct Prepared<'a> {
    /// The tasks' fingers, in order.
    pub subjects: Vec<Subject>,
    /// Meaning of each coordinate.
    pub layout: Layout,
    /// How to sample.
    pub settings: Settings<'a>,
}

impl BenchRequest {
    /// The setup, of the task of these measurements if none is given.
    fn setup(&self, measurements: &Source, priors: &Priors) -> Result<Setup, Failure> {
        if !self.setup.tasks.is_empty() {
            return self.setup.setup_with(Some(priors));
        }
        let tasks = vec![measured::task(measurements)?];
        SetupRequest { tasks, ..self.setup.clone() }.setup_with(Some(priors))
    }
}

impl HowCalibrated {
    /// Simulations per task.
    pub fn simulations(&self) -> usize {
        self.effort.count()
    }

    /// Simulates the tasks, and reads what was measured on them; `more` are fingers that are
    /// asked for beside those of the space.
    pub(crate) fn prepare<'a>(
        &self,
        (bench, measurements): (&BenchRequest, &Source),
        more: &[Design],
        context: &Context<'a>,
    ) -> Result<Prepared<'a>, Failure> {
        let source = find("file of priors", PRIORS, &self.priors)?;
        let priors = Priors::parse(&source.text, &source.file).map_err(Failure::input)?;
        let setup = bench.setup(measurements, &priors)?;
        setup.evaluator.check_paths(&priors, &source.file).map_err(Failure::input)?;
        let experiments = measured::lines(measurements, &setup.task_names())?;
        let effort = self.effort.or(None)?;
        let ground = Ground {
            setup: &setup,
            priors: &priors,
            simulations: usize::from(effort.simulations),
            seed: self.seed,
            cache: self.cache.folder(&setup)?,
            context,
        };
        let (subjects, layout) = ground.subjects(&measurements.file, &experiments, more)?;
        Ok(Prepared { subjects, layout, settings: settings(effort, self.seed, context.stop) })
    }
}

/// A calibration with fingers left out.
pub(crate) fn folds(done: usize, of: usize) -> Part {
    Part { what: "fingers left out".to_owned(), done, of, cost: cost::FOLD }
}

pub(crate) struct Ground<'a> {
    /// Tasks, robot, fingers, space.
    pub setup: &'a Setup,
    /// Priors of the parameters that were not measured.
    pub priors: &'a Priors,
    /// Simulations per task.
    pub simulations: usize,
    /// Names their set.
    pub seed: u64,
    /// Where they are kept, if they are.
    pub cache: Option<PathBuf>,
    /// Cancellation and progress.
    pub context: &'a Context<'a>,
}

impl<'a> Ground<'a> {
    fn simulation(&self, template: &'a Template) -> Simulation<'a> {
        let evaluator = &self.setup.evaluator;
        let parameters = self.priors.of(&template.task.name);
        Simulation::new(evaluator, template, parameters, self.cache.clone(), self.context.stop)
    }

    /// The tasks' fingers and their parameters; `measurements` is the file's name.
    pub fn subjects(
        &self,
        measurements: &str,
        experiments: &[Experiment],
        more: &[Design],
    ) -> Result<(Vec<Subject>, Layout), Failure> {
        let Setup { evaluator, space, .. } = self.setup;
        let subject = |template: &'a Template| {
            let (task, count) = (&template.task.name, self.simulations);
            let counted = AtomicUsize::new(0);
            let done = || {
                let done = counted.fetch_add(1, Ordering::Relaxed) + 1;
                let what = format!("{task}: simulations");
                self.context.part(&Part { what, done, of: count, cost: cost::SIMULATION });
            };
            let set = Set { task, count, seed: self.seed };
            let emulator = Emulator::new(&self.simulation(template), space, set, &done)?;
            Subject::new(evaluator, template, space, emulator, experiments, more)
        };
        let subjects = evaluator.templates.iter().map(subject).collect::<Result<Vec<_>, _>>();
        self.context.check()?;
        let subjects = subjects.map_err(|error| match error {
            CalibrationError::NoFit(..) => Failure::running(error.to_string()),
            CalibrationError::Impossible(_) => Failure::input(error),
            CalibrationError::Measured(..) => Failure::usage(format!("{measurements}: {error}")),
        })?;
        let of_task = |template: &'a Template| {
            (template.task.name.clone(), self.simulation(template).parameters)
        };
        let of_tasks: Vec<_> = evaluator.templates.iter().map(of_task).collect();
        Ok((subjects, Layout::new(&of_tasks)))
    }
}
