//! The best design in words.

use super::text::{design, end, escape, infill, is_infill, outcome_words, stiffness, values};
use crate::evaluation::{Evaluation, RobustRange, SuccessRate};
use crate::outcome::{FailureClass, Outcome};
use crate::study::{Recorded, StudyRecord, nearest};

/// The section; says so if no design can be recommended.
pub(super) fn section(record: &StudyRecord) -> String {
    let Some(best) = record.best() else { return none(record) };
    let objectives = &record.config.objective;
    let found = best.feasible().unwrap_or_default();
    let mut html = format!("<p class=\"big\">{}</p>\n", escape(&infill(&best.design)));
    let several = objectives.single().is_none();
    if several {
        html += &format!(
            "<p>has the best {}: {}. No one design is best in all objectives; see the front \
             below.</p>\n",
            objectives.first(),
            escape(&objectives.show(found))
        );
    }
    for (task, evaluation) in record.config.tasks().zip(best.tasks()) {
        html += &tolerated(record, task, evaluation);
    }
    html += &hull_note(best);
    html += &facts(record, best, found);
    html
}

fn none(record: &StudyRecord) -> String {
    let count = record.evaluations.len();
    match nearest(&record.evaluations) {
        None => format!(
            "<p class=\"warn\">No design has a value: of {count} evaluations none gave one \
             (none were run, or every simulation diverged at the nominal start, or none inserted \
             there and so had no force or slip).</p>"
        ),
        Some(nearest) => {
            let tasks = nearest.tasks();
            let words = record.config.constraints.iter().map(|c| c.words(&tasks));
            format!(
                "<p class=\"warn\">No design keeps all constraints, so none is recommended. Of \
                 {count} evaluations number {}, {}, violates them least: {}.</p>\n",
                nearest.index + 1,
                escape(&design(&nearest.design)),
                escape(&words.collect::<Vec<_>>().join("; "))
            )
        }
    }
}

/// What the best design tolerates on one task, and whether that is of any use.
fn tolerated(record: &StudyRecord, task: &str, evaluation: &Evaluation) -> String {
    let window = &evaluation.window;
    let on = match !record.config.several_tasks() {
        true => String::new(),
        false => format!(" on {}", escape(task)),
    };
    let mut html = format!(
        "<p>tolerates a start shifted by <b>{:.1} mm</b> in all{on}</p>\n",
        window.range_mm()
    );
    if window.nominal != Outcome::Inserted {
        html += &format!(
            "<p class=\"warn\">Even the best design fails at the nominal start{on} ({}), so its \
             range is 0 mm. No design of this study is usable as it is.</p>\n",
            outcome_words(window.nominal)
        );
    }
    html
}

fn hull_note(best: &Recorded) -> String {
    if best.stiffness.inside_hull() {
        return "<p>Inside the hull of the measured designs: the stiffness is interpolated.</p>\n"
            .to_owned();
    }
    format!(
        "<p class=\"warn\">Outside the hull of the measured designs, by {:.2} of the measured \
         span: the stiffness is extrapolated. Print and measure this finger before you trust \
         the result.</p>\n",
        best.stiffness.hull_distance
    )
}

type Rows = Vec<(String, String)>;

fn facts(record: &StudyRecord, best: &Recorded, found: &[f64]) -> String {
    let objectives = &record.config.objective;
    let others = best.design.0.iter().filter(|(key, _)| !is_infill(key));
    let mut rows: Rows = others.map(|(key, value)| (key.clone(), value.to_string())).collect();
    let value = match objectives.single() {
        Some(measure) => format!("{measure} = {}", values(objectives, found)),
        None => objectives.show(found),
    };
    rows.push(("objective".to_owned(), value));
    let tasks = best.tasks();
    let constraints = record.config.constraints.iter();
    rows.extend(constraints.map(|c| ("constraint".to_owned(), c.words(&tasks))));
    for (task, evaluation) in record.config.tasks().zip(&tasks) {
        if record.config.several_tasks() {
            rows.push(("on the task".to_owned(), task.to_owned()));
        }
        rows.extend(of_task(evaluation));
    }
    rows.extend([
        ("compliance stiffness (y), one finger".to_owned(), stiffness(best.stiffness.compliance)),
        ("assembly stiffness (z), one finger".to_owned(), stiffness(best.stiffness.assembly)),
        (
            "evaluation".to_owned(),
            format!("number {} of {}", best.index + 1, record.evaluations.len()),
        ),
    ]);
    super::sections::definitions(&rows)
}

/// What was measured on one task.
fn of_task(found: &Evaluation) -> Rows {
    let window = &found.window;
    let mut rows = vec![
        (
            "window".to_owned(),
            format!(
                "{:+.1} mm to {:+.1} mm; each end is the last 0.1 mm step that inserts, so the \
                 range is known to within +0.2 mm",
                window.negative_mm(),
                window.positive_mm()
            ),
        ),
        ("beyond the negative end".to_owned(), end(window.end_negative)),
        ("beyond the positive end".to_owned(), end(window.end_positive)),
        (
            "largest contact force plug to socket".to_owned(),
            format!("{:.1} N (over the inserted trials)", found.peak_force_n),
        ),
        (
            "largest slip in the grasp".to_owned(),
            format!("{:.2} mm (over the inserted trials)", found.slip_mm),
        ),
    ];
    rows.extend(found.success.iter().flat_map(success));
    rows.extend(found.robust.iter().map(robust));
    rows
}

fn success(success: &SuccessRate) -> Rows {
    let [low, high] = success.interval();
    let rate = success.rate().map_or("none".to_owned(), |rate| format!("{rate:.3}"));
    let classes = FailureClass::ALL.into_iter().zip(success.failure_counts);
    let failed = classes.map(|(class, count)| format!("{count} {}", class.label()));
    vec![
        (
            "success rate under drawn errors".to_owned(),
            format!(
                "{rate} ({} of {} trials; {} % interval {low:.3} to {high:.3})",
                success.inserted,
                success.counted(),
                100.0 * success.confidence
            ),
        ),
        (
            "failures under drawn errors".to_owned(),
            format!("{}, {} diverged", failed.collect::<Vec<_>>().join(", "), success.diverged),
        ),
    ]
}

fn robust(robust: &RobustRange) -> (String, String) {
    let value = robust.value_mm.map_or("none".to_owned(), |value| format!("{value:.2} mm"));
    let text = format!(
        "{value}; {} windows of mean {:.2} mm and standard deviation {:.2} mm, {} diverged",
        robust.ranges_mm.len(),
        robust.mean_mm(),
        robust.sd_mm(),
        robust.diverged
    );
    ("robust range under drawn errors".to_owned(), text)
}
