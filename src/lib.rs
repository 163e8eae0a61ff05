//! Finds the compliant finger that makes a connector insertion most robust.
//!
//! Data flows one way, and no module reaches back up the flow; `docs/architecture.md` draws it:
//!
//! ```text
//! input, contact, ask_tell -> finray -> insertion -> connector, study -> analysis, calibration -> report
//!       -> session -> cli
//! ```
//!
//! Inside the library every quantity is in SI units; millimetres, newtons per
//! millimetre and degrees appear only in names that say so (see [`input::units`]).
//!
//! What other programs may rely on are the requests and results of [`session`]:
//!
//! ```
//! use finger_opt::session::{EvaluateRequest, Failure, FingerRequest, SetupRequest, TaskSource};
//! use std::sync::atomic::AtomicBool;
//!
//! let setup = SetupRequest { tasks: TaskSource::list("usb"), ..SetupRequest::default() };
//! let finger = FingerRequest { density: Some(20.0), direction: Some(10.0), ..FingerRequest::default() };
//! let request = EvaluateRequest { setup, finger, ..EvaluateRequest::default() };
//! let stop = AtomicBool::new(false); // set by another thread, it ends the work
//! let window = request.run(&stop)?.evaluation.window;
//! assert!(window.range_mm() > 2.0 && window.negative_mm() < 0.0 && window.positive_mm() > 0.0);
//! # Ok::<(), Failure>(())
//! ```
#![forbid(unsafe_code)]
#![warn(missing_docs)]
// A stream that has gone makes these panic: `cli::terminal` prints.
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a defect; what input can reach is an error with a message.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod cli;
pub mod session;
