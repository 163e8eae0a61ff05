//! Finds the compliant finger that makes a connector insertion most robust.
//!
//! Data flows one way, and no module reaches back up the flow:
//!
//! ```text
//! space -> design -> stiffness surrogate -> finger -> scene -> engine -> trial
//!       -> tolerance -> robustness -> objective -> optimizer -> study -> report
//! ```
//!
//! Inside the library every quantity is in SI units; millimetres, newtons per
//! millimetre and degrees appear only in names that say so (see [`units`]).
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod arm;
pub mod ask_tell;
pub mod check;
pub mod codesign;
pub mod cross_check;
pub mod engine;
pub mod evaluation;
pub mod finger;
pub mod input;
pub mod mjcf;
pub mod objective;
pub mod optimizer;
pub mod pareto;
pub mod report;
pub mod robot;
pub mod robustness;
pub mod scene;
pub mod shipped;
pub mod space;
pub mod stream;
pub mod study;
pub mod suite;
pub mod surrogate;
pub mod task;
pub mod tolerance;
pub mod trial;
pub mod uncertainty;
pub mod units;
pub mod validate;
