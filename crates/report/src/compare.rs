//! Comparison of optimizers over studies of the same problem.

use super::chart::{Area, DrawResult, axes, legend, padded_range, render};
use super::convergence::best_so_far;
use super::marks::{line, stairs};
use super::theme::{BLUE, Colour, GREEN, INK, MUTED, ORANGE, RED};
use super::{ReportError, text_table};
use ask_tell::statistics::{interpolated_quantile, sorted};
use insertion::{Aggregate, Constraint};
use plotters::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;
use study::{StudyConfig, StudyRecord};

/// Distance of the target below the best known value, mm.
const TOLERANCE_MM: f64 = 0.1;
/// Tolerance for the rounding of values, which are multiples of 0.1 mm.
const ROUNDING_MM: f64 = 1e-9;

/// Quartiles over studies. Studies without a value or without reaching the target count as infinite; a quartile that
/// depends on them is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quartiles {
    /// Lower quartile.
    pub q25: Option<f64>,
    /// Median.
    pub median: Option<f64>,
    /// Upper quartile.
    pub q75: Option<f64>,
}

impl Quartiles {
    /// Interpolates linearly between the sorted values; `None` if one of the two is infinite.
    fn of(values: Vec<f64>) -> Self {
        let values = sorted(values);
        let quantile =
            |share| interpolated_quantile(&values, share).filter(|value| value.is_finite());
        Quartiles { q25: quantile(0.25), median: quantile(0.5), q75: quantile(0.75) }
    }

    /// Returns lower quartile, median and upper quartile.
    pub fn all(&self) -> [Option<f64>; 3] {
        [self.q25, self.median, self.q75]
    }
}

/// Studies of one optimizer with different seeds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OptimizerGroup {
    /// Name of the optimizer, with the evaluations of its final local search (polish): `gp+polish20`.
    pub optimizer: String,
    /// Designs proposed at a time.
    pub batch: u64,
    /// Number of studies.
    pub studies: usize,
    /// Studies that reached the target.
    pub reached: usize,
    /// Number of evaluations to the target; a study that did not reach it counts as later than
    /// all that did.
    pub evaluations_to_target: Quartiles,
    /// Best value so far over the studies after 1, 2, .. evaluations, up to the end of the
    /// shortest, mm.
    pub best_so_far_mm: Vec<Quartiles>,
}

/// Comparison of studies, as printed by `optimize compare --json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Task of the studies.
    pub task: String,
    /// Objective of the studies.
    pub objective: String,
    /// Best value of all studies, mm.
    pub best_known_mm: f64,
    /// Target up to which evaluations are counted: 0.1 mm below the best, mm.
    pub target_mm: f64,
    /// Studies by optimizer and batch.
    #[serde(rename = "optimizers")]
    pub groups: Vec<OptimizerGroup>,
}

/// Compares studies, each with a name for messages.
///
/// # Errors
/// If their problems differ, their objective is not a single length to be maximized, a study is given twice, or none
/// has a value.
pub fn compare(studies: &[(String, StudyRecord)]) -> Result<Comparison, String> {
    let first = studies.first().ok_or("give at least one study to compare")?;
    studies.iter().try_for_each(|study| check_same_problem(first, study))?;
    let objective = &first.1.config.objective;
    if !objective.single().is_some_and(|measure| measure.key() == "mm" && measure.sense() > 0.0) {
        return Err(format!(
            "{} has the objective {objective}; only studies of one objective in mm that is \
             maximized can be compared: range, centred-range or robust-range",
            first.0
        ));
    }
    let mut groups: BTreeMap<(String, u64), Vec<&(String, StudyRecord)>> = BTreeMap::new();
    for study in studies {
        let (config, method) = (&study.1.config, study.1.config.method());
        let group = groups.entry((method.clone(), config.batch)).or_default();
        if let Some(same) = group.iter().find(|other| other.1.config.seed == config.seed) {
            return Err(format!(
                "{} and {} are the same study ({method}, seed {}); give it once",
                same.0, study.0, config.seed
            ));
        }
        group.push(study);
    }
    let best = studies.iter().filter_map(|(_, record)| record.best()?.value()).reduce(f64::max);
    let best_known_mm =
        best.ok_or("no evaluation of these studies has a value: there is nothing to compare")?;
    let target_mm = best_known_mm - TOLERANCE_MM;
    let group = |((optimizer, batch), studies): ((String, u64), Vec<&(String, StudyRecord)>)| {
        let to_target: Vec<f64> =
            studies.iter().map(|(_, record)| reached(record, target_mm)).collect();
        let shortest = studies.iter().map(|(_, record)| record.evaluations.len()).min();
        let curves: Vec<Vec<f64>> = studies.iter().map(|(_, record)| curve(record)).collect();
        let band = |n| Quartiles::of(curves.iter().map(|curve| curve[n]).collect());
        OptimizerGroup {
            optimizer,
            batch,
            studies: studies.len(),
            reached: to_target.iter().filter(|n| n.is_finite()).count(),
            evaluations_to_target: Quartiles::of(to_target),
            best_so_far_mm: (0..shortest.unwrap_or(0)).map(band).collect(),
        }
    };
    let (task, groups) = (first.1.config.task_name(), groups.into_iter().map(group).collect());
    Ok(Comparison { task, objective: objective.to_string(), best_known_mm, target_mm, groups })
}

/// Returns the settings in which compared studies must agree, each with its name.
fn problem(config: &StudyConfig) -> [(&'static str, String); 7] {
    let limits: Vec<String> = config.constraints.iter().map(Constraint::to_string).collect();
    let aggregate = config.aggregate.as_ref().map_or("none".to_owned(), Aggregate::to_string);
    [
        ("task", config.task_name()),
        ("objective", config.objective.to_string()),
        ("constraints", if limits.is_empty() { "none".to_owned() } else { limits.join(", ") }),
        ("aggregate", aggregate),
        ("robot", config.robot.clone()),
        ("engine", config.provenance.engine.name.clone()),
        ("space", config.space.name.to_owned()),
    ]
}

/// Checks that two studies agree in the settings of [`problem`].
fn check_same_problem(
    (first, ours): &(String, StudyRecord),
    (second, theirs): &(String, StudyRecord),
) -> Result<(), String> {
    let mut parts = problem(&ours.config).into_iter().zip(problem(&theirs.config));
    match parts.find(|(ours, theirs)| ours != theirs) {
        None => Ok(()),
        Some(((what, ours), (_, theirs))) => Err(format!(
            "{first} and {second} cannot be compared: the first has the {what} {ours}, the second \
             {theirs}; compare studies of the same {what}"
        )),
    }
}

/// Returns the number of evaluations until a value of at least `target`, mm; infinite if there is none.
fn reached(record: &StudyRecord, target: f64) -> f64 {
    let mut values = record.evaluations.iter().map(|r| r.feasible()?.first().copied());
    let index = values.position(|v| v.is_some_and(|v| v >= target - ROUNDING_MM));
    index.map_or(f64::INFINITY, |index| index as f64 + 1.0)
}

/// Returns the best so far after each evaluation; minus infinity before the first value.
fn curve(record: &StudyRecord) -> Vec<f64> {
    let known = best_so_far(record);
    let none = record.evaluations.len() - known.len();
    let values = known.into_iter().map(|(_, value)| value);
    std::iter::repeat_n(f64::NEG_INFINITY, none).chain(values).collect()
}

/// Table headings; the quartiles are of the number of evaluations to the target.
const HEAD: [&str; 7] = ["optimizer", "batch", "studies", "reached", "25 %", "median", "75 %"];

impl OptimizerGroup {
    /// Returns the cells below [`HEAD`].
    fn row(&self) -> [String; 7] {
        let number = |number: Option<f64>| number.map_or("-".to_owned(), |n| format!("{n:.1}"));
        let [low, median, high] = self.evaluations_to_target.all().map(number);
        let counts = [self.batch, self.studies as u64, self.reached as u64];
        let [batch, studies, reached] = counts.map(|count| count.to_string());
        [self.optimizer.clone(), batch, studies, reached, low, median, high]
    }
}

/// Returns the comparison as text for a terminal.
pub fn text(comparison: &Comparison) -> String {
    let Comparison { task, objective, best_known_mm, target_mm, groups } = comparison;
    let table = text_table(1, HEAD, groups.iter().map(OptimizerGroup::row));
    format!(
        "{task}, {objective}: best known {best_known_mm:.1} mm\n\
         evaluations to {target_mm:.1} mm ({TOLERANCE_MM} mm below the best known)\n\n{table}"
    )
}

const COLOURS: [Colour; 6] = [BLUE, ORANGE, GREEN, RED, MUTED, INK];

/// Plots the best so far of each optimizer: the median as a line and the quartiles as a band.
pub fn svg(comparison: &Comparison) -> Result<String, ReportError> {
    render("the comparison", (880, 480), |area| draw(area, comparison))
}

fn draw(area: &Area<'_>, comparison: &Comparison) -> DrawResult {
    let title = format!("{}: best so far, median and quartiles over seeds", comparison.task);
    let groups = &comparison.groups;
    let longest = groups.iter().map(|g| g.best_so_far_mm.len()).max().unwrap_or(0).max(1) as f64;
    let values = groups.iter().flat_map(|g| g.best_so_far_mm.iter().flat_map(|q| q.all()));
    let range = padded_range(values.flatten().chain([comparison.best_known_mm]), 0.06);
    let label = format!("{} (mm)", comparison.objective);
    let x = ("number of evaluations", 0.0..longest * 1.02 + 0.5);
    let mut chart = axes(area, &title, x, (&label, range), None)?;
    let coloured = || groups.iter().zip(COLOURS.iter().cycle());
    for (group, colour) in coloured().filter(|(group, _)| group.studies > 1) {
        let mut outline = quartile(group, 0);
        outline.extend(quartile(group, 2).into_iter().rev());
        if !outline.is_empty() {
            chart.draw_series([Polygon::new(outline, colour.rgb.mix(0.16).filled())])?;
        }
    }
    let several =
        |g: &OptimizerGroup| groups.iter().filter(|o| o.optimizer == g.optimizer).count() > 1;
    for (group, colour) in coloured() {
        let batch = if several(group) { format!(", batch {}", group.batch) } else { String::new() };
        let plural = if group.studies == 1 { "study" } else { "studies" };
        let label = format!("{}{batch} ({} {plural})", group.optimizer, group.studies);
        line(&mut chart, quartile(group, 1), colour.rgb.stroke_width(3), label)?;
    }
    let target = vec![(0.0, comparison.target_mm), (longest, comparison.target_mm)];
    line(&mut chart, target, MUTED.rgb.stroke_width(1), format!("best known - {TOLERANCE_MM} mm"))?;
    legend(&mut chart, SeriesLabelPosition::LowerRight)
}

/// Returns a quartile (0 lower, 1 median, 2 upper) as a step function, from the first evaluation at which it is known.
fn quartile(group: &OptimizerGroup, index: usize) -> Vec<(f64, f64)> {
    let numbered = (1..).zip(&group.best_so_far_mm);
    stairs(numbered.filter_map(|(n, quartiles)| Some((f64::from(n), quartiles.all()[index]?))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_interpolate_and_do_not_invent() {
        let five = vec![5.0, 1.0, 3.0, 2.0, 4.0];
        let quartiles = |values| Quartiles::of(values).all();
        assert_eq!(quartiles(five), [Some(2.0), Some(3.0), Some(4.0)]);
        assert_eq!(quartiles(vec![1.0, 2.0]), [Some(1.25), Some(1.5), Some(1.75)]);
        assert_eq!(quartiles(vec![7.0, f64::INFINITY]), [None; 3]);
        let late = vec![7.0, 9.0, f64::INFINITY];
        assert_eq!(quartiles(late), [Some(8.0), Some(9.0), None]);
        assert_eq!(quartiles(vec![]), [None; 3]);
    }
}
