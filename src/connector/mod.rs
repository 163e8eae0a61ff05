//! Task files of your own connector: drafted from dimensions or meshes, and checked before simulation.

pub(crate) mod body;
pub mod check;
pub mod draft;
pub(crate) mod hold;
pub mod mesh;
pub mod nominal;
pub mod picture;
pub(crate) mod plan;
pub(crate) mod rewrite;
pub(crate) mod seat;
pub(crate) mod write;
