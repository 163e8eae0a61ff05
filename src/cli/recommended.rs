//! The recommendation of a study, in lines and as JSON: what it leads with.

use super::on_bench;
use super::terminal::merge;
use super::words;
use crate::answer::words::{evaluated, interval, mm, span};
use crate::answer::{Alternative, Answer, AsGood, OnTask, Recommended, TaskOrder};
use crate::study::{ByRibs, StudyRecord};
use insertion::evaluation::objective::Measure;
use insertion::evaluation::robustness::firm::{Firm, REPEATS};
use serde_json::{Value, json};

/// The recommended finger, what it tolerates and how firm that is, what is as good, and whether
/// it matters.
pub fn lines(answer: &Answer, found: &Recommended) -> Vec<String> {
    let config = &answer.record.config;
    let mut lines = vec![format!("best design   {}", evaluated(found.design))];
    lines.extend(found.firm_range_mm.map(firm_range));
    if let Some((measure, value)) = found.objective {
        let of =
            config.aggregate.as_ref().map_or(String::new(), |a| format!(" ({a} of the tasks)"));
        lines.push(format!("{measure:<13} {}{of}", measure.show(value)));
    }
    let limits = found.constraints.iter();
    lines.extend(limits.map(|(measure, words)| format!("constraint    {measure} {words}")));
    for task in &found.tasks {
        if config.several_tasks() {
            lines.push(format!("task          {}", task.name));
        }
        lines.push(words::window(task.measured));
        lines.extend(task.firm.map(firm_window));
        lines.extend(task.peak_force_n.map(force));
        lines.extend(words::drawn_text(task.measured));
    }
    lines.extend(by_ribs(found));
    lines.push(words::stiffness(&found.design.stiffness));
    lines.extend(walked(answer, found));
    lines.extend(found.as_good.iter().flat_map(|as_good| equivalent(as_good, answer.designs)));
    lines.extend(answer.spread_mm.map(|spread| {
        format!("spread        ranges of the {} designs: {}", answer.designs, interval(spread))
    }));
    lines.extend(answer.orders.iter().map(robot));
    if answer.orders.is_empty() {
        let unknown = "no bench experiment is known: print and measure the best few";
        lines.push(format!("robot         {unknown}"));
    }
    lines
}

fn firm_range(range_mm: f64) -> String {
    format!(
        "firm range    {}: inserts in {REPEATS} of {REPEATS} repeats, friction, start, step varied",
        mm(range_mm)
    )
}

fn firm_window(firm: &Firm) -> String {
    match firm.window_mm() {
        None => "firm window   none: a repeat fails even at the nominal start".to_owned(),
        Some(window) => format!("firm window   {} mm", span(window)),
    }
}

fn force(peak_n: f64) -> String {
    let peak = Measure::PeakForce.show(peak_n);
    format!("peak force    {peak} between plug and socket, over the inserted trials")
}

/// What the finger tolerates with springs computed from its ribs; of several tasks with their names.
fn by_ribs(found: &Recommended) -> Vec<String> {
    let lines: Vec<String> = found.by_ribs.iter().flat_map(|found| words::by_ribs(found)).collect();
    let named = lines.len() > 1;
    let name = |(line, task): (&String, &OnTask)| match named {
        true => format!("{} on {}", line.trim_end(), task.name),
        false => line.trim_end().to_owned(),
    };
    lines.iter().zip(&found.tasks).map(name).collect()
}

/// What the walk said of the best designs of the search, if they were walked.
fn walked(answer: &Answer, found: &Recommended) -> Option<String> {
    let (measure, _) = found.objective.filter(|_| !answer.walked.is_empty())?;
    let fell = found.searched.map_or(String::new(), |before| {
        format!("; the search had given this one {}", measure.show(before))
    });
    Some(format!("walked        step by step: {} designs{fell}", answer.walked.len()))
}

/// How many designs are as good, and which of them to take for other reasons.
fn equivalent(as_good: &AsGood, of: usize) -> Vec<String> {
    let count = as_good.designs;
    if count < 2 {
        return vec![format!("as good       no other of {of} designs")];
    }
    let line = |&Alternative { reason, design, value, unit }: &Alternative| {
        let label = design.design.labelled();
        format!("  {reason:<11} {label}: {value:.1} {unit} (evaluation {})", design.index)
    };
    let mut lines = vec![format!(
        "as good       {count} of {of} designs are equivalent: choose by other needs"
    )];
    lines.extend(as_good.alternatives.iter().map(line));
    lines
}

/// What is known of how the robot orders the designs.
fn robot(known: &TaskOrder) -> String {
    let TaskOrder { task, order } = known;
    let chance = match known.beyond_chance() {
        true => "",
        false => "; no more than chance gives: measure the best few",
    };
    format!(
        "robot         on {task} {} ranked {} printed fingers {:+.2} like the bench (1: alike){chance}",
        order.source.words(),
        order.fingers,
        order.spearman
    )
}

/// The [`json()`] of a study's answer.
pub fn to_json(record: &StudyRecord) -> Value {
    json(&Answer::of(record))
}

/// `recommended`, `equivalent_designs` and `spread_mm`.
pub fn json(answer: &Answer) -> Value {
    let one = answer.recommended.as_ref().filter(|_| answer.front.is_none());
    let simulated = one.filter(|_| answer.nothing_inserts.is_none());
    let simulated = simulated.map(|found| recommended(answer.record, found));
    let mut fields = match &answer.record.on_bench {
        None => json!({ "recommended": simulated }),
        Some(bench) => json!({
            "recommended": on_bench::recommended(answer.record, bench),
            "recommended_by_simulation": simulated,
            "bench": on_bench::to_json(bench),
        }),
    };
    let equivalent = one.and_then(|found| found.as_good.as_ref()).map(|as_good| as_good.designs);
    let spread = answer.spread_mm.map(|[low, high]| words::rounded(high - low));
    merge(&mut fields, json!({ "equivalent_designs": equivalent, "spread_mm": spread }));
    fields
}

fn recommended(record: &StudyRecord, found: &Recommended) -> Value {
    let window = found.range_mm.map(|_| found.window_mm);
    let mut fields = json!({
        "values": found.design.design,
        "evaluation": found.design.index,
        "firm_range_mm": found.firm_range_mm,
        "range_mm": found.range_mm,
        "negative_mm": window.map(|[negative, _]| negative),
        "positive_mm": window.map(|[_, positive]| positive),
        "firm_negative_mm": found.firm_window_mm.map(|[negative, _]| negative),
        "firm_positive_mm": found.firm_window_mm.map(|[_, positive]| positive),
        "peak_force_n": found.peak_force_n,
    });
    // What springs computed from its ribs make of the design, task by task.
    let computed = found.by_ribs.map(|found| match found {
        ByRibs::Measured(tasks) => json!({"computed": { "tasks": tasks }}),
        ByRibs::Refused(why) => json!({"computed": { "refused": why }}),
    });
    computed.into_iter().for_each(|computed| merge(&mut fields, computed));
    if record.config.several_tasks() {
        merge(&mut fields, json!({"tasks": record.config.tasks}));
    }
    fields
}
