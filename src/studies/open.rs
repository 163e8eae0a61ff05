//! A study that is open: measured on the threads of this process, or guided from outside.

use super::{film, on_bench, optimizer, printable, report, unusable};
use crate::context::Context;
use crate::failure::{Failure, bad_config};
use crate::progress::{Part, cost};
use crate::setup::Setup;
use crate::setup::run::RunRequest;
use crate::setup::task::nominal_start;
use ::report::answer::command::mend;
use ::report::answer::words::outcome;
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
use std::sync::atomic::Ordering;
use study::{
    Cache, Confirmed, Confirmer, Ending, Kept, Recorded, Runner, Simulated, Study, StudyConfig,
    StudyError, StudyRecord,
};

/// A study that is open; no other process can open it meanwhile.
pub struct OpenStudy {
    pub(crate) study: Study,
    pub(crate) setup: Setup,
    pub(crate) how: RunRequest,
    /// Plan of the measurements beside the window.
    pub(crate) plan: Plan,
    pub(crate) cache: Option<Cache>,
    /// Lines of measurement on its task that it has not seen before.
    pub new_measurements: usize,
}

/// A study that has ended.
pub struct Ended {
    /// Its folder.
    pub dir: PathBuf,
    /// Record of its measurements.
    pub record: StudyRecord,
    /// How it ended.
    pub ending: Ending,
    /// Evaluations that were known from other studies.
    pub known: u64,
    /// Why it is of no use, if no design inserts at the nominal start.
    pub unusable: Option<Failure>,
    pub(crate) how: RunRequest,
}

impl OpenStudy {
    pub(crate) fn new(mut study: Study, setup: Setup, how: RunRequest) -> Result<Self, Failure> {
        check(&study.config, &setup)?;
        // Folders up to version 0.4.0 have it with the prediction only.
        let predicted = || study.record().on_bench.map(|found| found.effort);
        let known = study.config.conclusion.bench.or_else(predicted);
        study.conclude_by(how.conclusion(&setup, known)?)?;
        let goals = study.config.goals();
        let plan = setup.plan(study.config.seed, |measure| goals.need(measure))?;
        let cache = how.cache(&setup)?;
        Ok(OpenStudy { study, setup, how, plan, cache, new_measurements: 0 })
    }

    /// The study as it stands.
    pub fn study(&self) -> &Study {
        &self.study
    }

    /// A line for each task whose nominal start, not taught, fails with the middle one of the measured
    /// fingers; nothing of a study that has begun.
    ///
    /// # Errors
    /// If that cannot be simulated.
    pub fn warnings(&self) -> Result<Vec<String>, Failure> {
        let (mut warnings, record) = (Vec::new(), self.study.record());
        let Evaluator { templates, robot, engine, .. } = &self.setup.evaluator;
        for (place, Template { task, .. }) in templates.iter().enumerate() {
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

    /// Writes what is to be known of the study before it starts.
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

    /// Runs the study until its budget is spent, confirms and writes the report.
    ///
    /// # Errors
    /// If a design cannot be simulated or a file cannot be written; if `stop` is set meanwhile.
    pub fn run(mut self, context: &Context<'_>) -> Result<Ended, Failure> {
        let pool = self.how.pool()?;
        let mut optimizer = optimizer::optimizer(&self.setup, &self.study.config)?;
        let evaluator = Simulated {
            evaluator: &self.setup.evaluator,
            search: Search::default(),
            plan: &self.plan,
            cache: self.cache.as_ref(),
            stop: context.stop,
        };
        let kept = Kept::read(&self.study);
        let no_confirm = self.study.config.conclusion.no_confirm;
        let judge = |study: &Study, told: usize| {
            let known = (&self.setup, self.cache.as_ref());
            confirmer(known, no_confirm, &pool, context, |it| it.judge(study, &kept, told))
        };
        let stop = context.stop;
        let runner = Runner { evaluator: &evaluator, pool: &pool, stop, judge: &judge };
        let mut measured = |recorded: &_| context.evaluated(recorded);
        let ended = runner.run(&mut self.study, &mut *optimizer, &mut measured);
        if let Some(problem) = self.cache.as_ref().and_then(Cache::problem) {
            context
                .note(&format!("warning: evaluations are not kept for other studies: {problem}"));
        }
        let ending = ended.map_err(|error| hint(error, &self.study))?;
        self.conclude(ending, &kept, &pool, context)
    }

    /// Confirms what is recommended and writes the report of a study that has ended so.
    pub(crate) fn conclude(
        &mut self,
        ending: Ending,
        kept: &Kept,
        pool: &ThreadPool,
        context: &Context<'_>,
    ) -> Result<Ended, Failure> {
        let stop = context.stop;
        let known = self.cache.as_ref().map_or(0, Cache::found);
        let OpenStudy { study, setup, how, cache, .. } = self;
        let no_confirm = study.config.conclusion.no_confirm;
        let interrupted = || ending == Ending::Interrupted || stop.load(Ordering::SeqCst);
        let settled = ending == Ending::Settled;
        if ending != Ending::Interrupted && (settled || !no_confirm) {
            let known = (&*setup, cache.as_ref());
            confirmer(known, no_confirm, pool, context, |it| it.confirm(study, kept, settled))
                .map_err(|error| hint(error, study))?;
        }
        study.check_journal()?;
        if !interrupted() {
            let predicted = on_bench::predict((study, setup), how, pool, context);
            // Interrupted, it says nothing; the report is written all the same.
            predicted.or_else(|failure| if interrupted() { Ok(()) } else { Err(failure) })?;
        }
        let (dir, record) = (study.dir().to_owned(), study.record());
        if !interrupted() {
            film::boundary(&dir, &record, setup, pool, stop)?;
        }
        printable::write(&dir, &record, &setup.evaluator)?;
        // Before the page, which shows its picture.
        let unusable = match interrupted() {
            true => None,
            false => unusable::check(&dir, &record, setup, stop).err(),
        };
        report::write(&dir, &record, &setup.evaluator.surrogate)?;
        if interrupted() {
            return Err(Failure::Interrupted(Some(resume_hint(study))));
        }
        Ok(Ended { dir, record, ending, known, unusable, how: how.clone() })
    }
}

/// Calls `what` with the confirmer of this setup.
pub(crate) fn confirmer<T>(
    (setup, cache): (&Setup, Option<&Cache>),
    no_confirm: bool,
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
    let stop = context.stop;
    let (evaluator, search, plan) = (&setup.evaluator, Search::Walk, &Plan::WINDOW);
    let walker = Simulated { evaluator, search, plan, cache, stop };
    let by_ribs = setup.by_ribs();
    let (walker, by_ribs) = (&walker, by_ribs.as_ref());
    what(&Confirmer { walker, by_ribs, evaluator, pool, stop, no_confirm, done: &done })
}

/// A design in few letters: `10 %, 26°`, of many parameters the number of its evaluation.
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
                "{key}: is not what the input files in the folder say; restore the file from a copy"
            )));
        }
    }
    Ok(())
}

/// The failure, and how to go on after it where the journal is as it was written.
pub(crate) fn hint(error: StudyError, study: &Study) -> Failure {
    let lost = matches!(error, StudyError::Interfered { .. });
    match Failure::from(error) {
        Failure::Run(error) if !lost => {
            Failure::running(format!("{error}\n{}", resume_hint(study)))
        }
        other => other,
    }
}

/// How far a study is, and how to go on.
pub(crate) fn resume_hint(study: &Study) -> String {
    let (done, dir) = (study.config.counted(study.evaluations.len()), study.dir().display());
    format!("{done} are safe; continue with: optimize resume {dir}")
}
