//! The log of one attempt: commanded and measured TCP, and the force on the tool.

use input::units::{DEG, MM};
use input::{Fault, Place};
use insertion::outcome::FailureClass;
use insertion::space::Design;
use insertion::trial::{Sample, Tcp};
use nalgebra::Vector3;
use std::fmt::Write as _;

/// Fewest moments: 0.1 s at 500 Hz.
pub const FEWEST: usize = 50;
/// Most moments: half an hour at 500 Hz, 0.1 GB.
pub const MOST: usize = 1_000_000;
/// Longest log, s: curves are made of it at even times, however far apart its moments are.
pub const LONGEST_S: f64 = 600.0;

/// Header of [`Log::csv`] without targets: time, TCP and force on the tool, in the task's frame.
pub const COLUMNS: [&str; 8] = ["t_s", "x_mm", "y_mm", "z_mm", "tilt_deg", "fx_n", "fy_n", "fz_n"];
/// Columns of the commanded TCP; a log has all of them or none.
pub const TARGETS: [&str; 3] = ["target_x_mm", "target_y_mm", "target_z_mm"];

/// One moment of a log, in the task's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Its line in the file, from 1.
    pub line: usize,
    /// Time on the recorder's clock, s.
    pub time_s: f64,
    /// Measured TCP, m.
    pub position: Vector3<f64>,
    /// Measured turn of the TCP about x from upright, rad.
    pub tilt: f64,
    /// Commanded TCP, if the log has it.
    pub target: Option<Tcp>,
    /// Force on the tool, N.
    pub force: Vector3<f64>,
}

/// A recorded attempt or probe: all finite, time increasing, all moments with a target or none.
#[derive(Debug, Clone, PartialEq)]
pub struct Log {
    /// The file as given.
    pub file: String,
    /// At least [`FEWEST`] and at most [`MOST`] moments.
    pub moments: Vec<Moment>,
}

/// How an attempt ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// It inserted.
    Inserted,
    /// It did not.
    Failed(FailureClass),
    /// It was none: slow motions on a flat face of the socket.
    Probe,
}

/// A log and what is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Recorded log.
    pub log: Log,
    /// The finger's infill, and what else its columns set.
    pub design: Design,
    /// Shift of the start along y, m; 0 for a probe that has none.
    pub offset: f64,
    /// How it ended.
    pub ended: Ended,
    /// Line in the table of runs.
    pub line: usize,
}

impl Log {
    /// Checks the moments of a log; `file` is named in errors.
    ///
    /// # Errors
    /// If there are too few or too many, a number is not finite, or time does not increase.
    pub fn new(file: &str, moments: Vec<Moment>) -> Result<Self, Fault> {
        let whole = |problem: String| Err(Place::file(file).fault(problem));
        if !(FEWEST..=MOST).contains(&moments.len()) {
            let count = moments.len();
            return whole(format!("has {count} moments; it must have {FEWEST} to {MOST}"));
        }
        for (i, moment) in moments.iter().enumerate() {
            let wrong = match i.checked_sub(1).and_then(|before| moments.get(before)) {
                _ if !moment.is_finite() => Some("has a number that is not finite".to_owned()),
                Some(before) if moment.time_s <= before.time_s => Some(format!(
                    "time goes from {} s in line {} to {} s; it must increase: cut the log where \
                     its clock was set",
                    before.time_s, before.line, moment.time_s
                )),
                _ => None,
            };
            if let Some(problem) = wrong {
                return Err(Place::file(file).line(moment.line).fault(problem));
            }
        }
        let lasts = moments[moments.len() - 1].time_s - moments[0].time_s;
        if lasts > LONGEST_S {
            return whole(format!(
                "lasts {lasts:.0} s; an attempt lasts {LONGEST_S} s at most: cut the log, or mend its clock"
            ));
        }
        Ok(Log { file: file.to_owned(), moments })
    }

    /// Its text with the columns [`COLUMNS`] and, with targets, [`TARGETS`]: lengths to 1e-5 mm,
    /// tilt to 1e-5 degrees, force to 1e-4 N, time to 1e-6 s. Moment `i` stands in line `i + 2`.
    /// A commanded tilt is not kept.
    pub fn csv(&self) -> String {
        let mut text = COLUMNS.join(",");
        if self.moments.iter().any(|moment| moment.target.is_some()) {
            text = format!("{text},{}", TARGETS.join(","));
        }
        // Writing to a String cannot fail. What rounds to 0 has no sign.
        let fixed = |text: &mut String, value: f64, digits: usize| {
            let scale = 10_f64.powi(digits as i32);
            let _ = write!(text, ",{:.digits$}", (value * scale).round() / scale + 0.0);
        };
        for moment in &self.moments {
            let _ = write!(text, "\n{:.6}", moment.time_s);
            moment.position.iter().for_each(|value| fixed(&mut text, value / MM, 5));
            fixed(&mut text, moment.tilt / DEG, 5);
            moment.force.iter().for_each(|value| fixed(&mut text, *value, 4));
            let target = moment.target.iter().flat_map(|target| &target.position);
            target.for_each(|value| fixed(&mut text, value / MM, 5));
        }
        text.push('\n');
        text
    }
}

impl Moment {
    fn is_finite(&self) -> bool {
        let target =
            self.target.map_or([0.0; 4], |Tcp { position: p, tilt }| [p.x, p.y, p.z, tilt]);
        let vectors = self.position.iter().chain(&self.force).chain(&target);
        vectors.chain([&self.time_s, &self.tilt]).all(|value| value.is_finite())
    }
}

/// The log that a robot with a perfect sensor would write of a simulated attempt.
///
/// # Errors
/// As of [`Log::new`]: if the attempt ended before there was much to write.
pub fn of_samples(file: &str, samples: &[Sample]) -> Result<Log, Fault> {
    let start = samples.first().map_or(0.0, |sample| sample.time_s);
    let moment = |(i, sample): (usize, &Sample)| Moment {
        line: i + 2,
        time_s: sample.time_s - start,
        position: Vector3::from(sample.tcp_mm) * MM,
        tilt: sample.tcp_tilt_deg * DEG,
        target: Some(Tcp {
            position: Vector3::from(sample.target_mm) * MM,
            tilt: sample.tcp_tilt_deg * DEG,
        }),
        force: Vector3::from(sample.sensed_n),
    };
    Log::new(file, samples.iter().enumerate().map(moment).collect())
}
