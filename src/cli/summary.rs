//! What is printed of a whole study.

use super::terminal::merge;
use super::{Failure, on_bench, print, recommended};
use crate::report::volume_unit;
use crate::study::{Ending, Recorded, StudyRecord, Walked, nearest, volume};
use insertion::evaluation::objective::Measure;
use insertion::evaluation::robustness::firm::Firm;
use serde_json::{Value, json};
use std::path::Path;

/// Prints the result of a study, `known` evaluations of which were in the cache.
pub fn show(
    dir: &Path,
    record: &StudyRecord,
    ending: Ending,
    known: u64,
    as_json: bool,
) -> Result<(), Failure> {
    print(&words(dir, record, ending, known, as_json))
}

/// What is printed.
pub fn words(
    dir: &Path,
    record: &StudyRecord,
    ending: Ending,
    known: u64,
    as_json: bool,
) -> String {
    if as_json {
        let mut fields = to_json(record, ending, known);
        merge(&mut fields, json!({"study": dir}));
        return format!("{fields}\n");
    }
    text(dir, record, ending, known)
}

fn text(dir: &Path, record: &StudyRecord, ending: Ending, known: u64) -> String {
    let config = &record.config;
    let done = record.evaluations.len();
    let end = match ending {
        Ending::SpaceExhausted => ": every design of the space",
        Ending::Converged => ": the polish has converged",
        Ending::BudgetSpent | Ending::Interrupted => "",
    };
    let (task, method) = (config.task_name(), config.method());
    let mut lines = vec![format!("{task} with {method}: {done} evaluations{end}")];
    let first = record.first_current();
    if first > 0 {
        lines.push(format!(
            "segment       {}, from evaluation {first}: the settings changed, and only these count",
            record.segments.len(),
        ));
    }
    if let Some(bench) = &record.on_bench {
        lines.extend(on_bench::lines(bench));
        lines.push("by simulation alone:".to_owned());
    }
    if let Some((task, nearest)) = record.unusable() {
        lines.push(unusable(record, task, nearest));
    } else if let Some(found) = record.recommendation() {
        lines.extend(recommended::lines(record, &found));
    } else if config.objective.single().is_none() && record.best().is_some() {
        lines.extend(front_lines(record));
    } else {
        lines.push(none(record));
    }
    if known > 0 {
        lines.push(format!("cache         {known} evaluations were known from other studies"));
    }
    let page = dir.join(crate::session::PAGE);
    let place = format!("study         {} (see {})\n", dir.display(), page.display());
    super::words::wrapped(&(lines.join("\n") + "\n")) + &place
}

/// That a task is of no use as it is.
fn unusable(record: &StudyRecord, task: usize, nearest: &Recorded) -> String {
    let name = record.config.tasks().nth(task).unwrap_or_default();
    format!(
        "no design inserts at the nominal start of {name}, so none is recommended\n\
         nearest       {} (evaluation {})",
        nearest.design.labelled(),
        nearest.index
    )
}

/// Why no design is recommended.
fn none(record: &StudyRecord) -> String {
    let Some(nearest) = nearest(record.current()) else {
        return "no evaluation gave a value".to_owned();
    };
    let tasks = nearest.tasks();
    let words = record.config.constraints.iter().map(|constraint| constraint.words(&tasks));
    format!(
        "no design keeps all constraints, so none is recommended\nnearest       {} (evaluation {}): {}",
        nearest.design.labelled(),
        nearest.index,
        words.collect::<Vec<_>>().join("; ")
    )
}

fn front_lines(record: &StudyRecord) -> Vec<String> {
    let (front, goals) = (record.front(), record.config.goals());
    let objectives = &goals.objectives;
    let line = |recorded: &&Recorded| {
        let values = objectives.show(recorded.feasible().unwrap_or_default());
        format!(
            "              {values}: {} (evaluation {})",
            recorded.design.labelled(),
            recorded.index
        )
    };
    let size = match front.len() {
        1 => "one design is the best in all objectives".to_owned(),
        count => {
            format!("{count} designs; none is at least as good as another in all objectives")
        }
    };
    let mut lines = vec![format!("front         {size}")];
    lines.extend(front.iter().map(line));
    let found = volume(&goals, record.current());
    lines.push(format!(
        "hypervolume   {:.3} {} from the reference {}",
        found.hypervolume,
        volume_unit(objectives),
        objectives.show(&found.reference)
    ));
    lines
}

fn to_json(record: &StudyRecord, ending: Ending, known: u64) -> Value {
    let config = &record.config;
    let ending = match ending {
        Ending::BudgetSpent => "budget_spent",
        Ending::SpaceExhausted => "space_exhausted",
        Ending::Converged => "converged",
        Ending::Interrupted => "interrupted",
    };
    let single = config.objective.single();
    let best = record.best().filter(|_| single.is_some());
    let mut fields = json!({
        "task": config.task_name(),
        "space": config.space.name(),
        "robot": config.robot,
        "engine": record.segments.last().map(|segment| &segment.provenance.engine.name),
        "optimizer": config.optimizer,
        "objective": config.objective,
        "seed": config.seed,
        "budget": config.budget,
        "polish": config.polish,
        "evaluations": record.evaluations.len(),
        "cached": known,
        "ending": ending,
        "best": best.map(|best| recorded_json(record, best)),
    });
    merge(&mut fields, recommended::to_json(record));
    if !record.walked.is_empty() {
        let one = |walked: &Walked| {
            let mut fields = recorded_json(record, &walked.recorded);
            let firm: Vec<f64> = walked.firm.iter().map(Firm::range_mm).collect();
            merge(&mut fields, json!({"firm_range_mm": record.aggregated(Measure::Range, &firm)}));
            fields
        };
        let walked: Vec<Value> = record.walked.iter().map(one).collect();
        merge(&mut fields, json!({"walked": walked}));
    }
    if record.segments.len() > 1 {
        merge(&mut fields, json!({"segments": record.segments}));
    }
    if !config.constraints.is_empty() {
        let feasible = record.current().iter().filter(|r| r.feasible().is_some()).count();
        merge(&mut fields, json!({"constraints": config.constraints, "feasible": feasible}));
    }
    if let Some(aggregate) = &config.aggregate {
        merge(&mut fields, json!({"aggregate": aggregate}));
    }
    if single.is_none() {
        let found = volume(&config.goals(), record.current());
        let front = record.front();
        let front: Vec<Value> = front.iter().map(|r| recorded_json(record, r)).collect();
        let keys = config.objective.keys();
        let reference: serde_json::Map<_, _> =
            keys.into_iter().zip(found.reference.iter().map(|&value| json!(value))).collect();
        let volume = json!({
            "front": front,
            "hypervolume": found.hypervolume,
            "hypervolume_reference": reference,
        });
        merge(&mut fields, volume);
    }
    fields
}

pub fn recorded_json(record: &StudyRecord, recorded: &Recorded) -> Value {
    let config = &record.config;
    let mut fields = json!({
        "evaluation": recorded.index,
        "stiffness": recorded.stiffness,
    });
    if let Some(score) = &recorded.score {
        let keys = config.objective.keys().into_iter();
        let values = keys.zip(score.values.iter().map(|&value| json!(value)));
        merge(&mut fields, Value::Object(values.collect()));
        if !score.violations.is_empty() {
            merge(&mut fields, json!({"violations": score.violations}));
        }
    }
    merge(&mut fields, json!(recorded.design));
    if !config.several_tasks() {
        merge(&mut fields, json!(recorded.tasks.first()));
    } else {
        let of = |(task, evaluation)| {
            let mut fields = json!({"task": task});
            merge(&mut fields, json!(evaluation));
            fields
        };
        let tasks: Vec<Value> = config.tasks().zip(recorded.tasks()).map(of).collect();
        merge(&mut fields, json!({"tasks": tasks}));
    }
    fields
}
