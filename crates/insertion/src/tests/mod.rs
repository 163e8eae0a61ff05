//! Fixtures of the tests, and the rig that replaces the simulation in them.

pub mod fake;
#[cfg(test)]
pub(crate) mod fixtures;
