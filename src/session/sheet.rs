//! The sheet to measure windows by hand.

use super::{Failure, FingerRequest, SetupRequest, TaskSource, TrialDone, TrialRequest, read_task};
use crate::report::sheet::{self, Picture};
use crate::study::write_file;
use insertion::outcome::Outcome;
use insertion::trial::picture;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

/// How far outward pictures are looked for, mm.
const FARTHEST_MM: u8 = 12;
/// Shipped examples of what no start of the task shows: task, shift, mm, and grip, N, unless it is the task's.
const EXAMPLES: [(&str, f64, Option<f64>); 5] = [
    ("ket8", 0.0, None),
    ("ket8", 0.0, Some(0.02)),
    ("ket8", -12.0, None),
    ("ket8", 3.0, None),
    ("usb", -10.0, None),
];

/// Of which task and fingers the windows are to be measured.
#[derive(Debug, Clone, clap::Args)]
pub struct SheetRequest {
    /// Task: ket8, ket12, rj45, usb, or the path of a task file
    #[arg(long, value_name = "NAME")]
    pub task: String,
    /// Infill density, percent, and direction, degrees, of a finger; may be given several times
    #[arg(long = "finger", value_name = "PERCENT,DEG", required = true, value_parser = infill)]
    pub fingers: Vec<(f64, f64)>,
    /// File to write
    #[arg(long, value_name = "FILE.html")]
    pub out: PathBuf,
}

fn infill(text: &str) -> Result<(f64, f64), String> {
    match text.split_once(',').map(|(a, b)| (a.trim().parse(), b.trim().parse())) {
        Some((Ok(density), Ok(direction))) => Ok((density, direction)),
        _ => Err("a finger is PERCENT,DEG, as in 10,0".to_owned()),
    }
}

impl SheetRequest {
    /// Simulates how insertions of the fingers end, and writes the sheet.
    pub fn run(&self, stop: &AtomicBool) -> Result<(), Failure> {
        let task = read_task(&self.task)?.task;
        let shifts = (1..=FARTHEST_MM).flat_map(|mm| [f64::from(mm), -f64::from(mm)]);
        let outward = shifts.filter_map(|shift| Some((self.fingers.first()?, shift)));
        let mut pictures = Vec::new();
        for (&finger, shift) in self.fingers.iter().map(|finger| (finger, 0.0)).chain(outward) {
            picture(&mut pictures, &tried(&self.task, finger, (shift, None), stop)?, None);
        }
        for (task, shift, grip) in EXAMPLES {
            picture(&mut pictures, &tried(task, (10.0, 0.0), (shift, grip), stop)?, Some(task));
        }
        pictures.sort_by_key(|picture| picture.outcome.failure());
        Ok(write_file(&self.out, &sheet::page(&task, &self.task, &self.fingers, &pictures))?)
    }
}

/// A trial with the start shifted by so much, mm, held with so much, N.
fn tried(
    task: &str,
    (density, direction): (f64, f64),
    (offset_mm, grip): (f64, Option<f64>),
    stop: &AtomicBool,
) -> Result<TrialDone, Failure> {
    let tasks = vec![TaskSource::Named(task.to_owned())];
    let set = grip.map(|force| ("task.grip.force_n".to_owned(), force)).into_iter().collect();
    let (density, direction) = (Some(density), Some(direction));
    let finger = FingerRequest { density, direction, set, ..FingerRequest::default() };
    let setup = SetupRequest { tasks, ..SetupRequest::default() };
    TrialRequest { setup, finger, offset_mm, ..TrialRequest::default() }.run(stop)
}

/// Keeps the picture of an outcome that is met for the first time.
fn picture(pictures: &mut Vec<Picture>, done: &TrialDone, example: Option<&'static str>) {
    let outcome = done.trial.outcome;
    if outcome != Outcome::Diverged && pictures.iter().all(|one| one.outcome != outcome) {
        let specimen = &done.chosen.specimen;
        let svg = picture::ended(&specimen.task, &specimen.finger.pad, &done.trial);
        pictures.push(Picture { outcome, svg, example });
    }
}
