//! Calibration of the simulation on few bench measurements: posterior of the unmeasured parameters,
//! predictions for every finger (Kennedy and O'Hagan 2001, doi:10.1111/1467-9868.00294).
//!
//! The tolerance window of a finger on a task is the interval of shifts of the start along y from which the plug is
//! inserted; its width is the range, mm. A finger is that of a design; a bench is a robot on which ranges are measured.
//!
//! 1. `simulation`: windows for given friction, preload, robot and finger.
//! 2. `emulator`: a Gaussian process fitted to simulated ranges, with its error.
//! 3. `process`: discrepancy between simulation and bench, a Gaussian process over the stiffness.
//! 4. `subject`, `bench`: the posterior of parameters and hyperparameters, given the measurements of each task.
//! 5. `predict`, `calibrate`, `verdict`: ranges with intervals; leave-one-out validation.
//! 6. `next`: which finger to print.
//! 7. `table`: the results as JSON and CSV, and their summary in a study.
//!
//! `experiments` reads measurements, `identify` estimates parameters from logs of the robot.
#![allow(missing_docs)]

pub mod bench;
pub mod calibrate;
pub mod emulator;
pub mod experiments;
pub mod identify;
pub mod next;
pub mod predict;
pub mod process;
pub mod published;
pub mod rank_correlation;
pub mod simulation;
pub mod subject;
pub mod table;
#[cfg(test)]
mod tests;
pub mod verdict;
