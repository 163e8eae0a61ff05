//! Tests of the program and of the project, in one binary: linked once, and run beside each other.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::print_stderr
)]

mod architecture;
mod ask_tell;
mod bench;
mod cell;
mod command_line;
mod common;
mod compare;
mod connectors;
mod dependencies;
mod documents;
mod executor;
mod export;
mod fuzz;
mod guide;
mod hostile;
mod identify;
mod insertion;
mod journal;
mod map;
mod objectives;
mod optimizers;
mod parameters;
mod race;
mod recovery;
mod requests;
mod settle;
mod study;
mod task;
mod tune;
mod version_0_5_0;
