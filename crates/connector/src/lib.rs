//! Task files of new connectors: drafts from dimensions or meshes, checks, and tuning of the strategy.
#![allow(missing_docs)]

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
pub mod push;
pub mod rewrite;
pub mod seat;
pub mod tune;
pub mod write;
