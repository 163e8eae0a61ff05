//! Curves of a log or a simulated attempt, sampled at regular times.

use super::log::{Log, LogSample};
use input::units::{DEG, MM};
use insertion::Tcp;
/// Time between two points, s.
pub use insertion::trial::LOG_STEP_S as STEP_S;
use insertion::trial::{Sample, Trajectory};
use nalgebra::{UnitQuaternion, Vector3};

/// Number of points on either side from which derivatives are computed.
pub const REACH: usize = 2;
/// Reduction of the target's speed from one point to the next, as a fraction of its maximum, that counts as a stop.
const STOPPED: f64 = 0.25;

/// Curves of one attempt, SI units, task frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    /// Position of the TCP.
    pub tcp: Vec<Vector3<f64>>,
    /// Commanded position of the TCP, if it was recorded.
    pub target: Option<Vec<Vector3<f64>>>,
    /// Force on the tool, less its bias: the mean force in the air.
    pub force: Vec<Vector3<f64>>,
    /// Tilt of the TCP at the first point, rad.
    pub tilt: f64,
}

impl Curves {
    /// Returns the curves of a log; `bias` is subtracted from the force.
    pub fn of_log(log: &Log, bias: Vector3<f64>) -> Self {
        let samples = &log.samples;
        let (first, last) = (samples[0].time_s, samples[samples.len() - 1].time_s);
        let count = ((last - first) / STEP_S) as usize + 1;
        let mut at = 0;
        let points: Vec<LogSample> = (0..count)
            .map(|i| {
                let time = first + i as f64 * STEP_S;
                while at + 2 < samples.len() && samples[at + 1].time_s <= time {
                    at += 1;
                }
                between(&samples[at], &samples[at + 1], time)
            })
            .collect();
        let target = |point: &LogSample| point.target.map(|target| target.position);
        Curves {
            tcp: points.iter().map(|point| point.tcp.position).collect(),
            target: points.iter().map(target).collect(),
            force: points.iter().map(|point| point.force - bias).collect(),
            tilt: points.first().map_or(0.0, |point| point.tcp.tilt),
        }
    }

    /// Returns the curves of simulated samples `STEP_S` apart. The force is that which a sensor above a tool of this
    /// mass, kg, would measure: less mass times acceleration.
    pub fn of_samples(samples: &[Sample], tool_mass: f64) -> Self {
        let vectors = |of: fn(&Sample) -> [f64; 3], unit: f64| {
            samples.iter().map(|sample| Vector3::from(of(sample)) * unit).collect::<Vec<_>>()
        };
        let tcp = vectors(|sample| sample.tcp_mm, MM);
        let inertia = accelerations(&tcp, REACH).into_iter().map(|a| a * tool_mass);
        let force = vectors(|sample| sample.sensed_n, 1.0);
        Curves {
            force: force.into_iter().zip(inertia).map(|(force, inertia)| force - inertia).collect(),
            target: Some(vectors(|sample| sample.target_mm, MM)),
            tilt: samples.first().map_or(0.0, |sample| sample.tcp_tilt_deg * DEG),
            tcp,
        }
    }

    /// Returns the commanded trajectory, or the measured one if none was recorded, with the tilt of the first point.
    pub fn trajectory(&self) -> Option<Trajectory> {
        let commanded = self.target.as_ref().unwrap_or(&self.tcp);
        let place = |(i, position): (usize, &Vector3<f64>)| {
            (i as f64 * STEP_S, Tcp { position: *position, tilt: self.tilt })
        };
        Trajectory::new(commanded.iter().enumerate().map(place))
    }

    /// Returns the curves in the axes of the tilted tool, which are the principal axes of a compliant flange.
    pub fn in_tool(&self) -> Self {
        let turn = UnitQuaternion::from_scaled_axis(-self.tilt * Vector3::x());
        let turned = |all: &Vec<Vector3<f64>>| all.iter().map(|one| turn * one).collect();
        let target = self.target.as_ref().map(turned);
        Curves { tcp: turned(&self.tcp), target, force: turned(&self.force), tilt: self.tilt }
    }

    /// Returns the index at which the target was stopped by a detected touch.
    pub fn stopped(&self) -> Option<usize> {
        let target = self.target.as_ref()?;
        let speeds: Vec<f64> =
            target.windows(2).map(|pair| (pair[0].z - pair[1].z) / STEP_S).collect();
        let before = self.trajectory().map_or(0, |path| (path.push_start() / STEP_S) as usize);
        let slowed = |i: &usize| speeds[*i] - speeds[*i + 1];
        let all = 0..before.min(speeds.len().saturating_sub(1));
        let most = all.max_by(|a, b| slowed(a).total_cmp(&slowed(b)))?;
        let fastest = speeds[..before.min(speeds.len())].iter().copied().fold(0.0, f64::max);
        (slowed(&most) > STOPPED * fastest).then_some(most + 1)
    }
}

/// Interpolates linearly between two samples.
fn between(a: &LogSample, b: &LogSample, time: f64) -> LogSample {
    let part = ((time - a.time_s) / (b.time_s - a.time_s)).clamp(0.0, 1.0);
    let target = a.target.zip(b.target).map(|(a, b)| a.towards(&b, part));
    let force = a.force + part * (b.force - a.force);
    LogSample { line: a.line, time_s: time, tcp: a.tcp.towards(&b.tcp, part), target, force }
}

/// Returns the first derivatives, by central differences over `reach` steps on either side.
pub fn rates(points: &[Vector3<f64>], reach: usize) -> Vec<Vector3<f64>> {
    let last = points.len().saturating_sub(1);
    let rate = |i: usize| {
        let (a, b) = (i.saturating_sub(reach), (i + reach).min(last));
        (points[b] - points[a]) / ((b - a).max(1) as f64 * STEP_S)
    };
    (0..points.len()).map(rate).collect()
}

/// Returns the second derivatives: twice the first ones.
pub fn accelerations(points: &[Vector3<f64>], reach: usize) -> Vec<Vector3<f64>> {
    rates(&rates(points, reach), reach)
}

/// Returns moving averages over `reach` points on either side.
pub fn smoothed(points: &[Vector3<f64>], reach: usize) -> Vec<Vector3<f64>> {
    let around = |i: usize| i.saturating_sub(reach)..(i + reach + 1).min(points.len());
    (0..points.len()).map(|i| mean(&points[around(i)])).collect()
}

/// Returns the mean; NaN without vectors.
pub(super) fn mean(vectors: &[Vector3<f64>]) -> Vector3<f64> {
    vectors.iter().sum::<Vector3<f64>>() / vectors.len() as f64
}
