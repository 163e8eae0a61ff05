//! `optimize completions` and `optimize man`: the command line, described for a shell and for
//! `man`.

use super::{Cli, Failure, print};
use clap::{Args, CommandFactory};
use clap_complete::Shell;

#[derive(Debug, Args)]
pub struct CompletionArguments {
    /// Shell
    shell: Shell,
}

pub fn completions(arguments: &CompletionArguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "optimize", &mut script);
    print(&String::from_utf8_lossy(&script))
}

pub fn page() -> Result<(), Failure> {
    let mut page = Vec::new();
    clap_mangen::Man::new(Cli::command())
        .render(&mut page)
        .map_err(|error| Failure::running(format!("cannot write the manual page: {error}")))?;
    print(&String::from_utf8_lossy(&page))
}

/// The reference of all commands as a page: what `--help` says of each.
pub fn reference() -> String {
    fn section(command: &mut clap::Command, path: &str, page: &mut String) {
        let help = command.render_long_help().to_string();
        let plain: String = help.lines().map(|line| line.trim_end().to_owned() + "\n").collect();
        page.push_str(&format!("\n## {path}\n\n```text\n{}\n```\n", plain.trim_end()));
        let below: Vec<clap::Command> = command.get_subcommands().cloned().collect();
        for mut command in below.into_iter().filter(|command| command.get_name() != "help") {
            let path = format!("{path} {}", command.get_name());
            section(&mut command, &path, page);
        }
    }
    let mut page =
        "# Commands and options\n\nWhat `optimize --help` says of each command.\n".into();
    let mut command = Cli::command().term_width(100);
    command.build();
    section(&mut command, "optimize", &mut page);
    page
}
