//! Differences between two values, field by field.

use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Returns the fields in which two values differ, one line each; `None` if there are none. `who` are the names of
/// the values in the text.
pub(super) fn differences<T: Serialize>(ours: &T, theirs: &T, who: [&str; 2]) -> Option<String> {
    let (ours, theirs) = (flat(ours), flat(theirs));
    let keys: BTreeSet<&String> = ours.keys().chain(theirs.keys()).collect();
    let lines: Vec<String> = keys
        .into_iter()
        .filter(|key| ours.get(*key) != theirs.get(*key))
        .map(|key| {
            let [a, b] = [&ours, &theirs].map(|of| of.get(key).map(String::as_str));
            if key.starts_with("input_sha256.") && a.is_some() && b.is_some() {
                return format!(
                    "  {key}: the input file differs from its copy in the study's folder"
                );
            }
            let [a, b] = [a, b].map(|of| of.unwrap_or("nothing"));
            format!("  {key}: {} has {a}, {} has {b}", who[0], who[1])
        })
        .collect();
    (!lines.is_empty()).then(|| lines.join("\n"))
}

/// Returns every leaf of a value as text, by its path (`space.parameter.0.low`).
fn flat(value: &impl Serialize) -> BTreeMap<String, String> {
    fn walk(value: &serde_json::Value, path: &str, leaves: &mut BTreeMap<String, String>) {
        let join =
            |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        match value {
            serde_json::Value::Object(fields) => {
                fields.iter().for_each(|(key, value)| walk(value, &join(key), leaves));
            }
            serde_json::Value::Array(items) => {
                let items = items.iter().enumerate();
                items.for_each(|(i, value)| walk(value, &join(&i.to_string()), leaves));
            }
            leaf => {
                leaves.insert(path.to_owned(), leaf.to_string());
            }
        }
    }
    let mut leaves = BTreeMap::new();
    // Configurations can always be serialized.
    walk(&serde_json::to_value(value).unwrap_or_default(), "", &mut leaves);
    leaves
}
