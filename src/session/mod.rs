//! The door to all that comes before it: typed requests in, typed results out, for whoever asks:
//! the command line, the program `lab`, Python.
//!
//! A request is checked when it is turned into what it is used as; nothing is printed here. It fails
//! if a file that it names cannot be used or written, or if there is no such finger, task or study.
//! Long work ends, with a failure, once the `stop` that it is given is set.

mod around;
mod calibration;
mod evaluate;
mod failure;
mod files;
mod film;
mod finger;
mod guided;
mod how;
mod identify;
mod import;
mod levers;
mod map;
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
mod robots;
mod sensitivity;
mod setup;
mod sheet;
mod standing;
mod study;
mod sweep;
mod task;
#[cfg(test)]
mod tests;
mod trial;
mod tune;
mod unusable;

pub use ::calibration::identify::question::IdentifyDone;
pub use around::Around;
pub use calibration::{BenchRequest, CalibrateRequest, Calibrated, HowCalibrated};
pub use evaluate::{EvaluateRequest, Evaluated};
pub use failure::Failure;
pub use files::robot;
pub use film::FilmRequest;
pub use finger::{Chosen, FingerRequest};
pub use guided::{Guided, NotTaken, Order, perform};
pub use how::{CacheRequest, EffortRequest, RunRequest};
pub use identify::IdentifyRequest;
pub use import::{ImportRequest, ImportedTask};
pub use levers::LeversRequest;
pub use map::MapRequest;
pub use measured::read as read_measurements;
pub use next::{Advised, Among, NextRequest};
pub use open::{Ended, OpenStudy};
pub use repeat::RepeatRequest;
pub use report::{PAGE, rewrite};
pub use request::{DEFAULT_ROBOT, FingerModelRequest, SetupRequest, TaskSource};
pub use ribs::{PrintRequest, Ribs, RibsRequest, StiffnessRequest};
pub use robots::{ForCell, robots};
pub use sensitivity::SensitivityRequest;
pub use setup::Setup;
pub use sheet::SheetRequest;
pub use standing::Standing;
pub use study::{AnyStudy, POLISH, ResumeRequest, StudyRequest};
pub use sweep::Sweep;
pub use task::{TaskCheck, TaskFile, read_space, read_task};
pub use trial::{Insertion, SceneRequest, TrialDone, TrialRequest};
pub use tune::{TuneDone, TuneRequest, begun};

use ::study::Recorded;
use std::sync::Mutex;

/// Events of a run, for whoever shows them.
#[derive(Debug)]
pub enum Event<'a> {
    /// A design was measured and is written down.
    Measured(&'a Recorded),
    /// The search has ended; what confirms its result follows.
    Searched {
        /// Why evaluations are not kept for other studies, if so.
        not_kept: Option<String>,
    },
    /// A part of what follows the search, or of a calibration, is done.
    Part(Part),
}

/// A part of a long phase.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The phase, and what was done: `confirming 10 %, 26°`.
    pub what: String,
    /// Parts of the phase that are done.
    pub done: usize,
    /// Parts of the phase.
    pub of: usize,
    /// Cost of such a part, in evaluations of the search, roughly.
    pub cost: f64,
}

/// Costs of the parts: of a design that is repeated at its ends, of one that is walked, of a
/// simulation for an emulator, of a calibration with fingers left out. Measured on usb and ket8; they
/// decide nothing but the time that is said to be left.
pub const COSTS: [f64; 4] = [4.0, 12.0, 1.2, 4.0];

/// Tells a part from whichever thread has done it.
fn tell(watch: &Mutex<&mut Watch<'_>>, part: Part) {
    // Whoever shows it has panicked: that ends the run by itself.
    if let Ok(mut watch) = watch.lock() {
        watch(Event::Part(part));
    }
}

/// Is told what happens meanwhile.
pub type Watch<'a> = dyn FnMut(Event<'_>) + Send + 'a;
