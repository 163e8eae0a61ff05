//! Tuning of a task's strategy, and its result as text.

use super::files::robot;
use super::request::RobotRequest;
use crate::{Failure, layout, not_stopped};
use connector::check::problems;
use connector::tune::{DEFAULT_BUDGET, Effort, Stage, Step, Tuned, Tuner, YAW_DEG, tune};
use insertion::{Outcome, Task, Window};
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;

/// Tunes a new task: moves its start to the middle of a medium finger's window (taught start) and, if that is not
/// enough, tries the strategies of the shipped families of connectors. A task with problems is returned unchanged.
///
/// # Errors
/// If the task cannot be simulated; if `stop` is set meanwhile.
pub fn tune_new(
    task: Task,
    with: &RobotRequest,
    stop: &AtomicBool,
) -> Result<(Task, Option<Tuned>), Failure> {
    if !problems(&task).is_empty() {
        return Ok((task, None));
    }
    let tuned = tune_until_success(&task, with, Stage::Families, stop)?;
    let best = tuned.best();
    let strategy = if tuned.inserts() { best.tried.strategy.clone() } else { task.strategy };
    Ok((Task { strategy, ..task }, Some(tuned)))
}

/// Tries the stages of tuning up to `last` until the window of one is large enough.
///
/// # Errors
/// If the task cannot be simulated; if `stop` is set meanwhile.
pub fn tune_until_success(
    task: &Task,
    with: &RobotRequest,
    last: Stage,
    stop: &AtomicBool,
) -> Result<Tuned, Failure> {
    let robot = robot(&with.name)?;
    let progress = &|_: &str, _, _, _| ();
    let effort = Effort { last, until_enough: true, budget: DEFAULT_BUDGET, seed: 0, progress };
    let tuned = tune(&Tuner::new(task, &robot, with.engine, stop), &effort)?;
    not_stopped(stop)?;
    Ok(tuned)
}

/// Returns a tried strategy as JSON: stage, change, and ranges of a soft, a medium and a stiff finger, mm.
pub fn step_json(Step { stage, change, tried, turned_mm }: &Step) -> Value {
    json!({
        "stage": stage,
        "what": change,
        "least_range_mm": tried.inserts().then_some(tried.score),
        "range_mm": tried.windows.iter().map(Window::range_mm).collect::<Vec<_>>(),
        "turned_least_range_mm": turned_mm,
    })
}

/// Returns the chosen strategy as JSON; null if none inserts.
pub fn chosen(tuned: Option<&Tuned>) -> Value {
    let tuned = tuned.filter(|tuned| tuned.inserts());
    tuned.map_or(Value::Null, |tuned| step_json(tuned.best()))
}

/// Returns lines with the label `name` about the chosen strategy and about the first one, if it replaces that.
pub fn brief(name: &str, tuned: &Tuned) -> String {
    let (step, first) = (tuned.best(), &tuned.steps[0]);
    let text =
        format!("{}: {} with a soft, a medium and a stiff finger", step.change, outcome(step));
    let instead = format!("instead of {}: {}", first.change, outcome(first));
    let instead = (tuned.best > 0).then(|| (String::new(), instead));
    layout::lines([(name.to_owned(), text)].into_iter().chain(instead))
}

/// Returns the tried strategies as text; of the numerical search only the number of variations.
pub fn tried(tuned: &Tuned) -> String {
    let searched = tuned.steps.iter().filter(|step| step.stage == Stage::Search).count();
    let named = tuned.steps.iter().filter(|step| step.stage != Stage::Search);
    let mut all = distinct(named.map(|step| step.change.as_str()));
    let variations = format!("{searched} variations of tilt, strokes, preload and speed");
    if searched > 0 {
        all.push(&variations);
    }
    all.join("; ")
}

/// Returns each change once; one with a slower push is not another one.
fn distinct<'a>(changes: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut all = Vec::new();
    for change in changes {
        let change = change.split(", push slowed").next().unwrap_or(change);
        if !all.contains(&change) {
            all.push(change);
        }
    }
    all
}

/// Returns the result of a strategy as text.
pub fn outcome(step: &Step) -> String {
    match step.tried.windows.is_empty() {
        true => "inserts from no start".to_owned(),
        false => {
            let start = if step.stage == Stage::AsItIs { "given" } else { "taught" };
            format!("{} about the {start} start{}", ranges(&step.tried.windows), turned_text(step))
        }
    }
}

/// Returns the smallest range with the socket turned about z as text; empty if it was not simulated.
pub fn turned_text(step: &Step) -> String {
    step.turned_mm.map_or(String::new(), |least_mm| {
        format!(", with the socket turned by {YAW_DEG}° at least {least_mm:.1} mm")
    })
}

/// Returns the ranges as text, `3.1, 3.3, 2.9 mm`; for a window whose nominal start fails, the outcome instead.
pub fn ranges(windows: &[Window]) -> String {
    let inserts = |window: &Window| window.nominal == Outcome::Inserted;
    let all = windows.iter().all(inserts);
    let unit = if all { "" } else { " mm" };
    let range = |window: &Window| match inserts(window) {
        true => format!("{:.1}{unit}", window.range_mm()),
        false => window.nominal.short().to_owned(),
    };
    let each: Vec<_> = windows.iter().map(range).collect();
    format!("{}{}", each.join(", "), if all { " mm" } else { "" })
}

#[cfg(test)]
mod tests {
    use super::*;
    #[test]
    fn a_strategy_tried_in_two_stages_or_with_a_slower_push_is_named_once() {
        let tried = ["as it is", "start taught, +0.0 mm in y", "like a key"];
        let slowed = "start taught, +0.0 mm in y, push slowed to 12 mm/s";
        let changes = tried.into_iter().chain([slowed, "like a key", "like a round peg"]);
        assert_eq!(distinct(changes), [&tried[..], &["like a round peg"]].concat());
    }
}
