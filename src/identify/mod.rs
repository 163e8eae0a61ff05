//! From the logs of attempts to the cell in which they were made. Reads files, writes none.
//!
//! 1. `log`: one attempt, moment by moment; `read`: from the formats in which it is recorded.
//! 2. `frame`: the task's frame in the robot's base, and what its force means.
//! 3. `runs`: which finger, offset and outcome belong to which log.
//! 4. `touch`: where the tool touches, and the force before.
//! 5. `check`: what is wrong with a log, before anything is fitted to it.

pub(crate) mod check;
pub(crate) mod curves;
pub(crate) mod flange;
pub(crate) mod formulas;
pub(crate) mod frame;
pub mod log;
pub(crate) mod misfit;
pub(crate) mod question;
pub(crate) mod read;
pub(crate) mod replay;
pub(crate) mod runs;
pub(crate) mod smoother;
#[cfg(test)]
pub(crate) mod tests;
pub(crate) mod touch;
pub(crate) mod unknown;
