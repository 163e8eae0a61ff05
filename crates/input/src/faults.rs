//! Faults of the structure of a TOML file: unknown keys, and the first missing key or value of another type or name.

use crate::{Document, InputError, Place, shipped};
use serde::de::DeserializeOwned;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeValue, Error, ValueDeserializer};

/// Largest number of faults that are reported at once.
pub const MAX_FAULTS: usize = 10;
const UNKNOWN: &str = "unknown field `";
const MISSING: &str = "missing field `";

/// Returns the error of a file with invalid TOML or an unexpected structure; `text` is that of the file, empty for a
/// table without a text.
pub fn syntax(file: &str, text: &str, error: &Error) -> InputError {
    let near = nearest_key(error.message(), &[]);
    fault(file, text, error.clone(), near)
}

fn fault(file: &str, text: &str, mut error: Error, near: Option<&str>) -> InputError {
    let hint = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
    let before = error.span().and_then(|span| text.get(..span.start));
    let line = before.map(|before| 1 + before.matches('\n').count());
    let place = Place { line, ..Place::file(file) };
    let plain = error.to_string();
    // Without a text, the message ends with the path of the table or value.
    let (problem, path) = plain.trim_end().rsplit_once("\nin `").unwrap_or((plain.trim_end(), ""));
    let path = path.trim_end_matches('`');
    if text.is_empty() {
        return place.key(path).fault(problem.to_owned() + &hint);
    }
    error.set_input(Some(text));
    let shown = error.to_string();
    let begin = [UNKNOWN, MISSING].into_iter().find(|begin| problem.starts_with(begin));
    match (begin, shown.trim_end().strip_suffix(problem)) {
        (Some(begin), Some(excerpt)) if !path.is_empty() => {
            let key = &problem[begin.len()..];
            place.fault(format!("{excerpt}{begin}{path}.{key}{hint}"))
        }
        _ => place.fault(shown.trim_end().to_owned() + &hint),
    }
}

/// Returns the word nearest to the unknown key or word of a parser's message, of the accepted words and `more` words.
fn nearest_key<'a>(message: &'a str, more: &[&'a str]) -> Option<&'a str> {
    [UNKNOWN, "unknown variant `"].into_iter().find(|begin| message.starts_with(begin))?;
    let words = quoted(message);
    let (given, accepted) = words.split_first()?;
    shipped::nearest(given, &[accepted, more].concat())
}

/// Returns the words in backticks.
fn quoted(message: &str) -> Vec<&str> {
    message.split('`').skip(1).step_by(2).collect()
}

/// Document after the repair of a fault, with its next error.
type Repaired<'a> = (Document<'a>, Option<Error>);

impl<'a> Document<'a> {
    /// Returns the faults of a document of which `error` is the first one, as one error: [`MAX_FAULTS`] unknown keys at
    /// most, in the order of the file, then the first fault of another kind. Unknown keys are repaired in the tree to
    /// find the next fault.
    pub(crate) fn faults<T: DeserializeOwned>(mut self, error: Error) -> InputError {
        let (mut found, mut next) = (Vec::new(), Some(error));
        while let Some(error) = next.take_if(|_| found.len() < MAX_FAULTS) {
            let is_key = error.message().starts_with(UNKNOWN);
            let near = nearest_key(error.message(), if is_key { self.taken } else { &[] });
            let repaired = if is_key { self.without_key::<T>(&error, near) } else { None };
            let order = (!is_key, error.span().map(|span| span.start));
            found.push((order, fault(self.file, self.text, error.clone(), near)));
            if let Some((document, after)) = repaired {
                (self, next) = (document, after);
            }
        }
        found.sort_by_key(|(order, _)| *order);
        let mut faults = found.into_iter().map(|(_, fault)| fault);
        let first = faults.next().unwrap_or_else(|| Place::file(self.file).fault("invalid"));
        faults.fold(first, |first, next| InputError {
            problem: format!("{}\n{}", first.problem, next.problem),
            ..first
        })
    }

    /// Returns the document with the unknown key of an error renamed to the nearest one, or removed if there is none,
    /// and its next error.
    fn without_key<T: DeserializeOwned>(
        &self,
        error: &Error,
        near: Option<&str>,
    ) -> Option<Repaired<'a>> {
        let (at, mut document) = (error.span()?, self.clone());
        let name = near.filter(|near| !self.taken.contains(near));
        rename_first(&mut document.tree, &at, name).then(|| {
            let error = T::deserialize(ValueDeserializer::from(document.tree.clone())).err();
            (document, error)
        })
    }
}

/// Renames the key at these bytes of the text in a value or within it; removes it if there is no `new` name or the name
/// is taken. Returns whether the key was found.
fn rename_first(value: &mut Spanned<DeValue<'_>>, at: &Range<usize>, new: Option<&str>) -> bool {
    match value.get_mut() {
        DeValue::Table(table) => {
            let Some(key) = table.keys().find(|key| key.span() == *at).cloned() else {
                return table.iter_mut().any(|(_, value)| rename_first(value, at, new));
            };
            if let (Some(value), Some(new)) = (table.remove(&key), new) {
                table.entry(Spanned::new(at.clone(), new.to_owned().into())).or_insert(value);
            }
            true
        }
        DeValue::Array(items) => items.iter_mut().any(|item| rename_first(item, at, new)),
        _ => false,
    }
}
