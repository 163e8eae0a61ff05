//! Calibration of the simulation on few bench measurements: posterior of the unmeasured parameters,
//! predictions for every finger (Kennedy and O'Hagan 2001, doi:10.1111/1467-9868.00294).
//!
//! 1. `simulation`: windows for drawn friction, preload, robot and finger.
//! 2. `emulator`: a Gaussian process fitted to simulations, with its error.
//! 3. `process`: discrepancy between simulation and bench, a Gaussian process over the stiffness.
//! 4. `bench`: the posterior of parameters and process, given measurements.
//! 5. `predict`, `calibrate`: ranges with intervals; each measured finger predicted without it.
//! 6. `next`: which finger to print.
//! 7. `table`: the results as JSON and CSV, and their summary in a study.
#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a bug; invalid input must produce an error with a message.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod bench;
pub mod calibrate;
pub mod emulator;
pub mod experiments;
pub mod identify;
pub mod next;
pub mod order;
pub mod predict;
pub mod process;
pub mod published;
pub mod simulation;
pub mod subject;
pub mod table;
#[cfg(test)]
mod tests;
