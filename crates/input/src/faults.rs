//! Faults of the structure of a TOML file: unknown and missing keys, unknown words, and the first value of another type.

use crate::{Document, InputError, Place, shipped};
use serde::de::DeserializeOwned;
use std::borrow::Cow;
use std::mem::replace;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeArray, DeInteger, DeTable, DeValue, Error, ValueDeserializer};

/// Largest number of faults that are reported at once.
pub const MAX_FAULTS: usize = 10;
/// Largest text, bytes, of which more than the first fault is reported: each fault takes several readings.
const MAX_LENGTH: usize = 16 << 10;
/// Span of the values that are not in the file.
const PLACEHOLDER: Range<usize> = usize::MAX..usize::MAX;
const UNKNOWN: &str = "unknown field `";
const MISSING: &str = "missing field `";
const UNKNOWN_WORD: &str = "unknown variant `";

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
    [UNKNOWN, UNKNOWN_WORD].into_iter().find(|begin| message.starts_with(begin))?;
    let words = quoted(message);
    let (given, accepted) = words.split_first()?;
    shipped::nearest(given, &[accepted, more].concat())
}

/// Returns the words in backticks.
fn quoted(message: &str) -> Vec<&str> {
    message.split('`').skip(1).step_by(2).collect()
}

/// Returns the key that is missing according to a parser's message.
fn missing_key(message: &str) -> Option<&str> {
    message.strip_prefix(MISSING)?.strip_suffix('`')
}

/// Document after the repair of a fault, with its next error.
type Repaired<'a> = (Document<'a>, Option<Error>);

impl<'a> Document<'a> {
    /// Returns the faults of a document of which `error` is the first one, as one error: in the order of the file,
    /// missing keys last, [`MAX_FAULTS`] at most. Unknown and missing keys and unknown words are repaired in the tree
    /// to find the next fault.
    pub(crate) fn faults<T: DeserializeOwned>(mut self, error: Error) -> InputError {
        let (mut found, mut next) = (Vec::new(), Some(error));
        let most = if self.text.len() > MAX_LENGTH { 1 } else { MAX_FAULTS };
        while let Some(error) = next.take_if(|_| found.len() < most) {
            let (near, repaired) = self.repaired::<T>(&error);
            let missing = missing_key(error.message()).is_some();
            let order = (missing, error.span().map(|span| span.start));
            found.push((order, fault(self.file, self.text, error, near.as_deref())));
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

    /// Returns the word that was probably meant, and the document without this fault, if it can be repaired.
    fn repaired<T: DeserializeOwned>(
        &self,
        error: &Error,
    ) -> (Option<String>, Option<Repaired<'a>>) {
        let message = error.message();
        if !message.starts_with(UNKNOWN) {
            let near = nearest_key(message, &[]).map(str::to_owned);
            return (near, self.with_word::<T>(error).or_else(|| self.with_missing::<T>(error)));
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

    /// Returns the document with an accepted word in place of an unknown one; `None` for another error.
    fn with_word<T: DeserializeOwned>(&self, error: &Error) -> Option<Repaired<'a>> {
        let (words, at) = (error.message().strip_prefix(UNKNOWN_WORD)?, error.span()?);
        let word = words.split('`').nth(2)?;
        let new = || DeValue::String(word.to_owned().into());
        self.changed::<T>(|value| value.span() == at && replace(value.get_mut(), new()).is_str())
    }

    /// Returns the document with any accepted value for a missing key; `None` if none is accepted.
    fn with_missing<T: DeserializeOwned>(&self, error: &Error) -> Option<Repaired<'a>> {
        let (key, at) = (missing_key(error.message())?, error.span()?);
        let with = |new: DeValue<'a>| self.changed::<T>(|table| insert(table, &at, key, &new));
        let fits = |(_, after): &Repaired<'_>| {
            after.as_ref().and_then(Error::span).is_none_or(|span| span != PLACEHOLDER)
        };
        let number = DeValue::Integer(DeInteger::default());
        let zeros = |count: usize| {
            let mut zeros = DeArray::new();
            (0..count).for_each(|_| zeros.push(Spanned::new(PLACEHOLDER, number.clone())));
            DeValue::Array(zeros)
        };
        let text = |word: String| DeValue::String(Cow::Owned(word));
        let table = DeValue::Table(DeTable::new());
        let others = [number.clone(), zeros(2), zeros(3), zeros(0), table];
        // The error of an empty text lists the accepted words, if not every text is.
        let refused = with(text(String::new())).and_then(|(_, after)| after);
        let words = refused.as_ref().map_or(Vec::new(), |error| quoted(error.message()));
        let words = std::iter::once("").chain(words).map(|word| text(word.to_owned()));
        words.chain(others).filter_map(with).find(fits)
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

/// Inserts a missing key into the table at these bytes of the text. Returns whether the table is there.
fn insert<'a>(
    table: &mut Spanned<DeValue<'a>>,
    at: &Range<usize>,
    key: &str,
    new: &DeValue<'a>,
) -> bool {
    let found = table.span() == *at;
    let DeValue::Table(table) = table.get_mut() else { return false };
    if !found || table.contains_key(key) {
        return false;
    }
    let key = Spanned::new(PLACEHOLDER, Cow::Owned(key.to_owned()));
    table.insert(key, Spanned::new(PLACEHOLDER, new.clone()));
    true
}
