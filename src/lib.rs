//! Finds the compliant finger that makes a connector insertion most robust.
//!
//! Data flows between the crates in one direction; `docs/architecture.md` has a diagram. This crate contains the
//! [`commands`] of the program `optimize`: each is a request, whose fields are its options, and an output,
//! which is printed as text or JSON.
//!
//! Inside the library every quantity is in SI units; values in millimetres, newtons per millimetre or degrees have the
//! unit in their names (see [`input::units`]).
//!
//! ```
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
//! let window = request.evaluated(&Context::silent(&stop))?.evaluation.window;
//! assert!(window.range_mm() > 2.0 && window.negative_mm() < 0.0 && window.positive_mm() > 0.0);
//! # Ok::<(), Failure>(())
//! ```

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

pub use command::Output;
pub use context::{Context, not_stopped};
pub use failure::Failure;
pub use setup::Setup;
pub use setup::finger::{ChosenFinger, FingerRequest};
pub use setup::request::{RobotRequest, SetupRequest, TaskSource};
pub use setup::run::RunRequest;
pub use setup::task::{TaskCheck, TaskFile, read_task};
