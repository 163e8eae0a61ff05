//! Input files by shipped name or path.

use crate::failure::Failure;
use finray::printed::PrintedFinger;
use input::shipped::{self, FINGERS, ROBOTS, STIFFNESS, Shipped, Source};
use insertion::finger::model::ComputedFingers;
use insertion::stiffness::SurrogateError;
use insertion::surrogate::{self, Model};
use insertion::{FingerFile, FingerSource, Robot, stiffness};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Default finger file.
pub const DEFAULT_FINGER: &str = "finray9";

/// Finger file of a setup: the one of computed fingers, else the shipped one.
pub(crate) struct Fingers {
    /// Text of the file, if fingers are computed.
    pub source: Option<Source>,
    /// The file; its finger is the one whose stiffness was measured.
    pub file: FingerFile,
}

impl Fingers {
    pub fn parse(source: Option<Source>) -> Result<Self, Failure> {
        let shipped = || find("finger", FINGERS, DEFAULT_FINGER);
        let Source { file, text } = source.clone().map_or_else(shipped, Ok)?;
        Ok(Fingers { source, file: FingerFile::parse(&text, &file)? })
    }

    /// Returns the finger model.
    pub fn finger_source(&self) -> FingerSource {
        self.source.as_ref().map_or(FingerSource::Paper, |_| self.computed())
    }

    /// Returns the finger model that computes stiffness from the ribs of the file.
    pub fn computed(&self) -> FingerSource {
        FingerSource::Computed(Box::new(ComputedFingers::new(self.file.clone())))
    }
}

/// Returns the data of the stiffness model (surrogate): those at `path`, else the table named in the finger file.
///
/// # Errors
/// If they cannot be read, or the finger file names none.
pub fn stiffness_data(path: Option<&str>, finger: &PrintedFinger) -> Result<Source, Failure> {
    let find = |name: &str| find("stiffness data", STIFFNESS, name);
    match (path, &finger.measured) {
        (Some(path), _) => find(path),
        (None, Some(named)) => match STIFFNESS.iter().find(|shipped| shipped.file == named) {
            Some(shipped) => find(shipped.name),
            None => {
                let beside = Path::new(&finger.file).parent().unwrap_or(Path::new(""));
                find(&beside.join(named).to_string_lossy())
            }
        },
        (None, None) => Err(Failure::in_file(
            &finger.file,
            "key `measured` (table of measured fingers) is missing; add it, or give --stiffness-data: one \
             finger is enough",
        )),
    }
}

/// Returns the shipped file of that name, or the file at that path.
pub fn find(kind: &'static str, shipped: &[Shipped], name: &str) -> Result<Source, Failure> {
    shipped::resolve(kind, shipped, name).map_err(Failure::input)
}

/// Checks that a file to be written does not exist yet.
pub(crate) fn check_is_new(out: &Path) -> Result<(), Failure> {
    let problem = || format!("{} exists; name another file with --out", out.display());
    if out.exists() { Err(Failure::usage(problem())) } else { Ok(()) }
}

/// Reads the robot of that name, or of the file at that path.
pub fn robot(name: &str) -> Result<Robot, Failure> {
    let source = find("robot", ROBOTS, name)?;
    Robot::parse(&source.text, &source.file).map_err(Failure::input)
}

/// Stiffness model with the data and the finger to which it was fitted.
type Fit = (Source, PrintedFinger, Arc<Model>);

/// Last fit, which the next evaluation usually needs again.
static LAST: Mutex<Option<Fit>> = Mutex::new(None);

/// Fits the stiffness model (surrogate) to a CSV table of stiffness measurements of a finger.
pub fn surrogate(data: &Source, finger: &PrintedFinger) -> Result<Arc<Model>, Failure> {
    let last = || LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((known, of, model)) = &*last()
        && (known, of) == (data, finger)
    {
        return Ok(Arc::clone(model));
    }
    let measurements = stiffness::parse(&data.text, &data.file).map_err(Failure::input)?;
    let model = surrogate::fit(&measurements, finger).map_err(|error| match error {
        // The measurements have been checked: the fault is that of a finger.
        SurrogateError::Fault(error) => Failure::input(error),
        error => Failure::in_file(&data.file, error),
    })?;
    let model = Arc::new(model);
    *last() = Some((data.clone(), finger.clone(), Arc::clone(&model)));
    Ok(model)
}
