//! Sampling plans over parameters: where to evaluate, not how.

pub mod grid;
pub mod one_at_a_time;
pub mod saltelli;
