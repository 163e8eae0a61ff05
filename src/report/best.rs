//! The best design in words.

use super::text::{end, escape, infill, is_infill, outcome_words, stiffness};
use crate::evaluation::Outcome;
use crate::study::{Recorded, StudyRecord};

/// The section; says so if nothing has a value.
pub(super) fn section(record: &StudyRecord) -> String {
    let Some(best) = record.best() else {
        let count = record.evaluations.len();
        return format!(
            "<p class=\"warn\">No design has a value: of {count} evaluations none gave one \
             (none were run, or every simulation diverged at the nominal start).</p>"
        );
    };
    let window = &best.evaluation.window;
    let mut html = format!(
        "<p class=\"big\">{}</p>\n<p>tolerates a start shifted by <b>{:.1} mm</b> in all</p>\n",
        escape(&infill(&best.design)),
        window.range_mm(),
    );
    if window.nominal != Outcome::Inserted {
        html += &format!(
            "<p class=\"warn\">Even the best design fails at the nominal start ({}), so its \
             range is 0 mm. No design of this study is usable as it is.</p>\n",
            outcome_words(window.nominal)
        );
    }
    html += &hull_note(best);
    html += &facts(record, best);
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

fn facts(record: &StudyRecord, best: &Recorded) -> String {
    let (found, window) = (&best.evaluation, &best.evaluation.window);
    let value = best.value.map_or("none".to_owned(), |value| format!("{value:.1} mm"));
    let others = best.design.0.iter().filter(|(key, _)| !is_infill(key));
    let mut rows: Vec<(String, String)> =
        others.map(|(key, value)| (key.clone(), value.to_string())).collect();
    rows.extend([
        ("objective".to_owned(), format!("{} = {value}", record.config.objective)),
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
        ("compliance stiffness (y), one finger".to_owned(), stiffness(best.stiffness.compliance)),
        ("assembly stiffness (z), one finger".to_owned(), stiffness(best.stiffness.assembly)),
        (
            "largest contact force plug to socket".to_owned(),
            format!("{:.1} N (over the inserted trials)", found.peak_force_n),
        ),
        (
            "largest slip in the grasp".to_owned(),
            format!("{:.2} mm (over the inserted trials)", found.slip_mm),
        ),
        (
            "evaluation".to_owned(),
            format!("number {} of {}", best.index + 1, record.evaluations.len()),
        ),
    ]);
    super::sections::definitions(&rows)
}
