//! Search spaces and designs, re-exported from the crate `parameters`.

pub use parameters::space::{
    DENSITY_KEY, DIRECTION_KEY, Design, Space, Variable, corners, is_of_task,
};
pub use parameters::{Scale, label};
