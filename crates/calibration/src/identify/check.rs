//! Faults of a log, as sentences for its author, before anything is fitted to it.

use super::log::{Ended, Log, Moment, Run};
use super::read::median_gap;
use super::touch::{Air, after, air, any_touch, mean, touch};
use ask_tell::statistics::Moments;
use input::units::{DEG, MM};
use insertion::outcome::FailureClass;
use insertion::task::Task;
use nalgebra::Vector3;

/// Slowest recording, Hz: a search stroke of 60 ms is then six moments.
const SLOWEST_HZ: f64 = 100.0;
/// A gap so many times the median is a step of the clock.
const STEP: f64 = 5.0;
/// So many moments alike at the largest force, N, beyond the bias are a saturated sensor.
const SATURATED: (usize, f64) = (10, 10.0);
/// Bias, N, and its slope, N/s, that are worth a word.
const DRIFT: (f64, f64) = (3.0, 2.0);
/// Farthest first position from the task's start, m.
const ASTRAY: f64 = 30.0 * MM;
/// Largest difference of the tilt from the task's, rad.
const TILTED: f64 = 2.0 * DEG;
/// A pose within the first, m, while the target moves by the second, stands still.
const STILL: (f64, f64) = (1e-6, 1e-3);
/// Time after a touch over which its force is averaged, s.
const TOUCH_S: f64 = 0.02;

/// Something about a log that a person should know.
#[derive(Debug, Clone, PartialEq)]
pub struct Remark {
    /// The log's file as given.
    pub file: String,
    /// First and last line that it is about; all, if there are none.
    pub lines: Option<[usize; 2]>,
    /// A sentence without file and lines.
    pub text: String,
    /// Whether what is read from the log would be wrong.
    pub serious: bool,
}

impl std::fmt::Display for Remark {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.lines {
            Some([from, to]) if from != to => {
                write!(f, "{}: lines {from} to {to}: {}", self.file, self.text)
            }
            Some([line, _]) => write!(f, "{}: line {line}: {}", self.file, self.text),
            None => write!(f, "{}: {}", self.file, self.text),
        }
    }
}

/// Faults of one log.
struct Remarks<'a> {
    log: &'a Log,
    found: Vec<Remark>,
}

impl Remarks<'_> {
    /// Says something of the moments between two indices.
    fn say(&mut self, serious: bool, between: Option<[usize; 2]>, text: impl Into<String>) {
        let last = self.log.moments.len() - 1;
        let lines = between.map(|ends| ends.map(|at| self.log.moments[at.min(last)].line));
        self.found.push(Remark { file: self.log.file.clone(), lines, text: text.into(), serious });
    }
}

/// Returns the faults of a log of a run of `task`; none if there are none.
pub fn remarks(run: &Run, task: &Task) -> Vec<Remark> {
    let mut remarks = Remarks { log: &run.log, found: Vec::new() };
    clock(&mut remarks);
    pose(&mut remarks, run, task);
    let touched = contact(&mut remarks);
    sensor(&mut remarks, touched);
    if let Some(touched) = touched {
        phases(&mut remarks, run, task, touched);
    }
    remarks.found
}

/// Sampling rate and steps of the clock.
fn clock(remarks: &mut Remarks<'_>) {
    let (log, median) = (remarks.log, median_gap(remarks.log));
    let gap = |i: &usize| log.moments[i + 1].time_s - log.moments[*i].time_s;
    let gaps = 0..log.moments.len() - 1;
    let Some(worst) = gaps.clone().max_by(|a, b| gap(a).total_cmp(&gap(b))) else { return };
    let (rate, largest) = (1.0 / median, 1e3 * gap(&worst));
    if rate < SLOWEST_HZ {
        let text = format!(
            "it is recorded at {rate:.0} Hz (median; the worst gap is {largest:.0} ms), too slow for \
             the strokes of a search: record at 125 to 500 Hz"
        );
        remarks.say(true, None, text);
    }
    let steps = gaps.filter(|i| gap(i) > STEP * median).count();
    if steps > 0 {
        let text = format!(
            "the clock steps by {largest:.0} ms where {:.1} ms are usual, one of {steps} such gaps: \
             what happened in them is not known",
            1e3 * median
        );
        remarks.say(steps > 3, Some([worst, worst + 1]), text);
    }
}

/// First position and tilt against the task, targets, and a pose that stands still.
fn pose(remarks: &mut Remarks<'_>, run: &Run, task: &Task) {
    let (log, first) = (remarks.log, remarks.log.moments[0]);
    let start = Vector3::from(task.strategy.start) + Vector3::y() * run.offset;
    let far = (first.position - start).norm();
    let probe = run.ended == Ended::Probe;
    if far > ASTRAY {
        let text = format!(
            "it begins at ({}) mm, {:.0} mm from the start of the task and offset, ({}) mm: check \
             frame and units",
            shown(first.position / MM, 1),
            far / MM,
            shown(start / MM, 1)
        );
        remarks.say(!probe, Some([0, 0]), text);
    }
    let (tilt, wanted) = (first.tilt / DEG, task.strategy.tilt / DEG);
    if !probe && (first.tilt - task.strategy.tilt).abs() > TILTED {
        let hint = if (first.tilt + task.strategy.tilt).abs() < TILTED {
            "its sign, or the direction of x, is turned"
        } else if (first.tilt / DEG - task.strategy.tilt).abs() < 0.1 * task.strategy.tilt.abs() {
            "it looks like radians"
        } else {
            "check the frame, or where the tool is upright"
        };
        let text = format!(
            "the tool is tilted by {tilt:.1} degrees where the task says {wanted:.1}: {hint}"
        );
        remarks.say(true, Some([0, 0]), text);
    }
    if first.target.is_none() {
        let text = "it has no commanded positions (target columns): the robot's stiffness cannot \
                    be told from this log";
        remarks.say(false, None, text);
    }
    if let Some([from, to]) = standstill(&log.moments) {
        let text = "the measured pose stands still while the commanded one moves: the pose is \
                    recorded too seldom or from another robot";
        remarks.say(true, Some([from, to]), text);
    }
}

/// Ends of the first stretch in which the pose stands still and the target moves.
fn standstill(moments: &[Moment]) -> Option<[usize; 2]> {
    let mut from = 0;
    for (at, now) in moments.iter().enumerate() {
        if (now.position - moments[from].position).amax() > STILL.0 {
            from = at;
        }
        let (old, new) = (moments[from].target?, now.target?);
        if (new.position - old.position).norm() > STILL.1 {
            return Some([from, at]);
        }
    }
    None
}

/// Whether and how it touches: index of the touch, if its direction is right.
fn contact(remarks: &mut Remarks<'_>) -> Option<usize> {
    let log = remarks.log;
    let Some(any) = any_touch(log) else {
        let text = "nothing is touched: the force never leaves the noise of the air for good; the \
                    log has only the approach, or no force";
        remarks.say(true, None, text);
        return None;
    };
    let [from, to] = [any, after(log, any, 3.0 * TOUCH_S)];
    let force = mean(&log.moments[after(log, any, TOUCH_S).min(to - 1)..to])
        - Air::of(air(log, Some(any))).bias;
    let [x, y, z]: [f64; 3] = force.abs().into();
    let words = format!("the force on the tool becomes ({}) N", shown(force, 1));
    if z >= x.max(y) && force.z < 0.0 {
        let text = format!(
            "at the touch {words}: on a tool that goes down it must be above 0 along z; turn \
             `force_sign`"
        );
        remarks.say(true, Some([from, to]), text);
    } else if z < x.max(y) {
        let along = if x > y { "x" } else { "y" };
        let text = format!(
            "at the touch {words}: the frame looks turned, since the force is along {along} and not \
             along z; check `axis_angle_rad`"
        );
        remarks.say(true, Some([from, to]), text);
    } else {
        return touch(log);
    }
    None
}

/// Bias and drift in the air, and saturation.
fn sensor(remarks: &mut Remarks<'_>, touched: Option<usize>) {
    let log = remarks.log;
    let quiet = air(log, touched);
    let Air { bias, noise } = Air::of(quiet);
    let span = touched.map(|_| [0, quiet.len() - 1]);
    if touched.is_some() && bias.norm() > DRIFT.0 {
        let text = format!(
            "the force in the air is ({}) N and not nought; it is taken off: zero the sensor before \
             an attempt, or give the tool's weight",
            shown(bias, 1)
        );
        remarks.say(false, span, text);
    }
    let (slope, error) = slope(quiet, bias, noise);
    if touched.is_some() && slope.norm() > DRIFT.1.max(4.0 * error.norm()) {
        let text = format!(
            "the force in the air changes by ({}) N/s: the sensor drifts, or the tool accelerates",
            shown(slope, 1)
        );
        remarks.say(false, span, text);
    }
    for (axis, name) in ["fx", "fy", "fz"].into_iter().enumerate() {
        let all = || log.moments.iter().map(|moment| moment.force[axis]);
        for extreme in [all().fold(f64::MIN, f64::max), all().fold(f64::MAX, f64::min)] {
            let (mut run, mut longest) = (0, [0, 0]);
            for (at, force) in all().enumerate() {
                run = if force == extreme { run + 1 } else { 0 };
                if run > longest[1] - longest[0] {
                    longest = [at + 1 - run, at + 1];
                }
            }
            let [from, end] = longest;
            if end - from >= SATURATED.0 && (extreme - bias[axis]).abs() > SATURATED.1 {
                let text = format!(
                    "{name} stays at {extreme:.1} N, its extreme, for {} moments: the sensor is \
                     saturated",
                    end - from
                );
                remarks.say(true, Some([from, end - 1]), text);
            }
        }
    }
}

/// Slope of the force over time by least squares, N/s, and its deviation by the noise.
fn slope(
    moments: &[Moment],
    bias: Vector3<f64>,
    noise: Vector3<f64>,
) -> (Vector3<f64>, Vector3<f64>) {
    let middle = Moments::of(moments.iter().map(|moment| moment.time_s)).mean;
    let late = |moment: &Moment| moment.time_s - middle;
    let spread: f64 = moments.iter().map(|moment| late(moment).powi(2)).sum::<f64>().max(1e-12);
    let sum: Vector3<f64> = moments.iter().map(|moment| (moment.force - bias) * late(moment)).sum();
    (sum / spread, noise / spread.sqrt())
}

/// Phases that the outcome asks for.
fn phases(remarks: &mut Remarks<'_>, run: &Run, task: &Task, touched: usize) {
    let log = remarks.log;
    let depth = |moment: &Moment| task.grip.tcp_z * libm::cos(moment.tilt) - moment.position.z;
    let deepest = log.moments.iter().map(depth).fold(f64::MIN, f64::max);
    let last = log.moments.len() - 1;
    if run.ended == Ended::Inserted && deepest < 0.5 * task.success.depth {
        let text = format!(
            "it is said to be inserted, but by the TCP the tip never is deeper than {:.1} mm where \
             {:.1} mm count: a phase is missing, or the frame's origin or the outcome is wrong",
            deepest / MM,
            task.success.depth / MM
        );
        remarks.say(true, Some([touched, last]), text);
    }
    let seated = matches!(run.ended, Ended::Inserted | Ended::Failed(FailureClass::Jammed));
    if seated && deepest > 0.0 && depth(&log.moments[last]) < 0.0 {
        let left = log.moments.iter().rposition(|moment| depth(moment) >= 0.0).unwrap_or(0);
        let text = "it ends in the air, above the socket: cut it where the attempt ends";
        remarks.say(false, Some([left, last]), text);
    }
}

/// A vector's numbers with so many decimals.
fn shown(vector: Vector3<f64>, decimals: usize) -> String {
    let numbers: Vec<String> = vector.iter().map(|v| format!("{:.decimals$}", v + 0.0)).collect();
    numbers.join(", ")
}
