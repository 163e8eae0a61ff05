//! The recommendation of a study, in lines and as JSON: what it leads with.

use super::on_bench;
use super::terminal::merge;
use super::words;
use crate::calibration::order::{Order, order_on_bench};
use crate::report::beyond_chance;
use crate::study::{ByRibs, Recommendation, Recorded, StudyRecord};
use input::units::N_PER_MM;
use insertion::evaluation::objective::Measure;
use insertion::evaluation::robustness::firm::{Firm, REPEATS};
use serde_json::{Value, json};

/// The recommended finger, what it tolerates and how firm that is, what is as good, and whether
/// it matters.
pub fn lines(record: &StudyRecord, found: &Recommendation) -> Vec<String> {
    let (config, best) = (&record.config, found.recorded);
    let mut lines =
        vec![format!("best design   {} (evaluation {})", best.design.labelled(), best.index)];
    lines.extend(firm_range(record, found));
    if let (Some(measure), Some(value)) = (config.objective.single(), best.value()) {
        let of =
            config.aggregate.as_ref().map_or(String::new(), |a| format!(" ({a} of the tasks)"));
        lines.push(format!("{measure:<13} {}{of}", measure.show(value)));
    }
    let tasks = best.tasks();
    let constraints = config.constraints.iter();
    lines.extend(constraints.map(|c| format!("constraint    {} {}", c.measure, c.words(&tasks))));
    for (at, (name, evaluation)) in config.tasks().zip(&tasks).enumerate() {
        if config.several_tasks() {
            lines.push(format!("task          {name}"));
        }
        lines.push(words::window(evaluation));
        lines.extend(found.firm.and_then(|firm| firm.get(at)).map(firm_window));
        lines.extend(words::force(evaluation));
        lines.extend(words::drawn_text(evaluation));
    }
    lines.extend(by_ribs(record, found));
    lines.push(words::stiffness(&best.stiffness));
    lines.extend(walked(record, best));
    lines.extend(as_good(record, found));
    lines.extend(matters(record));
    lines.extend(robot(record));
    lines
}

/// What the finger tolerates with springs computed from its ribs; of several tasks with their names.
fn by_ribs(record: &StudyRecord, found: &Recommendation) -> Vec<String> {
    let lines: Vec<String> = found.by_ribs.iter().flat_map(|found| words::by_ribs(found)).collect();
    let named = lines.len() > 1;
    let name = |(line, task): (&String, &str)| match named {
        true => format!("{} on {task}", line.trim_end()),
        false => line.trim_end().to_owned(),
    };
    lines.iter().zip(record.config.tasks()).map(name).collect()
}

fn firm_range(record: &StudyRecord, found: &Recommendation) -> Option<String> {
    let range = record.aggregated(Measure::Range, &found.firm_ranges_mm()?);
    Some(format!(
        "firm range    {range:.1} mm: inserts in {REPEATS} of {REPEATS} repeats, friction, start, step varied"
    ))
}

fn firm_window(firm: &Firm) -> String {
    match firm.window_mm() {
        None => "firm window   none: a repeat fails even at the nominal start".to_owned(),
        Some([negative, positive]) => format!("firm window   {negative:.1} to {positive:+.1} mm"),
    }
}

/// What the walk said of the best designs of the search, if they were walked.
fn walked(record: &StudyRecord, best: &Recorded) -> Option<String> {
    let measure = record.config.objective.single()?;
    let show = |recorded: &Recorded| recorded.value().map_or("none".into(), |v| measure.show(v));
    let count = record.walked.len();
    let before = record.current().iter().find(|recorded| recorded.index == best.index)?;
    let mut line = format!("walked        step by step: {count} designs");
    if before.value() != best.value() {
        line += &format!("; the search had given this one {}", show(before));
    }
    (count > 0).then_some(line)
}

/// How many designs are as good, and which of them to take for other reasons.
fn as_good(record: &StudyRecord, found: &Recommendation) -> Vec<String> {
    let (count, of) = (found.equivalent.len(), record.current().len());
    if count < 2 {
        return vec![format!("as good       no other of {of} designs")];
    }
    let mut lines = vec![format!(
        "as good       {count} of {of} designs are equivalent: choose by other needs"
    )];
    let force = |r: &&&Recorded| record.measure(r, Measure::PeakForce).unwrap_or(f64::INFINITY);
    let stiffness = |r: &&&Recorded| r.stiffness.compliance.mean / N_PER_MM;
    let designs = || found.equivalent.iter();
    let least = designs().min_by(|a, b| force(a).total_cmp(&force(b)));
    let softest = designs().min_by(|a, b| stiffness(a).total_cmp(&stiffness(b)));
    let stiffest = designs().max_by(|a, b| stiffness(a).total_cmp(&stiffness(b)));
    for (name, found, value, unit) in [
        ("least force", least, least.map(|r| force(&r)), "N"),
        ("softest", softest, softest.map(|r| stiffness(&r)), "N/mm"),
        ("stiffest", stiffest, stiffest.map(|r| stiffness(&r)), "N/mm"),
    ] {
        if let (Some(design), Some(value)) = (found, value.filter(|value| value.is_finite())) {
            let label = design.design.labelled();
            lines.push(format!(
                "  {name:<11} {label}: {value:.1} {unit} (evaluation {})",
                design.index
            ));
        }
    }
    lines
}

/// How much the finger matters on this task.
fn matters(record: &StudyRecord) -> Option<String> {
    let [low, high] = record.spread_mm()?;
    let count = record.current().len();
    Some(format!("spread        ranges of the {count} designs: {low:.1} to {high:.1} mm"))
}

/// What is known of how the robot orders the designs.
fn robot(record: &StudyRecord) -> Vec<String> {
    let known = |(at, task): (usize, &str)| {
        let order = order_on_bench(record, at)?;
        let chance = if beyond_chance(&order) {
            ""
        } else {
            "; no more than chance gives: measure the best few"
        };
        let Order { spearman, fingers, source } = order;
        let whose = source.words();
        Some(format!(
            "robot         on {task} {whose} ranked {fingers} printed fingers {spearman:+.2} like the bench (1: alike){chance}"
        ))
    };
    let mut lines: Vec<String> = record.config.tasks().enumerate().filter_map(known).collect();
    if lines.is_empty() {
        lines.push(
            "robot         no bench experiment is known: print and measure the best few".into(),
        );
    }
    lines
}

/// `recommended`, `equivalent_designs` and `spread_mm`.
pub fn to_json(record: &StudyRecord) -> Value {
    let found = record.recommendation();
    let spread = record.spread_mm();
    let simulated = found.as_ref().filter(|_| record.unusable().is_none());
    let simulated = simulated.map(|found| recommended(record, found));
    if let Some(bench) = &record.on_bench {
        return json!({
            "recommended": on_bench::recommended(record, bench),
            "recommended_by_simulation": simulated,
            "bench": on_bench::to_json(bench),
            "equivalent_designs": found.as_ref().map(|found| found.equivalent.len()),
            "spread_mm": spread.map(|[low, high]| words::rounded(high - low)),
        });
    }
    json!({
        "recommended": simulated,
        "equivalent_designs": found.as_ref().map(|found| found.equivalent.len()),
        "spread_mm": spread.map(|[low, high]| words::rounded(high - low)),
    })
}

/// Of several tasks the ranges are aggregated, the window is what all have in common, and the
/// force is the largest.
fn recommended(record: &StudyRecord, found: &Recommendation) -> Value {
    let best = found.recorded;
    let windows = || best.tasks.iter().map(|task| &task.window);
    let firm = found
        .firm
        .map(|firm| -> Option<Vec<[f64; 2]>> { firm.iter().map(Firm::window_mm).collect() });
    let [negative, positive] = common(windows().map(|w| [w.negative_mm(), w.positive_mm()]));
    let firm_window = firm.flatten().map(|firm| common(firm.into_iter()));
    let range = record.measure(best, Measure::Range);
    let firm_range = found.firm_ranges_mm().map(|mm| record.aggregated(Measure::Range, &mm));
    let mut fields = json!({
        "values": best.design,
        "evaluation": best.index,
        "firm_range_mm": firm_range,
        "range_mm": range,
        "negative_mm": range.map(|_| negative),
        "positive_mm": range.map(|_| positive),
        "firm_negative_mm": firm_window.map(|[negative, _]| negative),
        "firm_positive_mm": firm_window.map(|[_, positive]| positive),
        "peak_force_n": record.measure(best, Measure::PeakForce),
    });
    if let Some(by_ribs) = found.by_ribs {
        merge(&mut fields, json!({"computed": computed(by_ribs)}));
    }
    if record.config.several_tasks() {
        merge(&mut fields, json!({"tasks": record.config.tasks}));
    }
    fields
}

/// What springs computed from its ribs make of the design, task by task.
fn computed(by_ribs: &ByRibs) -> Value {
    match by_ribs {
        ByRibs::Measured(tasks) => json!({ "tasks": tasks }),
        ByRibs::Refused(why) => json!({ "refused": why }),
    }
}

fn common(windows: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    windows
        .fold([f64::NEG_INFINITY, f64::INFINITY], |[low, high], [a, b]| [low.max(a), high.min(b)])
}
