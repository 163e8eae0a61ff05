//! Errors from one insertion to the next, over which a success rate and a robust range are taken.

mod draw;
mod raw;

pub use draw::{Draw, draws};

use crate::evaluation::tolerance::Search;

/// A checked distribution of errors, and how many draws each measure takes; SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Name, as used on the command line.
    pub name: String,
    /// One line for lists.
    pub description: String,
    /// Spread of each error.
    pub errors: Errors,
    /// Settings of success-rate measurements.
    pub success: SuccessSettings,
    /// Settings of robust-range measurements.
    pub robust: RobustSettings,
}

/// Spread of each error; 0 switches it off.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    /// Start along y, normal: standard deviation, m.
    pub offset_sd: f64,
    /// Socket about z, normal: standard deviation, rad.
    pub yaw_sd: f64,
    /// Both coefficients of friction, uniform: half the width, as a share.
    pub friction_half_width: f64,
    /// Both stiffnesses, lognormal: standard deviations of the stiffness model.
    pub stiffness_sd_factor: f64,
    /// Width of the opening, uniform: half the width, m.
    pub clearance_half_width: f64,
    /// Part in the gripper along x, normal: standard deviation, m.
    pub grasp_across_sd: f64,
    /// Part in the gripper downwards, uniform from 0: largest, m.
    pub grasp_low_max: f64,
}

/// Settings of a success-rate measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SuccessSettings {
    /// Trials of each design.
    pub trials: u32,
    /// Probability with which the interval holds the true rate, 0 to 1.
    pub confidence: f64,
}

/// Settings of a robust-range measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobustSettings {
    /// Windows of each design.
    pub samples: u32,
    /// Statistic of their ranges.
    pub statistic: Statistic,
    /// Search for the ends of each window.
    pub search: Search,
}

/// One number for a sample of ranges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Statistic {
    /// Mean less so many standard deviations.
    MeanMinusSd(f64),
    /// Mean of the lowest share (0 to 1) of the samples, at least one of them.
    LowerTail(f64),
}
