//! The numbers of a TOML file by their paths.

use std::collections::BTreeSet;
use toml::Value;

const VECTOR: [&str; 3] = ["x", "y", "z"];

/// Every number within `value` with its path, which begins with `path`.
pub fn numbers<'a>(path: &str, value: &'a mut Value) -> Vec<(String, &'a mut Value)> {
    let below = |name: &str| format!("{path}.{name}");
    match value {
        Value::Integer(_) | Value::Float(_) => vec![(path.to_owned(), value)],
        Value::Table(table) => {
            table.iter_mut().flat_map(|(key, value)| numbers(&below(key), value)).collect()
        }
        Value::Array(items) => {
            let vector = items.len() == VECTOR.len() && items.iter().all(Value::is_float);
            let name = |place: usize, item: &Value| match item.get("name").and_then(Value::as_str) {
                Some(name) => below(name),
                None if vector => below(VECTOR[place]),
                None => below(&place.to_string()),
            };
            let items = items.iter_mut().enumerate();
            items.flat_map(|(place, item)| numbers(&name(place, item), item)).collect()
        }
        _ => Vec::new(),
    }
}

/// What is wrong with a key that is none of `keys`: how a key that begins like it goes on.
pub fn unknown(key: &str, keys: &[&str]) -> String {
    let mut end = key.len();
    loop {
        let prefix = if end == 0 { String::new() } else { format!("{}.", &key[..end]) };
        let next = |other: &&str| {
            let rest = other.strip_prefix(&prefix)?;
            Some(rest.split('.').next().unwrap_or(rest).to_owned())
        };
        let next: BTreeSet<String> = keys.iter().filter_map(next).collect();
        if !next.is_empty() {
            let names: Vec<String> = next.into_iter().collect();
            return match (prefix.as_str(), names.split_last()) {
                ("", Some((last, others))) => {
                    format!("sets nothing; a key begins with {} or {last}", others.join(", "))
                }
                _ => format!("sets no number; `{prefix}` goes on with {}", names.join(", ")),
            };
        }
        end = key[..end].rfind('.').unwrap_or(0);
    }
}
