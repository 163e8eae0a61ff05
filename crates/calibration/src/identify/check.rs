//! Checks of the logs before the fit; the remarks are sentences for the user who recorded them.

use super::axes::{cause, motion};
use super::formulas::runs_of;
use super::log::{Log, LogSample, Run};
use super::read::median_gap;
use super::touch::{AirForce, after, air, any_touch, mean, touch};
use ask_tell::statistics::Moments;
use input::units::{DEG, MM};
use insertion::{FailureClass, Outcome, Task};
use nalgebra::Vector3;
use std::ops::Range;

/// Lowest sampling rate, Hz: six samples in a search stroke of 60 ms.
const MIN_RATE_HZ: f64 = 100.0;
/// Smallest time between two samples that counts as a gap in the log, in medians of that time.
const GAP_FACTOR: f64 = 5.0;
/// Saturation of the sensor: smallest number of consecutive samples at the largest or smallest force of the log, and
/// smallest deviation of that force from the bias, N.
const SATURATED: (usize, f64) = (10, 10.0);
/// Bias of the force, N, and its drift, N/s, above which a remark is made.
const MAX_DRIFT: (f64, f64) = (5.0, 7.0);
/// Largest distance of the first position from the task's start, m.
const MAX_START_DISTANCE: f64 = 30.0 * MM;
/// Largest difference of the tilt from the task's, rad.
const MAX_TILT_DIFFERENCE: f64 = 2.0 * DEG;
/// Largest motion of a pose that counts as a standstill, and smallest motion of its target in the meantime for a
/// remark, m.
const STANDSTILL: (f64, f64) = (1e-6, 1e-3);
/// Interval after a touch over which its force is averaged, s: a soft robot oscillates at first.
const TOUCH_S: [f64; 2] = [0.02, 0.5];
/// Smallest force of a contact, N.
const MIN_CONTACT_N: f64 = 1.0;
/// Ratio of measured to simulated forces beyond which the unit is taken to be wrong: fingers and their friction vary
/// by less.
const MAX_RATIO: f64 = 3.0;

/// Remark on a log.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Remark {
    /// Path of the log as given; the table of the runs for a remark on all logs.
    #[serde(rename = "log")]
    pub file: String,
    /// First and last line concerned; `None` for the whole log.
    pub lines: Option<[usize; 2]>,
    /// Sentence for the user, without the file and the lines.
    pub text: String,
    /// Whether results from this log would be wrong.
    pub serious: bool,
}

impl std::fmt::Display for Remark {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let lines = match self.lines {
            Some([from, to]) if from != to => format!("lines {from} to {to}: "),
            Some([line, _]) => format!("line {line}: "),
            None => String::new(),
        };
        write!(f, "{}: {lines}{}", self.file, self.text)
    }
}

/// Remarks on one log.
pub(super) struct Remarks<'a> {
    pub(super) log: &'a Log,
    all: Vec<Remark>,
}

impl Remarks<'_> {
    /// Adds a remark on a span of samples, given by its first and last index; `None` for the whole log.
    pub(super) fn add(&mut self, serious: bool, span: Option<[usize; 2]>, text: impl Into<String>) {
        let last = self.log.samples.len() - 1;
        let lines = span.map(|ends| ends.map(|at| self.log.samples[at.min(last)].line));
        self.all.push(Remark { file: self.log.file.clone(), lines, text: text.into(), serious });
    }
}

/// Returns the remarks on the logs of the runs of a task; `file` is the table of the runs.
pub(super) fn remarks(file: &str, runs: &[Run], task: &Task) -> Vec<Remark> {
    let frame = rotated_frame(file, runs);
    let rotated = frame.is_some();
    runs.iter().flat_map(|run| of_log(run, task, rotated)).chain(frame).collect()
}

/// Returns the remarks on one log; `rotated` if the forces of all logs are in a rotated frame.
fn of_log(run: &Run, task: &Task, rotated: bool) -> Vec<Remark> {
    let mut remarks = Remarks { log: &run.log, all: Vec::new() };
    clock(&mut remarks);
    pose(&mut remarks, run, task);
    let touched = contact(&mut remarks).filter(|_| !rotated);
    sensor(&mut remarks, touched);
    motion(&mut remarks, run, task, touched);
    if let Some(touched) = touched {
        phases(&mut remarks, run, task, touched);
    }
    remarks.all
}

/// Returns a remark if the forces are in another unit than newtons: if `ratio`, of measured to simulated forces along
/// the measured path, is far from 1. `file` is the table of the runs.
pub(super) fn force_scale(file: &str, ratio: f64) -> Option<Remark> {
    let factor = ratio.max(1.0 / ratio);
    let [size, times] = if ratio < 1.0 { ["small", "smaller"] } else { ["large", "larger"] };
    let text = format!(
        "the forces look too {size}, {factor:.1} times {times} than the simulated force of the finger along \
         the measured path: check their unit (1 kgf is 9.8 N, 1 lbf is 4.4 N), or the scale of the sensor"
    );
    let remark = Remark { file: file.to_owned(), lines: None, text, serious: true };
    (factor > MAX_RATIO).then_some(remark)
}

/// Checks the sampling rate, and that the log has no gaps.
fn clock(remarks: &mut Remarks<'_>) {
    let (log, median) = (remarks.log, median_gap(remarks.log));
    let gap = |i: &usize| log.samples[i + 1].time_s - log.samples[*i].time_s;
    let gaps = 0..log.samples.len() - 1;
    let Some(worst) = gaps.clone().max_by(|a, b| gap(a).total_cmp(&gap(b))) else { return };
    let (rate, largest) = (1.0 / median, 1e3 * gap(&worst));
    if rate < MIN_RATE_HZ {
        let text = format!(
            "it is recorded at {rate:.0} Hz (median; the worst gap is {largest:.0} ms), too slow for \
             the strokes of a search: record at 125 to 500 Hz"
        );
        remarks.add(true, None, text);
    }
    let steps = gaps.filter(|i| gap(i) > GAP_FACTOR * median).count();
    if steps > 0 {
        let text = format!(
            "the clock steps by {largest:.0} ms where {:.1} ms are usual (gaps of this kind: {steps}): \
             the motion in them is unknown",
            1e3 * median
        );
        remarks.add(steps > 3, Some([worst, worst + 1]), text);
    }
}

/// Checks the first position and tilt against the task, and that there are targets and the pose follows them.
fn pose(remarks: &mut Remarks<'_>, run: &Run, task: &Task) {
    let (log, first) = (remarks.log, remarks.log.samples[0]);
    let start = Vector3::from(task.strategy.start) + Vector3::y() * run.offset;
    let far = (first.tcp.position - start).norm();
    let probe = run.outcome.is_none();
    if far > MAX_START_DISTANCE {
        let text = format!(
            "it begins at ({}) mm, {:.0} mm from the start of the task and offset, ({}) mm: {}",
            formatted(first.tcp.position / MM),
            far / MM,
            formatted(start / MM),
            cause(first.tcp.position, start)
        );
        remarks.add(!probe, Some([0, 0]), text);
    }
    let (tilt, wanted) = (first.tcp.tilt, task.strategy.tilt);
    if !probe && (tilt - wanted).abs() > MAX_TILT_DIFFERENCE {
        let hint = if (tilt + wanted).abs() < MAX_TILT_DIFFERENCE {
            "its sign, or the direction of x, is inverted"
        } else if (tilt / DEG - wanted).abs() < 0.1 * wanted.abs() {
            "it looks like radians"
        } else {
            "check the frame, or the orientation in which the tool is upright"
        };
        let [tilt, wanted] = [tilt, wanted].map(|angle| angle / DEG);
        let text = format!(
            "the tool is tilted by {tilt:.1} degrees, but in the task by {wanted:.1}: {hint}"
        );
        remarks.add(true, Some([0, 0]), text);
    }
    if first.target.is_none() {
        let text = "it has no commanded positions (target columns): the robot's stiffness cannot \
                    be identified from this log";
        remarks.add(false, None, text);
    }
    if let Some([from, to]) = standstill(&log.samples) {
        let text = "the measured pose stands still while the commanded one moves: the pose is \
                    recorded at too low a rate or from another robot";
        remarks.add(true, Some([from, to]), text);
    }
}

/// Returns both ends of the first interval in which the pose stands still while the target moves.
fn standstill(samples: &[LogSample]) -> Option<[usize; 2]> {
    let mut from = 0;
    for (at, now) in samples.iter().enumerate() {
        if (now.tcp.position - samples[from].tcp.position).amax() > STANDSTILL.0 {
            from = at;
        }
        let (old, new) = (samples[from].target?, now.target?);
        if (new.position - old.position).norm() > STANDSTILL.1 {
            return Some([from, at]);
        }
    }
    None
}

/// Returns the first and last index of the first touch, and its mean force less the bias, N.
fn touch_force(log: &Log) -> Option<([usize; 2], Vector3<f64>)> {
    let from = any_touch(log)?;
    let to = after(log, from, TOUCH_S[1]);
    let contact = &log.samples[after(log, from, TOUCH_S[0]).min(to - 1)..to];
    let force = mean(contact) - AirForce::of(air(log, Some(from))).bias;
    (force.norm() > MIN_CONTACT_N).then_some(([from, to], force))
}

/// Returns a remark if in most logs the largest component of the force at the touch is along x, or along y, instead of
/// z. In a few logs it may be, since an edge also pushes sideways.
fn rotated_frame(file: &str, runs: &[Run]) -> Option<Remark> {
    let forces = runs.iter().filter_map(|run| Some(touch_force(&run.log)?.1.abs()));
    let largest: Vec<usize> = forces.map(|force| force.imax()).collect();
    let count = |axis: usize| largest.iter().filter(|&&one| one == axis).count();
    let (along, times) = [("x", count(0)), ("y", count(1))].into_iter().max_by_key(|one| one.1)?;
    let text = format!(
        "the frame looks rotated: at the touch the force is along {along} and not along z in {times} of {} logs; check \
         `axis_angle_rad`, or whether f{along}_n and fz_n are swapped",
        largest.len()
    );
    let most = 2 * times > largest.len();
    most.then(|| Remark { file: file.to_owned(), lines: None, text, serious: true })
}

/// Checks the first touch; returns its index unless its force mainly points down, which means a wrong sign.
fn contact(remarks: &mut Remarks<'_>) -> Option<usize> {
    let log = remarks.log;
    let Some(([from, to], force)) = touch_force(log) else {
        let text = "no contact: the force never stays above the noise of the sensor; the log has only the \
                    approach, no force, or a force in another unit than newtons";
        remarks.add(true, None, text);
        return None;
    };
    if force.iamax() != 2 || force.z >= 0.0 {
        return touch(log);
    }
    let text = format!(
        "at the touch the force on the tool becomes ({}) N: while the tool moves down it must be \
         above 0 along z; invert `force_sign`",
        formatted(force)
    );
    remarks.add(true, Some([from, to]), text);
    None
}

/// Checks the force for bias and drift in the air, and for saturation.
fn sensor(remarks: &mut Remarks<'_>, touched: Option<usize>) {
    let log = remarks.log;
    let quiet = air(log, touched);
    let bias = mean(quiet);
    let span = touched.map(|_| [0, quiet.len() - 1]);
    if touched.is_some() && bias.norm() > MAX_DRIFT.0 {
        let text = format!(
            "the force in the air is ({}) N instead of zero; it is subtracted: zero the sensor before \
             an attempt, or give the tool's weight",
            formatted(bias)
        );
        remarks.add(false, span, text);
    }
    let (slope, error) = slope(quiet);
    if touched.is_some() && slope.norm() > MAX_DRIFT.1.max(4.0 * error.norm()) {
        let text = format!(
            "the force in the air changes by ({}) N/s: the sensor drifts, or the tool accelerates",
            formatted(slope)
        );
        remarks.add(false, span, text);
    }
    for (axis, name) in ["fx", "fy", "fz"].into_iter().enumerate() {
        let all: Vec<f64> = log.samples.iter().map(|sample| sample.force[axis]).collect();
        let extremes = [f64::max, f64::min].map(|of| all.iter().copied().reduce(of).unwrap_or(0.0));
        for extreme in extremes {
            let runs = runs_of(all.len(), |i| all[i] == extreme).into_iter().rev();
            let longest = runs.max_by_key(Range::len).unwrap_or_default();
            if longest.len() >= SATURATED.0 && (extreme - bias[axis]).abs() > SATURATED.1 {
                let text = format!(
                    "{name} stays at its extreme value {extreme:.1} N for {} samples: the sensor is \
                     saturated",
                    longest.len()
                );
                remarks.add(true, Some([longest.start, longest.end - 1]), text);
            }
        }
    }
}

/// Returns the slope of the force over time by least squares, N/s, and its standard deviation.
fn slope(samples: &[LogSample]) -> (Vector3<f64>, Vector3<f64>) {
    let AirForce { bias, noise } = AirForce::of(samples);
    let middle = Moments::of(samples.iter().map(|sample| sample.time_s)).mean;
    let late = |sample: &LogSample| sample.time_s - middle;
    let spread: f64 = samples.iter().map(|sample| late(sample).powi(2)).sum::<f64>().max(1e-12);
    let sum: Vector3<f64> = samples.iter().map(|sample| (sample.force - bias) * late(sample)).sum();
    (sum / spread, noise / spread.sqrt())
}

/// Checks that an inserted plug reached its depth, and that the log ends before the tool is withdrawn.
fn phases(remarks: &mut Remarks<'_>, run: &Run, task: &Task, touched: usize) {
    let log = remarks.log;
    let depth =
        |sample: &LogSample| task.grip.tcp_z * libm::cos(sample.tcp.tilt) - sample.tcp.position.z;
    let deepest = log.samples.iter().map(depth).fold(f64::MIN, f64::max);
    let last = log.samples.len() - 1;
    if run.outcome == Some(Outcome::Inserted) && deepest < 0.5 * task.success.depth {
        let text = format!(
            "its outcome is `inserted`, but according to the TCP the tip is never deeper than {:.1} mm; \
             {:.1} mm are required: a phase is missing, or the frame's origin or the outcome is wrong",
            deepest / MM,
            task.success.depth / MM
        );
        remarks.add(true, Some([touched, last]), text);
    }
    let end = run.outcome;
    let seated = matches!(end, Some(Outcome::Inserted | Outcome::Failed(FailureClass::Jammed)));
    if seated && deepest > 0.0 && depth(&log.samples[last]) < 0.0 {
        let left = log.samples.iter().rposition(|sample| depth(sample) >= 0.0).unwrap_or(0);
        let text = "it ends in the air, above the socket: cut it where the attempt ends";
        remarks.add(false, Some([left, last]), text);
    }
}

fn formatted(vector: Vector3<f64>) -> String {
    let numbers: Vec<String> = vector.iter().map(|v| format!("{:.1}", v + 0.0)).collect();
    numbers.join(", ")
}
