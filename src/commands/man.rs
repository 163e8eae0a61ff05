//! `optimize man`: the manual.

use crate::{Context, Failure, Output, command, manual};

/// Print the manual, with all commands and options
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: optimize man > optimize.md")]
pub struct Request {
    /// Output format
    #[arg(long, value_enum, hide = true, default_value_t)]
    pub format: Format,
}

/// Formats of the manual.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
pub enum Format {
    /// The reference of all commands, docs/cli.md
    #[default]
    Markdown,
    /// The commands with their options, for generated code
    Json,
}

impl command::Request for Request {
    const JSON: bool = false;

    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let program = context.program()?;
        let text = match self.format {
            Format::Markdown => manual::reference(program),
            Format::Json => serde_json::json!(manual::commands(program)).to_string() + "\n",
        };
        Ok(text.into())
    }
}
