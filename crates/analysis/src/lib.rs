//! Analyses of one finger beyond its tolerance window: levers (one-at-a-time sensitivity), Sobol indices and capture
//! map.

pub mod levers;
pub mod map;
pub mod sensitivity;
