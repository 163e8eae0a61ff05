//! JSON output of a study.

use super::open::Ended;
use super::recommended::{advice, recommendation, values};
use insertion::evaluation::objective::{Aggregate, Constraint, Objectives};
use report::PostAnalysis;
use report::answer::{Answer, UnderRobot};
use serde::Serialize;
use serde_json::{Value, json};
use std::path::Path;
use study::{Ending, Recorded, Segment, StudyRecord};

/// Version of the output; raised when a key changes its meaning or is removed.
const SCHEMA_VERSION: u32 = 1;

#[derive(Serialize)]
struct Summary<'a> {
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
    ending: Ending,
    best: Option<Value>,
    #[serde(flatten)]
    recommendation: Value,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    walked: Vec<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    segments: Option<&'a [Segment]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    constraints: Option<&'a [Constraint]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    feasible: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    aggregate: Option<&'a Aggregate>,
    #[serde(flatten)]
    front: Option<Value>,
    answer: Value,
    levers: Option<Value>,
    maps: Vec<Value>,
    robots: &'a [UnderRobot],
    study: &'a Path,
}

/// Returns the output of a study as JSON.
pub fn summary(ended: &Ended, answer: &Answer, analyses: &PostAnalysis) -> Value {
    let record = answer.record;
    let config = &record.config;
    let evaluated = |recorded: &Recorded| evaluated(record, recorded);
    let walked = answer.walked.iter().map(|&(design, firm_range_mm)| {
        let mut walked = evaluated(design);
        walked["firm_range_mm"] = json!(firm_range_mm);
        walked
    });
    let front = answer.front.as_ref().map(|front| {
        let reference = front.volume.reference.iter().copied();
        json!({
            "front": front.designs.iter().map(|design| evaluated(design)).collect::<Vec<_>>(),
            "hypervolume": front.volume.hypervolume,
            "hypervolume_reference": values(&config.objective, reference),
        })
    });
    let levers = analyses.levers.as_ref().map(|levers| {
        let mut json = json!({"sentence": levers.sentence()});
        extend(&mut json, json!(levers));
        json
    });
    let maps = analyses.maps.iter().map(|map| {
        let axes = map.axes.each_ref().map(|axis| axis.name.as_ref());
        let axes: [&str; 2] = axes;
        json!({
            "axes": axes,
            "area": map.area,
            "area_unit": map.area_unit,
            "trials": map.trials,
        })
    });
    let constrained = !config.constraints.is_empty();
    json!(Summary {
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
        ending: ended.ending,
        best: record.best().filter(|_| answer.front.is_none()).map(evaluated),
        recommendation: recommendation(answer),
        walked: walked.collect(),
        segments: (record.segments.len() > 1).then_some(&record.segments[..]),
        constraints: constrained.then_some(&config.constraints[..]),
        feasible: constrained.then_some(answer.feasible),
        aggregate: config.aggregate.as_ref(),
        front,
        answer: advice(answer, &ended.dir),
        levers,
        maps: maps.collect(),
        robots: &analyses.robots,
        study: &ended.dir,
    })
}

/// Returns a design with all its measurements.
fn evaluated(record: &StudyRecord, recorded: &Recorded) -> Value {
    let config = &record.config;
    let mut json = json!({"evaluation": recorded.index, "stiffness": recorded.stiffness});
    if let Some(score) = &recorded.score {
        let values = values(&config.objective, score.values.iter().copied());
        extend(&mut json, values.into());
        if !score.violations.is_empty() {
            json["violations"] = json!(score.violations);
        }
    }
    extend(&mut json, json!(recorded.design));
    if !config.several_tasks() {
        extend(&mut json, json!(recorded.tasks.first()));
        return json;
    }
    let on_task = |(task, evaluation)| {
        let mut json = json!({"task": task});
        extend(&mut json, json!(evaluation));
        json
    };
    json["tasks"] = config.tasks().zip(&recorded.tasks).map(on_task).collect();
    json
}

/// Adds the fields of an object.
fn extend(json: &mut Value, more: Value) {
    if let (Value::Object(fields), Value::Object(more)) = (json, more) {
        fields.extend(more);
    }
}
