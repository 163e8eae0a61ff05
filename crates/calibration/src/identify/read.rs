//! Parsing of logs: columns `t_s,x_mm,..` in the task's frame, or those of Universal Robots' real-time interface (RTDE)
//! in the frame of the robot's base.

use super::frame::Frame;
use super::log::{COLUMNS, Log, LogSample, TARGETS};
use crate::experiments::line::LARGEST_FORCE_N;
use ask_tell::statistics::median;
use input::files;
use input::units::{DEG, MM};
use input::{InputError, Place, shown};
use insertion::Tcp;
use nalgebra::Vector3;
use std::f64::consts::TAU;
use std::path::Path;

/// Largest size of a log, bytes: ten minutes at 500 Hz.
pub const LARGEST_LOG: u64 = 64 << 20;
/// Largest plausible coordinate of a position, m.
const MAX_REACH: f64 = 10.0;
/// Largest coordinate of a log, mm, below which its unit is taken to be metres.
const MIN_COORDINATE_MM: f64 = 1.0;
/// Largest plausible median time between samples, s.
const MAX_GAP_S: f64 = 0.5;

/// Reads the text of a log.
///
/// # Errors
/// If it cannot be read, or is longer than [`LARGEST_LOG`].
pub fn text(path: &Path) -> Result<String, InputError> {
    let cannot =
        |error| Place::file(path.display().to_string()).fault(format!("cannot be read: {error}"));
    files::read_text(path, LARGEST_LOG).map_err(cannot)
}

/// Parses and checks the text of a log; `file` is named in errors. A log in the base's frame needs `frame`; in the
/// task's frame, its force convention applies if it is given. Lines that begin with `#` are comments.
///
/// # Errors
/// If the header is unknown, a cell is invalid or looks like a value in another unit, or [`Log::new`] rejects the
/// samples.
pub fn parse(text: &str, file: &str, frame: Option<&Frame>) -> Result<Log, InputError> {
    let whole = |problem: String| Place::file(file).fault(problem);
    let mut lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    let ignored = |line: &str| line.trim().is_empty() || line.trim_start().starts_with('#');
    let (at, header) = lines
        .find(|(_, line)| !ignored(line))
        .ok_or_else(|| whole(format!("is empty; a log begins with {}", COLUMNS.join(","))))?;
    let fault = |at: usize, problem: String| Place::file(file).line(at + 1).fault(problem);
    let table = Table::new(header, frame).map_err(|problem| fault(at, problem))?;
    let mut samples: Vec<LogSample> = Vec::new();
    for (at, line) in lines.filter(|(_, line)| !ignored(line)) {
        let mut sample = table.sample(at + 1, line).map_err(|problem| fault(at, problem))?;
        if let (None, Some(target)) = (table.rtde, &mut sample.target) {
            target.tilt = samples.first().map_or(sample.tcp.tilt, |first| first.tcp.tilt);
        }
        samples.push(sample);
    }
    let log = Log::new(file, samples)?;
    check_units(&log).map_err(whole)?;
    Ok(log)
}

/// Checks the units of time and position by the values of a whole log.
fn check_units(log: &Log) -> Result<(), String> {
    let gap = median_gap(log);
    if gap > MAX_GAP_S {
        return Err(format!(
            "the time between its lines is {gap}, which looks like milliseconds; give seconds"
        ));
    }
    let far = log.samples.iter().map(|sample| sample.tcp.position.amax()).fold(0.0, f64::max);
    if far < MIN_COORDINATE_MM * MM {
        return Err(format!(
            "no coordinate exceeds {} mm, so that they look like metres; give millimetres",
            shown(far / MM)
        ));
    }
    Ok(())
}

/// Returns the median time between two samples, s.
pub(super) fn median_gap(log: &Log) -> f64 {
    median(log.samples.windows(2).map(|w| w[1].time_s - w[0].time_s)).unwrap_or(0.0)
}

/// Columns of a log: time, TCP, force, and the commanded TCP if it was recorded.
struct Table<'a> {
    /// Frame for the conversion of poses and force, if the log has RTDE columns.
    rtde: Option<&'a Frame>,
    /// Frame for the convention of the force, if it is given.
    frame: Option<&'a Frame>,
    /// Whether commas separate the cells; otherwise white space does.
    commas: bool,
    /// Names of all columns of the file.
    names: Vec<&'a str>,
    /// Indices of the columns of time, TCP and force.
    places: Vec<usize>,
    /// Indices of the columns of the commanded TCP.
    targets: Vec<usize>,
}

/// Returns the cells of a line, without quotes.
fn cells(line: &str, commas: bool) -> impl Iterator<Item = &str> {
    let cells = line.split(move |c: char| if commas { c == ',' } else { c.is_whitespace() });
    cells.filter(move |cell| commas || !cell.is_empty()).map(|cell| cell.trim().trim_matches('"'))
}

impl<'a> Table<'a> {
    fn new(header: &'a str, frame: Option<&'a Frame>) -> Result<Self, String> {
        if header.contains(';') {
            return Err("its columns are separated by `;`; separate them by commas".to_owned());
        }
        let commas = header.contains(',');
        let names: Vec<&str> = cells(header, commas).collect();
        let axes =
            |name: &str, count: usize| (0..count).map(move |i| format!("{name}_{i}")).collect();
        let [pose, force, goal]: [Vec<String>; 3] =
            [axes("actual_TCP_pose", 6), axes("actual_TCP_force", 3), axes("target_TCP_pose", 6)];
        let rtde = [vec!["timestamp".to_owned()], pose, force].concat();
        let has = |name: &&str| names.contains(name);
        let known = |all: &[String]| all.iter().filter(|name| has(&name.as_str())).count();
        let task = COLUMNS.map(str::to_owned).to_vec();
        let is_rtde = known(&rtde) > known(&task);
        let (needed, goal) = match is_rtde {
            true => (rtde, goal),
            false => (task, TARGETS.map(str::to_owned).to_vec()),
        };
        let wanted = if known(&goal) > 0 { &goal[..] } else { &[] };
        let missing: Vec<&str> =
            needed.iter().chain(wanted).map(String::as_str).filter(|name| !has(name)).collect();
        if missing.len() > needed.len() / 2 {
            return Err(format!(
                "is not the header of a log; required are the columns {}, or `timestamp`, \
                 `actual_TCP_pose_0` to `_5` and `actual_TCP_force_0` to `_5`",
                COLUMNS.join(",")
            ));
        }
        if !missing.is_empty() {
            return Err(format!("the header lacks {}", missing.join(", ")));
        }
        if let Some(twice) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
            return Err(format!("the header has {} twice; each column may occur once", twice.1));
        }
        if is_rtde && frame.is_none() {
            let problem = "its poses are in the robot's base; give the pose of the task's frame \
                           there by --frame frame.toml";
            return Err(problem.to_owned());
        }
        let place = |name: &String| names.iter().position(|other| other == name);
        let places = needed.iter().filter_map(place).collect();
        let targets = wanted.iter().filter_map(place).collect();
        Ok(Table { rtde: frame.filter(|_| is_rtde), frame, commas, names, places, targets })
    }

    /// Returns the sample of a line. The commanded tilt, which a log in the task's frame lacks, is 0; `parse` sets it.
    fn sample(&self, line: usize, text: &str) -> Result<LogSample, String> {
        let found: Vec<&str> = cells(text, self.commas).collect();
        if found.len() != self.names.len() {
            let (has, header) = (found.len(), self.names.len());
            return Err(format!(
                "has {has} cells where the header has {header}; complete or delete the line"
            ));
        }
        let number = |place: &usize| {
            let (name, cell) = (self.names[*place], found[*place]);
            match cell.parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(value),
                _ if cell.is_empty() => {
                    Err(format!("{name}: is empty; give a number, or delete the line"))
                }
                _ => Err(format!("{name}: `{}` is not a finite number", files::visible(cell))),
            }
        };
        let numbers = |places: &[usize]| places.iter().map(number).collect::<Result<Vec<f64>, _>>();
        let (numbers, goal) = (numbers(&self.places)?, numbers(&self.targets)?);
        let force = &numbers[numbers.len() - 3..];
        if let Some(large) = exceeding(force, LARGEST_FORCE_N) {
            return Err(format!("a force of {large} looks like millinewtons; give newtons"));
        }
        let vector = Vector3::from_column_slice;
        let (tcp, target, force) = match self.rtde {
            Some(frame) => {
                let target = (!goal.is_empty()).then(|| of_base(frame, &goal)).transpose()?;
                let force = frame.force(frame.base.rotation.inverse() * vector(force));
                (of_base(frame, &numbers[1..7])?, target, force)
            }
            None => {
                let of = |place: &[f64]| match exceeding(place, MAX_REACH / MM) {
                    Some(far) => Err(format!(
                        "a coordinate of {far} looks like micrometres; give millimetres"
                    )),
                    None => Ok(vector(place) * MM),
                };
                if numbers[4].abs() > 90.0 {
                    return Err(format!("tilt_deg: is {}; it must lie in -90 .. 90", numbers[4]));
                }
                let target = (!goal.is_empty()).then(|| of(&goal)).transpose()?;
                let target = target.map(|position| Tcp { position, tilt: 0.0 });
                let tcp = Tcp { position: of(&numbers[1..4])?, tilt: numbers[4] * DEG };
                let force = vector(force);
                (tcp, target, self.frame.map_or(force, |frame| frame.force(force)))
            }
        };
        Ok(LogSample { line, time_s: numbers[0], tcp, target, force })
    }
}

/// Formats the first of some values whose magnitude exceeds a limit.
fn exceeding(values: &[f64], limit: f64) -> Option<String> {
    values.iter().find(|value| value.abs() > limit).map(|value| shown(*value))
}

/// Converts a pose, position (m) and axis-angle (rad), from the base's to the task's frame.
fn of_base(frame: &Frame, pose: &[f64]) -> Result<Tcp, String> {
    let (place, turn) = pose.split_at(3);
    if let Some(far) = exceeding(place, MAX_REACH) {
        return Err(format!("a position of {far} looks like millimetres; RTDE records metres"));
    }
    if let Some(large) = exceeding(turn, TAU + 1e-3) {
        return Err(format!(
            "a turn of {large} looks like degrees; RTDE records axis-angle in rad"
        ));
    }
    frame.pose(Vector3::from_column_slice(place), Vector3::from_column_slice(turn))
}
