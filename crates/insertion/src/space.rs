//! Search spaces and designs, as of the crate `parameters`.

pub use parameters::space::{DENSITY_KEY, DIRECTION_KEY, Design, Space, Variable, corners};
pub use parameters::{Scale, label};
