//! Bench predictions of every finger from simulations, measurements and priors.

use super::files::find;
use super::request::SetupRequest;
use super::run::{CacheRequest, EffortRequest, settings};
use super::{
    Setup,
    measured::{self, BENCH_FILE},
};
use crate::progress::cost;
use crate::{Context, Failure};
use calibration::bench::Settings;
use calibration::calibrate::Layout;
use calibration::emulator::{CalibrationError, Emulator};
use calibration::experiments::Experiment;
use calibration::simulation::Simulation;
use calibration::subject::Subject;
use input::shipped::{PRIORS, Source};
use insertion::{Design, Priors, Template};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Default priors.
pub const DEFAULT_PRIORS: &str = "bench";

/// Tasks and their measurements on a bench; by default, the only task of the measurements.
#[derive(Debug, Clone, clap::Args)]
#[command(mut_arg("tasks", |task| task.required(false).default_value("").hide_default_value(true).help(
    "Task: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file \
     [default: that of the measurements, if they are of one]"
)))]
pub struct BenchRequest {
    /// Tasks, robot, space, finger model.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// Bench measurements: published, or the path of a file
    #[arg(long, value_name = "FILE", default_value = BENCH_FILE)]
    pub measurements: String,
}

/// Options of a calibration.
#[derive(Debug, Clone, clap::Args)]
#[command(mut_arg("cache", |cache| cache.help(
    "Folder of simulations shared with studies; safe to delete [default: results/.cache]"
)))]
#[command(mut_arg("no_cache", |off| off.help("Simulate again and store nothing")))]
pub struct CalibrationRequest {
    /// Priors of the parameters that were not measured: bench, or the path of a file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_PRIORS)]
    pub priors: String,
    /// Effort.
    #[command(flatten)]
    pub effort: EffortRequest,
    /// Seed; the same seed gives the same answer
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Cache of simulations.
    #[command(flatten)]
    pub cache: CacheRequest,
}

/// Fingers, simulations and measurements of a calibration.
pub struct Prepared<'a> {
    /// Tasks with their fingers and measurements.
    pub subjects: Vec<Subject>,
    /// Meaning of each coordinate of a sample of the posterior.
    pub layout: Layout,
    /// Settings of the sampler.
    pub settings: Settings<'a>,
}

impl BenchRequest {
    /// Returns the setup, by default of the task of the measurements.
    fn setup(&self, measurements: &Source, priors: &Priors) -> Result<Setup, Failure> {
        if !self.setup.tasks.is_empty() {
            return self.setup.setup_with(Some(priors));
        }
        let tasks = vec![measured::task(measurements)?];
        SetupRequest { tasks, ..self.setup.clone() }.setup_with(Some(priors))
    }
}

impl CalibrationRequest {
    /// Returns the number of simulations per task.
    pub fn simulations(&self) -> usize {
        usize::from(self.effort.completed(None).simulations)
    }

    /// Simulates the tasks and reads their measurements; `more` are fingers to predict in addition to those of the
    /// space.
    pub fn prepare<'a>(
        &self,
        (bench, measurements): (&BenchRequest, &Source),
        more: &[Design],
        context: &Context<'a>,
    ) -> Result<Prepared<'a>, Failure> {
        context.cancel_on_interrupt()?;
        let source = find("file of priors", PRIORS, &self.priors)?;
        let priors = Priors::parse(&source.text, &source.file)?;
        let setup = bench.setup(measurements, &priors)?;
        setup.evaluator.check_paths(&priors, &source.file)?;
        let experiments = measured::lines(measurements, &setup.task_names())?;
        let effort = self.effort.completed(None);
        let (setup, priors, simulations) = (&setup, &priors, usize::from(effort.simulations));
        let (seed, cache) = (self.seed, self.cache.folder(setup));
        let calibration = CalibrationContext { setup, priors, simulations, seed, cache, context };
        let (subjects, layout) = calibration.subjects(&measurements.file, &experiments, more)?;
        Ok(Prepared { subjects, layout, settings: settings(effort, self.seed, context.stop) })
    }
}

/// Returns the progress callback of the leave-one-out validation: calibrations with one finger left out.
pub(crate) fn folds(context: &Context<'_>) -> impl Fn([usize; 2]) {
    |done_of| context.part("fingers left out", done_of, cost::FOLD)
}

/// Setup, priors and simulations of a calibration.
pub(crate) struct CalibrationContext<'a> {
    /// Tasks, robot, fingers, space.
    pub setup: &'a Setup,
    /// Priors of the parameters that were not measured.
    pub priors: &'a Priors,
    /// Number of simulations per task.
    pub simulations: usize,
    /// Seed of the simulations.
    pub seed: u64,
    /// Folder of the cache.
    pub cache: Option<PathBuf>,
    /// Cancellation and progress.
    pub context: &'a Context<'a>,
}

impl<'a> CalibrationContext<'a> {
    /// Returns the tasks with their fingers and emulators, and the layout of a posterior sample; `measurements` names
    /// the file in errors.
    pub fn subjects(
        &self,
        measurements: &str,
        experiments: &[Experiment],
        more: &[Design],
    ) -> Result<(Vec<Subject>, Layout), Failure> {
        let Setup { evaluator, space, .. } = self.setup;
        let subject = |template: &'a Template| {
            let (task, count) = (&template.task.name, self.simulations);
            let what = format!("{task}: simulations with drawn parameters of the cell");
            let show = |done, cost| self.context.part(&what, [done, count], cost);
            show(0, 0.0);
            let counted = AtomicUsize::new(0);
            let done = || show(counted.fetch_add(1, Ordering::Relaxed) + 1, cost::SIMULATION);
            let (parameters, cache) = (self.priors.of(task), self.cache.clone());
            let simulation =
                Simulation::new(evaluator, template, parameters, cache, self.context.stop);
            let emulator = Emulator::new(&simulation, space, count, self.seed, &done)?;
            Subject::new(&simulation, space, emulator, experiments, more)
        };
        let subjects = evaluator.templates.iter().map(subject).collect::<Result<Vec<_>, _>>();
        self.context.check().map_err(|failure| match self.cache {
            Some(_) => {
                Failure::Interrupted(Some("the same command continues from the cache".into()))
            }
            None => failure,
        })?;
        let subjects = subjects.map_err(|error| match error {
            CalibrationError::NoFit(..) => Failure::running(error.to_string()),
            CalibrationError::Impossible(_) => Failure::input(error),
            CalibrationError::Outside(..) => Failure::usage(format!("{measurements}: {error}")),
        })?;
        let layout = Layout::new(&subjects);
        Ok((subjects, layout))
    }
}
