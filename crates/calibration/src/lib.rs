//! From simulation to the bench: what few measurements say of what nobody measured, and of
//! every finger (Kennedy and O'Hagan 2001, doi:10.1111/1467-9868.00294).
//!
//! 1. `simulation`: windows under drawn friction, preload, robot, finger: `prior`.
//! 2. `emulator`: a Gaussian process in the simulator's place, its error measured.
//! 3. `process`: what remains between simulation and bench, as a process over the stiffness.
//! 4. `bench`: the posterior of parameters and process, given measurements.
//! 5. `predict`, `calibrate`: ranges with intervals; each measured finger predicted without it.
//! 6. `next`: which finger to print.
//! 7. `table`: all this as text and files, and what a study keeps of it.
#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a defect; what input can reach is an error with a message.
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
