//! Faults of the structure of a TOML file: unknown and missing keys, and values of another type or name.

use crate::{Document, InputError, Place, shipped};
use serde::de::DeserializeOwned;
use std::borrow::Cow;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeArray, DeInteger, DeTable, DeValue, Error, ValueDeserializer};

/// Largest number of faults that are reported at once.
pub const MAX_FAULTS: usize = 10;
/// Largest number of words of a message that are tried as the text of a placeholder.
const MAX_WORDS: usize = 12;
/// Span of the values that are not in the file.
const PLACEHOLDER: Range<usize> = usize::MAX..usize::MAX;
const UNKNOWN: &str = "unknown field `";
const MISSING: &str = "missing field `";
/// Beginnings of messages about a value for which another value may be substituted.
const VALUES: [&str; 3] = ["unknown variant `", "unknown path `", "invalid type: "];

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
    [UNKNOWN, VALUES[0]].into_iter().find(|begin| message.starts_with(begin))?;
    let mut words = message.split('`').skip(1).step_by(2);
    let (given, accepted) = (words.next()?, words.chain(more.iter().copied()));
    shipped::nearest(given, &accepted.collect::<Vec<_>>())
}

/// Returns the key that is missing according to a parser's message.
fn missing_key(message: &str) -> Option<&str> {
    message.strip_prefix(MISSING)?.strip_suffix('`')
}

/// Document after the repair of a fault, with its next error.
type Repaired<'a> = (Document<'a>, Option<Error>);

impl<'a> Document<'a> {
    /// Returns the faults of a document of which `error` is the first one, as one error: in the order of the file,
    /// missing keys last, [`MAX_FAULTS`] at most. Each fault is repaired in the tree to find the next one.
    pub(crate) fn faults<T: DeserializeOwned>(mut self, error: Error) -> InputError {
        let (mut found, mut next) = (Vec::new(), Some(error));
        while let Some(error) = next.take() {
            let (near, repaired) = self.repaired::<T>(&error);
            let missing = missing_key(error.message()).is_some();
            let order = (missing, error.span().map(|span| span.start));
            // After a repair only the structure is certain.
            if found.is_empty() || repaired.is_some() || missing {
                found.push((order, fault(self.file, self.text, error, near.as_deref())));
            }
            if let (Some((document, after)), true) = (repaired, found.len() < MAX_FAULTS) {
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

    /// Returns the word that was probably meant, and the document without this fault, if it can be repaired.
    fn repaired<T: DeserializeOwned>(
        &self,
        error: &Error,
    ) -> (Option<String>, Option<Repaired<'a>>) {
        let message = error.message();
        if !message.starts_with(UNKNOWN) {
            let near = nearest_key(message, &[]).map(str::to_owned);
            return (near, self.with_placeholder::<T>(error));
        }
        let renamed = |name: Option<&str>| {
            let at = error.span()?;
            self.changed::<T>(|value| rename(value, &at, name))
        };
        let removed = renamed(None);
        let after = removed.as_ref().and_then(|(_, after)| after.as_ref());
        // If no key is similar, it may be the one that is missing.
        let missing = after.and_then(|after| missing_key(after.message())).filter(|key| {
            let fits = |(_, after): Repaired<'_>| {
                after.is_none_or(|after| !after.message().contains("invalid type"))
            };
            message.contains(&format!("`{key}`")) && renamed(Some(key)).is_some_and(fits)
        });
        let near = nearest_key(message, self.taken).or(missing);
        let near = near.map(str::to_owned);
        let name = near.as_deref().filter(|near| !self.taken.contains(near));
        let repaired = if name.is_some() { renamed(name) } else { removed };
        (near, repaired)
    }

    /// Returns the document with a value in place of an invalid one or for a missing key; `None` if none is accepted.
    fn with_placeholder<T: DeserializeOwned>(&self, error: &Error) -> Option<Repaired<'a>> {
        let (message, at) = (error.message(), error.span()?);
        let key = missing_key(message);
        if key.is_none() && !VALUES.iter().any(|begin| message.starts_with(begin)) {
            return None;
        }
        let with = |new: DeValue<'a>| self.changed::<T>(|value| place(value, &at, key, &new));
        let fits = |(_, after): &Repaired<'_>| {
            after.as_ref().and_then(Error::span).is_none_or(|span| span != PLACEHOLDER)
        };
        let text = |word: &str| DeValue::String(Cow::Owned(word.to_owned()));
        let empty = with(text(""))?;
        // Messages list the accepted words.
        let about_empty = empty.1.as_ref().map_or("", Error::message).to_owned();
        let words = [message, &about_empty].into_iter().flat_map(|message| {
            let end = |c: char| !c.is_alphanumeric() && !"_.-".contains(c);
            message.split(end).filter(|word| !word.is_empty()).take(MAX_WORDS)
        });
        let zeros = |count: usize| {
            let zero = Spanned::new(PLACEHOLDER, DeValue::Integer(DeInteger::default()));
            let mut zeros = DeArray::new();
            (0..count).for_each(|_| zeros.push(zero.clone()));
            DeValue::Array(zeros)
        };
        let number = DeValue::Integer(DeInteger::default());
        let plain = [number, DeValue::Table(DeTable::new()), zeros(0), zeros(2), zeros(3)];
        let mut rest = plain.into_iter().chain(words.map(text)).filter_map(with);
        if fits(&empty) { Some(empty) } else { rest.find(fits) }
    }

    /// Returns the document with a change of the first value to which it applies, and its error; `None` if there is no
    /// such value.
    fn changed<T: DeserializeOwned>(
        &self,
        change: impl Fn(&mut Spanned<DeValue<'a>>) -> bool,
    ) -> Option<Repaired<'a>> {
        let mut document = self.clone();
        change_first(&mut document.tree, &change).then(|| {
            let error = T::deserialize(ValueDeserializer::from(document.tree.clone())).err();
            (document, error)
        })
    }
}

/// Applies a change to a value or the first value within it to which it applies; returns whether there is one.
fn change_first<'a>(
    value: &mut Spanned<DeValue<'a>>,
    change: &impl Fn(&mut Spanned<DeValue<'a>>) -> bool,
) -> bool {
    change(value)
        || match value.get_mut() {
            DeValue::Table(table) => table.iter_mut().any(|(_, value)| change_first(value, change)),
            DeValue::Array(items) => items.iter_mut().any(|item| change_first(item, change)),
            _ => false,
        }
}

/// Renames the key at these bytes of the text in a table; removes it if there is no `new` name or the name is taken.
/// Returns whether the table has the key.
fn rename(table: &mut Spanned<DeValue<'_>>, at: &Range<usize>, new: Option<&str>) -> bool {
    let DeValue::Table(table) = table.get_mut() else { return false };
    let Some(key) = table.keys().find(|key| key.span() == *at).cloned() else { return false };
    if let (Some(value), Some(new)) = (table.remove(&key), new) {
        table.entry(Spanned::new(at.clone(), new.to_owned().into())).or_insert(value);
    }
    true
}

/// Replaces the value at these bytes of the text, or inserts `key` into the table there. Returns whether it is there.
fn place<'a>(
    value: &mut Spanned<DeValue<'a>>,
    at: &Range<usize>,
    key: Option<&str>,
    new: &DeValue<'a>,
) -> bool {
    let (found, new) = (value.span() == *at, Spanned::new(PLACEHOLDER, new.clone()));
    match (key, value.get_mut()) {
        (None, _) if found => *value = new,
        (Some(key), DeValue::Table(table)) if found && !table.contains_key(key) => {
            table.insert(Spanned::new(PLACEHOLDER, Cow::Owned(key.to_owned())), new);
        }
        _ => return false,
    }
    true
}
