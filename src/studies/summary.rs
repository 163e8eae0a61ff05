//! JSON output of a study.

use super::open::Ended;
use super::recommended::{advice, recommendation, values};
use analysis::levers::Levers;
use report::PostAnalysis;
use report::answer::Answer;
use serde_json::{Value, json};
use study::{Recorded, StudyRecord};

/// Version of the output; raised when a key changes its meaning or is removed.
const SCHEMA_VERSION: u32 = 1;

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
    let maps = analyses.maps.iter().map(|map| {
        json!({
            "axes": map.axes.each_ref().map(|axis| &axis.name),
            "area": map.area,
            "area_unit": map.area_unit,
            "trials": map.trials,
        })
    });
    let best = record.best().filter(|_| answer.front.is_none());
    let mut json = json!({
        "schema_version": SCHEMA_VERSION,
        "task": config.task_name(),
        "space": config.space.name,
        "robot": config.robot,
        "engine": record.provenance().engine.name,
        "optimizer": config.optimizer,
        "objective": config.objective,
        "seed": config.seed,
        "budget": config.budget,
        "polish": config.polish,
        "evaluations": record.evaluations.len(),
        "settled": record.settled,
        "cached": ended.cached,
        "ending": ended.ending,
        "best": best.map(evaluated),
    });
    extend(&mut json, recommendation(answer));
    if !answer.walked.is_empty() {
        json["walked"] = walked.collect();
    }
    if record.segments.len() > 1 {
        json["segments"] = json!(record.segments);
    }
    if !config.constraints.is_empty() {
        json["constraints"] = json!(config.constraints);
        json["feasible"] = json!(answer.feasible);
    }
    if let Some(aggregate) = &config.aggregate {
        json["aggregate"] = json!(aggregate);
    }
    extend(&mut json, front.unwrap_or_default());
    let rest = json!({
        "answer": advice(answer, &ended.dir),
        "levers": analyses.levers.as_ref().map(levers_json),
        "maps": maps.collect::<Vec<_>>(),
        "robots": analyses.robots,
        "study": ended.dir,
    });
    extend(&mut json, rest);
    json
}

/// Returns levers with their summary sentence and the ranges over uncertain parameters.
pub(crate) fn levers_json(levers: &Levers) -> Value {
    let mut json = json!({"sentence": levers.sentence(), "uncertainty": levers.uncertainty()});
    extend(&mut json, json!(levers));
    json
}

/// Returns a design with all its measurements.
fn evaluated(record: &StudyRecord, recorded: &Recorded) -> Value {
    let config = &record.config;
    let mut json = json!({"evaluation": recorded.index, "stiffness": recorded.stiffness});
    if let Some(score) = &recorded.score {
        extend(&mut json, values(&config.objective, score.values.iter().copied()).into());
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
