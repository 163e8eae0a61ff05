//! A study whose designs are measured by somebody else: a process pool, a cluster. It says
//! what is to be measured, checks what comes back, and writes the journal.

use super::open::{Ended, OpenStudy, confirmer, hint, resume_hint};
use super::optimizer;
use super::standing::Standing;
use crate::context::Context;
use crate::context::not_stopped;
use crate::failure::Failure;
use crate::setup::Setup;
use ask_tell::Optimizer;
use insertion::evaluation::evaluator::Evaluate;
use insertion::evaluation::objective::Measure;
use insertion::evaluation::tolerance::Search;
use insertion::trial::NEVER;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};
use study::{
    Arrived, Course, Ending, Kept, Next, Simulated, StudyError, Timing, Wanted, Work, WorkError,
};

/// An open study and what is out.
pub struct Guided {
    open: OpenStudy,
    optimizer: Box<dyn Optimizer + Send>,
    course: Course,
    /// Work being measured, by the number of its proposal.
    measuring: BTreeMap<u64, Work>,
    standing: Standing,
    /// Confirmations.
    kept: Kept,
}

/// Next step.
pub enum Order {
    /// Let these be measured: number of the proposal, and the bytes for [`perform`].
    Measure(Vec<(u64, Vec<u8>)>),
    /// Wait for a result.
    Wait,
    /// [Finish](Guided::finish).
    Finish(Ending),
}

/// Why a result was not taken.
pub enum NotTaken {
    /// It is not believed; the work may be done again.
    Refused(WorkError),
    /// The study cannot go on.
    Failed(Failure),
}

impl Guided {
    /// Returns an open study whose measuring the caller does.
    ///
    /// # Errors
    /// If the optimizer cannot be made.
    pub fn new(open: OpenStudy) -> Result<Self, Failure> {
        let optimizer = optimizer::optimizer(&open.setup, &open.study.config)?;
        let (course, standing) = (Course::new(&open.study), Standing::new(&open.study));
        let kept = Kept::read(&open.study);
        Ok(Guided { open, optimizer, course, measuring: BTreeMap::new(), standing, kept })
    }

    /// Next step. Designs that the cache knows are taken from there.
    ///
    /// # Errors
    /// If the journal holds other designs than are proposed, or cannot be written.
    pub fn order(&mut self, stop: &AtomicBool) -> Result<Order, Failure> {
        loop {
            let wanted = match self.course.next(&self.open.study, &mut *self.optimizer)? {
                Next::Wait => return Ok(Order::Wait),
                Next::Ended(ending) => return Ok(Order::Finish(ending)),
                Next::Judge(told) => {
                    self.judge(told, stop)?;
                    continue;
                }
                Next::Measure(wanted) => wanted,
            };
            let mut unknown = Vec::new();
            for wanted in wanted {
                if !self.recall(&wanted)? {
                    unknown.push(self.give(wanted)?);
                }
            }
            if !unknown.is_empty() {
                return Ok(Order::Measure(unknown));
            }
        }
    }

    /// Judges on the threads of this process whether a gain is expected.
    fn judge(&mut self, told: usize, stop: &AtomicBool) -> Result<(), Failure> {
        let OpenStudy { study, setup, how, cache, .. } = &self.open;
        let pool = how.pool()?;
        let no_confirm = study.config.conclusion.no_confirm;
        let known = (setup, cache.as_ref());
        let calm = confirmer(known, no_confirm, &pool, &Context::silent(stop), |it| {
            it.judge(study, &self.kept, told)
        })?;
        not_stopped(stop)?;
        self.course.judged(calm);
        Ok(())
    }

    /// Takes a design's evaluation from the cache; false if it is not there.
    fn recall(&mut self, wanted: &Wanted) -> Result<bool, Failure> {
        let (known, timing) =
            Timing::of(|| self.simulated(&NEVER).known(&wanted.design, wanted.race.as_ref()));
        let Some(measured) = known else { return Ok(false) };
        let timing = Timing { cached: measured.cached.clone(), ..timing };
        self.accept(Arrived { proposal: wanted.proposal, measured, timing })
    }

    fn give(&mut self, wanted: Wanted) -> Result<(u64, Vec<u8>), Failure> {
        let Wanted { proposal, design, race } = wanted;
        let OpenStudy { study, setup, .. } = &self.open;
        let goals = study.config.goals();
        let work = Work {
            proposal,
            design,
            seed: study.config.seed,
            success_rate: goals.need(Measure::SuccessRate),
            robust_range: goals.need(Measure::RobustRange),
            race,
            tasks: study.config.tasks.len() as u64,
            provenance: study.provenance().clone(),
            inputs: setup.inputs.clone(),
        };
        let bytes = work.encode().map_err(|error| Failure::running(error.to_string()))?;
        self.measuring.insert(proposal, work);
        Ok((proposal, bytes))
    }

    fn simulated<'a>(&'a self, stop: &'a AtomicBool) -> Simulated<'a> {
        let OpenStudy { setup, plan, cache, .. } = &self.open;
        let (evaluator, cache) = (&setup.evaluator, cache.as_ref());
        Simulated { evaluator, search: Search::default(), plan, cache, stop }
    }

    /// Takes in the result of a proposal; false if it is not awaited (it came before).
    ///
    /// # Errors
    /// If the result cannot be one of this work, or the journal cannot be written.
    pub fn take(&mut self, proposal: u64, result: &[u8]) -> Result<bool, NotTaken> {
        let Some(work) = self.measuring.get(&proposal) else { return Ok(false) };
        let impossible = |error| NotTaken::Failed(Failure::input(error));
        let stiffness = self.open.setup.evaluator.predict(&work.design).map_err(impossible)?;
        let arrived = work.check(result, &stiffness).map_err(NotTaken::Refused)?;
        self.simulated(&NEVER).keep(&work.design, work.race.as_ref(), &arrived.measured);
        let taken = self.accept(arrived).map_err(NotTaken::Failed)?;
        self.measuring.remove(&proposal);
        Ok(taken)
    }

    fn accept(&mut self, arrived: Arrived) -> Result<bool, Failure> {
        let (standing, study) = (&mut self.standing, &mut self.open.study);
        let mut see = |recorded: &_| standing.add(recorded);
        let taken = self.course.take(study, arrived, &mut see);
        taken.map_err(|error| hint(study.rescue(error), study))
    }

    /// Evaluations written, as many as are expected in all, and the best so far in words.
    pub fn progress(&self) -> (usize, u64, String) {
        let study = &self.open.study;
        let done = study.evaluations.len();
        let expected = study.config.expected_evaluations().max(done as u64);
        (done, expected, self.standing.best())
    }

    /// How to go on with the study.
    pub fn hint(&self) -> String {
        resume_hint(&self.open.study)
    }

    /// Confirms what is recommended on the threads of this process, and writes tables and report.
    pub fn finish(&mut self, ending: Ending, stop: &AtomicBool) -> Result<Ended, Failure> {
        let pool = self.open.how.pool()?;
        self.open.conclude(ending, &self.kept, &pool, &Context::silent(stop))
    }

    /// How many threads measure if nobody else does; 0 for one per processor.
    pub fn threads(&self) -> usize {
        self.open.how.threads()
    }
}

/// Last setup, by the bytes that name it: one worker measures many designs of one study.
static LAST: Mutex<Option<(Value, Arc<Setup>)>> = Mutex::new(None);

fn set_up(work: &Work) -> Result<Arc<Setup>, Failure> {
    let name = json!([work.inputs, work.provenance.engine.name]);
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((known, setup)) = &*last
        && *known == name
    {
        return Ok(Arc::clone(setup));
    }
    let setup = Arc::new(Setup::from_inputs(&work.inputs, &work.provenance.engine.name)?);
    *last = Some((name, Arc::clone(&setup)));
    Ok(setup)
}

/// The unit of work: what a [`Guided`] study gave out in, the result for it out. Depends on
/// nothing else, so it may be done twice. `worker` is the host and process that does it.
///
/// # Errors
/// If the bytes are no work, this program is not the one that the study wants, or the design
/// cannot be simulated; if `stop` is set meanwhile.
pub fn perform(bytes: &[u8], worker: &str, stop: &AtomicBool) -> Result<Vec<u8>, Failure> {
    // One thread: whoever calls has as many workers as there are processors. And a new one: a
    // process that was forked has not the threads of the pool that all share.
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let alone =
        alone.map_err(|error| Failure::running(format!("cannot start a thread: {error}")))?;
    alone.install(|| {
        let work = Work::decode(bytes).map_err(Failure::input)?;
        let setup = set_up(&work)?;
        work.admit(&setup.provenance(), worker).map_err(Failure::input)?;
        let plan = setup.plan(work.seed, |measure| match measure {
            Measure::SuccessRate => work.success_rate,
            Measure::RobustRange => work.robust_range,
            _ => false,
        })?;
        let (evaluator, search) = (&setup.evaluator, Search::default());
        let simulated = Simulated { evaluator, search, plan: &plan, cache: None, stop };
        let (measured, timing) = Timing::of(|| match &work.race {
            Some(race) => simulated.race(&work.design, race),
            None => simulated.evaluate(&work.design),
        });
        let measured = measured.map_err(|source| {
            let (index, design) = (work.proposal, work.design.to_string());
            StudyError::Impossible { index, design, source }
        })?;
        not_stopped(stop)?;
        work.done(measured, &timing, worker).map_err(|error| Failure::running(error.to_string()))
    })
}
