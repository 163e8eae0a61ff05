//! Analyses of one finger beyond its tolerance window: levers (one-at-a-time sensitivity), Sobol indices and capture
//! map.
#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a bug; invalid input must produce an error with a message.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod levers;
pub mod map;
pub mod sensitivity;
