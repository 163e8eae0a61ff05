//! `optimize completions`: completion scripts for shells.

use crate::{Context, Failure, Output, command};
use clap_complete::Shell;

/// Print a completion script for a shell
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: optimize completions bash > optimize.bash")]
pub struct Request {
    /// Shell
    shell: Shell,
}

impl command::Request for Request {
    const JSON: bool = false;

    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut context.program()?, "optimize", &mut script);
        Ok(String::from_utf8_lossy(&script).into_owned().into())
    }
}
