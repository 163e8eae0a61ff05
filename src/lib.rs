//! Finds the compliant finger that makes a connector insertion most robust.
//!
//! Data flows one way, and no module reaches back up the flow; `docs/architecture.md` draws
//! it, and `tests/architecture.rs` holds every import to this order:
//!
//! ```text
//! input -> finger -> surrogate -> physics -> trial -> connector
//!       -> evaluation -> optimizer -> sensitivity -> study -> verify -> calibration -> report -> cli
//! ```
//!
//! Inside the library every quantity is in SI units; millimetres, newtons per
//! millimetre and degrees appear only in names that say so (see [`units`]).
#![forbid(unsafe_code)]
#![warn(missing_docs)]
// A stream that has gone makes these panic: `cli::terminal` prints.
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a defect; what input can reach is an error with a message.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod units;

pub mod files;

pub mod stream;

pub mod outcome;

pub mod scene;

pub mod input;

pub mod finger;

pub mod surrogate;

pub mod physics;

pub mod trial;

pub mod connector;

pub mod evaluation;

pub mod optimizer;

pub mod sensitivity;

pub mod study;

pub mod verify;

pub mod calibration;

pub mod report;

pub mod cli;
