//! Verification of the models: analytic checks, comparisons of windows, optimizers on known problems.
#![forbid(unsafe_code)]
#![warn(missing_docs)]
// A stream that has gone makes these panic: `finger_opt::terminal` prints.
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a defect; what input can reach is an error with a message.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod analytic;
pub mod cli;
mod compare;
mod identified;
mod problems;
