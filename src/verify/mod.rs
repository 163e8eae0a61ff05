//! What is known of the simulation and the optimizers by comparison: analytic checks, the same
//! fingers measured in several ways, and functions with known optima.

pub mod analytic;
pub mod compare;
pub mod problems;
