//! Task files of new connectors: drafts from dimensions or meshes, checks, and tuning of the strategy.
#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr)]
// A panic is a bug; invalid input must produce an error with a message.
#![cfg_attr(not(test), deny(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod body;
pub mod check;
pub mod draft;
pub mod hold;
pub mod mating;
pub mod mesh;
pub mod nominal;
pub mod picture;
pub mod pins;
pub mod plan;
pub mod rewrite;
pub mod seat;
pub mod tune;
pub mod write;
