//! `optimize trial`: simulates one insertion.

use crate::setup::driven::undriven;
use crate::setup::film::{recordable, start_label};
use crate::setup::finger::usage;
use crate::setup::repeat::{RepeatRequest, impossible_text};
use crate::setup::task::outcome_json;
use crate::setup::words::{parse_at_least_0, parse_number};
use crate::{
    ChosenFinger, Context, Failure, FingerRequest, Output, SetupRequest, command, layout,
    not_stopped,
};
use calibration::identify::log::of_samples;
use input::units::MM;
use insertion::outcome::stop_words;
use insertion::trial::{Sample, picture};
use insertion::{Grasp, Outcome, Recording, Rig, Scenario, Trial, grid_mm};
use report::answer::lines;
use report::answer::words::number;
use report::replay::{self, Film};
use report::text_table;
use serde::{Serialize, Serializer};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use study::write_file;

/// Largest accepted offset, mm.
const LARGEST_OFFSET_MM: f64 = 1000.0;

fn offset(text: &str) -> Result<f64, String> {
    let problem =
        format!("must be a number between -{LARGEST_OFFSET_MM} and {LARGEST_OFFSET_MM} (mm)");
    parse_number(text, |mm| mm.abs() <= LARGEST_OFFSET_MM, &problem)
}

/// Simulate one insertion
#[derive(Debug, Clone, Default, clap::Args)]
#[command(
    override_usage = usage("trial"),
    after_help = "Example: optimize trial --task ket12 --density 10 --direction 0 --offset-mm 0.5 --svg trial.svg"
)]
pub struct Request {
    /// One task, robot and finger model.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// The finger.
    #[command(flatten)]
    pub finger: FingerRequest,
    /// Shift of the start along y, mm
    #[arg(long, value_name = "MM", default_value_t = 0.0,
          value_parser = offset)]
    pub offset_mm: f64,
    /// Repeats at that offset.
    #[command(flatten)]
    pub repeat: Option<RepeatRequest>,
    /// Simulated time between two samples of the time series in the JSON, s
    #[arg(long, value_name = "S", hide = true, value_parser = |text: &str| parse_at_least_0(text, "s"))]
    pub every_s: Option<f64>,
    /// Record the trial: a page that plays it
    #[arg(long, value_name = "FILE.html", value_parser = recordable)]
    pub record: Option<PathBuf>,
    /// Draw force against depth
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
    /// Include the page that plays the trial in the result
    #[arg(long = "film", hide = true)]
    pub page: bool,
    /// Write force and pose at 500 Hz, as a robot logs them, from the start of the search
    #[arg(long, value_name = "FILE.csv")]
    pub log: Option<PathBuf>,
    /// Slide the part on a flat plate instead of inserting it: 8 mm along y and back at 5 N, for `identify`
    #[arg(long, requires = "log", conflicts_with_all = ["repeat", "svg", "record", "plot"])]
    pub probe: bool,
    /// Draw plug, fingertips and socket at the end of each phase
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
}

/// Result of a trial.
#[derive(Serialize)]
pub struct Done {
    /// The finger on its task.
    #[serde(flatten)]
    pub chosen: ChosenFinger,
    /// Shift of the start along y, mm.
    pub offset_mm: f64,
    /// Simulated trial.
    #[serde(flatten, serialize_with = "whole")]
    pub trial: Trial,
    /// Shift of a taught start relative to that of the task, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub taught_start_mm: Option<f64>,
    /// Number of repeats with each outcome, with `--repeat`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub repeats: Option<BTreeMap<String, usize>>,
    /// Number of draws of the cell's numbers that are impossible on this task and left out, with `--repeat`.
    #[serde(rename = "impossible_draws", skip_serializing_if = "Option::is_none")]
    pub impossible: Option<usize>,
    /// Time series from the start of the search, with `--every-s`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub series: Option<Value>,
    /// HTML page that plays the trial, with the hidden option `--film`.
    #[serde(rename = "film", skip_serializing_if = "Option::is_none")]
    pub page: Option<String>,
}

impl command::Request for Request {
    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let done = self.done(context)?;
        let files = [&self.svg, &self.log, &self.record, &self.plot];
        let written = layout::wrote(files.into_iter().flatten());
        Ok(Output::new(layout::wrapped(&done.text()) + &written, done))
    }
}

impl Request {
    /// Simulates the trial and writes its files.
    ///
    /// # Errors
    /// If an input cannot be used, a file cannot be written, or the run is cancelled.
    pub fn done(&self, context: &Context<'_>) -> Result<Done, Failure> {
        let (stop, offset_mm) = (context.stop, self.offset_mm);
        let setup = self.setup.setup()?;
        let chosen = self.finger.choose(&setup)?;
        let scenario = &chosen.scenario;
        let offset = offset_mm * MM;
        let taught = setup.evaluator.taught(scenario, stop)?;
        let rig = setup.evaluator.rig(scenario, taught, 1.0)?;
        let (filmed, page) = self.recorded(&*rig, scenario, stop)?;
        let grasp = Grasp { stop, ..Grasp::of(&scenario.finger) };
        let (trial, samples) = match (self.every_s, filmed) {
            _ if self.probe => {
                setup.evaluator.rig(scenario, None, 1.0)?.probe(grasp).ok_or_else(undriven)?
            }
            _ if self.log.is_some() => rig.grasp(grasp).logged(offset),
            (None, Some(recording)) => (recording.trial, Vec::new()),
            (every_s, _) => rig.grasp(grasp).run(offset, every_s, 0.0),
        };
        not_stopped(stop)?;
        if let Some(file) = &self.log {
            write_file(file, &of_samples(&file.to_string_lossy(), &samples)?.csv())?;
        }
        if let Some(file) = &self.svg {
            let label = format!("{}, start shifted by {offset_mm:+.1} mm", scenario.task.name);
            write_file(file, &picture::svg(&scenario.task, &scenario.finger.pad, &trial, &label))?;
        }
        drop(rig);
        let outcomes = |repeat: RepeatRequest| {
            repeat.run(&setup, scenario, taught, context, |repeats| repeats.outcomes(offset))
        };
        let (outcomes, impossible) = self.repeat.map(outcomes).transpose()?.unzip();
        let repeats = outcomes.map(|outcomes| {
            let mut counts = BTreeMap::new();
            for outcome in outcomes {
                let word = match outcome {
                    Outcome::Failed(class) => format!("failed: {}", class.label()),
                    outcome => outcome.word().to_owned(),
                };
                *counts.entry(word).or_default() += 1;
            }
            counts
        });
        let series = self.every_s.map(|_| series(&samples));
        let taught_start_mm = taught.map(grid_mm);
        Ok(Done { chosen, offset_mm, trial, taught_start_mm, repeats, impossible, series, page })
    }

    /// Records the trial and writes the requested outputs; returns the recording (`None` if no output was requested),
    /// and the page if it was requested.
    fn recorded(
        &self,
        rig: &dyn Rig,
        scenario: &Scenario,
        stop: &AtomicBool,
    ) -> Result<(Option<Recording>, Option<String>), Failure> {
        if self.record.is_none() && self.plot.is_none() && !self.page {
            return Ok((None, None));
        }
        let grasp = Grasp { stop, ..Grasp::of(&scenario.finger) };
        let recording = rig.record(grasp, self.offset_mm * MM).ok_or_else(|| {
            Failure::usage("--record and --plot need an engine that simulates: --engine direct")
        })?;
        not_stopped(stop)?;
        let label = &start_label(self.offset_mm);
        let (task, pad) = (&scenario.task, &scenario.finger.pad);
        let film = Film { label, task, pad, recording: &recording };
        let page = || replay::page(&format!("{}, {label}", scenario.task.name), &[film]);
        if let Some(file) = &self.record {
            write_file(file, &page())?;
        }
        if let Some(file) = &self.plot {
            write_file(file, &replay::curve_svg(&film)?)?;
        }
        let page = self.page.then(page);
        Ok((Some(recording), page))
    }
}

impl Done {
    fn text(&self) -> String {
        // For example `repeats       18 inserted, 2 failed: jammed`.
        let repeats = self.repeats.as_ref().map_or(String::new(), |counts| {
            let counts = counts.iter().map(|(outcome, count)| format!("{count} {outcome}"));
            format!("repeats       {}\n", counts.collect::<Vec<_>>().join(", "))
        });
        let start = layout::lines(lines::taught(self.taught_start_mm));
        let impossible = impossible_text(self.impossible.unwrap_or(0));
        format!("{}{start}{}{repeats}{impossible}", self.chosen.text(), text(&self.trial))
    }
}

/// Returns the time series of a trial from the start of the search, a value for each sample.
fn series(samples: &[Sample]) -> Value {
    let each = |value: fn(&Sample) -> Value| samples.iter().map(value).collect::<Value>();
    json!({
        "time_s": each(|sample| json!(sample.time_s)),
        "phase": each(|sample| json!(sample.phase)),
        "tcp_mm": each(|sample| json!(sample.tcp_mm)),
        "tip_mm": each(|sample| json!(sample.tip_mm)),
        "tilt_deg": each(|sample| json!(sample.tilt_deg)),
        "force_n": each(|sample| json!(sample.force_n)),
        "slip_mm": each(|sample| json!(sample.slip_mm)),
    })
}

fn whole<S: Serializer>(trial: &Trial, serializer: S) -> Result<S::Ok, S::Error> {
    let mut json = outcome_json(trial);
    json["simulated_s"] = json!(trial.simulated_s);
    json["retried_at_half_step"] = json!(trial.retried);
    json["phases"] = json!(trial.phases);
    json.serialize(serializer)
}

fn text(trial: &Trial) -> String {
    let text = format!(
        "outcome       {}{}\ndepth         {}\ntilt          {}\npeak force    {}\n\
         slip          {}\n",
        trial.outcome,
        stop_words(trial.robot_stopped),
        number(trial.depth_mm, 2, "mm"),
        number(trial.tilt_deg, 2, "deg"),
        number(trial.peak_force_n, 1, "N"),
        number(trial.slip_mm, 2, "mm"),
    );
    if trial.phases.is_empty() {
        return text;
    }
    let rows = trial.phases.iter().map(|phase| {
        let [time, tilt, slip] =
            [phase.time_s, phase.tilt_deg, phase.slip_mm].map(|value| format!("{value:.2}"));
        let [x, y, z] = phase.tip_mm.map(|value| format!("{value:.2}"));
        [phase.name.clone(), time, x, y, z, tilt, slip, format!("{:.1}", phase.peak_force_n)]
    });
    let head =
        ["phase", "end s", "tip x mm", "tip y mm", "tip z mm", "tilt deg", "slip mm", "peak N"];
    text + "\n" + &text_table(1, head, rows)
}
