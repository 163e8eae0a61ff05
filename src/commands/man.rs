//! `optimize man`: the command line, described for `man`.

use crate::command::{self, Text};
use crate::context::Context;
use crate::failure::Failure;
use crate::program::program;

/// Print the manual page
#[derive(Debug, clap::Args)]
#[command(display_order = 92, after_help = "Example: optimize man > optimize.1")]
pub struct Request {}

impl command::Request for Request {
    type Response = Text;
    const JSON: bool = false;

    fn run(&self, _context: &Context<'_>) -> Result<Text, Failure> {
        let mut page = Vec::new();
        clap_mangen::Man::new(program())
            .render(&mut page)
            .map_err(|error| Failure::running(format!("cannot write the manual page: {error}")))?;
        Ok(Text(String::from_utf8_lossy(&page).into_owned()))
    }
}
