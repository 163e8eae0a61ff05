//! Identification of a cell from the logs of attempts in it. Reads files and writes none.
//!
//! 1. `log`: samples of one attempt; `read`: formats of log files.
//! 2. `frame`: frame of the task in the base of the robot, and convention of the recorded force.
//! 3. `runs`: table of the logs, with finger, offset and outcome of each.
//! 4. `touch`: first touch of the tool, and the force in the air before it.
//! 5. `check`: faults of logs, checked before the fit; `axes`: agreement of the columns of a log.

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
