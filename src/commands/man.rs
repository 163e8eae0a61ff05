//! `optimize man`: the manual page.

use crate::{Context, Failure, Output, command, manual};

/// Print the manual page
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: optimize man > optimize.1")]
pub struct Request {
    /// Output format
    #[arg(long, value_enum, hide = true, default_value_t)]
    pub format: Format,
}

/// Formats of the manual.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
pub enum Format {
    /// A page for `man`
    #[default]
    Man,
    /// The reference of all commands, docs/cli.md
    Markdown,
    /// The commands with their options, for generated code
    Json,
}

impl command::Request for Request {
    const JSON: bool = false;

    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let program = context.program()?;
        let text = match self.format {
            Format::Man => {
                let mut page = Vec::new();
                clap_mangen::Man::new(program).render(&mut page).map_err(|error| {
                    Failure::running(format!("cannot write the manual page: {error}"))
                })?;
                String::from_utf8_lossy(&page).into_owned()
            }
            Format::Markdown => manual::reference(program),
            Format::Json => serde_json::json!(manual::commands(program)).to_string() + "\n",
        };
        Ok(text.into())
    }
}
