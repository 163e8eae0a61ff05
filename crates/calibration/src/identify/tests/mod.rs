//! Tests of the identification, and their synthetic log, which other crates use as well.

#[cfg(test)]
mod cases;
pub mod fixtures;
