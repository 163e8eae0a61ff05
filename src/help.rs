//! Help of the command line: short help that fits a screen, headings of options, colours.

use crate::project::NO_CONFIG;
use clap::builder::styling::{AnsiColor, Style, Styles};
use clap::{Arg, ArgAction, Command};
use std::fmt::Write;

/// Styles of headings, of words to be typed, and of placeholders.
const TITLE: Style = AnsiColor::Green.on_default().bold();
const WORD: Style = AnsiColor::Cyan.on_default().bold();
const PLACEHOLDER: Style = AnsiColor::Cyan.on_default();

/// Largest width of a help text, also without a terminal, columns.
pub const COLUMNS: usize = 100;
/// Commands by purpose, for the short help.
const COMMANDS: [(&str, &[&str]); 5] = [
    ("Study", &["study", "resume", "report", "compare"]),
    ("Design", &["evaluate", "trial", "map", "levers", "sensitivity", "finger", "stiffness"]),
    ("Connector", &["task", "tasks", "robots"]),
    ("Bench", &["measure", "next", "identify", "calibrate"]),
    ("Files", &["export", "config", "ask-tell", "completions", "man"]),
];
/// Largest width of a command's description, columns.
const MAX_WIDTH: usize = 65;
/// Options of the short help.
const MAIN_OPTIONS: [(&str, &str); 6] = [
    ("--task <NAME>", "Task of a study: `optimize tasks`, or the path of a task file"),
    ("--budget <N>", "Number of evaluations [default: until no gain is expected]"),
    ("--robot <NAME>", "Robot: `optimize robots`, or the path of a robot file"),
    ("--json", "Print the result as JSON"),
    ("-h, --help", "Print this help; `--help` lists all options of a study"),
    ("-V, --version", "Print version"),
];
/// Headings of options in help texts, with their options.
const HEADINGS: [(&str, &str); 5] = [
    (
        "Task, robot and finger",
        "task space robot cell stiffness-data engine finger-model finger start density direction \
         stiffness-compliance stiffness-assembly set",
    ),
    (
        "Search",
        "budget polish indifference-mm optimizer objective constraint uncertainty aggregate weights seed \
         batch async",
    ),
    ("Bench", "measurements priors simulations samples runs frame"),
    ("Run", "threads cache no-cache no-confirm no-levers no-map accept-changed executor no-config"),
    ("Output", "out verbose json quiet svg html record plot log report"),
];

/// Returns the styles of help and usage errors.
pub fn styles() -> Styles {
    Styles::styled().header(TITLE).usage(TITLE).literal(WORD).placeholder(PLACEHOLDER)
}

/// Sets the headings of the options of a command with more than eight options.
pub fn with_headings(command: Command) -> Command {
    let group = |arg: &Arg| {
        let long = arg.get_long().unwrap_or_default();
        let lists = |options: &str| options.split(' ').any(|option| option == long);
        HEADINGS.iter().find(|(_, options)| lists(options)).map(|(title, _)| *title)
    };
    let several = command.get_arguments().filter(|arg| !arg.is_hide_set()).count() > 8;
    match several {
        true => command.mut_args(|arg| match group(&arg) {
            Some(title) => arg.help_heading(title),
            None => arg,
        }),
        false => command,
    }
}

/// Returns the option that ignores the project file.
pub fn no_config() -> Arg {
    let flag = Arg::new(NO_CONFIG).long(NO_CONFIG).action(ArgAction::SetTrue).global(true);
    flag.help("Ignore finger-opt.toml (see `optimize config`)")
}

/// Returns the short help of the program, with the first clause of each command's description.
pub fn short(program: &Command) -> String {
    let mut text = String::new();
    let about = program.get_about().map(ToString::to_string).unwrap_or_default();
    let usage = format!(
        "{TITLE}Usage:{TITLE:#} {WORD}optimize --task{WORD:#} {PLACEHOLDER}<NAME>{PLACEHOLDER:#}"
    );
    let _ = writeln!(
        text,
        "{about}\n\n{usage} [OPTIONS]\n       {WORD}optimize{WORD:#} {PLACEHOLDER}<COMMAND>{PLACEHOLDER:#}"
    );
    for (title, names) in COMMANDS {
        let _ = writeln!(text, "\n{TITLE}{title}:{TITLE:#}");
        for name in names {
            let Some(command) = program.find_subcommand(name) else { continue };
            let about = command.get_about().map(ToString::to_string).unwrap_or_default();
            let clauses = [about.as_str()].into_iter().chain(about.split([':', ',']));
            let about =
                clauses.take(2).find(|clause| clause.len() <= MAX_WIDTH).unwrap_or_default();
            let _ = writeln!(text, "  {WORD}{name:<12}{WORD:#} {about}");
        }
    }
    let _ = writeln!(text, "\n{TITLE}Options:{TITLE:#}");
    for (option, about) in MAIN_OPTIONS {
        let _ = writeln!(text, "  {WORD}{option:<15}{WORD:#} {about}");
    }
    let _ = write!(text, "\nExample: optimize --task usb --budget 200");
    text
}
