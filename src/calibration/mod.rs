//! From simulation to the bench: what few measurements say of what nobody measured, and of
//! every finger (Kennedy and O'Hagan 2001, doi:10.1111/1467-9868.00294).
//!
//! 1. [`simulation`]: windows under drawn friction, preload, robot, finger: [`prior`].
//! 2. [`emulator`]: a Gaussian process in the simulator's place, its error measured.
//! 3. [`process`]: what remains between simulation and bench, as a process over the stiffness.
//! 4. [`mod@bench`], [`sampler`]: the posterior of parameters and process, given measurements.
//! 5. [`mod@predict`], [`loo`]: ranges with intervals; each measured finger predicted without it.
//! 6. [`next`]: which finger to print.
//! 7. [`mod@on_bench`]: what a study keeps of it.

pub mod bench;
pub mod calibrate;
pub mod emulator;
pub mod experiments;
pub mod loo;
pub mod next;
pub mod on_bench;
pub mod order;
pub mod predict;
pub mod prior;
pub mod process;
pub mod published;
pub mod sampler;
pub mod simulation;
pub mod statistics;
pub mod subject;
pub mod table;
#[cfg(test)]
mod tests;
