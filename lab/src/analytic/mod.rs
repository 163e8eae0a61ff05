//! Analytic checks of a contact engine: cases whose answer is known in closed
//! form, simulated with the settings that the trials use.
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
//! | T15 | moment of a pressed patch of friction against a turn |
//! | F1 .. F4 | the computed stiffness of a printed finger ([`finger`]) |
//!
//! (T9 compares two engines on trials.) Every expected value is computed from
//! its formula, which the check's file gives with its source. What no formula
//! answers, whether the windows depend on the step, [`compare`](super::compare) asks.

use contact::Engine;

pub mod arm;
mod build;
pub mod chamfer;
pub mod edge;
pub mod finger;
pub mod flange;
pub mod grasp;
pub mod incline;
pub mod jamming;
pub mod peg;
pub mod push;
pub mod spring;
pub mod step;
mod table;
pub mod wedging;

pub use table::{json, table};

/// Makes the engine to check; the argument scales its production step, so
/// `make(1.0)` is the engine as trials use it and `make(0.5)` has half its step.
pub type Make<'a> = &'a dyn Fn(f64) -> Box<dyn Engine>;

/// Largest error with which a row passes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// A share of the expected value.
    Relative(f64),
    /// In the unit of the row.
    Absolute(f64),
}

/// One quantity, as expected and as measured.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckRow {
    /// Name of the check, `"T1"` and so on.
    pub check: &'static str,
    /// What was measured, and in which case.
    pub quantity: String,
    /// From the formula.
    pub expected: f64,
    /// From the engine or the finite elements; not a number where they failed.
    pub measured: f64,
    /// Unit of the two.
    pub unit: &'static str,
    /// Largest error that passes.
    pub tolerance: Tolerance,
    /// Whether the error is within it.
    pub passed: bool,
}

impl CheckRow {
    /// Compares a measured value with the expected one; without one, as from a simulation that
    /// diverged, the row fails.
    fn new<E>(
        (check, quantity): (&'static str, String),
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
        CheckRow { check, quantity, expected, measured, unit, tolerance, passed }
    }

    /// The error in the terms of the tolerance.
    pub fn error(&self) -> f64 {
        let error = self.measured - self.expected;
        match self.tolerance {
            Tolerance::Relative(_) => error / self.expected.abs(),
            Tolerance::Absolute(_) => error,
        }
    }
}

/// Runs every check, in order.
pub fn run(make: Make<'_>) -> Vec<CheckRow> {
    let engine = make(1.0);
    let engine = engine.as_ref();
    let mut rows = spring::t1(engine);
    rows.extend(incline::t2(engine));
    rows.extend(peg::t3(engine));
    rows.extend(jamming::t4(engine));
    rows.extend(wedging::t5(engine));
    rows.extend(chamfer::t6(engine));
    rows.extend(spring::t7(engine));
    rows.extend(edge::t8(engine));
    rows.extend(step::t8(make));
    rows.extend(peg::t10(engine));
    rows.extend(arm::t11(engine));
    rows.extend(grasp::t12(engine));
    rows.extend(flange::t13(engine));
    rows.extend(push::t14(engine));
    rows.extend(grasp::t15(engine));
    rows.extend(finger::run());
    rows
}
