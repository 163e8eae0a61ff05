//! Our ranges beside the published ones, as a table and against compliance stiffness.

use super::ReportError;
use super::chart::{Area, Drawn, around, axes, legend, sheet};
use super::elements::{figure, table};
use super::marks::{PointMark, points};
use super::theme::{BLUE, GREEN, ORANGE};
use crate::answer::words::{mm, outcome};
use crate::calibration::published::{Origin, Published, designs, of_task};
use crate::study::{Recorded, StudyRecord};
use input::units::N_PER_MM;
use insertion::evaluation::Window;
use insertion::evaluation::objective::Measure;
use insertion::outcome::Outcome;
use insertion::space::{DENSITY_KEY, DIRECTION_KEY};
use insertion::stiffness::Measurement;
use maud::{Markup, html};
use plotters::prelude::SeriesLabelPosition;

/// Ranges on one task, by its place among the tasks; the plot `size` pixels.
pub(super) fn section(
    record: &StudyRecord,
    task: usize,
    size: (u32, u32),
) -> Result<Markup, ReportError> {
    let name = record.config.tasks().nth(task).unwrap_or_default();
    let published = [Origin::Simulation, Origin::Bench].map(|origin| of_task(name, origin));
    let clouds = clouds(record, task, &published);
    let svg = match clouds.iter().all(Vec::is_empty) {
        true => None,
        false => Some(sheet("the published ranges", size, |area| draw(area, clouds))?),
    };
    let caption = "Range against the compliance stiffness of one finger: predicted for our \
                   designs, measured for the published ones.";
    Ok(html! {
        @if published.iter().all(Vec::is_empty) {
            p { "No ranges are published for the task " (name) "." }
        } @else {
            (ranges(record, task, &published))
        }
        @if let Some(svg) = svg { (figure(&svg, "range against compliance stiffness", caption)) }
    })
}

fn ranges(record: &StudyRecord, task: usize, published: &[Vec<Published>; 2]) -> Markup {
    let row = |m: &Measurement| {
        let found = of_design(record, m).and_then(|found| found.on(task));
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

/// The evaluation of a measured design, if the study has one.
fn of_design<'a>(record: &'a StudyRecord, m: &Measurement) -> Option<&'a Recorded> {
    record.evaluations.iter().find(|r| {
        r.design.get(DENSITY_KEY) == Some(m.density_percent)
            && r.design.get(DIRECTION_KEY) == Some(m.direction_deg)
    })
}

/// `(compliance stiffness in N/mm, range in mm)`: ours, published simulation, bench.
fn clouds(
    record: &StudyRecord,
    task: usize,
    [simulation, bench]: &[Vec<Published>; 2],
) -> [Vec<(f64, f64)>; 3] {
    let ours = |r: &Recorded| {
        let range = Measure::Range.value(r.on(task)?)?;
        Some((r.stiffness.compliance.mean / N_PER_MM, range))
    };
    let measured = designs();
    let point = |published: &Published| {
        let design = measured.iter().find(|m| m.design == published.design)?;
        Some((design.compliance / N_PER_MM, published.tolerable_range_mm?))
    };
    [
        record.evaluations.iter().filter_map(ours).collect(),
        simulation.iter().filter_map(point).collect(),
        bench.iter().filter_map(point).collect(),
    ]
}

fn draw(area: &Area<'_>, clouds: [Vec<(f64, f64)>; 3]) -> Drawn {
    let all = || clouds.iter().flatten();
    let mut range = around(all().map(|p| p.1).chain([0.0]), 0.1);
    range.start = 0.0;
    // Room for the legend above the points.
    range.end *= 1.3;
    let x = ("compliance stiffness of one finger (N/mm)", around(all().map(|p| p.0), 0.08));
    let mut chart = axes(area, "", x, ("tolerable range (mm)", range))?;
    let [ours, simulation, bench] = clouds;
    points(&mut chart, ours, PointMark::dot(BLUE, 3), "this study (predicted stiffness)")?;
    points(&mut chart, simulation, PointMark::ring(ORANGE, 5, 2), "published simulation")?;
    points(&mut chart, bench, PointMark::cross(GREEN, 5), "bench experiments")?;
    legend(&mut chart, SeriesLabelPosition::UpperLeft)
}
