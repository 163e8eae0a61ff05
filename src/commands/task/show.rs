//! `optimize task show`: prints a task file, or shows its parts in three dimensions.

use crate::layout::wrote;
use crate::setup::files::robot;
use crate::setup::request::DEFAULT_ROBOT;
use crate::setup::task::nominal_recording;
use crate::{Context, Failure, Output, TaskFile, TaskSource, command};
use report::replay::{self, Film};
use std::path::PathBuf;
use study::write_file;

/// Print a task file, or show its parts in three dimensions
///
/// With --html a page shows plug, socket and fingertips in a view that can be rotated: the grip, the path of the
/// search from the nominal start, and the pose at its end.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: optimize task show usb > mine.toml")]
pub struct Request {
    /// Task: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Write a page that shows the task in three dimensions
    #[arg(long, value_name = "FILE.html")]
    pub html: Option<PathBuf>,
}

impl command::Request for Request {
    const JSON: bool = false;

    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let source = TaskSource::Named(self.name.clone()).read()?;
        let Some(file) = &self.html else { return Ok(source.text.into()) };
        let TaskFile { task, .. } = TaskFile::parse(source)?;
        let (finger, recording) = nominal_recording(&task, &robot(DEFAULT_ROBOT)?, context.stop)?;
        let label = format!("nominal start with {DEFAULT_ROBOT}");
        let film = Film { label: &label, task: &task, pad: &finger.pad, recording: &recording };
        write_file(file, &replay::page(&format!("{}: {}", task.name, task.description), &[film]))?;
        Ok(wrote([file]).into())
    }
}
