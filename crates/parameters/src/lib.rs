//! Numbers of the input files: the table of all [`numbers`] with their [`Path`]s, uncertain [`Parameter`]s, search
//! spaces, and sampling plans.
#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a bug; invalid input must produce an error with a message.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod numbers;
mod parameter;
mod path;
pub mod plan;
pub mod space;

pub use parameter::{Parameter, Scale, Transform, draws};
pub use path::{Path, label};
