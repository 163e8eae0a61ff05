//! Finger models beside the published experiments: how far the ranges of each agree with the
//! robot's. Nothing is fitted to the experiments here.

use super::{Agreement, Calibrated, RangeSource, TaskTable};
use crate::verify::compare::statistics::median;
use serde_json::{Value, json};

/// What predicts a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// The publication's simulation.
    Published,
    /// Ours with the paper's springs.
    Paper,
    /// Ours with springs from the ribs, the part touching the pad.
    ComputedPad,
    /// The same, the part touching pad and roof.
    ComputedPadAndRoof,
    /// The pad's springs in the plane; across it the paper's.
    PadInPlane,
    /// Those of pad and roof in the plane; across it the paper's.
    PadAndRoofInPlane,
    /// The pad's springs, y and z pulling at one another.
    PadCoupled,
    /// Those of pad and roof, y and z pulling at one another.
    PadAndRoofCoupled,
    /// Springs from the ribs, pad and roof; friction of a pad by its pressed patch; a robot under
    /// position control; connectors as they are.
    Mechanisms,
}

impl Model {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Model::Published => "published",
            Model::Paper => "paper",
            Model::ComputedPad => "computed-pad",
            Model::ComputedPadAndRoof => "computed-pad-and-roof",
            Model::PadInPlane => "pad-in-plane",
            Model::PadAndRoofInPlane => "pad-and-roof-in-plane",
            Model::PadCoupled => "pad-coupled",
            Model::PadAndRoofCoupled => "pad-and-roof-coupled",
            Model::Mechanisms => "mechanisms",
        }
    }

    fn source(self) -> RangeSource {
        match self {
            Model::Published => RangeSource::Simulation,
            _ => RangeSource::Ours,
        }
    }
}

/// What a model says of the designs of a task, once for each rib phase.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelTables {
    /// The model.
    pub model: Model,
    /// At least one; the phases of a model that has none are one.
    pub tables: Vec<TaskTable>,
    /// Starts that were taught since the task's own does not insert, over all phases.
    pub taught: usize,
}

/// A number over the rib phases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// Smallest and largest.
    pub range: [f64; 2],
}

impl Spread {
    fn of(values: impl Iterator<Item = Option<f64>>) -> Option<Self> {
        let values: Vec<f64> = values.flatten().collect();
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Some(Spread { median: median(&values)?, range: [low, high] })
    }
}

impl ModelTables {
    /// A quantity of the agreement with the experiments, over the phases.
    pub fn spread(&self, of: impl Fn(&Agreement) -> Option<f64>) -> Option<Spread> {
        let agreement =
            |table: &TaskTable| Agreement::of(&table.rows, self.model.source(), RangeSource::Bench);
        Spread::of(self.tables.iter().map(|table| of(&agreement(table))))
    }

    /// Ranges of the designs in their order, mm: the median over the phases; `None` where
    /// there is no range.
    pub fn ranges_mm(&self) -> Vec<Option<f64>> {
        let designs = self.tables.first().map_or(0, |table| table.rows.len());
        let range = |at: usize| {
            let of = |table: &TaskTable| table.rows.get(at)?.range_mm(self.model.source());
            Some(Spread::of(self.tables.iter().map(of))?.median)
        };
        (0..designs).map(range).collect()
    }

    fn task(&self) -> &str {
        self.tables.first().map_or("", |table| &table.task)
    }

    fn designs(&self) -> f64 {
        self.spread(|found| Some(found.designs as f64)).map_or(0.0, |spread| spread.median)
    }

    fn json(&self) -> Value {
        let median = |of: &dyn Fn(&Agreement) -> Option<f64>| self.spread(of).map(|s| s.median);
        let mut row = json!({
            "task": self.task(),
            "model": self.model.name(),
            "designs": self.designs() as usize,
            "spearman": median(&|found| found.spearman),
            "mean_absolute_error_mm": median(&|found| found.mean_absolute_error_mm),
            "mean_deviation_percent": median(&|found| found.mean_deviation_percent),
            "failure_match_percent": median(&Agreement::match_percent),
            "ranges_mm": self.ranges_mm(),
        });
        if self.tables.len() > 1 {
            let range = |of: &dyn Fn(&Agreement) -> Option<f64>| self.spread(of).map(|s| s.range);
            row["over_phases"] = json!({
                "phases": self.tables.len(),
                "spearman": range(&|found| found.spearman),
                "mean_absolute_error_mm": range(&|found| found.mean_absolute_error_mm),
                "mean_deviation_percent": range(&|found| found.mean_deviation_percent),
                "failure_match_percent": range(&Agreement::match_percent),
            });
        }
        row
    }

    /// A line of the table; within 80 columns unless there are phases.
    fn text(&self) -> String {
        let several = self.tables.len() > 1;
        let cell = |of: &dyn Fn(&Agreement) -> Option<f64>, digits: usize, width: usize| {
            let words = |Spread { median, range: [low, high] }: Spread| match several {
                false => format!("{median:.digits$}"),
                true => format!("{median:.digits$} ({low:.digits$} .. {high:.digits$})"),
            };
            let wide = if several { width + 16 } else { width };
            let words = self.spread(of).map_or("-".to_owned(), words);
            format!("{words:>wide$}")
        };
        format!(
            "{:<5} {:<21}{:>8}{}{}{}{}{:>8}\n",
            self.task(),
            self.model.name(),
            self.designs(),
            cell(&|found| found.spearman, 2, 9),
            cell(&|found| found.mean_absolute_error_mm, 2, 9),
            cell(&|found| found.mean_deviation_percent, 0, 9),
            cell(&Agreement::match_percent, 0, 8),
            self.taught,
        )
    }
}

/// The list `agreement`; on each task what was calibrated comes last.
pub fn models_json(models: &[ModelTables], calibrated: &[Calibrated]) -> Value {
    each(models, calibrated, ModelTables::json, Calibrated::json).collect()
}

/// Something of each model, and at the end of each task's of what was calibrated on it.
fn each<'a, T>(
    models: &'a [ModelTables],
    calibrated: &'a [Calibrated],
    of: impl Fn(&ModelTables) -> T,
    of_calibrated: impl Fn(&Calibrated) -> T,
) -> impl Iterator<Item = T> {
    models.chunk_by(|a, b| a.task() == b.task()).flat_map(move |models| {
        let task = models.first().map_or("", ModelTables::task);
        let last = calibrated.iter().filter(|one| one.task == task).map(&of_calibrated);
        models.iter().map(&of).chain(last).collect::<Vec<T>>()
    })
}

/// A table of the agreements, a line each, and of the ranges.
pub fn models_text(models: &[ModelTables], calibrated: &[Calibrated]) -> String {
    let phases = models.iter().map(|model| model.tables.len()).max().unwrap_or(1);
    let more = if phases > 1 { 16 } else { 0 };
    let head = ["Spearman", "error mm", "off by %", "match %"];
    let widths = [9, 9, 9, 8];
    let mut text = format!("{:<5} {:<21}{:>8}", "task", "model", "designs");
    for (head, width) in head.into_iter().zip(widths) {
        text.push_str(&format!("{head:>width$}", width = width + more));
    }
    text.push_str(&format!("{:>8}\n", "taught"));
    text.extend(each(models, calibrated, ModelTables::text, Calibrated::text));
    text.push_str("\nranges, mm, of designs 1, 2 ..\n");
    let mut last = String::new();
    let mut line = |task: &str, name: &str, ranges: Vec<Option<f64>>| {
        let range = |mm: Option<f64>| mm.map_or("    -".to_owned(), |mm| format!("{mm:5.1}"));
        let ranges: Vec<String> = ranges.into_iter().map(range).collect();
        let head = if last == task { String::new() } else { format!("{task}\n") };
        task.clone_into(&mut last);
        format!("{head}  {name:<22}{}\n", ranges.concat())
    };
    let of_model =
        |model: &ModelTables| (model.task().to_owned(), model.model.name(), model.ranges_mm());
    let of_calibrated = |one: &Calibrated| (one.task.clone(), "calibrated", one.ranges_mm());
    let rows = each(models, calibrated, of_model, of_calibrated);
    text.extend(rows.into_iter().map(|(task, name, ranges)| line(&task, name, ranges)));
    text
}
