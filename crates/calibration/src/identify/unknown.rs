//! A number of the cell before and after the logs were read.

use super::smoother::Smoothed;
use ask_tell::statistics::{Moments, normal_cdf};
use parameters::numbers::{CLEARANCE, FRICTION, Kind, PAD_FRICTION, STIFFNESS};
use parameters::{Parameter, Scale};

/// Factor on the deviations that the smoother leaves, from the coverage on synthetic cells.
const INFLATION: f64 = 1.4;
/// An unknown that keeps so much of its prior's deviation is left at it.
const UNTOLD: f64 = 0.8;

/// Source of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum From {
    /// Read from the logs by a formula.
    Formula,
    /// Fitted to the curves of the logs.
    Fit,
    /// These logs cannot tell it.
    Prior,
    /// Not fitted: as in the files.
    Files,
}

/// A number of the cell before and after.
#[derive(Debug, Clone)]
pub struct Unknown {
    /// The prior's row.
    pub prior: Parameter,
    /// The same, with what the logs say.
    pub posterior: Parameter,
    /// The prior's deviation that the logs were expected to leave, and did leave, as shares of it.
    pub left: Option<[f64; 2]>,
    pub from: From,
    /// The attempt that would tell it, if these do not.
    pub advice: Option<&'static str>,
}

/// The values of rows at these standard normal coordinates.
pub(super) fn values<'a>(rows: &[&'a Parameter], z: &[f64]) -> Vec<(&'a Parameter, f64)> {
    rows.iter().zip(z).map(|(row, &z)| (*row, row.at(normal_cdf(z)))).collect()
}

/// A row with a value, within its bounds, which give way to a measurement.
pub(super) fn with(row: &Parameter, value: f64, sd: f64, source: &str) -> Parameter {
    Parameter {
        value: Some(value),
        sd: Some(sd),
        low: row.low.min(value - 3.0 * sd).max(if row.low > 0.0 { 0.2 * value } else { f64::MIN }),
        high: row.high.max(value + 3.0 * sd),
        source: source.to_owned(),
        ..row.clone()
    }
}

pub(super) fn told(prior: Parameter, posterior: Parameter, from: From) -> Unknown {
    Unknown { prior, posterior, left: None, from, advice: None }
}

pub(super) fn untold(prior: Parameter, left: Option<[f64; 2]>) -> Unknown {
    let advice = advice(&prior);
    Unknown { posterior: prior.clone(), prior, left, from: From::Prior, advice: Some(advice) }
}

/// An unknown after the fit.
pub(super) fn fit(
    prior: &Parameter,
    known: Option<&Parameter>,
    smoothed: &Smoothed,
    i: usize,
) -> Unknown {
    let z: Vec<f64> = smoothed.members.iter().map(|member| member[i]).collect();
    let own = Moments::of(&z);
    let (mean, sd) = (own.mean, own.sample_deviation());
    let left = Some([smoothed.expected_sd[i], INFLATION * sd]);
    if let Some(known) = known {
        // What was measured by itself is not bent to make up for what the model lacks elsewhere.
        return Unknown { left, ..told(prior.clone(), known.clone(), From::Formula) };
    }
    if sd > UNTOLD {
        return untold(prior.clone(), left);
    }
    let row = prior;
    let at = |z: &f64| row.at(normal_cdf(mean + INFLATION * (z - mean)));
    let log = row.scale == Scale::Log;
    let drawn: Vec<f64> = z.iter().map(at).map(|v| if log { libm::log(v) } else { v }).collect();
    let moments = Moments::of(&drawn);
    let (mean, sd) = (moments.mean, moments.sample_deviation());
    let (value, sd) = if log { (libm::exp(mean), sd * libm::exp(mean)) } else { (mean, sd) };
    let posterior = Parameter {
        value: Some(value.clamp(row.low, row.high)),
        sd: Some(sd),
        source: "curves of the attempts".to_owned(),
        ..row.clone()
    };
    Unknown { left, ..told(prior.clone(), posterior, From::Fit) }
}

/// Returns whether the curves would have to give way to a number: other numbers' errors end in these, which
/// a weight on the finger and the grip tell better.
pub(super) fn not_fitted(row: &Parameter) -> bool {
    row.path == PAD_FRICTION || row.path == STIFFNESS
}

/// Returns the attempt that would tell a number.
pub(super) fn advice(row: &Parameter) -> &'static str {
    let path = &row.path;
    match path.kind() {
        Kind::Robot => "record target_TCP_pose beside actual_TCP_pose",
        Kind::Springs => {
            "press the finger with a weight, as its sheet says (`optimize export finger --format sheet`)"
        }
        Kind::Added if *path == CLEARANCE => "measure plug and opening with a caliper",
        Kind::Added => "starts 0.2 mm inside and outside of both ends of the window",
        _ if *path == FRICTION => {
            "a probe: slide 8 mm along y and back at 5 mm/s and 5 N on a flat face"
        }
        _ if path.ends_with("preload_mm") => {
            "record target_TCP_pose: the preload is how far the target goes beyond the touch"
        }
        _ if not_fitted(row) => {
            "pull the plug out of the closed grip: half of the force over the grip force"
        }
        _ => "starts at both ends of the window, where the plug turns in the grasp",
    }
}
