//! Our ranges beside the published ones.

use super::elements::table;
use crate::answer::words::{mm, outcome};
use crate::calibration::published::{Origin, Published, designs, of_task};
use crate::study::{Recorded, StudyRecord};
use insertion::evaluation::Window;
use insertion::outcome::Outcome;
use insertion::space::{DENSITY_KEY, DIRECTION_KEY};
use insertion::stiffness::Measurement;
use maud::{Markup, html};

/// Ranges on one task, by its place among the tasks.
pub(super) fn section(record: &StudyRecord, task: usize) -> Markup {
    let name = record.config.tasks().nth(task).unwrap_or_default();
    let published = [Origin::Simulation, Origin::Bench].map(|origin| of_task(name, origin));
    if published.iter().all(Vec::is_empty) {
        return html! { p { "No ranges are published for the task " (name) "." } };
    }
    let row = |m: &Measurement| {
        let infill = (Some(m.density_percent), Some(m.direction_deg));
        let same =
            |r: &&Recorded| (r.design.get(DENSITY_KEY), r.design.get(DIRECTION_KEY)) == infill;
        let found = record.evaluations.iter().find(same).and_then(|found| found.on(task));
        let mut row = vec![
            m.design.to_string(),
            format!("{} %, {}°", m.density_percent, m.direction_deg),
            found.map_or(String::new(), |found| ours(&found.window)),
        ];
        row.extend(published.iter().map(|all| {
            let same = all.iter().find(|published| published.design == m.design);
            same.map_or(String::new(), Published::words)
        }));
        row
    };
    let head = ["design", "infill", "this study", "published simulation", "bench experiments"];
    html! {
        p {
            "Tolerable range, and in brackets the failure class beyond the negative | positive \
             end. Blank: this study did not evaluate the design. Published ranges come without \
             an error. Both ends of ours are the last 0.1 mm step found to insert."
        }
        (table(&head, &designs().iter().map(row).collect::<Vec<_>>()))
    }
}

/// Range and failure classes at both ends, as in the published columns.
fn ours(window: &Window) -> String {
    if window.nominal != Outcome::Inserted {
        return format!("0.0 mm; at the nominal start {}", outcome(window.nominal));
    }
    let class = |end: Option<Outcome>| {
        let end = end.filter(|end| *end != Outcome::Inserted);
        end.map_or("–".to_owned(), |end| {
            end.failure().map_or(end.label().to_owned(), |number| number.to_string())
        })
    };
    let [negative, positive] = [window.end_negative, window.end_positive].map(class);
    format!("{} ({negative} | {positive})", mm(window.range_mm()))
}
