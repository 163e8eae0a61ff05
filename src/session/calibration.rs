//! What few measurements say of every finger: simulations, measurements and priors together.

use super::failure::not_stopped;
use super::files::find;
use super::how::{CacheRequest, EffortRequest, settings};
use super::request::SetupRequest;
use super::{COSTS, Failure, Part, Setup, Watch, measured, tell};
use crate::calibration::bench::Settings;
use crate::calibration::calibrate::{Calibration, Layout};
use crate::calibration::emulator::{CalibrationError, Emulator, Set};
use crate::calibration::experiments::Experiment;
use crate::calibration::prior::Parameter;
use crate::calibration::simulation::Simulation;
use crate::calibration::subject::Subject;
use input::shipped::PRIORS;
use insertion::evaluation::template::Template;
use insertion::space::Design;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Priors unless others are named.
pub const DEFAULT_PRIORS: &str = "bench";

/// What to calibrate, and how.
#[derive(Debug, Clone)]
pub struct CalibrateRequest {
    /// Tasks, robot, space, finger model.
    pub setup: SetupRequest,
    /// What was measured on the bench: a shipped name, or the path of a file.
    pub measurements: String,
    /// What nobody measured, and its bounds: a shipped name, or the path of a file.
    pub priors: String,
    /// How much is computed.
    pub effort: EffortRequest,
    /// Seed; the same seed gives the same answer.
    pub seed: u64,
    /// Where simulations are kept.
    pub cache: CacheRequest,
}

/// What a calibration found.
pub struct Calibrated {
    /// The tasks' fingers, in order.
    pub subjects: Vec<Subject>,
    /// What is predicted of them.
    pub found: Calibration,
}

/// Tasks with all that is needed to calibrate them.
pub struct Prepared<'a> {
    /// The tasks' fingers, in order.
    pub subjects: Vec<Subject>,
    /// What each coordinate is.
    pub layout: Layout,
    /// How to sample.
    pub settings: Settings<'a>,
}

impl CalibrateRequest {
    /// Of this setup and these measurements, all else as usual.
    pub fn new(setup: SetupRequest, measurements: String) -> Self {
        CalibrateRequest {
            setup,
            measurements,
            priors: DEFAULT_PRIORS.to_owned(),
            effort: EffortRequest::default(),
            seed: 0,
            cache: CacheRequest::default(),
        }
    }

    /// Simulations in all.
    pub fn simulations(&self) -> usize {
        self.setup.tasks.len() * self.effort.count()
    }

    /// Predicts every finger of the space on each task.
    ///
    /// # Errors
    /// If a file cannot be used, or nothing can be fitted; if `stop` is set meanwhile.
    pub fn run(&self, stop: &AtomicBool, watch: &mut Watch<'_>) -> Result<Calibrated, Failure> {
        let Prepared { subjects, layout, settings, .. } = self.prepare(&[], stop, watch)?;
        let watch = Mutex::new(watch);
        let done = |[done, of]: [usize; 2]| tell(&watch, folds(done, of));
        let found = Calibration::new(layout, &subjects, &Settings { done: &done, ..settings });
        not_stopped(stop)?;
        Ok(Calibrated { subjects, found })
    }

    /// Simulates the tasks, and reads what was measured on them; `more` are fingers that are
    /// asked for beside those of the space.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn prepare<'a>(
        &self,
        more: &[Design],
        stop: &'a AtomicBool,
        watch: &mut Watch<'_>,
    ) -> Result<Prepared<'a>, Failure> {
        let setup = self.setup.setup()?;
        let experiments = measured::read(&self.measurements, &setup.task_names())?;
        let priors = measured::priors(&find("file of priors", PRIORS, &self.priors)?)?;
        let effort = self.effort.or(None)?;
        let ground = Ground {
            setup: &setup,
            parameters: &priors.parameters,
            simulations: usize::from(effort.simulations),
            seed: self.seed,
            cache: self.cache.folder(&setup)?,
            stop,
        };
        let (subjects, layout) = ground.subjects(&self.measurements, &experiments, more, watch)?;
        Ok(Prepared { subjects, layout, settings: settings(effort, self.seed, stop) })
    }
}

/// A calibration with fingers left out.
pub(super) fn folds(done: usize, of: usize) -> Part {
    Part { what: "fingers left out".to_owned(), done, of, cost: COSTS[3] }
}

/// What a calibration simulates with.
pub(super) struct Ground<'a> {
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
    /// Set when it is to end.
    pub stop: &'a AtomicBool,
}

impl<'a> Ground<'a> {
    fn simulation(&self, template: &'a Template) -> Simulation<'a> {
        let evaluator = &self.setup.evaluator;
        Simulation::new(evaluator, template, self.parameters, self.cache.clone(), self.stop)
    }

    /// The tasks' fingers and their parameters; `measurements` is the file's name.
    pub fn subjects(
        &self,
        measurements: &str,
        experiments: &[Experiment],
        more: &[Design],
        watch: &mut Watch<'_>,
    ) -> Result<(Vec<Subject>, Layout), Failure> {
        let templates = &self.setup.evaluator.templates;
        let subject = |template| self.subject(template, experiments, more, watch);
        let subjects = templates.iter().map(subject).collect::<Result<Vec<_>, _>>();
        not_stopped(self.stop)?;
        let subjects = subjects.map_err(|error| match error {
            CalibrationError::NoFit(..) => Failure::running(error.to_string()),
            CalibrationError::Impossible(_) => Failure::input(error),
            CalibrationError::Measured(..) => Failure::usage(format!("{measurements}: {error}")),
        })?;
        let of_task = |template: &'a Template| {
            (template.task.name.clone(), self.simulation(template).parameters)
        };
        let of_tasks: Vec<_> = templates.iter().map(of_task).collect();
        Ok((subjects, Layout::new(&of_tasks)))
    }

    fn subject(
        &self,
        template: &'a Template,
        experiments: &[Experiment],
        more: &[Design],
        watch: &mut Watch<'_>,
    ) -> Result<Subject, CalibrationError> {
        let (evaluator, space) = (&self.setup.evaluator, &self.setup.space);
        let (task, count) = (&template.task.name, self.simulations);
        let (counted, watch) = (AtomicUsize::new(0), Mutex::new(watch));
        let done = || {
            let done = counted.fetch_add(1, Ordering::Relaxed) + 1;
            let part =
                Part { what: format!("{task}: simulations"), done, of: count, cost: COSTS[2] };
            tell(&watch, part);
        };
        let set = Set { task, count, seed: self.seed };
        let emulator = Emulator::new(&self.simulation(template), space, set, &done)?;
        Subject::new(evaluator, template, space, emulator, experiments, more)
    }
}
