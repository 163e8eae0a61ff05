//! Commands called by another program, with their options as keywords.

use crate::command::Command;
use crate::{Context, Failure, Output};
use clap::{Arg, ArgAction, Args};
use serde_json::{Map, Value};
use std::ffi::OsString;

/// Runs a command by its name (`task new`) with its options as keywords, with underscores for hyphens. Keywords
/// with a dot are passed to `--set`; `null` and `false` leave an option out.
///
/// The keywords are parsed as a command line, so that defaults and bounds are declared once.
///
/// # Errors
/// If there is no such command or option, a value cannot be used, or the command fails.
pub fn call(
    commands: &[Command],
    name: &str,
    keywords: &Map<String, Value>,
    context: &Context<'_>,
) -> Result<Output, Failure> {
    let path: Vec<&str> = name.split(' ').collect();
    let command = commands.iter().find(|command| command.path == path);
    let command = command.ok_or_else(|| Failure::usage(format!("unknown command `{name}`")))?;
    let mut program = command.clap().no_binary_name(true);
    program.build();
    let words = words(&program, keywords)?;
    (command.call)(&program.try_get_matches_from(words).map_err(Failure::of_clap)?, context)
}

/// Reads a request from keywords, as [`call`] does.
///
/// # Errors
/// If there is no such option, or a value cannot be used.
pub fn request<R: Args>(keywords: &Map<String, Value>) -> Result<R, Failure> {
    // Declared for the options that conflict with `--json`.
    let json = Arg::new("json").long("json").action(ArgAction::SetTrue);
    let mut program = R::augment_args(clap::Command::new("request").arg(json)).no_binary_name(true);
    program.build();
    let matches = program.clone().try_get_matches_from(words(&program, keywords)?);
    R::from_arg_matches(&matches.map_err(Failure::of_clap)?).map_err(Failure::of_clap)
}

/// Returns the words of a command line with these options.
fn words(program: &clap::Command, keywords: &Map<String, Value>) -> Result<Vec<OsString>, Failure> {
    let (mut words, mut positional) = (Vec::new(), Vec::new());
    for (keyword, value) in keywords {
        if keyword.contains('.') {
            words.push(format!("--set={keyword}={}", text(value)));
            continue;
        }
        let name = keyword.trim_end_matches('_').replace('_', "-");
        let named =
            |arg: &&Arg| arg.get_long().unwrap_or(arg.get_id().as_str()).replace('_', "-") == name;
        let arg = program.get_arguments().find(named);
        let arg = arg.ok_or_else(|| Failure::usage(format!("unknown option `{keyword}`")))?;
        let values: Vec<String> = match value {
            Value::Null | Value::Bool(false) => continue,
            Value::Array(items) if items.is_empty() => continue,
            Value::Array(items) if takes_several(arg) => {
                items.iter().map(|item| joined(item, arg)).collect()
            }
            Value::Object(fields) if name == "set" => {
                fields.iter().map(|(key, value)| format!("{key}={}", text(value))).collect()
            }
            value => vec![joined(value, arg)],
        };
        // A default value is left out: given explicitly, it could require other options.
        let default = arg.get_default_values().iter().map(|value| value.to_string_lossy());
        if values.iter().map(String::as_str).eq(default) {
            continue;
        }
        match (arg.is_positional(), arg.get_action()) {
            (true, _) => positional.extend(values),
            (false, ArgAction::SetTrue) => words.push(format!("--{name}")),
            (false, _) if *value == Value::Bool(true) => words.push(format!("--{name}")),
            (false, ArgAction::Append)
                if arg.get_num_args().is_some_and(|count| count.min_values() > 1) =>
            {
                words.push(format!("--{name}"));
                words.extend(values);
            }
            (false, _) => words.extend(values.iter().map(|value| format!("--{name}={value}"))),
        }
    }
    // Ends the options; positional arguments follow.
    words.push("--".to_owned());
    Ok(words.into_iter().chain(positional).map(OsString::from).collect())
}

/// Returns whether an option takes several values.
fn takes_several(arg: &Arg) -> bool {
    let many = arg.get_num_args().is_some_and(|count| count.max_values() > 1);
    matches!(arg.get_action(), ArgAction::Append) && arg.get_value_delimiter().is_none() || many
}

/// Joins the parts of a value by `x` if the option takes `WxHxL`, else by commas.
fn joined(value: &Value, arg: &Arg) -> String {
    let Value::Array(parts) = value else { return text(value) };
    let by_x =
        arg.get_value_names().is_some_and(|names| names.iter().any(|name| name.contains('x')));
    parts.iter().map(text).collect::<Vec<_>>().join(if by_x { "x" } else { "," })
}

fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        value => value.to_string(),
    }
}
