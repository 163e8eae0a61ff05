//! The sheet to measure windows by hand.

use super::failure::not_stopped;
use super::{Chosen, Failure, FingerRequest, Setup, SetupRequest, TaskSource};
use crate::report::sheet::{self, Picture, Sheet};
use crate::study::write_file;
use insertion::outcome::{FailureClass, Outcome};
use insertion::trial::{Grasp, picture};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

/// Starts at which pictures are looked for: so many steps outward, m.
const SHIFTS: (u32, f64) = (24, 0.5e-3);
/// Shipped examples of what no start of the task shows: task, shift, m, and grip, N, unless it is the task's.
const EXAMPLES: [(Outcome, &str, f64, Option<f64>); 5] = [
    (Outcome::Inserted, "ket8", 0.0, None),
    (Outcome::Failed(FailureClass::ContactLossBeforeSearch), "ket8", 0.0, Some(0.02)),
    (Outcome::Failed(FailureClass::PlugMissed), "ket8", -12e-3, None),
    (Outcome::Failed(FailureClass::Jammed), "ket8", 3e-3, None),
    (Outcome::Failed(FailureClass::ContactLossInInsertion), "usb", -10e-3, None),
];

/// Of which task and fingers the windows are to be measured.
#[derive(Debug, Clone, clap::Args)]
pub struct SheetRequest {
    /// Task: ket8, ket12, rj45, usb, or the path of a task file
    #[arg(long, value_name = "NAME")]
    pub task: String,
    /// Infill density, percent, and direction, degrees, of a finger; may be given several times
    #[arg(long, value_name = "PERCENT,DEG", required = true, value_parser = infill)]
    pub finger: Vec<(f64, f64)>,
    /// File to write
    #[arg(long, value_name = "FILE.html")]
    pub out: PathBuf,
}

fn infill(text: &str) -> Result<(f64, f64), String> {
    let parts = text.split_once(',').map(|(a, b)| (a.trim().parse(), b.trim().parse()));
    match parts {
        Some((Ok(density), Ok(direction))) => Ok((density, direction)),
        _ => Err("a finger is PERCENT,DEG, as in 10,0".to_owned()),
    }
}

impl SheetRequest {
    /// Simulates how insertions of the first finger end, and writes the sheet.
    pub fn run(&self, stop: &AtomicBool) -> Result<(), Failure> {
        let shifts = (1..=SHIFTS.0).map(|step| f64::from(step) * SHIFTS.1);
        let shifts: Vec<f64> = [0.0].into_iter().chain(shifts.flat_map(|by| [by, -by])).collect();
        let mut pictures = Vec::new();
        let fingers = self.finger.iter().map(|&finger| choose(&self.task, finger, None));
        let fingers = fingers.collect::<Result<Vec<_>, Failure>>()?;
        let Some((setup, chosen)) = fingers.first() else {
            return Err(Failure::usage("give --finger"));
        };
        look(&mut pictures, (setup, chosen), &shifts, None, stop)?;
        for (outcome, task, shift, grip) in EXAMPLES {
            if pictures.iter().all(|picture: &Picture| picture.outcome != outcome) {
                let (setup, chosen) = choose(task, (10.0, 0.0), grip)?;
                look(&mut pictures, (&setup, &chosen), &[shift], Some(task), stop)?;
            }
        }
        pictures.sort_by_key(|picture| picture.outcome.failure());
        let task = &chosen.specimen.task;
        let sheet = Sheet { task, name: &self.task, fingers: &self.finger, pictures: &pictures };
        Ok(write_file(&self.out, &sheet::page(&sheet))?)
    }
}

fn choose(
    task: &str,
    (density, direction): (f64, f64),
    grip: Option<f64>,
) -> Result<(Setup, Chosen), Failure> {
    let tasks = vec![TaskSource::Named(task.to_owned())];
    let setup = SetupRequest { tasks, ..SetupRequest::default() }.setup()?;
    let set = grip.map(|force| ("task.grip.force_n".to_owned(), force)).into_iter().collect();
    let (density, direction) = (Some(density), Some(direction));
    let finger = FingerRequest { density, direction, set, ..FingerRequest::default() };
    let chosen = finger.choose(&setup)?;
    Ok((setup, chosen))
}

/// Adds a picture of each outcome that these shifts of the start, m, show for the first time.
fn look(
    pictures: &mut Vec<Picture>,
    (setup, chosen): (&Setup, &Chosen),
    shifts: &[f64],
    example: Option<&'static str>,
    stop: &AtomicBool,
) -> Result<(), Failure> {
    let specimen = &chosen.specimen;
    let taught = setup.evaluator.taught(specimen, stop).map_err(Failure::input)?;
    let rig = setup.evaluator.rig(specimen, taught, 1.0).map_err(Failure::input)?;
    let grasp = rig.hold(Grasp { stop, ..Grasp::of(&specimen.finger) });
    for &shift in shifts {
        let trial = grasp.trial(shift);
        not_stopped(stop)?;
        let outcome = trial.outcome;
        let new = pictures.iter().all(|picture| picture.outcome != outcome);
        if outcome != Outcome::Diverged && new {
            let svg = picture::ended(&specimen.task, &specimen.finger.pad, &trial);
            pictures.push(Picture { outcome, svg, example });
        }
    }
    Ok(())
}
