//! STEP files, which the Python package reads by Open Cascade.

use crate::context::Context;
use crate::failure::Failure;
use crate::python::Format;
use connector::mesh::{Body, read};
use std::path::Path;

/// Read as bodies in OBJ, mm.
const STEP: Format = Format {
    name: "a STEP file",
    extra: "step",
    reader: "
try:
    import warnings
    from finger_opt import _step
    warnings.formatwarning = lambda message, *rest: f'warning: {message}\\n'
    sys.stdout.write(_step.obj(_step.read(sys.argv[1], 0.01)))
except Exception as error:
    sys.exit(' '.join(str(error).split()))
",
    otherwise: "or export STL",
};

/// Returns the bodies of a STEP file, mm, meshed within 0.01 mm.
///
/// # Errors
/// If the file is no STEP file, or the Python package or its extra `step` is not installed.
pub fn bodies(path: &Path, file: &str, context: &Context<'_>) -> Result<Vec<Body>, Failure> {
    let (found, warnings) = STEP.read(path, file).map_err(Failure::input)?;
    warnings.iter().for_each(|warning| context.note(warning));
    read(&found, &format!("{file}.obj")).map_err(Failure::input)
}
