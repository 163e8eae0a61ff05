//! Paths of numbers, checked against the table of all numbers.

use crate::numbers::{Kind, NumberSpec, filled_paths};
use input::numbers::unknown_path;
use input::units::without_unit;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Deref;

/// Path of a number in the table: `task.friction.plug_socket`. The unit, if any, is the suffix of a word:
/// `task.grip.force_n`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Path {
    text: String,
    number: &'static NumberSpec,
}

impl Path {
    /// Looks up a path in the table.
    ///
    /// # Errors
    /// If it is not in the table; the message suggests the closest match.
    pub fn new(text: impl Into<String>) -> Result<Self, String> {
        let text = text.into();
        // The names in a path of which only `task` is missing are those of its suggestion.
        let in_task = ["plug.", "socket.", "strategy."].iter().any(|table| text.starts_with(table));
        let whole = if in_task { format!("task.{text}") } else { text.clone() };
        let variable = |(_, number): &(String, &NumberSpec)| number.kind != Kind::Fixed;
        let known: Vec<_> = filled_paths(&whole).filter(variable).collect();
        let Some((_, number)) = known.iter().find(|(path, _)| *path == text) else {
            let known: Vec<&str> = known.iter().map(|(path, _)| path.as_str()).collect();
            return Err(unknown_path(&text, &known));
        };
        Ok(Path { text, number })
    }

    /// Returns the kind of the number.
    pub fn kind(&self) -> Kind {
        self.number.kind
    }

    /// Returns the smallest and largest plausible value, in the unit of the path.
    pub fn bounds(&self) -> [f64; 2] {
        self.number.bounds
    }

    /// Returns the unit as a suffix to a value, with a leading space if needed; empty if dimensionless or if labels
    /// omit the unit.
    pub fn unit(&self) -> &'static str {
        label(self).1
    }
}

impl TryFrom<String> for Path {
    type Error = String;
    fn try_from(text: String) -> Result<Self, String> {
        Path::new(text)
    }
}

impl From<Path> for String {
    fn from(path: Path) -> String {
        path.text
    }
}

impl Deref for Path {
    type Target = str;
    fn deref(&self) -> &str {
        &self.text
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl<T: AsRef<str> + ?Sized> PartialEq<T> for Path {
    fn eq(&self, other: &T) -> bool {
        self.text == other.as_ref()
    }
}

/// Words of a path that labels omit.
const TABLES: [&str; 5] = ["task", "strategy", "phase", "grip", "finger"];

/// Returns the label of a path, and its unit as in [`Path::unit`]: `task.strategy.tilt_deg` is `tilt`, in `°`.
pub fn label(path: &str) -> (String, &'static str) {
    let mut unit = "";
    let mut words = Vec::new();
    for part in path.split('.').filter(|part| !TABLES.contains(part)) {
        let (word, of) = match part {
            // Of `rcc_mm`, over the infill direction.
            "at_0_deg" => (part, ""),
            "per_deg" => (part, " mm/°"),
            _ => without_unit(part),
        };
        unit = if of.is_empty() { unit } else { of };
        words.push(word.replace('_', " "));
    }
    (words.join(" "), unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::{DENSITY, FRICTION, NUMBERS};
    use input::Document;
    use input::numbers::NumberFile;
    use input::shipped::{FINGERS, ROBOTS, Shipped, TASKS};

    #[test]
    fn every_number_of_the_shipped_files_is_in_the_table_and_within_its_bounds() {
        let servo: Vec<Shipped> =
            ROBOTS.iter().filter(|robot| robot.name == "servo").copied().collect();
        let mut found = 0;
        for (root, files) in [("task", TASKS), ("finger", FINGERS), ("robot", &servo)] {
            for file in files {
                let numbers = Document::parse(file.text, file.file)
                    .and_then(|file| NumberFile::read(root, &file))
                    .unwrap();
                for key in numbers.keys() {
                    // The stiffnesses of the flange are scaled together, by the one along x.
                    if key.starts_with("robot.") && key.contains("stiffness") {
                        continue;
                    }
                    let path = Path::new(key).unwrap();
                    let [low, high] = path.bounds();
                    let value = numbers.number(&path).unwrap();
                    assert!((low..=high).contains(&value), "{}: {path} is {value}", file.file);
                    found += 1;
                }
            }
        }
        assert!(found > 300, "{found}");
    }

    #[test]
    fn no_number_is_listed_twice_and_bounds_are_intervals() {
        for number in NUMBERS.iter().filter(|number| number.kind != Kind::Fixed) {
            for path in number.paths() {
                let first = Path::new(path).unwrap();
                assert!(std::ptr::eq(first.number, number), "{first} is listed twice");
            }
            assert!(number.bounds[0] < number.bounds[1], "{}", number.pattern);
        }
    }

    #[test]
    fn an_unknown_path_names_the_nearest() {
        for (path, words) in [
            ("task.friction.plug_sokcet", "did you mean `task.friction.plug_socket`?"),
            (
                "task.strategy.phase.side.preload",
                "did you mean `task.strategy.phase.side.preload_mm`?",
            ),
            ("finger.skin.thick_mm", "`finger.skin.` continues with thickness_mm"),
            ("robot.mass", "did you mean `robot.mass_kg`?"),
            ("plug.mas", "did you mean `task.plug.mass_g`?"),
            ("task.plug.mas", "did you mean `task.plug.mass_g`?"),
            ("friction.plug_sokcet", "did you mean `task.friction.plug_socket`?"),
            ("strategy.phase.side.preload", "did you mean `task.strategy.phase.side.preload_mm`?"),
            ("finger.rcc", "did you mean `finger.rcc_mm`?"),
            ("tilt", "a path begins with `cell`, `finger`, `infill_density_percent`,"),
            ("task.clearance_mm.x", "unknown path `task.clearance_mm.x`"),
            ("", "unknown path ``"),
        ] {
            let error = Path::new(path).unwrap_err().to_string();
            assert!(error.contains(words), "{path}: {error}");
        }
    }

    #[test]
    fn names_may_have_dots_and_spaces() {
        for path in ["task.plug.part.metal shell v1.2.x_mm.0", "task.strategy.phase.a.b.settle_s"] {
            assert_eq!(Path::new(path).unwrap(), path);
        }
        assert!(Path::new("task.strategy.phase.settle_s").is_err());
    }

    #[test]
    fn paths_in_words() {
        for (path, words, unit) in [
            (DENSITY, "infill density", " %"),
            (FRICTION, "friction plug socket", ""),
            ("task.strategy.tilt_deg", "tilt", "°"),
            ("task.strategy.phase.side.move_mm.y", "side move y", " mm"),
            ("task.strategy.phase.assembly.speed_mm_per_s", "assembly speed", " mm/s"),
            ("task.grip.force_n", "force", " N"),
            ("finger.mass_g", "mass", " g"),
            ("finger.rotation_x_nm_per_rad", "rotation x", " N m/rad"),
            ("task.opening.0", "opening 0", ""),
            ("task.finger.rcc_mm.at_0_deg", "rcc at 0 deg", " mm"),
            ("task.finger.rcc_mm.per_deg", "rcc per deg", " mm/°"),
        ] {
            assert_eq!(label(path), (words.to_owned(), unit));
        }
    }
}
