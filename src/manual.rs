//! Description of the command line: reference page, and a list for other languages.

use crate::help::COLUMNS;
use crate::project::NO_CONFIG;
use clap::{Arg, ArgAction};
use serde_json::{Value, json};
use std::any::TypeId;
use std::path::PathBuf;

/// Returns the help of all commands as a Markdown page.
pub fn reference(program: clap::Command) -> String {
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
        "# Commands and options\n\nOutput of `optimize --help` for each command.\n".into();
    let mut command = program.term_width(COLUMNS);
    command.build();
    section(&mut command, "optimize", &mut page);
    page
}

/// Returns all commands and options, with their names in Python; hidden options are for other programs only.
pub fn commands(mut program: clap::Command) -> Vec<Value> {
    fn below(command: &clap::Command, path: &str, found: &mut Vec<Value>) {
        let nested =
            || command.get_subcommands().filter(|c| !c.is_hide_set() && c.get_name() != "help");
        if nested().next().is_none() {
            let own = |a: &&Arg| !["help", "version", NO_CONFIG].contains(&a.get_id().as_str());
            let (hidden, shown): (Vec<&Arg>, Vec<&Arg>) =
                command.get_arguments().filter(own).partition(|argument| argument.is_hide_set());
            let [options, hidden] =
                [shown, hidden].map(|some| some.into_iter().map(option).collect::<Vec<_>>());
            let about = command.get_long_about().or(command.get_about()).map(ToString::to_string);
            found.push(json!({"name": path, "about": about, "options": options, "hidden": hidden}));
        }
        for command in nested() {
            below(command, format!("{path} {}", command.get_name()).trim_start(), found);
        }
    }
    let mut found = Vec::new();
    program.build();
    below(&program, "", &mut found);
    found
}

fn option(argument: &Arg) -> Value {
    let words = argument.get_possible_values();
    let words = words.iter().filter(|word| !word.is_hide_set()).map(|word| word.get_name());
    let default = argument.get_default_values().iter().map(|value| value.to_string_lossy());
    let name = argument.get_long().unwrap_or(argument.get_id().as_str()).replace('-', "_");
    let takes = argument.get_action().takes_values();
    let listed = takes && !argument.is_hide_possible_values_set();
    let value = argument.get_value_names().and_then(|names| names.first());
    let many = argument.get_num_args().is_some_and(|count| count.max_values() > 1);
    json!({
        "name": name,
        "positional": argument.is_positional(),
        "required": argument.is_required_set(),
        "multiple": matches!(argument.get_action(), ArgAction::Append) || many,
        "flag": !takes,
        "kind": kind(argument),
        "value": value.filter(|_| takes).map(ToString::to_string),
        "words": words.filter(|_| listed).collect::<Vec<_>>(),
        "default": default.filter(|_| takes).collect::<Vec<_>>().join(","),
        "help": argument.get_help().map(ToString::to_string),
    })
}

/// Returns the type of an option's value.
fn kind(argument: &Arg) -> &'static str {
    let parsed = argument.get_value_parser().type_id();
    let integers =
        [TypeId::of::<u16>(), TypeId::of::<u32>(), TypeId::of::<u64>(), TypeId::of::<usize>()];
    match () {
        () if parsed == TypeId::of::<f64>() => "number",
        () if integers.into_iter().any(|integer| parsed == integer) => "integer",
        () if parsed == TypeId::of::<PathBuf>() => "path",
        () => "text",
    }
}
