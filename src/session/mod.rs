//! The door to all that comes before it: typed requests in, typed results out, for whoever asks:
//! the command line, the program `lab`, Python.
//!
//! A request is checked when it is turned into what it is used as; nothing is printed here. It fails
//! if a file that it names cannot be used or written, or if there is no such finger, task or study.
//! What takes long ends, with a failure, once the `stop` that it is given is set.

mod calibration;
mod evaluate;
mod failure;
mod files;
mod film;
mod finger;
mod guided;
mod how;
mod measured;
mod next;
mod on_bench;
mod open;
mod optimizer;
mod printable;
mod repeat;
mod report;
mod request;
mod ribs;
mod sensitivity;
mod setup;
mod standing;
mod study;
mod task;
#[cfg(test)]
mod tests;
mod trial;
mod unusable;

pub use calibration::{BenchRequest, CalibrateRequest, Calibrated, HowCalibrated};
pub use evaluate::{EvaluateRequest, Evaluated};
pub use failure::Failure;
pub use files::robot;
pub use film::FilmRequest;
pub use finger::{Chosen, FingerRequest};
pub use guided::{Guided, NotTaken, Order, perform};
pub use how::{CacheRequest, EffortRequest, RunRequest};
pub use measured::read as read_measurements;
pub use next::{Advised, Among, NextRequest};
pub use open::{Ended, OpenStudy};
pub use repeat::RepeatRequest;
pub use report::{PAGE, rewrite};
pub use request::{DEFAULT_ROBOT, FingerModelRequest, SetupRequest, TaskSource};
pub use ribs::{PrintRequest, RibsRequest, StiffnessRequest};
pub use sensitivity::SensitivityRequest;
pub use setup::Setup;
pub use standing::Standing;
pub use study::{AnyStudy, POLISH, ResumeRequest, StudyRequest};
pub use task::{TaskCheck, TaskFile, read_space, read_task};
pub use trial::{Insertion, SceneRequest, TrialDone, TrialRequest};

use crate::study::Recorded;

/// What happens meanwhile, for whoever shows it.
#[derive(Debug)]
pub enum Event<'a> {
    /// A design was measured and is written down.
    Measured(&'a Recorded),
    /// The search has ended; what confirms its result follows.
    Searched {
        /// Why evaluations are not kept for other studies, if so.
        not_kept: Option<String>,
    },
    /// An emulator is about to be made, of simulations or their cache.
    Simulating {
        /// Name of the task.
        task: &'a str,
        /// How many simulations.
        count: usize,
    },
}

/// Is told what happens meanwhile.
pub type Watch<'a> = dyn FnMut(Event<'_>) + Send + 'a;
