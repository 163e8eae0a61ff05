//! Identification of a hidden cell from its logs, compared with its hidden values and with the windows of fingers that
//! were not logged.

use super::cell::{FingerWindows, HIDDEN, HiddenCell, window};
use super::logs::LOGGED;
use ask_tell::statistics::{mean, spearman};
use finger_opt::commands::identify;
use finger_opt::context::Context;
use finger_opt::failure::Failure;
use finger_opt::setup::request::{SetupRequest, TaskSource};
use insertion::robot::{Drive, Robot};
use insertion::space::Design;
use insertion::trial::NEVER;
use insertion::trial::engine::EngineKind;
use rayon::prelude::*;
use std::path::Path;

/// Returns the header of `cells.csv`: `_found` is an identified value, `_sd` its standard deviation.
pub fn header() -> String {
    let hidden = HIDDEN.map(|(_, name)| format!("{name},{name}_found,{name}_sd,")).concat();
    format!(
        "cell,task,{hidden}error_nominal_mm,error_identified_mm,spearman_nominal,spearman_identified\n"
    )
}

/// Identifies a cell from the logs in a folder. Returns its line of `cells.csv`: hidden and identified values, then
/// mean absolute error and rank correlation with MuJoCo of the ranges of the fingers that were not logged, in the
/// nominal and in the identified cell.
pub fn line(
    cell: &HiddenCell<'_>,
    windows: &[FingerWindows],
    folder: &Path,
) -> Result<String, Failure> {
    let task = &cell.template.task.name;
    let tasks = vec![TaskSource::Named(task.clone())];
    let request = identify::Request {
        setup: SetupRequest { tasks, ..SetupRequest::default() },
        runs: folder.join("runs.csv"),
        frame: Some(folder.join("frame.toml")),
        priors: "bench".to_owned(),
        ..identify::Request::default()
    };
    let found = request.identify(&Context::silent(&NEVER))?.cell;
    let robot = found.robot("cell").map_err(Failure::input)?;
    let values: Vec<_> = found.of(task).map(|parameter| (parameter, parameter.middle())).collect();

    let mut line = format!("{},{task},", cell.number);
    for ((name, _), hidden) in HIDDEN.iter().zip(cell.shown()) {
        let estimate = values.iter().find(|(parameter, _)| parameter.name == *name);
        let sd = estimate.and_then(|(parameter, _)| parameter.sd);
        // The identified stiffness is in the robot; its parameter is the remaining factor, 1, with a relative
        // deviation.
        let (value, sd) = match *name {
            "stiffness of the flange" => {
                let factor = robot.as_ref().and_then(flange_stiffness);
                let factor =
                    factor.zip(flange_stiffness(&cell.evaluator.robot)).map(|(a, b)| a / b);
                (factor, sd.zip(factor).map(|(sd, factor)| sd * factor))
            }
            _ => (estimate.map(|(_, value)| *value), sd),
        };
        let cell = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.3}"));
        line += &format!("{hidden:.3},{},{},", cell(value), cell(sd));
    }

    let not_logged = |one: &&FingerWindows| !LOGGED.contains(&one.finger.infill());
    let others: Vec<&FingerWindows> = windows.iter().filter(not_logged).collect();
    let identified = others.par_iter().map(|one| {
        let design = Design::infill(one.finger.density_percent, one.finger.direction_deg);
        let under = cell.evaluator.apply(cell.template, (&design, None), &values);
        let mut scenario = under.map_err(Failure::input)?;
        scenario.robot = robot.clone().unwrap_or(scenario.robot);
        let taught = window(&scenario, EngineKind::Direct, None)?;
        Ok(taught.map_or(0.0, |taught| taught.evaluation.window.range_mm()))
    });
    let identified = identified.collect::<Result<Vec<f64>, Failure>>()?;
    let nominal = others.iter().map(|one| one.range_mm(2)).collect();
    let judged = [nominal, identified].map(|ranges: Vec<f64>| {
        let pairs: Vec<_> = others.iter().map(|one| one.range_mm(0)).zip(ranges).collect();
        let error = mean(pairs.iter().map(|(truth, range)| (truth - range).abs()));
        (error.unwrap_or(f64::NAN), spearman(&pairs).unwrap_or(f64::NAN))
    });
    let [(before, order), (after, ordered)] = judged;
    Ok(line + &format!("{before:.2},{after:.2},{order:.2},{ordered:.2}\n"))
}

/// Returns the stiffness of a servo's flange along z, N/m.
fn flange_stiffness(robot: &Robot) -> Option<f64> {
    let Drive::Servo(servo) = &robot.drive else { return None };
    Some(servo.stiffness[2])
}
