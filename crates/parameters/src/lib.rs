//! Numbers of the input files: the table of all [`numbers`] with their [`Path`]s, uncertain [`Parameter`]s, search
//! spaces, and sampling plans.

pub mod numbers;
mod parameter;
mod path;
pub mod plan;
pub mod space;

pub use parameter::{Parameter, Scale, Transform, draws};
pub use path::{Path, label};
