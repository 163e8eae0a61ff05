//! What is known of the simulation and the optimizers by comparison: analytic checks, a second
//! engine, the published tables, and functions with known optima.

pub mod agreement;
pub mod analytic;
pub mod cross_check;
pub mod problems;
