//! STEP files, which the Python package reads with Open Cascade.

use crate::context::Context;
use crate::failure::Failure;
use crate::python::Format;
use connector::mesh::{Body, read};
use std::path::Path;

/// STEP file, converted to bodies in OBJ, mm.
const STEP: Format = Format {
    name: "a STEP file",
    extra: "step",
    reader: "import warnings
    from finger_opt import _step
    warnings.formatwarning = lambda message, *rest: f'warning: {message}\\n'
    sys.stdout.write(_step.obj(_step.read(sys.argv[1], 0.01)))",
    otherwise: "or export STL",
};

/// Reads the bodies of a STEP file, mm, meshed with a tolerance of 0.01 mm.
///
/// # Errors
/// If the file is not a STEP file, or the Python package or its extra `step` is not installed.
pub fn bodies(path: &Path, file: &str, context: &Context<'_>) -> Result<Vec<Body>, Failure> {
    let (found, warnings) = STEP.read(path, file).map_err(Failure::input)?;
    warnings.iter().for_each(|warning| context.note(warning));
    read(&found, &format!("{file}.obj")).map_err(Failure::input)
}
