//! From the logs of attempts to the cell in which they were made. Reads files, writes none.
//!
//! 1. `log`: one attempt, sample by sample; `read`: from the formats in which it is recorded.
//! 2. `frame`: the task's frame in the robot's base, and what its force means.
//! 3. `runs`: which finger, offset and outcome belong to which log.
//! 4. `touch`: where the tool touches, and the force before.
//! 5. `check`: what is wrong with a log, before anything is fitted to it; `axes`: whether its columns agree.

mod axes;
pub mod check;
pub mod curves;
#[cfg(any(test, feature = "fixtures"))]
#[allow(clippy::expect_used, reason = "for tests only")]
pub mod fixtures;
pub mod flange;
pub mod formulas;
pub mod frame;
pub mod log;
pub mod misfit;
pub mod mount;
pub mod question;
pub mod read;
pub mod replay;
pub mod runs;
pub mod smoother;
#[cfg(test)]
mod tests;
pub mod touch;
pub mod unknown;
