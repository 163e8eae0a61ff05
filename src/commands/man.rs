//! `optimize man`: prints the manual page.

use crate::command::{self, Text};
use crate::context::Context;
use crate::failure::Failure;
use crate::manual;

/// Print the manual page
#[derive(Debug, clap::Args)]
#[command(display_order = 92, after_help = "Example: optimize man > optimize.1")]
pub struct Request {
    /// Format of the output
    #[arg(long, value_enum, hide = true, default_value_t)]
    pub format: Format,
}

/// Forms of the manual.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
pub enum Format {
    /// A page for `man`
    #[default]
    Man,
    /// The reference of all commands, docs/cli.md
    Markdown,
    /// The commands with their options, for what is generated of them
    Json,
}

impl command::Request for Request {
    type Response = Text;
    const JSON: bool = false;

    fn run(&self, context: &Context<'_>) -> Result<Text, Failure> {
        let program = context.program()?;
        match self.format {
            Format::Man => {}
            Format::Markdown => return Ok(Text(manual::reference(program))),
            Format::Json => return Ok(Text(manual::commands(program).to_string() + "\n")),
        }
        let mut page = Vec::new();
        clap_mangen::Man::new(program)
            .render(&mut page)
            .map_err(|error| Failure::running(format!("cannot write the manual page: {error}")))?;
        Ok(Text(String::from_utf8_lossy(&page).into_owned()))
    }
}
