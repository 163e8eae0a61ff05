//! The command line described: reference page, and a list for other languages.

use crate::program::program;
use clap::{Arg, ArgAction};
use serde_json::{Value, json};

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
    let mut command = program().term_width(100);
    command.build();
    section(&mut command, "optimize", &mut page);
    page
}

/// All commands with their options, by Python's words for them; the study is `study`.
pub fn commands() -> Value {
    fn below(command: &clap::Command, path: &str, found: &mut Vec<Value>) {
        let name = match path {
            "" => "study",
            path => path,
        };
        let nested =
            || command.get_subcommands().filter(|c| !c.is_hide_set() && c.get_name() != "help");
        if path.is_empty() || nested().next().is_none() {
            let arguments = command.get_arguments().filter(|argument| !argument.is_hide_set());
            let arguments =
                arguments.filter(|a| !["help", "version"].contains(&a.get_id().as_str()));
            let options: Vec<Value> = arguments.map(option).collect();
            found.push(json!({"name": name, "options": options}));
        }
        for command in nested() {
            below(command, format!("{path} {}", command.get_name()).trim_start(), found);
        }
    }
    let (mut found, mut command) = (Vec::new(), program());
    command.build();
    below(&command, "", &mut found);
    Value::Array(found)
}

fn option(argument: &Arg) -> Value {
    let words = argument.get_possible_values();
    let words = words.iter().filter(|word| !word.is_hide_set()).map(|word| word.get_name());
    let default = argument.get_default_values().iter().map(|value| value.to_string_lossy());
    let name = argument.get_long().unwrap_or(argument.get_id().as_str()).replace('-', "_");
    let takes = argument.get_action().takes_values();
    json!({
        "name": name,
        "positional": argument.is_positional(),
        "required": argument.is_required_set(),
        "multiple": matches!(argument.get_action(), ArgAction::Append)
            || argument.get_num_args().is_some_and(|count| count.max_values() > 1),
        "flag": !takes,
        "words": words.filter(|_| takes).collect::<Vec<_>>(),
        "default": default.filter(|_| takes).collect::<Vec<_>>().join(","),
        "help": argument.get_help().map(ToString::to_string),
    })
}
