//! Open studies, and the run of a study on the threads of this process.

use super::optimizer::optimizer;
use super::{film, on_bench, printable, report, unusable};
use crate::progress::cost;
use crate::setup::task::{nominal_start, nominal_warnings};
use crate::{Context, Failure, RunRequest, Setup};
use ::report::answer::Answer;
use ::report::answer::command::repair;
use ::report::answer::words::outcome;
use input::files::shell_word;
use insertion::outcome::stop_words;
use insertion::trial::NEVER;
use insertion::{Evaluator, Outcome, Plan, Search, StartRule, Template};
use parameters::label;
use rayon::ThreadPool;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use study::{
    Cache, CachedEvaluator, ConfirmationLog, ConfirmationStep, Confirmer, Ending, ROBOT_STOP_FILE,
    Recorded, Runner, Study, StudyError, StudyRecord, write_analysis,
};

/// Open study, locked against other processes.
pub struct OpenStudy {
    pub(crate) study: Study,
    pub(crate) setup: Setup,
    pub(crate) run: RunRequest,
    /// Plan of the trials under drawn errors.
    pub(crate) plan: Plan,
    pub(crate) cache: Option<Cache>,
    /// Number of bench measurements of its task that are new since its last run.
    pub new_measurements: usize,
}

/// Study that has ended.
pub struct Ended {
    /// Folder of the study.
    pub dir: PathBuf,
    /// Record of its evaluations.
    pub record: StudyRecord,
    /// Reason for which it ended.
    pub ending: Ending,
    /// Number of evaluations read from the cache.
    pub cached: u64,
    /// Error if no design inserts at the nominal start.
    pub unusable: Option<Failure>,
    pub(crate) run: RunRequest,
}

impl OpenStudy {
    pub(crate) fn new(mut study: Study, setup: Setup, run: RunRequest) -> Result<Self, Failure> {
        let before = &study.config.conclusion;
        let mut conclusion = run.analyses(&setup, before.bench);
        conclusion.project = conclusion.project.or_else(|| before.project.clone());
        study.set_analyses(conclusion)?;
        let plan = setup.plan(study.config.seed, study.config.goals().needs_draws())?;
        let cache = run.cache(&setup);
        Ok(OpenStudy { study, setup, run, plan, cache, new_measurements: 0 })
    }

    /// Shows the number of new measurements, and a warning for each task to which a part of the cell does not
    /// apply. Before the first evaluation, it also warns of each nominal start of a task file that fails with a
    /// finger of medium stiffness or stops the robot, and of a weak grip.
    ///
    /// # Errors
    /// If the nominal start cannot be simulated.
    pub fn warn(&self, context: &Context<'_>) -> Result<(), Failure> {
        if self.new_measurements > 0 {
            context.note(&input::counted(self.new_measurements, "new measurement"));
        }
        let record = self.study.record();
        let warn = |text: &str| context.note(&format!("warning: {text}"));
        let Evaluator { templates, robot, engine, cell, .. } = &self.setup.evaluator;
        for (place, Template { task, .. }) in templates.iter().enumerate() {
            let remark = cell.as_ref().and_then(|cell| cell.remark(&task.name));
            remark.iter().for_each(|remark| warn(remark));
            if task.strategy.rule == StartRule::Taught || !record.evaluations.is_empty() {
                continue;
            }
            let (_, trial) = nominal_start(task, robot, *engine, &NEVER)?;
            let name = &task.name;
            for text in nominal_warnings(task, &trial, robot) {
                warn(&format!("{name}: with the medium finger: {text}"));
            }
            if trial.outcome != Outcome::Inserted {
                let ends = outcome(trial.outcome) + stop_words(trial.robot_stopped);
                let (command, why) = repair(&record, self.study.dir(), place);
                warn(&format!(
                    "{name}: with the medium finger the nominal start ends with {ends}; try `{command}` to {why}"
                ));
            }
        }
        Ok(())
    }

    /// Runs the study to its end on the threads of this process, confirms the recommended design and writes
    /// the report.
    ///
    /// # Errors
    /// If a design cannot be simulated or a file cannot be written; if `stop` is set meanwhile.
    pub fn run(mut self, context: &Context<'_>) -> Result<Ended, Failure> {
        let pool = self.run.pool()?;
        let mut optimizer = optimizer(&self.setup, &self.study.config)?;
        let mut log = ConfirmationLog::open(&self.study);
        let OpenStudy { study, setup, plan, cache, .. } = &mut self;
        let cache = cache.as_ref();
        let evaluator = &cached_evaluator(setup, cache, plan, context.stop);
        let confirmer = || confirmer(setup, cache, &pool, context);
        let mut stagnates = |study: &_, told| confirmer().stagnates(study, &mut log, told);
        let runner = Runner { evaluator, pool: &pool, stop: context.stop };
        let mut progress = |recorded: &_| context.evaluated(recorded);
        let ended = runner.run(study, &mut *optimizer, &mut stagnates, &mut progress);
        if let Some(problem) = cache.and_then(Cache::problem) {
            let what = "evaluations are not stored for other studies";
            context.note(&format!("warning: {what}: {problem}"));
        }
        let ending = ended.map_err(|error| hint(error, study))?;
        self.conclude(ending, &mut log, &pool, context)
    }

    /// Confirms the recommended design of a study that has ended and writes its report.
    pub(super) fn conclude(
        &mut self,
        ending: Ending,
        log: &mut ConfirmationLog,
        pool: &ThreadPool,
        context: &Context<'_>,
    ) -> Result<Ended, Failure> {
        let stop = context.stop;
        let cached = self.cache.as_ref().map_or(0, Cache::hits);
        let OpenStudy { study, setup, run, cache, .. } = self;
        let interrupted = || ending == Ending::Interrupted || stop.load(Ordering::SeqCst);
        let settled = ending == Ending::Settled;
        if ending != Ending::Interrupted && (settled || !study.config.conclusion.no_confirm) {
            let confirmer = confirmer(setup, cache.as_ref(), pool, context);
            confirmer.confirm(study, log, settled).map_err(|error| hint(error, study))?;
        }
        study.check_journal()?;
        if !interrupted() {
            let predicted = on_bench::predict((study, setup), run, pool, context);
            // After cancellation the report is still written.
            predicted.or_else(|failure| if interrupted() { Ok(()) } else { Err(failure) })?;
        }
        let (dir, mut record) = (study.dir().to_owned(), study.record());
        // An error is that of `unusable::check`, too.
        record.robot_stop = unusable::robot_stop(&record, setup, stop).unwrap_or_default();
        if record.robot_stop.is_some() {
            write_analysis(&dir, ROBOT_STOP_FILE, &record.robot_stop)?;
        }
        let answer = Answer::of(&record);
        if !interrupted() {
            film::boundary(&dir, &answer, setup, pool, stop)?;
        }
        printable::write(&dir, &answer, &setup.evaluator)?;
        // Before the report page, which shows the picture of the failed trial.
        let problem = || unusable::check(&dir, &record, setup, stop).err();
        let unusable = if interrupted() { None } else { problem() };
        report::write(&dir, &answer)?;
        if interrupted() {
            return Err(Failure::Interrupted(Some(resume_hint(study))));
        }
        Ok(Ended { dir, record, ending, cached, unusable, run: run.clone() })
    }
}

/// Returns the evaluator of a study's designs with its cache.
pub(super) fn cached_evaluator<'a>(
    setup: &'a Setup,
    cache: Option<&'a Cache>,
    plan: &'a Plan,
    stop: &'a AtomicBool,
) -> CachedEvaluator<'a> {
    let (evaluator, search) = (&setup.evaluator, Search::default());
    CachedEvaluator { evaluator, search, plan, cache, stop }
}

/// Returns the confirmer of a study's best designs.
pub(super) fn confirmer<'a>(
    setup: &'a Setup,
    cache: Option<&'a Cache>,
    pool: &'a ThreadPool,
    context: &'a Context<'_>,
) -> Confirmer<'a> {
    let done = move |phase, recorded: &Recorded, done_of: [usize; 2]| {
        let (word, cost) = match phase {
            ConfirmationStep::Repeated => ("confirming", cost::REPEATED),
            ConfirmationStep::Walked => ("walking", cost::WALKED),
        };
        context.part(&format!("{word} {}", short(recorded)), done_of, cost);
    };
    let walker = cached_evaluator(setup, cache, &Plan::WINDOW, context.stop);
    let walker = CachedEvaluator { search: Search::Walk, ..walker };
    Confirmer { walker, by_ribs: setup.by_ribs(), pool, done: Box::new(done) }
}

/// Returns the parameters of a design, `10 %, 26°`, or its number if there are more than two.
fn short(recorded: &Recorded) -> String {
    let value = |(key, value): (&String, &f64)| format!("{value}{}", label(key).1);
    match recorded.design.0.len() {
        ..=2 => recorded.design.0.iter().map(value).collect::<Vec<_>>().join(", "),
        _ => format!("evaluation {}", recorded.index),
    }
}

/// Adds the command that resumes the study to an error, unless the journal was changed.
pub(super) fn hint(error: StudyError, study: &Study) -> Failure {
    let changed = matches!(error, StudyError::JournalChanged { .. });
    match Failure::from(error) {
        Failure::Run(error) if !changed => {
            Failure::running(format!("{error}\n{}", resume_hint(study)))
        }
        other => other,
    }
}

/// Returns the progress of a study and the command that resumes it.
pub(super) fn resume_hint(study: &Study) -> String {
    let done = study.config.counted(study.evaluations.len());
    let dir = shell_word(study.dir().display());
    format!("{done} are safe; continue with: optimize resume {dir}")
}
