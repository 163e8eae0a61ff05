//! Optimizers of named parameters by ask and tell, as lines of JSON.
//!
//! `docs/guide/python.md` describes the lines. [`Session`] is behind `optimize ask-tell` and
//! `finger_opt.Optimizer`.

mod message;
mod parameter;
mod session;

pub use message::MAX_LINE_BYTES;
pub use session::Session;
