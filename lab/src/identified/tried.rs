//! Identification of hidden cells from their logs, judged by what was hidden and by fingers never logged.

use super::logs::LOGGED;
use super::truth::{Known, window};
use super::{HIDDEN, HiddenCell};
use finger_opt::calibration::published;
use finger_opt::calibration::statistics::{mean, spearman};
use finger_opt::session::{Failure, IdentifyDone, IdentifyRequest, SetupRequest, TaskSource};
use insertion::evaluation::cell::Parameter;
use insertion::robot::{Drive, Robot};
use insertion::space::Design;
use insertion::trial::NEVER;
use insertion::trial::engine::EngineKind;
use rayon::prelude::*;
use std::path::Path;

/// What identification found of one cell.
pub struct Tried {
    /// Its number.
    pub cell: u64,
    /// Of each hidden number: what it is, its estimate and that one's standard deviation.
    pub hidden: Vec<[f64; 3]>,
    /// Of each finger that was not logged, mm: true range, that in the identified and in the nominal cell.
    pub ranges: Vec<[f64; 3]>,
}

/// Identifies a cell from the logs in a folder, and simulates the fingers that were not logged.
///
/// # Errors
/// If the logs cannot be used.
pub fn identify(
    cell: &HiddenCell<'_>,
    known: impl Fn(&Design) -> Option<Known> + Sync,
    folder: &Path,
) -> Result<(Tried, IdentifyDone), Failure> {
    let task = cell.template.task.name.clone();
    let setup =
        SetupRequest { tasks: vec![TaskSource::Named(task.clone())], ..SetupRequest::default() };
    let request = IdentifyRequest {
        setup,
        runs: folder.join("runs.csv"),
        frame: Some(folder.join("frame.toml")),
        priors: "bench".to_owned(),
        ..IdentifyRequest::default()
    };
    let done = request.run(&NEVER)?;
    let rows: Vec<&Parameter> = done.cell.of(&task).collect();
    let robot = done.cell.robot("cell").map_err(Failure::input)?;
    let along = |robot: &Robot| match &robot.drive {
        Drive::Servo(servo) => servo.stiffness[2],
        _ => f64::NAN,
    };
    let stiffer = robot.as_ref().map_or(f64::NAN, along) / along(&cell.evaluator.robot);
    let hidden = HIDDEN.iter().zip(cell.shown).map(|((name, _), is)| {
        let row = rows.iter().find(|row| row.name == *name);
        let found = row.map_or([f64::NAN; 2], |row| [row.middle(), row.sd.unwrap_or(f64::NAN)]);
        match *name {
            "stiffness of the flange" => [is, stiffer, found[1] * stiffer],
            _ => [is, found[0], found[1]],
        }
    });
    let hidden = hidden.collect();
    let range = |finger: &[f64; 2]| -> Result<Option<[f64; 3]>, Failure> {
        let design = Design::infill(finger[0], finger[1]);
        let Some(known) = known(&design) else { return Ok(None) };
        let values: Vec<_> = rows.iter().map(|row| (*row, row.middle())).collect();
        let under = cell.evaluator.under(cell.template, (&design, None), &values);
        let (specimen, own) = under.map_err(Failure::input)?;
        let robot = robot.clone().unwrap_or(own);
        let found = window(&(specimen, robot), EngineKind::Direct, None)?;
        let mm = found.map_or(0.0, |taught| taught.window.range_mm());
        Ok(Some([known.range, mm, known.nominal]))
    };
    let designs = published::designs();
    let fingers: Vec<[f64; 2]> =
        designs.iter().map(|d| [d.density_percent, d.direction_deg]).collect();
    let others: Vec<_> = fingers.into_iter().filter(|finger| !LOGGED.contains(finger)).collect();
    let ranges = others.par_iter().map(range).collect::<Result<Vec<_>, Failure>>()?;
    let ranges = ranges.into_iter().flatten().collect();
    Ok((Tried { cell: cell.number, hidden, ranges }, done))
}

/// One line of the table for each cell, in Markdown.
pub fn table(all: &[Tried]) -> String {
    let names = HIDDEN.map(|(_, name)| format!("{name}: hidden, found")).join(" | ");
    let mut text = format!(
        "| cell | {names} | error nominal, mm | error identified, mm | Spearman nominal | Spearman \
         identified |\n|{}\n",
        " --- |".repeat(10)
    );
    for one in all {
        let hidden =
            one.hidden.iter().map(|[is, found, sd]| format!("{is:.3}, {found:.3} ± {sd:.3}"));
        let hidden: Vec<String> = hidden.collect();
        let judged = [2, 1].map(|way| {
            let pairs: Vec<(f64, f64)> = one.ranges.iter().map(|row| (row[0], row[way])).collect();
            let errors: Vec<f64> = pairs.iter().map(|(a, b)| (a - b).abs()).collect();
            (mean(&errors).unwrap_or(f64::NAN), spearman(&pairs).unwrap_or(f64::NAN))
        });
        let [(before, order), (after, ordered)] = judged;
        text += &format!(
            "| {} | {} | {before:.2} | {after:.2} | {order:+.2} | {ordered:+.2} |\n",
            one.cell,
            hidden.join(" | ")
        );
    }
    text
}
