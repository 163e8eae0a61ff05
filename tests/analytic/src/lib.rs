//! Analytic checks: cases with a closed-form answer, simulated with the settings of the trials.
//!
//! | check | what must be right |
//! | --- | --- |
//! | T1 | static deflection of the finger's springs |
//! | T2 | friction on an incline |
//! | T3 | geometry of two-point contact of a peg in a hole |
//! | T4 | jamming threshold in two-point contact |
//! | T5 | wedging threshold in two-point contact |
//! | T6 | force of crossing a chamfer |
//! | T7 | remote centre of compliance |
//! | T8 | edge drop, convergence with the step, snapshots |
//! | T10 | stiffness of a contact that wedges a light plug |
//! | T11 | static deflection of the arm's TCP under its servos |
//! | T12 | friction of a face that slides and turns, as in the grasp |
//! | T13 | a soft flange whose command sets off |
//! | T14 | net force of a contact that sticks and that slides |
//! | T15 | moment of a contact patch of friction against a turn |
//! | T16 | friction along an axis, as of contact springs |
//! | P1 .. P11 | planar insertion: force over depth, wedging, rounded edges; yaw in a hole (`slab`) |
//! | F1 .. F4 | the computed stiffness of a printed finger |
//!
//! T9, `lab cross-check`, compares two engines on trials. The file of each check gives the formula of the
//! expected value, with its source.
#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

use contact::Engine;

pub mod arm;
mod axial;
mod build;
mod chamfer;
mod edge;
mod finger;
mod grasp;
mod incline;
mod jamming;
mod peg;
pub mod planar;
pub mod slab;
mod spring;
mod table;

pub use table::table;

/// Constructor of the engine under check; its argument scales the production step.
pub type Make<'a> = &'a dyn Fn(f64) -> Box<dyn Engine>;

/// Largest error with which a row passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// As a share of the expected value.
    Relative(f64),
    /// In the unit of the row.
    Absolute(f64),
}

impl Tolerance {
    /// Returns the largest error in the terms of [`CheckRow::error`].
    fn largest(self) -> f64 {
        let (Tolerance::Relative(error) | Tolerance::Absolute(error)) = self;
        error
    }
}

/// Result of one check.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckRow {
    /// Identifier of the check, such as `"T1"`.
    pub check: &'static str,
    /// Measured quantity and its case.
    pub quantity: String,
    /// Value of the formula.
    pub expected: f64,
    /// Value of the engine or the finite elements; not a number where they failed.
    pub measured: f64,
    /// Unit of expected and measured value.
    pub unit: &'static str,
    /// Largest error that passes.
    pub tolerance: Tolerance,
    /// Whether the error is within it, or halves with the compliance of contacts (`slab`).
    pub passed: bool,
}

impl CheckRow {
    /// Makes the row of a measured value; an error, as of a simulation that diverged, fails.
    fn new<E>(
        check: &'static str,
        quantity: impl Into<String>,
        expected: f64,
        measured: Result<f64, E>,
        unit: &'static str,
        tolerance: Tolerance,
    ) -> Self {
        let measured = measured.unwrap_or(f64::NAN);
        let allowed = match tolerance {
            Tolerance::Relative(share) => share * expected.abs(),
            Tolerance::Absolute(error) => error,
        };
        let passed = (measured - expected).abs() <= allowed;
        let quantity = quantity.into();
        CheckRow { check, quantity, expected, measured, unit, tolerance, passed }
    }

    /// Returns the error in the terms of the tolerance.
    pub fn error(&self) -> f64 {
        let error = self.measured - self.expected;
        match self.tolerance {
            Tolerance::Relative(_) => error / self.expected.abs(),
            Tolerance::Absolute(_) => error,
        }
    }
}

/// Returns the results of every check, in order.
pub fn run(make: Make<'_>) -> Vec<CheckRow> {
    let mut rows = contact(make);
    rows.extend(finger::run());
    rows
}

/// Returns the results of the checks of a contact engine, T1 to T16.
pub fn contact(make: Make<'_>) -> Vec<CheckRow> {
    let engine = make(1.0);
    let all = |checks: &[fn(&dyn Engine) -> Vec<CheckRow>]| -> Vec<CheckRow> {
        checks.iter().flat_map(|check| check(&*engine)).collect()
    };
    let first =
        [spring::t1, incline::t2, peg::t3, jamming::t4, jamming::t5, chamfer::t6, spring::t7];
    let last = [peg::t10, arm::t11, grasp::t12, arm::t13, incline::t14, grasp::t15, axial::t16];
    [all(&first), edge::t8(make), all(&last)].concat()
}
