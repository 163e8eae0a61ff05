//! Unknown parameters of the cell (robot, gripper and task): prior and posterior.

use super::smoother::Smoothed;
use ask_tell::statistics::{Moments, normal_cdf};
use parameters::numbers::{CLEARANCE, FRICTION, Kind, PAD_FRICTION, STIFFNESS};
use parameters::{Parameter, Scale};

/// Factor on the posterior standard deviations of the smoother, chosen by the coverage on synthetic cells.
const INFLATION: f64 = 1.4;
/// Posterior standard deviation, as a fraction of the prior's, above which an unknown keeps its prior.
const UNIDENTIFIED: f64 = 0.8;

/// Source of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ValueOrigin {
    /// Estimated from the logs in closed form (`formulas`).
    Formula,
    /// Fitted to the curves of the logs.
    Fit,
    /// Prior, since the logs do not identify it.
    Prior,
    /// Value of the input files, not fitted.
    Files,
}

/// Unknown parameter of the cell.
#[derive(Debug, Clone)]
pub struct Unknown {
    pub prior: Parameter,
    pub posterior: Parameter,
    /// Standard deviation of the posterior as expected before the fit, and after it, as fractions of the prior's;
    /// `None` if the parameter was not fitted.
    pub remaining_sd: Option<[f64; 2]>,
    /// Source of the posterior.
    pub from: ValueOrigin,
    /// Measurement that would identify it, if the logs do not.
    pub advice: Option<&'static str>,
}

/// Returns the values of parameters at standard normal coordinates `z`.
pub(super) fn values<'a>(rows: &[&'a Parameter], z: &[f64]) -> Vec<(&'a Parameter, f64)> {
    rows.iter().zip(z).map(|(row, &z)| (*row, row.at(normal_cdf(z)))).collect()
}

/// Returns a parameter with a measured value; its bounds are widened to three standard deviations but stay positive.
pub(super) fn with_value(row: &Parameter, value: f64, sd: f64, source: &str) -> Parameter {
    let low = row.low.min(value - 3.0 * sd).max(if row.low > 0.0 { 0.2 * value } else { f64::MIN });
    let (high, source) = (row.high.max(value + 3.0 * sd), source.to_owned());
    Parameter { value: Some(value), sd: Some(sd), low, high, source, ..row.clone() }
}

/// Creates an unknown with a posterior of its own.
pub(super) fn identified(prior: Parameter, posterior: Parameter, from: ValueOrigin) -> Unknown {
    Unknown { prior, posterior, remaining_sd: None, from, advice: None }
}

/// Creates an unknown that keeps its prior, with advice.
pub(super) fn unidentified(prior: Parameter, remaining_sd: Option<[f64; 2]>) -> Unknown {
    let advice = Some(advice(&prior));
    Unknown { posterior: prior.clone(), prior, remaining_sd, from: ValueOrigin::Prior, advice }
}

/// Creates unknown `i` of the smoother: with its closed-form estimate `known` if there is one, else with its fitted
/// posterior, or with its prior if the logs do not identify it.
pub(super) fn fit(
    prior: &Parameter,
    known: Option<&Parameter>,
    smoothed: &Smoothed,
    i: usize,
) -> Unknown {
    let z: Vec<f64> = smoothed.members.iter().map(|member| member[i]).collect();
    let own = Moments::of(&z);
    let (mean, sd) = (own.mean, own.sample_deviation());
    let remaining_sd = Some([smoothed.expected_sd[i], INFLATION * sd]);
    if let Some(known) = known {
        // The fit must not change a measured value to compensate for errors of the model.
        let unknown = identified(prior.clone(), known.clone(), ValueOrigin::Formula);
        return Unknown { remaining_sd, ..unknown };
    }
    if sd > UNIDENTIFIED {
        return unidentified(prior.clone(), remaining_sd);
    }
    let at = |z: &f64| prior.at(normal_cdf(mean + INFLATION * (z - mean)));
    let log = prior.scale == Scale::Log;
    let drawn: Vec<f64> = z.iter().map(at).map(|v| if log { libm::log(v) } else { v }).collect();
    let moments = Moments::of(&drawn);
    let (mean, sd) = (moments.mean, moments.sample_deviation());
    let (value, sd) = if log { (libm::exp(mean), sd * libm::exp(mean)) } else { (mean, sd) };
    let value = Some(value.clamp(prior.low, prior.high));
    let source = "curves of the attempts".to_owned();
    let posterior = Parameter { value, sd: Some(sd), source, ..prior.clone() };
    Unknown { remaining_sd, ..identified(prior.clone(), posterior, ValueOrigin::Fit) }
}

/// Returns whether a parameter is excluded from the fit, since it would absorb the errors of the others; the
/// measurement of [`advice`] determines it better.
pub(super) fn not_fitted(row: &Parameter) -> bool {
    row.path == PAD_FRICTION || row.path == STIFFNESS
}

/// Returns the measurement that would identify a parameter.
pub(super) fn advice(row: &Parameter) -> &'static str {
    let path = &row.path;
    match path.kind() {
        Kind::Robot => "record target_TCP_pose beside actual_TCP_pose",
        Kind::Springs => {
            "press the finger with a weight, as described on its sheet (`optimize export finger --format sheet`)"
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
