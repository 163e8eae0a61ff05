//! Range against compliance stiffness: ours and the published points.

use super::ReportError;
use super::chart::{Area, AxisOf, Drawn, around, axes, legend, message, sheet};
use super::theme::{BLUE, GREEN, ORANGE};
use crate::evaluation::objective::Measure;
use crate::input::published::{Origin, designs, of_task};
use crate::study::{Recorded, StudyRecord};
use crate::units::N_PER_MM;
use plotters::prelude::*;

/// The plot of one task, by its place among the tasks, `size` pixels; `None` if there is
/// nothing to show.
pub(super) fn svg(
    record: &StudyRecord,
    task: usize,
    size: (u32, u32),
) -> Result<Option<String>, ReportError> {
    let points = Points::of(record, task);
    if points.all().next().is_none() {
        return Ok(None);
    }
    sheet("the comparison", size, |area| draw(area, &points)).map(Some)
}

/// `(compliance stiffness in N/mm, range in mm)` of each kind.
struct Points {
    ours: Vec<(f64, f64)>,
    simulation: Vec<(f64, f64)>,
    bench: Vec<(f64, f64)>,
}

impl Points {
    fn of(record: &StudyRecord, task: usize) -> Self {
        let point = |r: &Recorded| {
            let range = Measure::Range.value(r.on(task)?)?;
            Some((r.stiffness.compliance.mean / N_PER_MM, range))
        };
        let ours = record.evaluations.iter().filter_map(point);
        let measured = designs();
        let name = record.config.tasks().nth(task).unwrap_or_default();
        let published = |origin| {
            let rows = of_task(name, origin);
            let point = |row: &crate::input::published::Published| {
                let design = measured.iter().find(|m| m.design == row.design)?;
                Some((design.compliance / N_PER_MM, row.tolerable_range_mm?))
            };
            rows.iter().filter_map(point).collect()
        };
        Points {
            ours: ours.collect(),
            simulation: published(Origin::Simulation),
            bench: published(Origin::Bench),
        }
    }

    fn all(&self) -> impl Iterator<Item = &(f64, f64)> {
        self.ours.iter().chain(&self.simulation).chain(&self.bench)
    }
}

fn draw(area: &Area<'_>, points: &Points) -> Drawn {
    let mut range = around(points.all().map(|p| p.1).chain([0.0]), 0.1);
    range.start = 0.0;
    // Room for the legend above the points.
    range.end *= 1.3;
    let mut chart = axes(
        area,
        "",
        AxisOf {
            label: "compliance stiffness of one finger (N/mm)",
            range: around(points.all().map(|p| p.0), 0.08),
        },
        AxisOf { label: "tolerable range (mm)", range },
    )?;
    let ours = BLUE.rgb().mix(0.6).filled();
    chart
        .draw_series(points.ours.iter().map(|&p| Circle::new(p, 3, ours)))
        .map_err(message)?
        .label("this study (predicted stiffness)")
        .legend(move |(x, y)| Circle::new((x + 10, y), 4, ours));
    if !points.simulation.is_empty() {
        let style = ORANGE.rgb().stroke_width(2);
        chart
            .draw_series(points.simulation.iter().map(|&p| TriangleMarker::new(p, 6, style)))
            .map_err(message)?
            .label("published simulation")
            .legend(move |(x, y)| TriangleMarker::new((x + 10, y), 6, style));
    }
    if !points.bench.is_empty() {
        let style = GREEN.rgb().stroke_width(2);
        chart
            .draw_series(points.bench.iter().map(|&p| Cross::new(p, 5, style)))
            .map_err(message)?
            .label("bench experiments")
            .legend(move |(x, y)| Cross::new((x + 10, y), 5, style));
    }
    legend(&mut chart, SeriesLabelPosition::UpperLeft)
}
