//! Sampling plans: the points at which to evaluate.

pub mod grid;
pub mod one_at_a_time;
pub mod saltelli;
