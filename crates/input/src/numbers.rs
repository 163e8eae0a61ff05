//! TOML files whose numbers a design may set by path.

use crate::shipped::nearest;
use crate::units::without_unit;
use crate::{Check, Document, InputError};
use std::collections::BTreeSet;
use toml::{Table, Value};

/// Check for values of a design, which are not in a file.
pub const DESIGN: Check<'static> = Check { file: "design" };

/// Names of the numbers in a vector.
const VECTOR: [&str; 3] = ["x", "y", "z"];

/// TOML file as read. The key (or path) of a number is the root, such as `task`, then the keys in the file. One of
/// several tables is identified by its `name`, a number in a vector by `x`, `y` or `z`, and one in any other list by
/// its index, from 0.
#[derive(Debug, Clone, PartialEq)]
pub struct NumberFile {
    root: &'static str,
    /// File name for errors.
    pub file: String,
    table: Table,
}

impl NumberFile {
    /// Reads the numbers of a file.
    ///
    /// # Errors
    /// See [`Document::read`].
    pub fn read(root: &'static str, document: &Document<'_>) -> Result<Self, InputError> {
        Ok(NumberFile { root, file: document.file().to_owned(), table: document.read()? })
    }

    /// Returns the keys of all numbers, in alphabetical order.
    pub fn keys(&self) -> Vec<String> {
        let mut table = self.table.clone();
        let mut keys: Vec<String> =
            numbers_in_table(self.root, &mut table).into_iter().map(|(key, _)| key).collect();
        keys.sort();
        keys
    }

    /// Returns the number under a key, in the unit of the key.
    pub fn number(&self, key: &str) -> Option<f64> {
        let mut table = self.table.clone();
        let number =
            numbers_in_table(self.root, &mut table).into_iter().find(|(name, _)| name == key)?.1;
        number.as_float().or_else(|| number.as_integer().map(|whole| whole as f64))
    }

    /// Returns the table with new values of some of its numbers.
    ///
    /// # Errors
    /// If a key matches no number or two numbers; the message suggests keys of the file and those in `elsewhere`.
    pub fn with<'k>(
        &self,
        values: impl IntoIterator<Item = (&'k str, f64)>,
        elsewhere: &[&str],
    ) -> Result<Table, InputError> {
        let mut table = self.table.clone();
        let mut numbers = numbers_in_table(self.root, &mut table);
        for (key, value) in values {
            let mut found = numbers.iter_mut().filter(|(name, _)| name == key);
            match (found.next(), found.next()) {
                (Some((_, number)), None) => **number = Value::Float(value),
                (Some(_), Some(_)) => {
                    let problem =
                        "names two numbers, since two tables have the same name; rename one table";
                    return Check { file: &self.file }.fail(key, problem);
                }
                (None, _) => {
                    let keys = numbers.iter().map(|(name, _)| name.as_str());
                    let keys: Vec<&str> = keys.chain(elsewhere.iter().copied()).collect();
                    return DESIGN.fail(key, unknown_path(key, &keys));
                }
            }
        }
        Ok(table)
    }
}

/// Returns every number within a table with its path, which begins with `path`.
fn numbers_in_table<'a>(path: &str, table: &'a mut Table) -> Vec<(String, &'a mut Value)> {
    let below = |name: &str| format!("{path}.{name}");
    table.iter_mut().flat_map(|(key, value)| numbers(&below(key), value)).collect()
}

fn numbers<'a>(path: &str, value: &'a mut Value) -> Vec<(String, &'a mut Value)> {
    match value {
        Value::Integer(_) | Value::Float(_) => vec![(path.to_owned(), value)],
        Value::Table(table) => numbers_in_table(path, table),
        Value::Array(items) => {
            let vector = items.len() == VECTOR.len() && items.iter().all(Value::is_float);
            let name = |place: usize, item: &Value| match item.get("name").and_then(Value::as_str) {
                Some(name) => format!("{path}.{name}"),
                None if vector => format!("{path}.{}", VECTOR[place]),
                None => format!("{path}.{place}"),
            };
            let items = items.iter_mut().enumerate();
            items.flat_map(|(place, item)| numbers(&name(place, item), item)).collect()
        }
        _ => Vec::new(),
    }
}

/// Returns the nearest path; `path` may lack its first word, `task`, and the unit.
fn nearest_path<'a>(path: &str, paths: &[&'a str]) -> Option<&'a str> {
    let unitless = paths.iter().map(|path| without_unit(path).0);
    let mut forms: Vec<&str> = paths.iter().copied().chain(unitless).collect();
    let bare = |form: &&'a str| form.strip_prefix("task.").unwrap_or(form);
    forms.extend(forms.iter().map(bare).collect::<Vec<_>>());
    let near = nearest(path, &forms)?;
    forms.iter().position(|form| *form == near).map(|i| paths[i % paths.len()])
}

/// Returns the error message for a path that is not in `paths`: the nearest path, and the words that can follow its
/// longest known prefix.
pub fn unknown_path(path: &str, paths: &[&str]) -> String {
    let near = nearest_path(path, paths).map(|near| format!("; did you mean `{near}`?"));
    let hint = near.as_deref().unwrap_or(";");
    let unknown = format!("unknown path `{path}`");
    let next = |prefix: &str| -> Vec<&str> {
        let words = paths.iter().filter_map(|other| other.strip_prefix(prefix)?.split('.').next());
        words.collect::<BTreeSet<_>>().into_iter().collect()
    };
    let ends = path.rmatch_indices('.').map(|(end, _)| end);
    let mut prefixes = [path.len()].into_iter().chain(ends).map(|end| format!("{}.", &path[..end]));
    if let Some(prefix) = prefixes.find(|prefix| !next(prefix).is_empty()) {
        return format!("{unknown}{hint} `{prefix}` continues with {}", next(&prefix).join(", "));
    }
    let words: Vec<String> = next("").iter().map(|word| format!("`{word}`")).collect();
    let Some((last, others)) = words.split_last() else { return unknown };
    format!("{unknown}{hint} a path begins with {} or {last}", others.join(", "))
}
