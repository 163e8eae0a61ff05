//! `optimize task check`: checks a task file and its nominal start; if that fails, looks for a strategy that inserts.

use crate::setup::tune::{brief, chosen, tried};
use crate::{Context, Failure, Output, RobotRequest, TaskCheck, TaskSource, command, layout};
use connector::picture;
use std::convert::Infallible;
use std::path::PathBuf;
use study::write_file;

/// Check a task file, draw it and simulate its nominal start
///
/// Exit code 0 if there is no problem and the plug inserts, 2 otherwise.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: optimize task check usb-c.toml --svg usb-c.svg")]
pub struct Request {
    /// Task file, or the name of a shipped task
    #[arg(value_name = "FILE", value_parser = |name: &str| Ok::<_, Infallible>(TaskSource::single(name)))]
    pub file: TaskSource,
    /// Draw plug, socket, clearances, fingertips and search path
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
    /// Robot and contact engine.
    #[command(flatten)]
    pub robot: RobotRequest,
}

impl command::Request for Request {
    const PROGRESS: bool = true;

    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let _busy = context.busy("simulating the start");
        let checked = TaskCheck::of(self.file.read()?, &self.robot, context.stop)?;
        let drawing = checked.task.as_ref().map(picture::svg);
        let written = self.svg.as_ref().zip(drawing.as_ref());
        written.map_or(Ok(()), |(file, drawing)| write_file(file, drawing))?;
        let mended = checked.tune(context.stop)?;
        let remedy = mended.as_ref().map_or(String::new(), |tuned| match tuned.inserts() {
            true => {
                format!("{}next          {}\n", brief("mended by", tuned), checked.tune_command())
            }
            false => format!("mended by     none of the strategies tried: {}\n", tried(tuned)),
        });
        let written = layout::wrote(written.map(|(file, _)| file));
        let text = layout::wrapped(&(checked.text() + &remedy + &written));
        let mut value = checked.json();
        value["mended_by"] = chosen(mended.as_ref());
        Ok(Output { picture: drawing, failure: checked.failure(), ..Output::new(text, value) })
    }
}
