//! Finds the compliant finger that makes a connector insertion most robust.
//!
//! Data flows one way, and no crate reaches back up the flow; `docs/architecture.md` draws it. This crate holds the
//! [`commands`] of the program `optimize`: each is a request, whose fields are its options, and a response,
//! which is printed as text or JSON.
//!
//! Inside the library every quantity is in SI units; millimetres, newtons per millimetre and degrees appear only in
//! names that say so (see [`input::units`]).
//!
//! ```
//! use finger_opt::command::Request as _;
//! use finger_opt::commands::evaluate;
//! use finger_opt::context::Context;
//! use finger_opt::failure::Failure;
//! use finger_opt::setup::finger::{FingerRequest, InfillRequest};
//! use finger_opt::setup::request::{SetupRequest, TaskSource};
//! use std::sync::atomic::AtomicBool;
//!
//! let setup = SetupRequest { tasks: TaskSource::list("usb"), ..SetupRequest::default() };
//! let finger = FingerRequest { infill: InfillRequest::of(20.0, 10.0), ..FingerRequest::default() };
//! let request = evaluate::Request { setup, finger, ..evaluate::Request::default() };
//! let stop = AtomicBool::new(false); // set by another thread, it ends the work
//! let window = request.run(&Context::silent(&stop))?.evaluation.window;
//! assert!(window.range_mm() > 2.0 && window.negative_mm() < 0.0 && window.positive_mm() > 0.0);
//! # Ok::<(), Failure>(())
//! ```
#![forbid(unsafe_code)]
#![warn(missing_docs)]
// A stream that has gone makes these panic: `terminal` prints.
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a defect; what input can reach is an error with a message.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod command;
pub mod commands;
pub mod context;
mod executor;
pub mod failure;
mod help;
pub mod keywords;
mod layout;
pub mod manual;
pub mod program;
pub mod progress;
pub mod project;
pub mod python;
pub mod setup;
pub mod studies;
pub mod terminal;
