//! First touch of the tool in a log, and the force in the air before it.

use super::log::{Log, LogSample};
use nalgebra::Vector3;

/// Shortest time in the air at the beginning of a log, s; an earlier touch is not detected.
const FIRST_AIR_S: f64 = 0.05;
/// Time over which forces are averaged to reduce noise, s; at least three samples.
const MEAN_S: f64 = 0.01;
/// Shortest touch, s: longer than the inertial forces at the start and stop of a fast motion.
const LASTS_S: f64 = 0.06;
/// Beginning and end of the interval from which noise and bias are estimated, s before the touch.
const NEAR_AIR_S: [f64; 2] = [0.3, 0.02];
/// Smallest mean force of a touch, N and in standard errors; the larger of the two applies.
const MIN_TOUCH: [f64; 2] = [1.5, 5.0];
/// Mean force, N, below which the tool is in the air; two standard errors if that is more.
const LEFT_N: f64 = 0.05;

/// Returns the mean force in the air before the touch, N; that of the whole log if nothing is touched.
pub fn bias(log: &Log) -> Vector3<f64> {
    AirForce::of(air(log, touch(log))).bias
}

/// Returns the samples in the air, without those next to the touch; the whole log if nothing is touched.
pub(super) fn air(log: &Log, touch: Option<usize>) -> &[LogSample] {
    let end = touch.map_or(log.samples.len(), |at| before(log, at, NEAR_AIR_S[1]).max(1));
    &log.samples[..end]
}

/// Returns the index of the first touch, from which the force along z, less its bias, stays above 1.5 N and 5 times its
/// noise; `None` if nothing is touched.
pub fn touch(log: &Log) -> Option<usize> {
    onset(log, |force| force.z)
}

/// Returns the index of the onset of a lasting force in any direction.
pub(super) fn any_touch(log: &Log) -> Option<usize> {
    onset(log, |force| force.norm())
}

/// Mean of the force in the air, N, and standard deviation of the noise of a sample, N.
pub(super) struct AirForce {
    pub bias: Vector3<f64>,
    pub noise: Vector3<f64>,
}

impl AirForce {
    /// Estimates mean and noise; the noise from differences between successive samples, which drift does not affect.
    pub fn of(samples: &[LogSample]) -> Self {
        let square = |w: &[LogSample]| (w[1].force - w[0].force).map(|step| step * step);
        let squares: Vector3<f64> = samples.windows(2).map(square).sum();
        let pairs = samples.len().saturating_sub(1).max(1) as f64;
        AirForce { bias: mean(samples), noise: (squares / (2.0 * pairs)).map(f64::sqrt) }
    }
}

/// Returns the mean force, N.
pub(super) fn mean(samples: &[LogSample]) -> Vector3<f64> {
    samples.iter().map(|sample| sample.force).sum::<Vector3<f64>>() / samples.len().max(1) as f64
}

/// Returns the index of the sample `seconds` before another.
fn before(log: &Log, at: usize, seconds: f64) -> usize {
    let since = log.samples[at].time_s - seconds;
    log.samples[..at].partition_point(|sample| sample.time_s < since)
}

/// Returns the index of the sample `seconds` after another; the number of samples if the log ends before.
pub(super) fn after(log: &Log, at: usize, seconds: f64) -> usize {
    let until = log.samples[at].time_s + seconds;
    at + log.samples[at..].partition_point(|sample| sample.time_s < until)
}

/// Returns the index from which the force, less its bias, lastingly exceeds its noise; `size` is the component or norm
/// that is compared.
fn onset(log: &Log, size: fn(Vector3<f64>) -> f64) -> Option<usize> {
    let samples = &log.samples;
    let first = after(log, 0, FIRST_AIR_S).max(5);
    let over = |air: &AirForce, from: usize, to: usize| size(mean(&samples[from..to]) - air.bias);
    let start = AirForce::of(&samples[..first]);
    let noise = |air: &AirForce, count: usize| size(air.noise) / (count as f64).sqrt();
    let touches = |&at: &usize| {
        let short = after(log, at, MEAN_S).max(at + 3);
        let long = after(log, at, LASTS_S).max(short);
        let least = MIN_TOUCH[0].max(MIN_TOUCH[1] * noise(&start, short - at));
        long < samples.len()
            && over(&start, at, short) > least
            && over(&start, short, long.max(short + 1)) > least
    };
    let found = (0..samples.len().saturating_sub(3)).find(touches)?;
    let found = after(log, found, MEAN_S).max(found + 3) - 1;
    // Goes back to where the force left the noise, with the bias just before the touch, since it may have drifted.
    let mut touch = found;
    for _ in 0..3 {
        let near = before(log, touch, NEAR_AIR_S[1]);
        let air = match before(log, touch, NEAR_AIR_S[0]) {
            from if near >= from + 5 => AirForce::of(&samples[from..near]),
            _ => return Some(touch),
        };
        touch = found;
        while touch > 0 {
            let from = before(log, touch, MEAN_S).min(touch.saturating_sub(3));
            if over(&air, from, touch + 1) <= LEFT_N.max(2.0 * noise(&air, touch + 1 - from)) {
                break;
            }
            touch -= 1;
        }
    }
    Some(touch)
}
