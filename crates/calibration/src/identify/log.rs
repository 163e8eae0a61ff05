//! Log of one attempt or probe: commanded and measured TCP, and the force on the tool.

use input::units::{DEG, MM};
use input::{InputError, Place};
use insertion::trial::Sample;
use insertion::{Design, Outcome, Tcp};
use nalgebra::Vector3;
use std::fmt::Write as _;

/// Smallest number of samples: 0.1 s at 500 Hz.
pub const MIN_SAMPLES: usize = 50;
/// Largest number of samples: 0.1 GB in memory.
const MAX_SAMPLES: usize = 1_000_000;
/// Longest duration of a log, s. It bounds the number of points after interpolation at regular times.
pub const MAX_DURATION_S: f64 = 600.0;

/// Required columns: time, TCP and force on the tool, in the task's frame.
pub const COLUMNS: [&str; 8] = ["t_s", "x_mm", "y_mm", "z_mm", "tilt_deg", "fx_n", "fy_n", "fz_n"];
/// Columns of the commanded TCP; a log has all of them or none.
pub const TARGETS: [&str; 3] = ["target_x_mm", "target_y_mm", "target_z_mm"];

/// One sample of a log, in the task's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogSample {
    /// Line in the file, counted from 1.
    pub line: usize,
    /// Time on the recorder's clock, s.
    pub time_s: f64,
    /// Measured TCP.
    pub tcp: Tcp,
    /// Commanded TCP, if it was recorded.
    pub target: Option<Tcp>,
    /// Force on the tool, N.
    pub force: Vector3<f64>,
}

/// Recorded attempt or probe: finite numbers, increasing times, a target in all samples or in none.
#[derive(Debug, Clone, PartialEq)]
pub struct Log {
    /// Path of the file as given.
    pub file: String,
    /// At least [`MIN_SAMPLES`] and at most `MAX_SAMPLES` samples.
    pub samples: Vec<LogSample>,
}

/// Line of the table of runs with its log, or with the file name of the log before that is read.
#[derive(Debug, Clone, PartialEq)]
pub struct Run<L = Log> {
    pub log: L,
    /// Infill of the finger, and other design parameters of the table.
    pub design: Design,
    /// Shift of the start along y, m; 0 for a probe that has none.
    pub offset: f64,
    /// Outcome on the robot; `None` for a probe: the part is slid back and forth on a flat face to measure friction.
    pub outcome: Option<Outcome>,
    /// Line in the table of runs.
    pub line: usize,
}

impl Log {
    /// Checks the samples of a log; `file` is named in errors.
    ///
    /// # Errors
    /// If there are too few or too many, a number is not finite, time does not increase, or the log is too long.
    pub fn new(file: &str, samples: Vec<LogSample>) -> Result<Self, InputError> {
        let whole = |problem: String| Err(Place::file(file).fault(problem));
        let count = samples.len();
        if !(MIN_SAMPLES..=MAX_SAMPLES).contains(&count) {
            let must = format!("it must have {MIN_SAMPLES} to {MAX_SAMPLES}");
            return whole(format!("has {count} samples; {must}"));
        }
        for (i, sample) in samples.iter().enumerate() {
            let problem = match i.checked_sub(1).and_then(|before| samples.get(before)) {
                _ if !sample.is_finite() => "has a number that is not finite".to_owned(),
                Some(before) if sample.time_s <= before.time_s => format!(
                    "time goes from {} s in line {} to {} s; it must increase: cut the log where \
                     its clock was set",
                    before.time_s, before.line, sample.time_s
                ),
                _ => continue,
            };
            return Err(Place::file(file).line(sample.line).fault(problem));
        }
        let lasts = samples[samples.len() - 1].time_s - samples[0].time_s;
        if lasts > MAX_DURATION_S {
            return whole(format!(
                "lasts {lasts:.0} s; an attempt lasts {MAX_DURATION_S} s at most: cut the log, or mend its clock"
            ));
        }
        Ok(Log { file: file.to_owned(), samples })
    }

    /// Returns the log as CSV with the columns [`COLUMNS`] and, with targets, [`TARGETS`]: lengths to 1e-5 mm,
    /// tilt to 1e-5 degrees, force to 1e-4 N, time to 1e-6 s. Sample `i` is in line `i + 2`.
    /// The commanded tilt is not written.
    pub fn csv(&self) -> String {
        let mut text = COLUMNS.join(",");
        if self.samples.iter().any(|sample| sample.target.is_some()) {
            text = format!("{text},{}", TARGETS.join(","));
        }
        // Writing to a String cannot fail. Adding zero avoids "-0.0".
        let fixed = |text: &mut String, value: f64, digits: usize| {
            let scale = 10_f64.powi(digits as i32);
            let _ = write!(text, ",{:.digits$}", (value * scale).round() / scale + 0.0);
        };
        for sample in &self.samples {
            let _ = write!(text, "\n{:.6}", sample.time_s);
            sample.tcp.position.iter().for_each(|value| fixed(&mut text, value / MM, 5));
            fixed(&mut text, sample.tcp.tilt / DEG, 5);
            sample.force.iter().for_each(|value| fixed(&mut text, *value, 4));
            let target = sample.target.iter().flat_map(|target| &target.position);
            target.for_each(|value| fixed(&mut text, value / MM, 5));
        }
        text.push('\n');
        text
    }
}

impl LogSample {
    fn is_finite(&self) -> bool {
        let own = self.force.iter().chain([&self.time_s]);
        let tcps = [&self.tcp].into_iter().chain(&self.target);
        let poses = tcps.flat_map(|tcp| tcp.position.iter().chain([&tcp.tilt]));
        own.chain(poses).all(|value| value.is_finite())
    }
}

/// Returns the log that a robot with a perfect sensor would record of a simulated attempt.
///
/// # Errors
/// If the attempt was too short; see [`Log::new`].
pub fn of_samples(file: &str, samples: &[Sample]) -> Result<Log, InputError> {
    let start = samples.first().map_or(0.0, |sample| sample.time_s);
    let converted = |(i, sample): (usize, &Sample)| {
        let tilt = sample.tcp_tilt_deg * DEG;
        let [tcp, target] = [sample.tcp_mm, sample.target_mm]
            .map(|mm| Tcp { position: Vector3::from(mm) * MM, tilt });
        let force = Vector3::from(sample.sensed_n);
        LogSample { line: i + 2, time_s: sample.time_s - start, tcp, target: Some(target), force }
    };
    Log::new(file, samples.iter().enumerate().map(converted).collect())
}
