//! Parsers of option values: words of a list, numbers in a range, pairs of numbers.

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use clap::{Arg, Command, Error};
use input::shipped::nearest;
use std::ffi::OsStr;
use std::fmt::Display;
use std::marker::PhantomData;
use std::str::FromStr;

/// Parser of an option by `T::from_str`. Help texts list the words from which a value is made, and the error for an
/// unknown word suggests the nearest one.
#[derive(Debug, Clone)]
pub struct WordParser<T> {
    words: Vec<&'static str>,
    value: PhantomData<fn() -> T>,
}

impl<T> WordParser<T> {
    /// Returns the parser of values made from these words.
    pub fn new(words: impl IntoIterator<Item = &'static str>) -> Self {
        WordParser { words: words.into_iter().collect(), value: PhantomData }
    }
}

impl<T: FromStr<Err: Display> + Clone + Send + Sync + 'static> TypedValueParser for WordParser<T> {
    type Value = T;

    fn parse_ref(&self, command: &Command, arg: Option<&Arg>, value: &OsStr) -> Result<T, Error> {
        let words = self.words.clone();
        let near = move |text: &str| {
            let mut unknown = text.split([',', '<', '>']).filter(|word| !words.contains(word));
            let near = unknown.find_map(|word| nearest(word, &words));
            near.map_or(String::new(), |near| format!("; did you mean `{near}`?"))
        };
        let parse = move |text: String| {
            text.parse::<T>().map_err(|problem| format!("{problem}{}", near(&text)))
        };
        StringValueParser::new().try_map(parse).parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.words.iter().map(|word| PossibleValue::new(*word))))
    }
}

/// Parses a number and checks it with `accepted`; `problem` is the error message.
pub(crate) fn parse_number(
    text: &str,
    accepted: impl Fn(f64) -> bool,
    problem: &str,
) -> Result<f64, String> {
    text.parse().ok().filter(|number| accepted(*number)).ok_or_else(|| problem.to_owned())
}

/// Parses a finite number of at least 0; the error message names `unit`.
pub(crate) fn parse_at_least_0(text: &str, unit: &str) -> Result<f64, String> {
    let problem = format!("must be a number of at least 0 ({unit})");
    parse_number(text, |number| number.is_finite() && number >= 0.0, &problem)
}
