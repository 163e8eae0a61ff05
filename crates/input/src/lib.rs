//! Input files: reading up to a size limit, checks, errors and units. Internally, every quantity is in SI units; a
//! quantity in another unit, such as mm, N/mm or degrees, has the unit in its name ([`units`]).

mod faults;
pub mod files;
pub mod numbers;
mod place;
pub mod shipped;
pub mod units;
pub mod wrong_unit;

pub use faults::syntax;
pub use place::{InputError, Place, Placed, RequestError};
use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::{DeTable, DeValue, ValueDeserializer};
use wrong_unit::WrongUnit;

/// Largest magnitude of a number in a file. A larger one is probably in a wrong unit, and could overflow in sums and
/// products.
const LARGEST: f64 = 1e9;
/// Largest magnitude of a coordinate or a displacement, mm.
const LONGEST_MM: f64 = 1000.0;

/// Parsed TOML text from which typed values are read.
#[derive(Debug, Clone)]
pub struct Document<'a> {
    text: &'a str,
    file: &'a str,
    tree: Spanned<DeValue<'a>>,
    /// Keys of the file that were taken out of the tree.
    taken: &'a [&'a str],
}

impl<'a> Document<'a> {
    /// Parses TOML; `file` is named in errors.
    ///
    /// # Errors
    /// If the text is not TOML.
    pub fn parse(text: &'a str, file: &'a str) -> Result<Self, InputError> {
        let table = DeTable::parse(text).map_err(|error| syntax(file, text, &error))?;
        let tree = Spanned::new(table.span(), DeValue::Table(table.into_inner()));
        Ok(Document { text, file, tree, taken: &[] })
    }

    /// Returns the file name, as passed to [`Document::parse`].
    pub fn file(&self) -> &str {
        self.file
    }

    /// Returns the document without these top-level keys.
    pub fn without(mut self, keys: &'a [&'a str]) -> Self {
        if let DeValue::Table(table) = self.tree.get_mut() {
            for key in keys {
                table.remove(*key);
            }
        }
        Document { taken: keys, ..self }
    }

    /// Deserializes the whole document.
    ///
    /// # Errors
    /// If the document does not have the structure of `T`.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T, InputError> {
        let (value, table) = (self.deserialize()?, self.deserialize()?);
        // No array may be too long. The deserializer of TOML text ignores surplus elements: it would read
        // `[-4,175, 4,175]`, with decimal commas, as -4 and 175.
        T::deserialize(toml::Value::Table(table)).map_err(|error| syntax(self.file, "", &error))?;
        Ok(value)
    }

    fn deserialize<T: DeserializeOwned>(&self) -> Result<T, InputError> {
        let read = T::deserialize(ValueDeserializer::from(self.tree.clone()));
        read.map_err(|error| self.clone().faults::<T>(error))
    }
}

/// Reads TOML; `file` is named in errors.
///
/// # Errors
/// See [`Document::parse`] and [`Document::read`].
pub fn read<T: DeserializeOwned>(text: &str, file: &str) -> Result<T, InputError> {
    Document::parse(text, file)?.read()
}

/// Checks that each line of a CSV text closes its quoted cells; an unclosed one would include the lines below. Lines
/// that begin with `#` are comments; `file` is named in the error.
///
/// # Errors
/// If a line has an unclosed cell; the error is about the first one.
pub fn check_quotes(text: &str, file: &str) -> Result<(), InputError> {
    let runs_over = |line: &str| {
        // A quotation mark opens a quoted cell only at the beginning of the cell; within it, a doubled mark is a
        // literal one.
        let (mut quoted, mut opens) = (false, true);
        for c in line.chars() {
            (quoted, opens) = match c {
                '"' if quoted => (false, true),
                '"' => (opens, false),
                _ => (quoted, !quoted && c == ','),
            };
        }
        quoted
    };
    let unclosed = text.lines().position(|line| !line.starts_with('#') && runs_over(line));
    unclosed.map_or(Ok(()), |at| Err(Place::file(file).line(at + 1).fault(UNCLOSED)))
}

/// Error message for [`check_quotes`].
const UNCLOSED: &str = "a quoted cell runs over the end of the line; close its quotation mark \
                            there (a mark within a quoted cell is written twice)";

/// Formats a number for messages with at most 15 significant digits, which omits the rounding error of a conversion
/// between units; very large and very small ones with an exponent.
pub fn shown(value: f64) -> String {
    let value = format!("{value:.14e}").parse().unwrap_or(value);
    let plain = value == 0.0 || (1e-6..1e12).contains(&value.abs()) || !value.is_finite();
    if plain { value.to_string() } else { format!("{value:e}") }
}

/// Returns a count with its noun, as in "1 line" and "2 lines".
pub fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Checker of the values of a file.
#[derive(Debug, Clone, Copy)]
pub struct Check<'a> {
    /// File name for errors.
    pub file: &'a str,
}

impl Check<'_> {
    /// Returns an error about a field.
    ///
    /// # Errors
    /// Always.
    pub fn fail<T>(&self, key: &str, problem: impl Into<String>) -> Result<T, InputError> {
        let key = Some(key.to_owned());
        Err(Place { key, ..Place::file(self.file) }.fault(problem))
    }

    /// Returns the value if it `fits`, else an error; `must` is the requirement, as in "be above 0".
    pub fn require(
        &self,
        key: &str,
        value: f64,
        fits: bool,
        must: &str,
    ) -> Result<f64, InputError> {
        match fits {
            true => Ok(value),
            false => self.fail(key, format!("is {}; it must {must}", shown(value))),
        }
    }

    /// Checks each value by a check of one value, such as [`Check::finite`].
    ///
    /// # Errors
    /// The error of the first invalid value.
    pub fn each<const N: usize>(
        &self,
        key: &str,
        values: [f64; N],
        one: fn(&Self, &str, f64) -> Result<f64, InputError>,
    ) -> Result<[f64; N], InputError> {
        values.iter().try_for_each(|&value| one(self, key, value).map(drop))?;
        Ok(values)
    }

    /// Checks that a value is in the unit of its key.
    ///
    /// # Errors
    /// If it is `found` to be in another.
    pub fn unit(&self, key: &str, found: Option<WrongUnit>) -> Result<(), InputError> {
        found.map_or(Ok(()), |found| self.fail(key, found.join("; ")))
    }

    /// Checks that a value lies in -1e9 .. 1e9.
    ///
    /// # Errors
    /// If it does not.
    pub fn finite(&self, key: &str, value: f64) -> Result<f64, InputError> {
        // A NaN fails the comparison.
        let fits = value.abs() <= LARGEST;
        self.require(key, value, fits, "be a finite number of magnitude 1e9 or less")
    }

    /// Checks that a value lies in 0 .. 1e9.
    ///
    /// # Errors
    /// If it does not.
    pub fn not_negative(&self, key: &str, value: f64) -> Result<f64, InputError> {
        let fits = (0.0..=LARGEST).contains(&value);
        self.require(key, value, fits, "be a finite number, 0 or above, 1e9 at most")
    }

    /// Checks that a coordinate or a displacement, mm, lies in -1000 .. 1000.
    ///
    /// # Errors
    /// If it does not.
    pub fn distance(&self, key: &str, mm: f64) -> Result<f64, InputError> {
        let fits = self.finite(key, mm)?.abs() <= LONGEST_MM;
        self.require(key, mm, fits, &format!("lie in -{LONGEST_MM} .. {LONGEST_MM} (mm)"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Friction {
        #[expect(dead_code, reason = "only its name is read")]
        plug_socket: f64,
    }

    #[test]
    fn numbers_are_shown_without_the_rounding_error_of_a_conversion() {
        for (value, text) in [
            (0.0041 * 1e3, "4.1"),
            (100.0 * 0.07, "7"),
            (15.7e-3 / 1e-3, "15.7"),
            (-0.123456789012345, "-0.123456789012345"),
            (0.0, "0"),
            (2e15, "2e15"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(shown(value), text);
        }
    }

    #[test]
    fn an_unknown_key_is_named_with_its_line_and_the_nearest_key() {
        let error = read::<Friction>("\nplug_sockt = 0.3", "task.toml").unwrap_err();
        assert_eq!(error.place().line, Some(2));
        let text = error.to_string();
        assert!(text.ends_with("expected `plug_socket`; did you mean `plug_socket`?"), "{text}");
        let error = |text: &str| read::<Friction>(text, "task.toml").unwrap_err().to_string();
        let text = error("plug_socket = 0.3\nother = 0.3");
        assert!(!text.contains("mean"), "{text}");
        // The only missing key, though it is not similar.
        let text = error("other = 0.3");
        assert!(text.matches("TOML").count() == 1 && text.contains("did you mean"), "{text}");
    }

    #[test]
    fn all_unknown_keys_and_a_missing_one_are_reported_at_once() {
        #[derive(Debug, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        #[expect(dead_code, reason = "only the names are read")]
        struct Pair {
            name: String,
            friction: Vec<Friction>,
            mass_g: f64,
            height_mm: f64,
        }
        let text =
            "nam = \"a\"\nother = 1\n[[friction]]\nplug_socket = 1\n[[friction]]\nplug_sockt = 1";
        let error = read::<Pair>(text, "task.toml").unwrap_err();
        assert_eq!(error.place().line, Some(1));
        let text = error.to_string();
        let found: Vec<_> = text.lines().filter(|line| line.contains('`')).collect();
        let expected = ["`nam`", "`other`", "`friction.plug_sockt`", "`height_mm`"];
        let begin = |(line, key): (&&str, &str)| {
            line.split(" field ").nth(1).is_some_and(|of| of.starts_with(key))
        };
        assert!(found.len() == 4 && found.iter().zip(expected).all(begin), "{text}");
        assert!(text.contains("line 1,") && text.contains("did you mean `name`?"), "{text}");
        assert!(text.contains("did you mean `mass_g`?"), "{text}");
        let line = "friction = [{ plug_sockt = 1, plug_scket = 2 }]";
        let text = format!("mass_g = 1\nname = 3\n{line}");
        let text = read::<Pair>(&text, "t.toml").unwrap_err().to_string();
        assert!(text.matches(line).count() == 2 && text.contains("| name = 3"), "{text}");
        let text = "friction = []\nname = \"a\"\nheight_mm = 1\nbought_at = \"bought\"";
        let text = read::<Pair>(text, "t.toml").unwrap_err().to_string();
        assert!(text.contains("missing field `mass_g`") && !text.contains("mean"), "{text}");
        let many: String = (0..20).map(|i| format!("other_{i} = 1\n")).collect();
        let text = read::<Pair>(&many, "t.toml").unwrap_err().to_string();
        assert_eq!(text.matches("unknown field").count(), faults::MAX_FAULTS);
        let document = Document::parse("kind = 1\nknd = 2\nplug_socket = 1", "t.toml").unwrap();
        let error = document.without(&["kind"]).read::<Friction>().unwrap_err().to_string();
        assert!(error.ends_with("did you mean `kind`?"), "{error}");
    }

    #[test]
    fn all_missing_keys_are_listed_up_to_the_first_wrong_value() {
        #[derive(Debug, serde::Deserialize)]
        #[expect(dead_code, reason = "only the names are read")]
        struct Part {
            x_mm: [f64; 2],
            mass_g: f64,
            axis: String,
        }
        #[derive(Debug, serde::Deserialize)]
        #[expect(dead_code, reason = "only the names are read")]
        struct Plug {
            part: Vec<Part>,
            height_mm: f64,
        }
        let listed = |text: &str| -> Vec<String> {
            let text = read::<Plug>(text, "t.toml").unwrap_err().to_string();
            let fault = |line: &&str| line.starts_with("missing") || line.starts_with("invalid");
            text.lines().filter(fault).map(str::to_owned).collect()
        };
        let text = "[[part]]\naxis = \"x\"\n[[part]]\nmass_g = 2.0";
        let missing = ["part.x_mm", "part.mass_g", "height_mm", "part.x_mm", "part.axis"];
        let mut found = listed(text);
        let mut expected = missing.map(|key| format!("missing field `{key}`")).to_vec();
        found.sort();
        expected.sort();
        assert_eq!(found, expected);
        let found = listed(&text.replace("2.0", "[2]"));
        assert_eq!(found.last().unwrap(), "missing field `part.mass_g`", "{found:?}");
        assert_eq!(found[0], "invalid type: sequence, expected f64", "{found:?}");
        // Each fault takes several readings of the file.
        assert_eq!(listed(&format!("{text}\n#{}", " ".repeat(16 << 10))).len(), 1);
    }

    #[test]
    fn the_faults_after_an_unknown_word_are_listed() {
        #[derive(Debug, serde::Deserialize)]
        #[serde(rename_all = "kebab-case")]
        enum Motion {
            Touch,
            Duration,
        }
        #[derive(Debug, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        #[expect(dead_code, reason = "only the names are read")]
        struct Phase {
            motion: Motion,
            speed: f64,
        }
        #[derive(Debug, serde::Deserialize)]
        #[expect(dead_code, reason = "only its names are read")]
        struct Strategy {
            phase: Vec<Phase>,
        }
        let text =
            "[[phase]]\nmotion = \"tuch\"\nsped = 1\n[[phase]]\nmotion = \"x\"\nspeed = \"1\"";
        let text = read::<Strategy>(text, "t.toml").unwrap_err().to_string();
        let faults =
            ["unknown variant `tuch`", "unknown field `phase.sped`", "unknown variant `x`"];
        let faults = [&faults[..], &["invalid type: string \"1\""]].concat();
        let at: Vec<_> = faults.iter().map(|fault| text.find(fault)).collect();
        assert!(at.is_sorted() && !at.contains(&None), "{text}");
        let accepted = [Motion::Touch, Motion::Duration].map(|of| format!("{of:?}").to_lowercase());
        assert!(accepted.iter().all(|word| text.contains(word)), "{text}");
    }

    #[test]
    fn a_table_without_a_text_is_reported_by_key_and_value() {
        let error = |text: &str| {
            let table: toml::Table = text.parse().unwrap();
            let error = table.try_into::<BTreeMap<String, Friction>>().unwrap_err();
            syntax("task", "", &error).to_string()
        };
        let wrong = "task: friction.plug_socket: invalid type: string \"0.3\", expected f64";
        assert_eq!(error("friction.plug_socket = \"0.3\""), wrong);
        let unknown = error("friction.plug_sockt = 0.3");
        assert!(unknown.starts_with("task: friction: unknown field `plug_sockt`"), "{unknown}");
    }

    #[derive(Debug, serde::Deserialize)]
    struct Start {
        #[expect(dead_code, reason = "only its length is checked")]
        at_mm: [f64; 2],
    }

    #[test]
    fn elements_beyond_those_that_are_used_are_refused() {
        #[derive(Debug, serde::Deserialize)]
        struct Strategy {
            #[expect(dead_code, reason = "only its name is read")]
            start: Start,
        }
        read::<Strategy>("[start]\nat_mm = [-4.175, 4.175]", "task.toml").unwrap();
        let error = read::<Strategy>("[start]\nat_mm = [-4,175, 4,175]", "task.toml").unwrap_err();
        assert_eq!(error.place.key.as_deref(), Some("start.at_mm"));
        assert!(error.to_string().contains("invalid length 4"), "{error}");
    }
}
