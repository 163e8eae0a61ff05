//! Finds the compliant finger that makes a connector insertion most robust.
//!
//! Data flows one way, and no module reaches back up the flow; `docs/architecture.md` draws it:
//!
//! ```text
//! input, contact, finray, ask_tell -> insertion
//!       -> connector, sensitivity, map, study, calibration -> identify, levers, tune -> answer -> report -> session -> cli
//! ```
//!
//! Inside the library every quantity is in SI units; millimetres, newtons per
//! millimetre and degrees appear only in names that say so (see [`input::units`]).
#![forbid(unsafe_code)]
#![warn(missing_docs)]
// A stream that has gone makes these panic: `cli::terminal` prints.
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a defect; what input can reach is an error with a message.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod answer;
pub mod calibration;
pub mod cli;
pub mod connector;
pub mod identify;
pub mod levers;
pub mod map;
pub mod report;
pub mod sensitivity;
pub mod session;
pub mod study;
pub mod tune;
