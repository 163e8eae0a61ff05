//! Numbers that may vary, each described once: a [`Path`] in the table of all [`numbers`], a
//! [`Parameter`] with its distribution and bounds, search spaces of them and the plans by which they
//! are sampled.
#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a defect; what input can reach is an error with a message.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod numbers;
mod parameter;
mod path;
pub mod plan;
pub mod space;

pub use parameter::{Parameter, Scale, Transform, draws};
pub use path::{Path, UnknownPath, label};
