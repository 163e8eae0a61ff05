//! The result of a study for other programs.

use super::around::Around;
use super::open::Ended;
use super::recommended::{Advice, Recommendation};
use analysis::levers::Levers;
use analysis::map::CaptureMap;
use insertion::evaluation::Evaluation;
use insertion::evaluation::objective::{Aggregate, Constraint, Objectives};
use insertion::space::Design;
use insertion::surrogate::Prediction;
use report::answer::{Answer, UnderRobot};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use std::path::Path;
use study::{Ending, Recorded, Segment, StudyRecord};

/// Raised when a key changes its meaning or goes.
const SCHEMA_VERSION: u32 = 1;

/// Output of a study that has ended.
#[derive(Serialize)]
pub struct Summary<'a> {
    schema_version: u32,
    task: String,
    space: &'a str,
    robot: &'a str,
    engine: Option<&'a str>,
    optimizer: &'a str,
    objective: &'a Objectives,
    seed: u64,
    budget: u64,
    polish: u64,
    evaluations: usize,
    settled: bool,
    cached: u64,
    ending: &'a str,
    best: Option<Evaluated<'a>>,
    #[serde(flatten)]
    recommendation: Recommendation<'a>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    walked: Vec<Evaluated<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    segments: Option<&'a [Segment]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    constraints: Option<&'a [Constraint]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    feasible: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    aggregate: Option<&'a Aggregate>,
    #[serde(flatten)]
    front: Option<Front<'a>>,
    answer: Advice<'a>,
    levers: Option<OfLevers<'a>>,
    maps: Vec<OfMap<'a>>,
    robots: &'a [UnderRobot],
    study: &'a Path,
}

/// Designs none of which is better than another in all objectives.
#[derive(Serialize)]
struct Front<'a> {
    front: Vec<Evaluated<'a>>,
    hypervolume: f64,
    hypervolume_reference: Values,
}

/// A design with all that was measured of it.
#[derive(Serialize)]
struct Evaluated<'a> {
    evaluation: u64,
    stiffness: &'a Prediction,
    #[serde(flatten)]
    values: Option<Values>,
    #[serde(skip_serializing_if = "Option::is_none")]
    violations: Option<&'a [f64]>,
    #[serde(flatten)]
    design: &'a Design,
    #[serde(flatten)]
    one: Option<&'a Evaluation>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tasks: Option<Vec<OnTask<'a>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    firm_range_mm: Option<f64>,
}

#[derive(Serialize)]
struct OnTask<'a> {
    task: &'a str,
    #[serde(flatten)]
    evaluation: &'a Evaluation,
}

/// Values by the keys of their objectives, in their order.
struct Values(Vec<(String, f64)>);

impl Values {
    fn of(objectives: &Objectives, values: &[f64]) -> Self {
        let keys = objectives.keys().into_iter().map(|key| key.to_string());
        Values(keys.zip(values.iter().copied()).collect())
    }
}

impl Serialize for Values {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (key, value) in &self.0 {
            map.serialize_entry(key, value)?;
        }
        map.end()
    }
}

#[derive(Serialize)]
struct OfLevers<'a> {
    sentence: String,
    #[serde(flatten)]
    levers: &'a Levers,
}

#[derive(Serialize)]
struct OfMap<'a> {
    axes: [&'a str; 2],
    area: f64,
    area_unit: &'a str,
    trials: usize,
}

impl<'a> From<&'a CaptureMap> for OfMap<'a> {
    fn from(map: &'a CaptureMap) -> Self {
        let axes = map.axes.each_ref().map(|axis| axis.name.as_ref());
        OfMap { axes, area: map.area, area_unit: map.area_unit.as_ref(), trials: map.trials }
    }
}

impl<'a> Evaluated<'a> {
    fn new(record: &'a StudyRecord, recorded: &'a Recorded) -> Self {
        let config = &record.config;
        let several = config.several_tasks();
        let score = recorded.score.as_ref();
        let violations = score.map(|score| score.violations.as_slice());
        let tasks = || config.tasks().zip(recorded.tasks());
        Evaluated {
            evaluation: recorded.index,
            stiffness: &recorded.stiffness,
            values: score.map(|score| Values::of(&config.objective, &score.values)),
            violations: violations.filter(|violations| !violations.is_empty()),
            design: &recorded.design,
            one: recorded.tasks.first().filter(|_| !several),
            tasks: several
                .then(|| tasks().map(|(task, evaluation)| OnTask { task, evaluation }).collect()),
            firm_range_mm: None,
        }
    }
}

impl<'a> Summary<'a> {
    /// Returns the output of a study.
    pub fn new(ended: &'a Ended, answer: &'a Answer<'a>, around: &'a Around) -> Self {
        let record = answer.record;
        let config = &record.config;
        let evaluated = |recorded| Evaluated::new(record, recorded);
        let walked = answer.walked.iter().map(|&(design, firm_range_mm)| Evaluated {
            firm_range_mm: Some(firm_range_mm),
            ..evaluated(design)
        });
        let front = answer.front.as_ref().map(|front| Front {
            front: front.designs.iter().map(|design| evaluated(design)).collect(),
            hypervolume: front.volume.hypervolume,
            hypervolume_reference: Values::of(&config.objective, &front.volume.reference),
        });
        let constrained = !config.constraints.is_empty();
        let levers = around.levers.as_ref();
        Summary {
            schema_version: SCHEMA_VERSION,
            task: config.task_name(),
            space: &config.space.name,
            robot: &config.robot,
            engine: record.segments.last().map(|segment| &*segment.provenance.engine.name),
            optimizer: &config.optimizer,
            objective: &config.objective,
            seed: config.seed,
            budget: config.budget,
            polish: config.polish,
            evaluations: record.evaluations.len(),
            settled: record.settled,
            cached: ended.known,
            ending: word(ended.ending),
            best: record.best().filter(|_| answer.front.is_none()).map(evaluated),
            recommendation: Recommendation::of(answer),
            walked: walked.collect(),
            segments: (record.segments.len() > 1).then_some(&record.segments[..]),
            constraints: constrained.then_some(&config.constraints[..]),
            feasible: constrained.then_some(answer.feasible),
            aggregate: config.aggregate.as_ref(),
            front,
            answer: Advice::of(answer, &ended.dir),
            levers: levers.map(|levers| OfLevers { sentence: levers.sentence(), levers }),
            maps: around.maps.iter().map(OfMap::from).collect(),
            robots: &around.robots,
            study: &ended.dir,
        }
    }
}

/// Returns the word for the ending of a study.
pub fn word(ending: Ending) -> &'static str {
    match ending {
        Ending::BudgetSpent => "budget_spent",
        Ending::SpaceExhausted => "space_exhausted",
        Ending::Converged => "converged",
        Ending::Interrupted => "interrupted",
        Ending::Settled => "settled",
        Ending::NothingInserts => "nothing_inserts",
    }
}
