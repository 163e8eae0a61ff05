//! Identification of hidden cells from their logs, judged by what was hidden and by fingers never logged.

use super::logs::LOGGED;
use super::truth::{Known, window};
use super::{HIDDEN, HiddenCell};
use ask_tell::statistics::{mean, spearman};
use calibration::identify::question::IdentifyDone;
use finger_opt::command::Request as _;
use finger_opt::commands::identify;
use finger_opt::context::Context;
use finger_opt::failure::Failure;
use finger_opt::setup::request::{SetupRequest, TaskSource};
use insertion::robot::{Drive, Robot};
use insertion::space::Design;
use insertion::trial::NEVER;
use insertion::trial::engine::EngineKind;
use parameters::Parameter;
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
    let request = identify::Request {
        setup,
        runs: folder.join("runs.csv"),
        frame: Some(folder.join("frame.toml")),
        priors: "bench".to_owned(),
        ..identify::Request::default()
    };
    let done = request.run(&Context::silent(&NEVER))?.done;
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
    let designs = insertion::stiffness::designs();
    let fingers: Vec<[f64; 2]> =
        designs.iter().map(|d| [d.density_percent, d.direction_deg]).collect();
    let others: Vec<_> = fingers.into_iter().filter(|finger| !LOGGED.contains(finger)).collect();
    let ranges = others.par_iter().map(range).collect::<Result<Vec<_>, Failure>>()?;
    let ranges = ranges.into_iter().flatten().collect();
    Ok((Tried { cell: cell.number, hidden, ranges }, done))
}

/// Half of the width of an 80 % interval, in standard deviations.
const EIGHTY: f64 = 1.2816;

impl Tried {
    /// Mean error of the ranges, mm, and their order, in the nominal and in the identified cell.
    fn judged(&self) -> [(f64, f64); 2] {
        [2, 1].map(|way| {
            let pairs: Vec<(f64, f64)> = self.ranges.iter().map(|row| (row[0], row[way])).collect();
            let errors = pairs.iter().map(|(a, b)| (a - b).abs());
            (mean(errors).unwrap_or(f64::NAN), spearman(&pairs).unwrap_or(f64::NAN))
        })
    }

    /// By what factor a hidden number is missed.
    fn off(&self, which: usize) -> f64 {
        let [is, found, _] = self.hidden[which];
        (found / is - 1.0).abs()
    }
}

/// One line for each cell, and what is counted over all, in Markdown.
pub fn table(all: &[Tried]) -> String {
    let names = HIDDEN.map(|(_, name)| format!("{name}: hidden, found")).join(" | ");
    let mut text = format!(
        "| cell | {names} | error nominal, mm | error identified, mm | Spearman nominal | Spearman \
         identified |\n|{}\n",
        " --- |".repeat(10)
    );
    for one in all {
        let hidden = one.hidden.iter().map(|[is, found, sd]| match sd.is_nan() {
            true => format!("{is:.3}, not told"),
            false => format!("{is:.3}, {found:.3} ± {sd:.3}"),
        });
        let hidden: Vec<String> = hidden.collect();
        let [(before, order), (after, ordered)] = one.judged();
        text += &format!(
            "| {} | {} | {before:.2} | {after:.2} | {order:+.2} | {ordered:+.2} |\n",
            one.cell,
            hidden.join(" | ")
        );
    }
    let count = |good: &dyn Fn(&Tried) -> bool| all.iter().filter(|one| good(one)).count();
    let halved = count(&|one| one.judged()[1].0 <= 0.5 * one.judged()[0].0);
    let ordered = count(&|one| {
        let [(_, before), (_, after)] = one.judged();
        after >= 0.9 || after >= before + 0.2
    });
    let told = || all.iter().flat_map(|one| &one.hidden).filter(|row| !row[2].is_nan());
    // Of numbers that are all above 0 and drawn over their logarithms.
    let inside =
        told().filter(|[is, found, sd]| libm::log(is / found).abs() <= EIGHTY * sd / found);
    let errors = |way: usize| mean(all.iter().map(|one| one.judged()[way].0)).unwrap_or(f64::NAN);
    text + &format!(
        "\n{} cells. Friction within 15 %: {}; stiffness of the robot along z within 10 %: {}. 80 % intervals \
         hold {} of {} hidden numbers that were told. Mean error of the ranges {:.2} mm, in the nominal cell \
         {:.2} mm; at most half in {halved}; Spearman at least 0.9, or 0.2 higher, in {ordered}.\n",
        all.len(),
        count(&|one| one.off(0) <= 0.15),
        count(&|one| one.off(1) <= 0.10),
        inside.count(),
        told().count(),
        errors(1),
        errors(0),
    )
}
