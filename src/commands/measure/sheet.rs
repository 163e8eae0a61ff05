//! `optimize measure sheet`: sheet for measuring windows by hand.

use crate::commands::trial;
use crate::setup::finger::InfillRequest;
use crate::{
    Context, Failure, FingerRequest, Output, SetupRequest, TaskSource, command, read_task,
};
use insertion::trial::picture;
use insertion::{Outcome, Scenario};
use report::sheet::{self, Picture};
use std::collections::BTreeMap;
use std::path::PathBuf;
use study::write_file;

/// Largest offset for which outcomes are simulated, mm.
const FARTHEST_MM: u8 = 12;
/// Shipped examples of each outcome, for outcomes that do not occur on the task.
const EXAMPLES: [Example<'_>; 5] = [
    ("ket8", (10.0, 0.0), 0.0, None),
    ("ket8", (10.0, 0.0), 0.0, Some(0.02)),
    ("ket8", (10.0, 0.0), -12.0, None),
    ("ket8", (10.0, 0.0), 3.0, None),
    ("usb", (10.0, 0.0), -10.0, None),
];

/// Trial to draw: task, infill, shift of the start, mm, and grip force, N, if not that of the task.
type Example<'a> = (&'a str, (f64, f64), f64, Option<f64>);

/// Write a printable sheet for measuring windows by hand
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: optimize measure sheet --task usb --finger 10,0 --out sheet.html")]
pub struct Request {
    /// Task: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file
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
    let pair = text.split_once(',');
    let pair = pair.and_then(|(a, b)| a.trim().parse().ok().zip(b.trim().parse().ok()));
    pair.ok_or_else(|| "must be PERCENT,DEG, for example 10,0".to_owned())
}

impl command::Request for Request {
    /// Simulates insertions of the fingers and writes the sheet.
    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let task = read_task(&self.task)?.task;
        let shifts = (1..=FARTHEST_MM).flat_map(|mm| [f64::from(mm), -f64::from(mm)]);
        let outward = shifts.filter_map(|shift| Some((self.fingers.first()?, shift)));
        let own = self.fingers.iter().map(|finger| (finger, 0.0)).chain(outward);
        let own = own.map(|(finger, shift)| (&*self.task, *finger, shift, None));
        let drawn = own.chain(EXAMPLES).map(|example| draw(example, context));
        let mut pictures = drawn.collect::<Result<Vec<_>, Failure>>()?;
        pictures.retain(|picture| picture.outcome != Outcome::Diverged);
        pictures.sort_by_key(|picture| picture.outcome.failure());
        pictures.dedup_by_key(|picture| picture.outcome);
        write_file(&self.out, &sheet::page(&task, &self.task, &self.fingers, &pictures))?;
        let text = format!("wrote {}\n", self.out.display());
        Ok(Output::new(text, BTreeMap::from([("out", &self.out)])))
    }
}

/// Simulates a trial and draws its final state.
fn draw(
    (task, infill, offset_mm, grip): Example<'_>,
    context: &Context<'_>,
) -> Result<Picture, Failure> {
    let tasks = vec![TaskSource::Named(task.to_owned())];
    let set = grip.map(|force| ("task.grip.force_n".to_owned(), force)).into_iter().collect();
    let infill = InfillRequest::of(infill.0, infill.1);
    let finger = FingerRequest { infill, set, ..FingerRequest::default() };
    let setup = SetupRequest { tasks, ..SetupRequest::default() };
    let trial = trial::Request { setup, finger, offset_mm, ..trial::Request::default() };
    let done = trial.done(context)?;
    let Scenario { task, finger, .. } = done.chosen.scenario;
    let svg = picture::final_state(&task, &finger.pad, &done.trial);
    Ok(Picture { outcome: done.trial.outcome, svg, task: task.name })
}
