//! Answer of a study, found once from its record: terminal, page, JSON and Python say it, and
//! compute nothing of their own. Lengths in mm, forces in N.

mod alike;
pub mod command;
pub mod lines;
mod recommended;
mod robots;
mod start;
mod trust;
mod verdict;
pub mod words;

use calibration::order::{Order, order_on_bench};
use insertion::evaluation::Evaluation;
use insertion::evaluation::objective::Measure;
use insertion::evaluation::robustness::firm::Firm;
use insertion::space::Design;
use study::{Recorded, StudyRecord, Volume, Walked, nearest, volume};

pub use alike::{AsGood, Safe, Spread};
pub use recommended::{OnTask, Recommended};
pub use robots::UnderRobot;
pub use start::Start;
pub use trust::{Measured, Trust};
pub use verdict::{Verdict, expectation};

/// The answer of a study.
#[derive(Debug, Clone)]
pub struct Answer<'a> {
    /// The study.
    pub record: &'a StudyRecord,
    /// What to do.
    pub verdict: Verdict<'a>,
    /// How far to trust it.
    pub trust: Trust,
    /// Designs that count: the evaluations of the present model.
    pub designs: usize,
    /// Number of them that keep all constraints and have a value.
    pub feasible: usize,
    /// The recommended design, or of a front its first; `None` if none has a value and keeps all
    /// constraints.
    pub recommended: Option<Recommended<'a>>,
    /// The design that violates the constraints least, and each constraint with its value, in
    /// words; `None` if none has values.
    pub nearest: Option<(&'a Recorded, Vec<String>)>,
    /// The designs that were walked, step by step, and repeated at their ends, best first; each with
    /// its firm range, mm, aggregated over the tasks.
    pub walked: Vec<(&'a Recorded, f64)>,
    /// Front of several objectives, to choose from; `None` for a single one.
    pub front: Option<Front<'a>>,
    /// The smallest and the largest range of the designs, mm; `None` if none has a range.
    pub spread_mm: Option<[f64; 2]>,
    /// The fingers that were measured on a robot: those given to the study, else the published ones;
    /// none of several tasks.
    pub measured: Vec<Measured>,
    /// How our simulation orders fingers on the bench, for the tasks of which that is known.
    pub orders: Vec<(&'a str, Order)>,
}

/// Designs none of which is at least as good as another in all objectives.
#[derive(Debug, Clone)]
pub struct Front<'a> {
    /// The designs, best in the first objective first.
    pub designs: Vec<&'a Recorded>,
    /// Volume that they dominate.
    pub volume: Volume,
}

impl<'a> Answer<'a> {
    /// The answer of a study as it stands.
    pub fn of(record: &'a StudyRecord) -> Self {
        let (config, current) = (&record.config, record.current());
        let front = || Front { designs: record.front(), volume: volume(&config.goals(), current) };
        let walked = |walked: &'a Walked| {
            let firm: Vec<f64> = walked.firm.iter().map(Firm::range_mm).collect();
            (&walked.recorded, record.aggregated(Measure::Range, &firm))
        };
        let order = |(at, task)| Some((task, order_on_bench(record, at)?));
        let measured = measured(record);
        let recommended = Recommended::of(record, &measured);
        let mut answer = Answer {
            record,
            verdict: Verdict::NoneFeasible,
            trust: Trust::of(record, None),
            designs: current.len(),
            feasible: current.iter().filter(|recorded| recorded.feasible().is_some()).count(),
            recommended,
            nearest: nearest(current).map(|design| {
                let words = config.constraints.iter().map(|c| c.words(&design.tasks()));
                (design, words.collect())
            }),
            walked: record.walked.iter().map(walked).collect(),
            front: config.objective.single().is_none().then(front),
            spread_mm: record.spread_mm(),
            measured,
            orders: config.tasks().enumerate().filter_map(order).collect(),
        };
        answer.verdict = Verdict::of(&answer, &answer.measured);
        answer.trust = Trust::of(record, answer.named());
        answer
    }

    /// The evaluation of the finger that the verdict names, or would without measurements; `None` if
    /// there is none to print.
    pub fn named(&self) -> Option<&'a Recorded> {
        let found = self.recommended.as_ref()?;
        match (&self.verdict, &found.as_good) {
            (Verdict::NothingInserts { .. } | Verdict::NoneFeasible, _) => None,
            (Verdict::Any { .. }, Some(AsGood { safe: Some(safe), .. })) => Some(safe.design),
            _ => Some(found.design),
        }
    }

    /// The finger that the verdict names, and what simulation finds of it on each task; `None` if it
    /// names none.
    pub fn shown(&self) -> Option<(&'a Design, Vec<&'a Evaluation>)> {
        let finger = self.verdict.finger()?;
        match &self.record.on_bench {
            Some(bench) => Some((finger, vec![&bench.simulated])),
            None => self.named().map(|named| (finger, named.tasks())),
        }
    }
}

/// The fingers that were measured on a robot: those given to the study, else the published ones.
fn measured(record: &StudyRecord) -> Vec<Measured> {
    let given = record.on_bench.as_ref().map(|found| {
        let ranges = found.ranges.iter();
        ranges.map(|(design, range_mm)| Measured { design: design.clone(), range_mm: *range_mm })
    });
    match (given, &record.config.tasks[..]) {
        (Some(given), _) => given.collect(),
        (None, [task]) => trust::published(task).into_iter().map(|(found, _)| found).collect(),
        (None, _) => Vec::new(),
    }
}
