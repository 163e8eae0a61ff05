//! `optimize ask-tell`: an optimizer behind JSON lines, for anything that can be measured.
//!
//! The protocol is described in `docs/guide/python.md`. [`Session`] is all of it but the reading
//! and writing: one line in, at most one line out.

mod batch;
mod decimal;
mod message;
mod parameter;
mod session;

pub use message::LONGEST_LINE;
pub use session::Session;
