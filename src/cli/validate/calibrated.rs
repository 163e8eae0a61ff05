//! Calibrations that were made before, for `optimize validate --against bench`.

use crate::cli::Failure;
use crate::files::{self, LARGEST_INPUT};
use crate::input::task::Task;
use crate::verify::compare::published::{Calibrated, LeftOutFinger};
use std::path::{Path, PathBuf};

/// The left-out fingers in a folder's `leave_one_out*.csv`, by task.
pub fn read(dir: &Path, tasks: &[Task]) -> Result<Vec<Calibrated>, Failure> {
    let mut fingers: Vec<LeftOutFinger> = Vec::new();
    for path in tables(dir)? {
        let wrong = |problem: String| Failure::usage(format!("{}: {problem}", path.display()));
        let text = files::read_named(&path, LARGEST_INPUT).map_err(|e| wrong(e.to_string()))?;
        fingers.extend(LeftOutFinger::parse(&text).map_err(wrong)?);
    }
    let of = |task: &Task| Calibrated {
        task: task.name.clone(),
        fingers: fingers.iter().filter(|one| one.task == task.name).cloned().collect(),
    };
    let found = tasks.iter().map(of).filter(|one| !one.fingers.is_empty());
    let found: Vec<Calibrated> = found.collect();
    match found.is_empty() {
        true => Err(Failure::usage(format!(
            "{}: no leave_one_out*.csv with fingers of these tasks; `optimize calibrate --task T \
             --measurements published --out DIR` writes it",
            dir.display()
        ))),
        false => Ok(found),
    }
}

fn tables(dir: &Path) -> Result<Vec<PathBuf>, Failure> {
    let unreadable = |error| Failure::usage(format!("{}: cannot read it: {error}", dir.display()));
    let named = |path: &PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        name.starts_with("leave_one_out") && name.ends_with(".csv")
    };
    let entries = std::fs::read_dir(dir).map_err(unreadable)?;
    let mut paths: Vec<PathBuf> =
        entries.filter_map(|entry| Some(entry.ok()?.path())).filter(named).collect();
    paths.sort();
    Ok(paths)
}
