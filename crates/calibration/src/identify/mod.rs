//! Identification of a cell from the logs of attempts in it. The cell is the robot with its gripper and the task; its
//! unknown parameters are, for example, stiffness of the robot and friction. Reads files and writes none.
//!
//! 1. `log`: samples of one attempt; `read`: formats of log files.
//! 2. `frame`: frame of the task in the base of the robot, and convention of the recorded force.
//! 3. `runs`: table of the logs, with finger, offset and outcome of each.
//! 4. `touch`: first touch of the tool, and the force in the air before it.
//! 5. `check`: faults of logs, checked before the fit; `axes`: agreement of the columns of a log.
//! 6. `curves`: curves at regular times; `formulas`, `flange`: closed-form estimates from them.
//! 7. `replay`: simulation of logged attempts; `smoother`: fit of the other parameters to their curves.
//! 8. `question`: inputs, course and result of an identification; `unknown`: prior and posterior of a parameter.
//! 9. `misfit`: validation of the result; `mount`: detection of a compliant socket.

mod axes;
pub mod check;
pub mod curves;
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
#[cfg(any(test, feature = "fixtures"))]
#[allow(clippy::expect_used, reason = "for tests only")]
pub mod tests;
pub mod touch;
pub mod unknown;
