//! `optimize task new`: creates a task file.

use crate::layout::wrapped;
use crate::setup::files::{check_is_new, robot};
use crate::setup::tune::{brief, chosen, tune_new};
use crate::{Context, Failure, Output, RobotRequest, TaskCheck, TaskFile, command, read_task};
use connector::draft::{self, Dimensions, Hole, Size};
use connector::pins::Pins;
use connector::tune::Tuned;
use connector::write::{self, Notes};
use input::shipped::Source;
use input::units::MM;
use insertion::task::checked_name;
use parameters::numbers;
use serde_json::json;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use study::write_file;

/// Create a commented task file from a few dimensions, or from another task
///
/// With --plug, --round or --pins, start, tilt, strokes and success depth are derived from the geometry; with --like
/// as well, friction and grasp force are those of that task. With --like alone the file is a copy of that task.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: optimize task new usb-c --plug 8.25x2.4x6.65 --clearance 0.1 --body 12x6.5x20"
)]
pub struct Request {
    /// Name of the task: letters, digits, - and _
    #[arg(value_name = "NAME", value_parser = checked_name)]
    pub name: String,
    /// Plug: width (y, between the jaws) x height (x) x length, mm
    #[arg(long, value_name = "WxHxL", requires = "clearance", group = "tip")]
    pub plug: Option<Size>,
    /// Cylindrical plug: diameter x length, mm
    #[arg(long, value_name = "DxL", requires = "clearance", group = "tip", value_parser = Size::round)]
    pub round: Option<Size>,
    /// Plug of square pins: rows (y, between the jaws) x columns (x); each has its own hole
    #[arg(long, value_name = "NxM", requires = "clearance", group = "tip", value_parser = Pins::count)]
    pub pins: Option<[u32; 2]>,
    /// Distance from pin to pin, mm [default: 2.54]
    #[arg(long, value_name = "MM", requires = "pins", value_parser = Pins::length_mm)]
    pub pitch_mm: Option<f64>,
    /// Side of a pin, mm [default: 0.64]
    #[arg(long, value_name = "MM", requires = "pins", value_parser = Pins::length_mm)]
    pub pin_mm: Option<f64>,
    /// Length of a pin, mm [default: 6]
    #[arg(long, value_name = "MM", requires = "pins", value_parser = Pins::length_mm)]
    pub pin_length_mm: Option<f64>,
    /// Clearance, mm: opening minus plug in x and y, both sides together
    #[arg(long, value_name = "C", requires = "tip",
          value_parser = |text: &str| parse_mm(text, "connector.clearance_mm", 0.1))]
    pub clearance: Option<f64>,
    /// Key of a cylindrical plug, on its side across the jaws (+x): width x height beyond the cylinder, mm
    #[arg(long, value_name = "WxH", requires = "round", conflicts_with = "plug", value_parser = draft::key)]
    pub key: Option<[f64; 2]>,
    /// Chamfer of 45 degrees at the opening of a plug with flat sides, mm
    #[arg(long, value_name = "MM", requires = "plug", conflicts_with = "round",
          value_parser = |text: &str| parse_mm(text, "task.socket.part.x.edges.0.chamfer_mm", 0.3))]
    pub chamfer_mm: Option<f64>,
    /// Body that the fingers hold, above the plug: width x height x length, mm [default: the plug itself; for
    /// pins their block, 20 mm long]
    #[arg(long, value_name = "WxHxL", requires = "tip")]
    pub body: Option<Size>,
    /// Task to start from: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file
    #[arg(long, value_name = "T")]
    pub like: Option<String>,
    /// File to write [default: NAME.toml]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Robot and contact engine.
    #[command(flatten)]
    pub robot: RobotRequest,
}

impl command::Request for Request {
    const PROGRESS: bool = true;

    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        // Checked before a file is written.
        robot(&self.robot.name)?;
        let _busy = context.busy("trying strategies");
        let like = self.like.as_deref().map(read_task).transpose()?;
        let (text, tuned) = match (&like, tip(self)) {
            (Some(like), None) => (copy(&self.name, like), None),
            (like, _) => drafted(self, like.as_ref(), context.stop)?,
        };
        let out = self.out.clone().unwrap_or_else(|| format!("{}.toml", self.name).into());
        let file = out.display().to_string();
        // Checks the name and that the file can be read.
        let written = TaskFile::parse(Source { file: file.clone(), text })?;
        check_is_new(&out)?;
        write_file(&out, &written.source.text)?;
        let checked = TaskCheck::of(written.source, &self.robot, context.stop)?;
        let tuned = tuned.as_ref();
        let strategy = tuned.map_or(String::new(), |tuned| brief("strategy", tuned));
        let text = format!("written       {file}\n{strategy}{}", checked.text_of_new());
        let value = json!({"out": file, "tuned": chosen(tuned), "check": checked.json()});
        Ok(Output { failure: checked.failure_of_new(tuned), ..Output::new(wrapped(&text), value) })
    }
}

/// Returns the text of a new task file, with the tuning of its strategy.
fn drafted(
    request: &Request,
    like: Option<&TaskFile>,
    stop: &AtomicBool,
) -> Result<(String, Option<Tuned>), Failure> {
    let (Some(plug), Some(clearance)) = (tip(request), request.clearance) else {
        return Err(Failure::usage("give --plug, --round or --pins, with --clearance; or --like"));
    };
    let (clearance, pins) = (clearance * MM, pins(request));
    let body = request.body.or(pins.map(|pins| pins.body()));
    let (key, chamfer) = (request.key, request.chamfer_mm.map(|mm| mm * MM));
    let round = request.round.is_some();
    let size = Dimensions { plug, pins, round, clearance, key, chamfer, body };
    let task =
        draft::draft(&request.name, &size, like.map(|like| &like.task)).map_err(Failure::usage)?;
    let body = size.body.map_or(String::new(), |body| format!(" --body {}", text(&body)));
    let tip = match (size.pins, size.round) {
        (Some(Pins { count: [rows, columns], pitch, side, length }), _) => {
            let [pitch, side, length] = [pitch, side, length].map(|length| mm(&[length]));
            format!(
                "--pins {rows}x{columns} --pitch-mm {pitch} --pin-mm {side} --pin-length-mm {length}"
            )
        }
        (None, true) => format!("--round {}", mm(&[size.plug.width, size.plug.length])),
        (None, false) => format!("--plug {}", text(&size.plug)),
    };
    let (name, clearance_mm) = (&request.name, mm(&[size.clearance]));
    let key = size.key.map_or(String::new(), |key| format!(" --key {}", mm(&key)));
    let leg = size.chamfer.map_or(String::new(), |leg| format!(" --chamfer-mm {}", mm(&[leg])));
    let command =
        format!("optimize task new {name} {tip}{key} --clearance {clearance_mm}{leg}{body}");
    let mut head = vec![format!("Made by: {command}")];
    if size.round {
        let hole = Hole::new(size.plug.width, size.clearance);
        head.push(format!(
            "The hole has {} flats, which keep its diameter within {:.4} mm.",
            hole.flats,
            2.0 * hole.deviation / MM
        ));
    }
    let (task, tuned) = tune_new(task, &request.robot, stop)?;
    Ok((write::task(&task, &Notes { head, ..Notes::default() }), tuned))
}

/// Returns the pins of the plug.
fn pins(request: &Request) -> Option<Pins> {
    let [pitch, side, length] =
        [(request.pitch_mm, 2.54), (request.pin_mm, 0.64), (request.pin_length_mm, 6.0)]
            .map(|(given, usual)| given.unwrap_or(usual) * MM);
    request.pins.map(|count| Pins { count, pitch, side, length })
}

/// Returns the size of the inserted part.
fn tip(request: &Request) -> Option<Size> {
    request.plug.or(request.round).or(pins(request).map(|pins| pins.size()))
}

fn text(size: &Size) -> String {
    mm(&[size.width, size.height, size.length])
}

/// Formats lengths, m, as the options expect them: `8.25x2.4x6.65`, mm.
fn mm(lengths: &[f64]) -> String {
    let mm = |length: &f64| ((length / MM * 1e4).round() / 1e4).to_string();
    lengths.iter().map(mm).collect::<Vec<_>>().join("x")
}

/// Returns a copy of a task's file under another name.
fn copy(name: &str, TaskFile { source, task }: &TaskFile) -> String {
    let line =
        |key: &str, value: &str| format!("{key} = {}", toml::Value::String(value.to_owned()));
    let described = format!("like {}: {}", task.name, task.description);
    let mut head = true;
    let lines = source.text.lines().map(|text| {
        head &= !text.starts_with('[');
        match text.split_once('=').map(|(key, _)| key.trim()) {
            Some("name") if head => line("name", name),
            Some("description") if head => line("description", &described),
            _ => text.to_owned(),
        }
    });
    lines.collect::<Vec<_>>().join("\n") + "\n"
}

/// Parses a length, mm, within the bounds of the number `key`; `example` is for the error.
fn parse_mm(text: &str, key: &str, example: f64) -> Result<f64, String> {
    let mm = text.parse::<f64>().map_err(|_| format!("give a number of mm, as in {example}"))?;
    numbers::problem(key, mm).map_or(Ok(mm), Err)
}
