//! Open studies, and the run of a study on the threads of this process.

use super::{film, on_bench, optimizer, printable, report, unusable};
use crate::context::Context;
use crate::failure::{Failure, bad_config};
use crate::progress::{Part, cost};
use crate::setup::Setup;
use crate::setup::run::RunRequest;
use crate::setup::task::nominal_start;
use ::report::answer::Answer;
use ::report::answer::command::mend;
use ::report::answer::words::outcome;
use ask_tell::Optimizer;
use insertion::evaluation::evaluator::Evaluator;
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::template::Template;
use insertion::evaluation::tolerance::Search;
use insertion::outcome::Outcome;
use insertion::space::label;
use insertion::task::StartRule;
use insertion::trial::NEVER;
use rayon::ThreadPool;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use study::{
    Cache, ConfirmationLog, Confirmed, Confirmer, Ending, Recorded, Runner, Simulated, Study,
    StudyConfig, StudyError, StudyRecord,
};

/// Study that is open; no other process can open it.
pub struct OpenStudy {
    pub(crate) study: Study,
    pub(crate) setup: Setup,
    pub(crate) run: RunRequest,
    /// Plan of the measurements under drawn errors.
    pub(crate) plan: Plan,
    pub(crate) cache: Option<Cache>,
    /// Number of new measurements on its task.
    pub new_measurements: usize,
}

/// Study that has ended.
pub struct Ended {
    /// Its folder.
    pub dir: PathBuf,
    /// Record of its evaluations.
    pub record: StudyRecord,
    /// Reason for which it ended.
    pub ending: Ending,
    /// Evaluations that were in the cache.
    pub known: u64,
    /// Failure if no design inserts at the nominal start.
    pub unusable: Option<Failure>,
    pub(crate) run: RunRequest,
}

impl OpenStudy {
    pub(crate) fn new(mut study: Study, setup: Setup, run: RunRequest) -> Result<Self, Failure> {
        check(&study.config, &setup)?;
        let before = &study.config.conclusion;
        let mut conclusion = run.conclusion(&setup, before.bench);
        conclusion.project = conclusion.project.or_else(|| before.project.clone());
        study.conclude_by(conclusion)?;
        let goals = study.config.goals();
        let plan = setup.plan(study.config.seed, |measure| goals.need(measure))?;
        let cache = run.cache(&setup);
        Ok(OpenStudy { study, setup, run, plan, cache, new_measurements: 0 })
    }

    /// Returns a new optimizer of the study.
    pub(super) fn optimizer(&self) -> Result<Box<dyn Optimizer + Send>, Failure> {
        optimizer::optimizer(&self.setup, &self.study.config)
    }

    /// Returns the evaluator of designs with its cache.
    pub(super) fn simulated<'a>(&'a self, stop: &'a AtomicBool) -> Simulated<'a> {
        simulated((&self.setup, self.cache.as_ref()), &self.plan, stop)
    }

    /// Returns a line for each task to which a part of the cell does not apply, and, before the first
    /// evaluation, for each whose given nominal start fails with the finger of medium stiffness.
    ///
    /// # Errors
    /// If that cannot be simulated.
    fn warnings(&self) -> Result<Vec<String>, Failure> {
        let (mut warnings, record) = (Vec::new(), self.study.record());
        let Evaluator { templates, robot, engine, .. } = &self.setup.evaluator;
        for (place, Template { task, .. }) in templates.iter().enumerate() {
            warnings.extend(
                self.setup.evaluator.cell.iter().filter_map(|cell| cell.remark(&task.name)),
            );
            let given = task.strategy.rule == StartRule::Given;
            if given
                && record.evaluations.is_empty()
                && let (_, trial) = nominal_start(task, robot, *engine, &NEVER)?
                && trial.outcome != Outcome::Inserted
            {
                let (name, ends) = (&task.name, outcome(trial.outcome));
                let (command, why) = mend(&record, self.study.dir(), place);
                warnings.push(format!(
                    "{name}: with the medium finger the nominal start ends with {ends}; {command} {why}"
                ));
            }
        }
        Ok(warnings)
    }

    /// Shows new measurements and warnings before the study starts.
    ///
    /// # Errors
    /// If the nominal start cannot be simulated.
    pub fn warn(&self, context: &Context<'_>) -> Result<(), Failure> {
        if self.new_measurements > 0 {
            let plural = if self.new_measurements == 1 { "" } else { "s" };
            context.note(&format!("{} new measurement{plural}", self.new_measurements));
        }
        let warnings = self.warnings()?;
        warnings.iter().for_each(|warning| context.note(&format!("warning: {warning}")));
        Ok(())
    }

    /// Runs the study to its end on the threads of this process, confirms the recommended design and writes
    /// the report.
    ///
    /// # Errors
    /// If a design cannot be simulated or a file cannot be written; if `stop` is set meanwhile.
    pub fn run(mut self, context: &Context<'_>) -> Result<Ended, Failure> {
        let pool = self.run.pool()?;
        let mut optimizer = self.optimizer()?;
        let log = ConfirmationLog::open(&self.study);
        let OpenStudy { study, setup, plan, cache, .. } = &mut self;
        let (stop, cache) = (context.stop, cache.as_ref());
        let evaluator = simulated((setup, cache), plan, stop);
        let stagnates = |study: &Study, told: usize| {
            with_confirmer((setup, cache), study, &pool, context, |confirmer| {
                confirmer.stagnates(study, &log, told)
            })
        };
        let runner = Runner { evaluator: &evaluator, pool: &pool, stop, stagnates: &stagnates };
        let mut progress = |recorded: &_| context.evaluated(recorded);
        let ended = runner.run(study, &mut *optimizer, &mut progress);
        if let Some(problem) = cache.and_then(Cache::problem) {
            let what = "evaluations are not stored for other studies";
            context.note(&format!("warning: {what}: {problem}"));
        }
        let ending = ended.map_err(|error| hint(error, study))?;
        self.conclude(ending, &log, &pool, context)
    }

    /// Confirms the recommended design of a study that has ended and writes its report.
    pub(super) fn conclude(
        &mut self,
        ending: Ending,
        log: &ConfirmationLog,
        pool: &ThreadPool,
        context: &Context<'_>,
    ) -> Result<Ended, Failure> {
        let stop = context.stop;
        let known = self.cache.as_ref().map_or(0, Cache::found);
        let OpenStudy { study, setup, run, cache, .. } = self;
        let interrupted = || ending == Ending::Interrupted || stop.load(Ordering::SeqCst);
        let settled = ending == Ending::Settled;
        if ending != Ending::Interrupted && (settled || !study.config.conclusion.no_confirm) {
            let known = (&*setup, cache.as_ref());
            with_confirmer(known, study, pool, context, |it| it.confirm(study, log, settled))
                .map_err(|error| hint(error, study))?;
        }
        study.check_journal()?;
        if !interrupted() {
            let predicted = on_bench::predict((study, setup), run, pool, context);
            // After cancellation the report is written all the same.
            predicted.or_else(|failure| if interrupted() { Ok(()) } else { Err(failure) })?;
        }
        let (dir, record) = (study.dir().to_owned(), study.record());
        let answer = Answer::of(&record);
        if !interrupted() {
            film::boundary(&dir, &answer, setup, pool, stop)?;
        }
        printable::write(&dir, &answer, &setup.evaluator)?;
        // Before the page, which shows its picture.
        let unusable = match interrupted() {
            true => None,
            false => unusable::check(&dir, &record, setup, stop).err(),
        };
        report::write(&dir, &answer, &setup.evaluator.surrogate)?;
        if interrupted() {
            return Err(Failure::Interrupted(Some(resume_hint(study))));
        }
        Ok(Ended { dir, record, ending, known, unusable, run: run.clone() })
    }
}

/// Returns the evaluator of a study's designs with its cache.
pub(super) fn simulated<'a>(
    (setup, cache): (&'a Setup, Option<&'a Cache>),
    plan: &'a Plan,
    stop: &'a AtomicBool,
) -> Simulated<'a> {
    let (evaluator, search) = (&setup.evaluator, Search::default());
    Simulated { evaluator, search, plan, cache, stop }
}

/// Calls `what` with the confirmer of a study.
pub(super) fn with_confirmer<T>(
    (setup, cache): (&Setup, Option<&Cache>),
    study: &Study,
    pool: &ThreadPool,
    context: &Context<'_>,
    what: impl FnOnce(&Confirmer) -> T,
) -> T {
    let done = |phase, recorded: &Recorded, [done, of]: [usize; 2]| {
        let (word, cost) = match phase {
            Confirmed::Repeated => ("confirming", cost::REPEATED),
            Confirmed::Walked => ("walking", cost::WALKED),
        };
        let what = format!("{word} {}", short(recorded));
        context.part(&Part { what, done, of, cost });
    };
    let (stop, no_confirm) = (context.stop, study.config.conclusion.no_confirm);
    let (evaluator, search, plan) = (&setup.evaluator, Search::Walk, &Plan::WINDOW);
    let walker = &Simulated { evaluator, search, plan, cache, stop };
    let by_ribs = setup.by_ribs();
    let by_ribs = by_ribs.as_ref();
    what(&Confirmer { walker, by_ribs, evaluator, pool, stop, no_confirm, done: &done })
}

/// Returns the parameters of a design, `10 %, 26°`, or its number if there are more than two.
fn short(recorded: &Recorded) -> String {
    let value = |(key, value): (&String, &f64)| format!("{value}{}", label(key).1);
    match recorded.design.0.len() {
        ..=2 => recorded.design.0.iter().map(value).collect::<Vec<_>>().join(", "),
        _ => format!("evaluation {}", recorded.index),
    }
}

/// Checks that `study.toml` agrees with the input files in the folder.
fn check(config: &StudyConfig, setup: &Setup) -> Result<(), Failure> {
    let evaluator = &setup.evaluator;
    let tasks = evaluator.templates.iter().map(|template| template.task.name.as_str());
    let uncertainty = setup.uncertainty.as_ref().map(|errors| &errors.name);
    for (key, same) in [
        ("tasks", tasks.eq(config.tasks())),
        ("robot", evaluator.robot.name == config.robot),
        ("uncertainty", uncertainty == config.uncertainty.as_ref()),
        ("space", setup.space == config.space),
    ] {
        if !same {
            return Err(bad_config(format!(
                "{key}: differs from the input files in the folder; restore the file from a copy"
            )));
        }
    }
    Ok(())
}

/// Adds how to resume the study to an error, unless the journal was changed.
pub(super) fn hint(error: StudyError, study: &Study) -> Failure {
    let changed = matches!(error, StudyError::Interfered { .. });
    match Failure::from(error) {
        Failure::Run(error) if !changed => {
            Failure::running(format!("{error}\n{}", resume_hint(study)))
        }
        other => other,
    }
}

/// Returns the progress of a study and how to resume it.
pub(super) fn resume_hint(study: &Study) -> String {
    let (done, dir) = (study.config.counted(study.evaluations.len()), study.dir().display());
    format!("{done} are safe; continue with: optimize resume {dir}")
}
