//! The program `optimize`: arguments in, the output of one command out.

use crate::command::Command;
use crate::commands::{COMMANDS, study};
use crate::executor;
use crate::failure::{Failure, described_numbers};
use crate::terminal::say;
use clap::ArgMatches;
use std::ffi::OsString;
use std::process::ExitCode;
use std::sync::LazyLock;

/// The command of a study, whose name may be left out.
const STUDY: Command = Command::of::<study::Request>(&["study"]);

/// Groups of commands: position in the list, name, description, example.
const GROUPS: [(usize, &str, &str, &str); 3] = [
    (
        30,
        "measure",
        "Add measurements to a file, check such a file, or write a measuring sheet\n\n\
         docs/guide/measuring.md describes the file. Required are the task, the infill and one measured value, \
         for example the range.",
        "Example: optimize measure check published",
    ),
    (
        31,
        "export",
        "Write a scene for MuJoCo, or a finger for the printer",
        "Example: optimize export mjcf --task usb --density 20 --direction 10 --out scene.xml",
    ),
    (
        52,
        "task",
        "Make, show and check a task",
        "Example: optimize task new usb-c --plug 8.25x2.4x6.65 --clearance 0.1 --body 12x6.5x20",
    ),
];

const ABOUT: &str = "Finds the 3D-printed compliant finger that makes a connector insertion most robust\n\n\
    Without a subcommand it runs a study: an optimizer proposes fingers, their insertions are simulated from shifted \
    starting positions, and the result is the finger that tolerates the largest shift. Running the same command again \
    continues the study.\n\n\
    Exit codes: 0 done, 1 failed or interrupted while running, 2 bad usage or bad input file.";

/// Version, commit and first digits of the hash of the sources.
static VERSION: LazyLock<String> = LazyLock::new(|| {
    let [version, commit] = [env!("CARGO_PKG_VERSION"), env!("FINGER_OPT_COMMIT")];
    format!("{version} ({commit}, sources {})", &::study::SOURCES[..8])
});

/// Returns the command line of the program.
pub fn program() -> clap::Command {
    let root = clap::Command::new("optimize")
        .version(VERSION.as_str())
        .subcommand_negates_reqs(true)
        .arg_required_else_help(true)
        .args_conflicts_with_subcommands(true);
    let root = described(STUDY.augment(root), ABOUT, "Example: optimize --task usb --budget 200");
    let mut groups = GROUPS.map(|(order, name, about, example)| {
        let group = clap::Command::new(name)
            .display_order(order)
            .subcommand_required(true)
            .arg_required_else_help(true);
        described(group, about, example)
    });
    let mut commands = Vec::new();
    let mut below: Vec<_> = COMMANDS.iter().map(|command| (command.path, command.clap())).collect();
    below.sort_by_key(|(_, command)| command.get_display_order());
    for (path, command) in below {
        match *path {
            [group, _] => {
                let group = groups.iter_mut().find(|found| found.get_name() == group);
                group
                    .into_iter()
                    .for_each(|group| *group = group.clone().subcommand(command.clone()));
            }
            _ => commands.push(command),
        }
    }
    commands.extend(groups);
    commands.sort_by_key(clap::Command::get_display_order);
    root.subcommands(commands)
}

fn described(command: clap::Command, about: &'static str, example: &'static str) -> clap::Command {
    let short = about.split("\n\n").next().unwrap_or_default();
    let command = command.about(short).after_help(example);
    if short == about { command } else { command.long_about(about) }
}

/// Runs `optimize` with these arguments, the program's name first.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    survive_size_limit();
    let words: Vec<OsString> = arguments.into_iter().collect();
    let matches = match program().try_get_matches_from(&words) {
        Ok(matches) => matches,
        Err(usage) if usage.use_stderr() => {
            say(described_numbers(&usage.render().to_string()).trim_end());
            return ExitCode::from(2);
        }
        // Help and version come this way, too.
        Err(shown) => shown.exit(),
    };
    let done = chosen(&matches).and_then(|(command, matches)| {
        // Only a study has this option.
        match matches.try_get_one::<String>("executor").ok().flatten() {
            Some(executor) => executor::run(executor, words.get(1..).unwrap_or_default()),
            None => command.print(matches, program).map(|()| ExitCode::SUCCESS),
        }
    });
    done.unwrap_or_else(|failure| {
        say(&format!("error: {failure}"));
        ExitCode::from(failure.exit_code())
    })
}

/// Returns the command that was chosen, and its options.
fn chosen(matches: &ArgMatches) -> Result<(Command, &ArgMatches), Failure> {
    let (mut path, mut at) = (Vec::new(), matches);
    while let Some((name, below)) = at.subcommand() {
        path.push(name);
        at = below;
    }
    if path.is_empty() {
        return Ok((STUDY, matches));
    }
    let found = COMMANDS.iter().find(|command| command.path == path);
    let found = found.ok_or_else(|| Failure::usage("give --task NAME, or a subcommand"))?;
    Ok((*found, at))
}

/// Makes a write beyond `ulimit -f` fail like one to a full disk; by default the system ends the process silently.
fn survive_size_limit() {
    // If this fails, the default remains.
    #[cfg(unix)]
    let _ = signal_hook::flag::register(libc::SIGXFSZ, Default::default());
}
