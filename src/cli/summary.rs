//! What is printed of a whole study.

use super::words::{drawn_text, evaluation_json, merge, stiffness, stiffness_json, window};
use super::{Failure, print, print_json};
use crate::report::volume_unit;
use crate::study::{Ending, Recorded, Study, StudyRecord, nearest, volume};
use serde_json::{Value, json};

/// Prints the result of a study, `known` evaluations of which were in the cache.
pub fn show(study: &Study, ending: Ending, known: u64, as_json: bool) -> Result<(), Failure> {
    if as_json {
        return print_json(&to_json(study, ending, known));
    }
    print(&text(study, ending, known))
}

fn text(study: &Study, ending: Ending, known: u64) -> String {
    let (config, record) = (&study.config, study.record());
    let done = record.evaluations.len();
    let end = match ending {
        Ending::SpaceExhausted => ": every design of the space",
        Ending::Converged => ": the polish has converged",
        Ending::BudgetSpent | Ending::Interrupted => "",
    };
    let (task, method) = (config.task_name(), config.method());
    let mut lines = vec![format!("{task} with {method}: {done} evaluations{end}")];
    match (record.best(), config.objective.single()) {
        (None, _) => lines.push(none(&record)),
        (Some(best), Some(_)) => lines.extend(best_lines(&record, best)),
        (Some(_), None) => lines.extend(front_lines(&record)),
    }
    if known > 0 {
        lines.push(format!("cache         {known} evaluations were known from other studies"));
    }
    let page = study.dir().join(super::report::PAGE);
    lines.push(format!("study         {} (see {})", study.dir().display(), page.display()));
    lines.join("\n") + "\n"
}

/// Why no design is recommended.
fn none(record: &StudyRecord) -> String {
    let Some(nearest) = nearest(&record.evaluations) else {
        return "no evaluation gave a value".to_owned();
    };
    let tasks = nearest.tasks();
    let words = record.config.constraints.iter().map(|constraint| constraint.words(&tasks));
    format!(
        "no design keeps all constraints, so none is recommended\nnearest       {} (evaluation {}): {}",
        nearest.design,
        nearest.index,
        words.collect::<Vec<_>>().join("; ")
    )
}

fn best_lines(record: &StudyRecord, best: &Recorded) -> Vec<String> {
    let config = &record.config;
    let mut lines = vec![format!("best design   {} (evaluation {})", best.design, best.index)];
    if let (Some(measure), Some(value)) = (config.objective.single(), best.value()) {
        let of =
            config.aggregate.as_ref().map_or(String::new(), |a| format!(" ({a} of the tasks)"));
        lines.push(format!("{measure:<13} {}{of}", measure.show(value)));
    }
    let tasks = best.tasks();
    let constraints = config.constraints.iter();
    lines.extend(constraints.map(|c| format!("constraint    {} {}", c.measure, c.words(&tasks))));
    for (name, evaluation) in config.tasks().zip(&tasks) {
        if !config.other_tasks.is_empty() {
            lines.push(format!("task          {name}"));
        }
        lines.push(window(evaluation));
        lines.extend(drawn_text(evaluation));
    }
    lines.push(stiffness(&best.stiffness));
    lines
}

fn front_lines(record: &StudyRecord) -> Vec<String> {
    let (front, goals) = (record.front(), record.config.goals());
    let objectives = &goals.objectives;
    let line = |recorded: &&Recorded| {
        let values = objectives.show(recorded.feasible().unwrap_or_default());
        format!("              {values}: {} (evaluation {})", recorded.design, recorded.index)
    };
    let mut lines = vec![format!(
        "front         {} designs; none is at least as good as another in all objectives",
        front.len()
    )];
    lines.extend(front.iter().map(line));
    let found = volume(&goals, &record.evaluations);
    lines.push(format!(
        "hypervolume   {:.3} {} from the reference {}",
        found.hypervolume,
        volume_unit(objectives),
        objectives.show(&found.reference)
    ));
    lines
}

fn to_json(study: &Study, ending: Ending, known: u64) -> Value {
    let (config, record) = (&study.config, study.record());
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
        "engine": config.engine,
        "optimizer": config.optimizer,
        "objective": config.objective,
        "seed": config.seed,
        "budget": config.budget,
        "polish": config.polish,
        "evaluations": record.evaluations.len(),
        "cached": known,
        "ending": ending,
        "best": best.map(|best| recorded_json(&record, best)),
        "study": study.dir(),
    });
    if !config.constraints.is_empty() {
        let feasible = record.evaluations.iter().filter(|r| r.feasible().is_some()).count();
        merge(&mut fields, json!({"constraints": config.constraints, "feasible": feasible}));
    }
    if let Some(aggregate) = &config.aggregate {
        merge(&mut fields, json!({"aggregate": aggregate}));
    }
    if single.is_none() {
        let found = volume(&config.goals(), &record.evaluations);
        let front = record.front();
        let front: Vec<Value> = front.iter().map(|r| recorded_json(&record, r)).collect();
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

fn recorded_json(record: &StudyRecord, recorded: &Recorded) -> Value {
    let config = &record.config;
    let mut fields = json!({
        "evaluation": recorded.index,
        "stiffness": stiffness_json(&recorded.stiffness),
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
    if config.other_tasks.is_empty() {
        merge(&mut fields, evaluation_json(&recorded.evaluation));
    } else {
        let of = |(task, evaluation)| {
            let mut fields = json!({"task": task});
            merge(&mut fields, evaluation_json(evaluation));
            fields
        };
        let tasks: Vec<Value> = config.tasks().zip(recorded.tasks()).map(of).collect();
        merge(&mut fields, json!({"tasks": tasks}));
    }
    fields
}
