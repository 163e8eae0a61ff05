//! Tasks from meshes.

use crate::errors::raise;
use crate::keywords::Keywords;
use crate::measure::interruptible;
use finger_opt::cli::imported_json;
use finger_opt::session::ImportRequest;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Writes the task of two meshes; what it measured of them, as JSON.
#[pyfunction]
#[pyo3(signature = (plug, socket, out, /, **settings))]
pub fn import_parts<'py>(
    py: Python<'py>,
    plug: PathBuf,
    socket: Option<PathBuf>,
    out: PathBuf,
    settings: Option<&Bound<'py, PyDict>>,
) -> PyResult<String> {
    let words = Keywords::new(py, settings)?;
    let usual = ImportRequest::new(plug, socket, out);
    let request = ImportRequest {
        plug_body: words.take("plug_body")?,
        socket_body: words.take("socket_body")?,
        unit: words.choice("unit")?,
        insert_along: words.choice("insert_along")?,
        jaws: words.choice("jaws")?,
        like: words.text("like")?,
        resolution: words.take("resolution")?.unwrap_or(usual.resolution),
        engine: words.choice("engine")?.unwrap_or(usual.engine),
        names: words.take("names")?,
        ..usual
    };
    words.finish()?;
    let found = interruptible(py, |stop| request.run(&|_| (), stop))?.map_err(raise)?;
    Ok(imported_json(&request, &found).to_string())
}
