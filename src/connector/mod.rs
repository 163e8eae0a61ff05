//! One's own connector: a task from dimensions or meshes, and whether it can work.

pub mod body;
pub mod check;
pub mod draft;
pub mod hold;
pub mod mesh;
pub mod nominal;
pub mod path;
pub mod picture;
pub mod plan;
pub mod round;
pub mod seat;
pub mod write;
