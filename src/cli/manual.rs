//! `optimize completions` and `optimize man`: the command line, described for a shell and for
//! `man`.

use super::{Cli, Failure, print};
use clap::{Args, CommandFactory};
use clap_complete::Shell;

/// Which shell.
#[derive(Debug, Args)]
pub struct CompletionArguments {
    /// Shell
    shell: Shell,
}

/// Prints a completion script.
pub fn completions(arguments: &CompletionArguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "optimize", &mut script);
    print(&String::from_utf8_lossy(&script))
}

/// Prints the manual page.
pub fn page() -> Result<(), Failure> {
    let mut page = Vec::new();
    clap_mangen::Man::new(Cli::command())
        .render(&mut page)
        .map_err(|error| Failure::running(format!("cannot write the manual page: {error}")))?;
    print(&String::from_utf8_lossy(&page))
}
