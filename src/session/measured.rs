//! Bench measurements, and the bounds of what nobody measured, as files have them.

use super::Failure;
use super::files::find;
use crate::calibration::experiments::{self, Experiment};
use crate::calibration::prior::Priors;
use crate::calibration::subject::whole;
use input::files::{LARGEST_INPUT, read_named};
use input::shipped::{MEASUREMENTS, Source, TASKS};
use insertion::evaluation::template::Template;
use insertion::space::Space;

/// Measurements from the bench, and the bounds of what nobody measured.
pub struct Measured {
    /// The measurements' file.
    pub file: String,
    /// Its lines.
    pub experiments: Vec<Experiment>,
    /// The bounds.
    pub priors: Priors,
}

/// The measurements of that name or at that path, checked; their tasks are shipped ones or
/// those in `more`.
pub fn read(name: &str, more: &[&str]) -> Result<Vec<Experiment>, Failure> {
    lines(&file(name)?, more)
}

/// A shipped name, or else a path, whatever it looks like.
pub fn file(name: &str) -> Result<Source, Failure> {
    if std::path::Path::new(name).is_file() {
        let text = read_named(std::path::Path::new(name), LARGEST_INPUT);
        let unreadable = |error| Failure::usage(format!("{name}: cannot read it: {error}"));
        return Ok(Source { file: name.to_owned(), text: text.map_err(unreadable)? });
    }
    find("measurement file", MEASUREMENTS, name)
}

/// Most fingers of a task: the process of so many takes a minute to sample.
const MOST_FINGERS: usize = 200;

/// The lines of a file, in the one order that decides draws; their tasks are shipped ones or those
/// in `more`.
pub fn lines(source: &Source, more: &[&str]) -> Result<Vec<Experiment>, Failure> {
    let mut found = experiments::parse(&source.text, &source.file).map_err(Failure::input)?;
    let shipped = TASKS.iter().map(|task| task.name);
    let known: Vec<&str> = shipped.chain(more.iter().copied()).collect();
    experiments::check_tasks(&found, &known, &source.file).map_err(Failure::input)?;
    found.sort_by(Experiment::order);
    for of_task in found.chunk_by(|a, b| a.task == b.task) {
        let fingers = of_task.chunk_by(|a, b| a.design == b.design).count();
        if fingers > MOST_FINGERS {
            let (file, task) = (&source.file, &of_task[0].task);
            return Err(Failure::usage(format!(
                "{file}: has {fingers} different fingers of the task `{task}`; at most \
                 {MOST_FINGERS} are taken: keep those nearest to the best"
            )));
        }
    }
    Ok(found)
}

/// Whether lines say something of the ranges of a task's fingers, and all of fingers in the space.
pub fn check(
    file: &str,
    lines: &[Experiment],
    template: &Template,
    space: &Space,
) -> Result<(), Failure> {
    let task = &template.task.name;
    let own = || lines.iter().filter(|line| line.task == *task);
    if !own().any(|line| line.extent().is_some()) {
        return Err(Failure::usage(format!(
            "{file}: no line has a range of the task `{task}`; measure one finger at least \
             (`optimize next` says which), or leave out --measurements"
        )));
    }
    for line in own() {
        whole(space, template, line).map_err(|error| Failure::usage(format!("{file}: {error}")))?;
    }
    Ok(())
}
