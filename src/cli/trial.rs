//! `optimize trial`: one simulated insertion.

use super::film::FilmArguments;
use super::repeat::{self, RepeatArguments};
use super::setup::{Setup, SetupArguments};
use super::specimen::{Chosen, FingerArguments};
use super::words::{self, merge, number};
use super::{Failure, print, print_json};
use crate::study::write_file;
use clap::Args;
use input::units::MM;
use insertion::evaluation::{OffsetStep, grid_mm};
use insertion::outcome::Outcome;
use insertion::trial::{NEVER, Sample, Trial, picture};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Largest offset accepted, mm: far outside any socket.
const LARGEST_OFFSET_MM: f64 = 1000.0;

/// Simulate one insertion.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    pub setup: SetupArguments,
    #[command(flatten)]
    finger: FingerArguments,
    /// Shift of the start along y, mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true, default_value_t = 0.0,
          value_parser = offset)]
    offset_mm: f64,
    #[command(flatten)]
    repeat: RepeatArguments,
    #[command(flatten)]
    film: FilmArguments,
    /// Draw plug, fingertips and socket at the end of each phase
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<std::path::PathBuf>,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// What the command found.
pub struct Found {
    setup: Setup,
    chosen: Chosen,
    taught: Option<OffsetStep>,
    trial: Trial,
    /// The course of the trial, if it was asked for.
    pub samples: Vec<Sample>,
    repeats: Option<BTreeMap<String, usize>>,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let found = find(arguments, None)?;
    if arguments.json {
        return print_json(&found.json(arguments));
    }
    let repeats = found.repeats.as_ref().map(repeat::outcomes_text).unwrap_or_default();
    let start = words::taught(found.taught).map_or(String::new(), |line| line + "\n");
    let drawn = arguments.svg.iter().map(|file| format!("wrote         {}\n", file.display()));
    let wrote: String = drawn.chain([arguments.film.written()]).collect();
    let chosen = found.chosen.text(&found.setup);
    print(&format!("{chosen}\n{start}{}{repeats}{wrote}", text(&found.trial)))
}

/// Simulates, with a sample each `every_s` seconds if that is given.
pub fn find(arguments: &Arguments, every_s: Option<f64>) -> Result<Found, Failure> {
    let setup = Setup::from_arguments(&arguments.setup)?;
    let chosen = arguments.finger.choose(&setup)?;
    let specimen = &chosen.specimen;
    let offset = arguments.offset_mm * MM;
    let taught = setup.evaluator.taught(specimen, &NEVER).map_err(Failure::input)?;
    let rig = setup.evaluator.rig(specimen, taught, 1.0).map_err(Failure::input)?;
    let filmed = arguments.film.record(&*rig, specimen, arguments.offset_mm)?;
    let (trial, samples) = match (every_s, filmed) {
        (Some(every_s), _) => rig.grasp(&specimen.finger).traced(offset, every_s),
        (None, Some(recording)) => (recording.trial, Vec::new()),
        (None, None) => (rig.grasp(&specimen.finger).trial(offset), Vec::new()),
    };
    drop(rig);
    if let Some(file) = &arguments.svg {
        let label =
            format!("{}, start shifted by {:+.1} mm", specimen.task.name, arguments.offset_mm);
        write_file(file, &picture::svg(&specimen.task, &specimen.finger.pad, &trial, &label))?;
    }
    let repeats = arguments.repeat.outcomes(&setup, &chosen, (taught, offset))?;
    Ok(Found { setup, chosen, taught, trial, samples, repeats })
}

impl Found {
    /// What `--json` prints.
    pub fn json(&self, arguments: &Arguments) -> Value {
        let mut fields = self.chosen.json(&self.setup, &arguments.finger);
        let trial = &self.trial;
        merge(
            &mut fields,
            json!({
                "offset_mm": arguments.offset_mm,
                "outcome": trial.outcome.word(),
                "failure": trial.outcome.failure(),
                "depth_mm": trial.depth_mm,
                "tilt_deg": trial.tilt_deg,
                "peak_force_n": trial.peak_force_n,
                "slip_mm": trial.slip_mm,
                "simulated_s": trial.simulated_s,
                "retried_at_half_step": trial.retried,
                "phases": trial.phases,
            }),
        );
        if let Some(taught) = self.taught {
            merge(&mut fields, json!({ "taught_start_mm": grid_mm(taught) }));
        }
        if let Some(counts) = &self.repeats {
            merge(&mut fields, json!({ "repeats": counts }));
        }
        fields
    }
}

fn text(trial: &Trial) -> String {
    let reason = match trial.outcome {
        Outcome::Failed(class) => format!(": {} (class {})", class.label(), class.number()),
        Outcome::Inserted | Outcome::Diverged => String::new(),
    };
    let mut text = format!(
        "outcome       {}{reason}\ndepth         {}\ntilt          {}\npeak force    {}\n\
         slip          {}\n",
        trial.outcome.word(),
        number(trial.depth_mm, 2, "mm"),
        number(trial.tilt_deg, 2, "deg"),
        number(trial.peak_force_n, 1, "N"),
        number(trial.slip_mm, 2, "mm"),
    );
    if trial.phases.is_empty() {
        return text;
    }
    text += "\nphase         end s   tip x mm  tip y mm  tip z mm  tilt deg  slip mm  peak N\n";
    for phase in &trial.phases {
        let [x, y, z] = phase.tip_mm;
        text.push_str(&format!(
            "{:<12} {:6.2}  {x:9.2} {y:9.2} {z:9.2} {:9.2} {:8.2} {:7.1}\n",
            phase.name, phase.time_s, phase.tilt_deg, phase.slip_mm, phase.peak_force_n
        ));
    }
    text
}

fn offset(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        // Written so that a NaN is outside.
        Ok(value) if value.abs() <= LARGEST_OFFSET_MM => Ok(value),
        _ => Err(format!("an offset is a number of mm between ±{LARGEST_OFFSET_MM}")),
    }
}
