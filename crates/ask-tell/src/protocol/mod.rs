//! Ask-and-tell protocol for named parameters, as JSON lines.
//!
//! `docs/guide/python.md` describes the messages. `optimize ask-tell` and `finger_opt.Optimizer`
//! use [`Session`].

mod message;
mod parameter;
mod session;

pub use message::MAX_LINE_BYTES;
pub use session::Session;
