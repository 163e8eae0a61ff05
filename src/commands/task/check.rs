//! `optimize task check`: checks a task file and its nominal start.

use crate::command;
use crate::context::Context;
use crate::failure::Failure;
use crate::layout;
use crate::setup::request::{DEFAULT_ROBOT, TaskSource};
use crate::setup::task::TaskCheck;
use crate::setup::tune::{Tried, brief, chosen, tried};
use connector::picture;
use connector::tune::Tuned;
use insertion::trial::engine::EngineKind;
use serde::{Serialize, Serializer};
use std::convert::Infallible;
use std::fmt;
use std::path::PathBuf;
use study::write_file;

/// Check a task file, draw it and simulate its nominal start
///
/// Exit code 0 if there is no problem and the plug inserts, 2 otherwise.
#[derive(Debug, clap::Args)]
#[command(
    display_order = 3,
    after_help = "Example: optimize task check usb-c.toml --svg usb-c.svg"
)]
pub struct Request {
    /// Task file, or the name of a shipped task
    #[arg(value_name = "FILE", value_parser = |name: &str| Ok::<_, Infallible>(TaskSource::single(name)))]
    pub file: TaskSource,
    /// Draw plug, socket, clearances, fingertips and search path
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
    /// Robot: see `optimize robots`, or the path of a robot file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT)]
    pub robot: String,
    /// Contact engine
    #[arg(long, value_enum, default_value_t)]
    pub engine: EngineKind,
}

/// Problems of a task, and a strategy that repairs a nominal start that fails.
#[derive(Serialize)]
pub struct Checked {
    #[serde(flatten)]
    checked: TaskCheck,
    #[serde(rename = "mended_by", serialize_with = "mended_by")]
    mended: Option<Tuned>,
    #[serde(skip)]
    written: Option<PathBuf>,
}

fn mended_by<S: Serializer>(mended: &Option<Tuned>, serializer: S) -> Result<S::Ok, S::Error> {
    let chosen: Option<Tried<'_>> = mended.as_ref().and_then(chosen);
    chosen.serialize(serializer)
}

impl command::Request for Request {
    type Response = Checked;

    fn run(&self, context: &Context<'_>) -> Result<Checked, Failure> {
        let checked = TaskCheck::of(self.file.read()?, &self.robot, self.engine, context.stop)?;
        let written = self.svg.as_ref().filter(|_| checked.task.is_some()).cloned();
        if let (Some(file), Some(task)) = (&written, &checked.task) {
            write_file(file, &picture::svg(task))?;
        }
        let mended = checked.tune(&self.robot, self.engine, context.stop)?;
        Ok(Checked { checked, mended, written })
    }
}

impl command::Response for Checked {
    fn picture(&self) -> Result<Option<String>, Failure> {
        Ok(self.checked.task.as_ref().map(picture::svg))
    }

    fn verdict(self) -> Result<(), Failure> {
        self.checked.verdict()
    }
}

impl fmt::Display for Checked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = &self.checked.source.file;
        let remedy = self.mended.as_ref().map_or(String::new(), |tuned| match tuned.inserts() {
            true => {
                format!("{}next          optimize task tune {file}\n", brief("mended by", tuned))
            }
            false => format!("mended by     none of the strategies tried: {}\n", tried(tuned)),
        });
        let text = self.checked.text() + &remedy + &layout::wrote(&self.written);
        f.write_str(&layout::wrapped(&text))
    }
}
