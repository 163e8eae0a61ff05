//! The program `optimize`: parses its arguments, applies the project file and runs one command.

use crate::command::Command;
use crate::commands::{COMMANDS, study};
use crate::failure::plain_number_errors;
use crate::project::{NO_CONFIG, OptionDefault, Project, with_defaults};
use crate::terminal::say;
use crate::{Failure, executor, help};
use clap::ArgMatches;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use input::shipped::nearest;
use std::ffi::OsString;
use std::process::ExitCode;
use std::sync::LazyLock;

/// The command of a study, whose name may be left out.
const STUDY: Command = Command::of::<study::Request>(&["study"]);

/// Order of the commands in the help, within each group as well.
const ORDER: &str = "study resume report evaluate trial map stiffness mjcf finger compare sensitivity levers calibrate \
                     identify next measure export ask-tell config robots tasks task add new show check import sheet \
                     tune completions man";

/// Groups of commands: name, description, example.
const GROUPS: [(&str, &str, &str); 3] = [
    (
        "measure",
        "Add measurements to a file, check such a file, or write a measuring sheet\n\n\
         docs/guide/measuring.md describes the file. Required are the task, the infill and one measured value, \
         for example the range.",
        "Example: optimize measure check published",
    ),
    (
        "export",
        "Write a scene for MuJoCo, or a finger for the printer",
        "Example: optimize export mjcf --task usb --density 20 --direction 10 --out scene.xml",
    ),
    (
        "task",
        "Make, show and check a task",
        "Example: optimize task new usb-c --plug 8.25x2.4x6.65 --clearance 0.1 --body 12x6.5x20",
    ),
];

const ABOUT: &str = "Finds the 3D-printed compliant finger that makes an insertion most robust\n\n\
    Without a subcommand it runs a study: an optimizer proposes fingers, their insertions are simulated from shifted \
    starting positions, and the result is the finger that tolerates the largest shift. Running the same command again \
    continues the study.\n\n\
    Exit codes: 0 done, 1 failed or interrupted while running, 2 bad usage or bad input file.";

/// Version, commit and first digits of the hash of the sources.
static VERSION: LazyLock<String> = LazyLock::new(|| {
    let [version, commit] = [env!("CARGO_PKG_VERSION"), env!("FINGER_OPT_COMMIT")];
    format!("{version} ({commit}, sources {})", &::study::SOURCES[..8])
});

/// Returns the clap definition of the whole command line.
pub fn program() -> clap::Command {
    let root = clap::Command::new("optimize")
        .version(VERSION.as_str())
        .styles(help::styles())
        .max_term_width(help::COLUMNS)
        .subcommand_negates_reqs(true)
        .arg_required_else_help(true)
        .args_conflicts_with_subcommands(true);
    let root = help::with_headings((STUDY.augment)(root).arg(help::no_config()));
    let root = described(root, ABOUT, "Example: optimize --task usb --budget 200");
    let commands_in = |group: &[&str]| {
        let members = COMMANDS
            .iter()
            .filter(|command| matches!(command.path, [above @ .., _] if above == group));
        let mut commands: Vec<_> =
            members.map(|command| help::with_headings(command.clap())).collect();
        commands.sort_by_key(place);
        commands
    };
    let mut commands = commands_in(&[]);
    commands.extend(GROUPS.map(|(name, about, example)| {
        let group = clap::Command::new(name).subcommand_required(true).arg_required_else_help(true);
        described(group, about, example).subcommands(commands_in(&[name]))
    }));
    commands.sort_by_key(place);
    root.subcommands(commands)
}

/// Returns the position of a command in the help; one that is missing in [`ORDER`] comes last.
fn place(command: &clap::Command) -> usize {
    let mut names = ORDER.split(' ');
    names.position(|name| name == command.get_name()).unwrap_or(usize::MAX)
}

fn described(command: clap::Command, about: &'static str, example: &'static str) -> clap::Command {
    let short = about.split("\n\n").next().unwrap_or_default();
    let command = command.about(short).after_help(example);
    if short == about { command } else { command.long_about(about) }
}

/// Runs `optimize` with these arguments, the program's name first.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    survive_size_limit();
    run(&arguments.into_iter().collect::<Vec<_>>()).unwrap_or_else(|failure| {
        say(&format!("error: {failure}"));
        ExitCode::from(failure.exit_code())
    })
}

fn run(words: &[OsString]) -> Result<ExitCode, Failure> {
    let (program, defaults) = with_project(program(), words)?;
    let long = words.iter().any(|word| word == "--help");
    let mut program =
        if long { program } else { program.clone().override_help(help::short(&program)) };
    let matches = match program.try_get_matches_from_mut(words) {
        Ok(matches) => matches,
        Err(usage) if usage.use_stderr() => {
            let usage = with_tip(usage, &program, words);
            say(plain_number_errors(&usage.render().to_string()).trim_end());
            return Ok(ExitCode::from(2));
        }
        // clap returns help and version as errors.
        Err(shown) => shown.exit(),
    };
    let (command, matches) = chosen(&matches)?;
    // Only a study has the option `--executor`.
    match matches.try_get_one::<String>("executor").ok().flatten() {
        Some(executor) => {
            let word = |set: &OptionDefault| format!("--{}={}", set.option, set.value).into();
            let set = defaults.iter().map(word);
            let words: Vec<OsString> = words.iter().skip(1).cloned().chain(set).collect();
            executor::run(executor, &words)
        }
        None => (command.print)(matches, self::program).map(|()| ExitCode::SUCCESS),
    }
}

/// Adds the right option to the error of an unknown one: `--direction` for an angle and, for a study, the nearest option
/// of `evaluate`.
fn with_tip(mut usage: clap::Error, program: &clap::Command, words: &[OsString]) -> clap::Error {
    let unknown = match usage.get(ContextKind::InvalidArg) {
        Some(ContextValue::String(text)) => text.strip_prefix("--"),
        _ => None,
    };
    let Some(unknown) = unknown.filter(|_| usage.kind() == ErrorKind::UnknownArgument) else {
        return usage;
    };
    let command = command_of(program, words).1;
    let has = |command: &clap::Command, name: &str| {
        command.get_arguments().any(|argument| argument.get_long() == Some(name))
    };
    let is_study = command.get_name() == "study" || std::ptr::eq(command, program);
    let evaluate = program.find_subcommand("evaluate").filter(|_| is_study);
    let known = evaluate.into_iter().flat_map(clap::Command::get_arguments);
    let known: Vec<&str> = known.filter_map(clap::Arg::get_long).collect();
    let near = match unknown {
        "angle" | "angel" => Some("direction"),
        _ if usage.get(ContextKind::SuggestedArg).is_some() => None,
        _ => nearest(unknown, &known),
    };
    let Some(near) = near else { return usage };
    if has(command, near) {
        usage.insert(ContextKind::SuggestedArg, ContextValue::String(format!("--{near}")));
    } else if is_study {
        usage.remove(ContextKind::SuggestedArg);
        let tip = format!("'--{near}' is an option of `optimize evaluate`");
        usage.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    usage
}

/// Returns the command that the words begin with, and its path.
fn command_of<'a>(
    program: &'a clap::Command,
    words: &[OsString],
) -> (Vec<String>, &'a clap::Command) {
    let (mut path, mut command) = (Vec::new(), program);
    let name = |place: usize| words.get(place + 1).and_then(|word| word.to_str());
    while let Some(below) = name(path.len()).and_then(|name| command.find_subcommand(name)) {
        path.push(below.get_name().to_owned());
        command = below;
    }
    (path, command)
}

/// Reports the defaults of the project file on standard error; returns the clap definition with them, and the defaults.
fn with_project(
    program: clap::Command,
    words: &[OsString],
) -> Result<(clap::Command, Vec<OptionDefault>), Failure> {
    let texts: Vec<&str> = words.iter().skip(1).filter_map(|word| word.to_str()).collect();
    let given = |option: &str| {
        let mut names = texts.iter().filter_map(|word| word.strip_prefix("--")?.split('=').next());
        names.any(|name| name == option)
    };
    let (path, command) = command_of(&program, words);
    let help = ["-h", "--help", "-V", "--version", "help"];
    let aside =
        given(NO_CONFIG) || texts.is_empty() || texts.iter().any(|word| help.contains(word));
    let set = |arg: &clap::Arg| ["task", "robot"].map(Some).contains(&arg.get_long());
    let takes = command.get_arguments().any(|arg| set(arg) || path[..] == ["measure"]);
    if aside || !takes {
        return Ok((program, Vec::new()));
    }
    let Some(project) = Project::current()? else { return Ok((program, Vec::new())) };
    let (mut defaults, words) = project.defaults(command, given)?;
    if !words.is_empty() {
        let value = format!("{} {words}", project.file);
        say(&value);
        defaults.push(OptionDefault { option: "project", value });
    }
    // A measurement file given as a positional argument takes precedence.
    let positional = texts.get(path.len()).is_some_and(|word| !word.starts_with('-'));
    defaults.retain(|set| set.option != "file" || !positional);
    Ok((with_defaults(program, &path, &defaults), defaults))
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
