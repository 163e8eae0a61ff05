//! Replacement of the strategy in the text of a task file: comments are kept, and old values become comments.

use super::write;
use insertion::Strategy;
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, RawString, Table, TomlError, Value};

/// Returns the text of a task file with its strategy replaced by `after`. A rule for the start (`start`) becomes a comment,
/// since `start_mm` then gives the start.
///
/// # Errors
/// If the text is not TOML.
pub fn with_strategy(text: &str, after: &Strategy) -> Result<String, TomlError> {
    let mut file: DocumentMut = text.parse()?;
    let new: DocumentMut = write::strategy(after).parse()?;
    // Inline tables are expanded, since they cannot contain comments.
    if let Ok(table) = std::mem::take(&mut file["strategy"]).into_table() {
        file["strategy"] = Item::Table(table);
    }
    if let (Some(old), Some(new)) = (file["strategy"].as_table_mut(), new["strategy"].as_table()) {
        if let Some(Ok(phases)) = old.remove("phase").map(Item::into_array_of_tables) {
            old.insert("phase", Item::ArrayOfTables(phases));
        }
        update(old, new);
        if let Some(Item::Value(rule)) = old.remove("start")
            && let Some(mut key) = old.key_mut("start_mm")
        {
            let decor = key.leaf_decor_mut();
            let before = decor.prefix().and_then(|raw| raw.as_str()).unwrap_or("").to_owned();
            decor.set_prefix(format!("{before}# start was {}\n", bare(&rule)));
        }
        let phases = old.get_mut("phase").and_then(Item::as_array_of_tables_mut);
        if let (Some(from), Some(to)) = (phases, new["phase"].as_array_of_tables()) {
            if same_moves(from, to) {
                from.iter_mut().zip(to).for_each(|(old, new)| update(old, new));
            } else {
                replace(from, to);
            }
        }
    }
    Ok(file.to_string())
}

/// Returns the text of a task file with another name.
///
/// # Errors
/// If the text is not TOML.
pub fn with_name(text: &str, name: &str) -> Result<String, TomlError> {
    let mut file: DocumentMut = text.parse()?;
    let new = Table::from_iter([("name", name)]);
    update(file.as_table_mut(), &new);
    Ok(file.to_string())
}

/// Returns whether the phases of two strategies agree in number, names, stages and motions.
fn same_moves(old: &ArrayOfTables, new: &ArrayOfTables) -> bool {
    let kinds = |phases: &ArrayOfTables| -> Vec<_> {
        let word = |phase: &Table, key| phase.get(key).and_then(Item::as_str).map(str::to_owned);
        phases.iter().map(|phase| ["name", "stage", "motion"].map(|key| word(phase, key))).collect()
    };
    kinds(old) == kinds(new)
}

/// Updates the values of a table that differ, each with its old value in a comment behind it.
fn update(old: &mut Table, new: &Table) {
    for (key, to) in new {
        let Some(to) = to.as_value() else { continue };
        let from = old.get(key).and_then(Item::as_value).cloned();
        if from.as_ref().is_some_and(|from| same(from, to)) {
            continue;
        }
        let mut value = to.clone();
        let note = from.map_or(String::new(), |from| {
            let beside = from.decor().suffix().and_then(RawString::as_str).unwrap_or("").trim();
            let join = if beside.is_empty() { "#" } else { ";" };
            format!(" {beside}{join} was {}", bare(&from))
        });
        *value.decor_mut() = toml_edit::Decor::new(" ", note);
        // Replaced in place, because a key that is removed and inserted loses the comments above it.
        match old.get_mut(key) {
            Some(item) => *item = Item::Value(value),
            None => drop(old.insert(key, Item::Value(value))),
        }
    }
}

/// Replaces the phases; the old ones stay as comments.
fn replace(old: &mut ArrayOfTables, new: &ArrayOfTables) {
    let mut was = String::from("\n# was:\n");
    for phase in old.iter() {
        was.push_str("# [[strategy.phase]]\n");
        for line in phase.to_string().lines().filter(|line| !line.trim().is_empty()) {
            was.push_str(&format!("# {}\n", line.trim()));
        }
    }
    old.clear();
    for (i, phase) in new.iter().enumerate() {
        let mut phase = phase.clone();
        let above = if i == 0 { was.as_str() } else { "\n" };
        phase.decor_mut().set_prefix(above);
        phase.set_position(None);
        old.push(phase);
    }
}

/// Returns whether two values are equal for a task, numbers within the resolution of task files.
fn same(a: &Value, b: &Value) -> bool {
    let number = |value: &Value| value.as_float().or(value.as_integer().map(|whole| whole as f64));
    let list =
        |a: &Array, b: &Array| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b));
    match (number(a), number(b), a.as_array(), b.as_array()) {
        // In the unit of the key; 0.1 um for a length in mm.
        (Some(a), Some(b), ..) => (a - b).abs() < 1e-4,
        (.., Some(a), Some(b)) => list(a, b),
        _ => a.as_str().is_some() && a.as_str() == b.as_str(),
    }
}

/// Formats a value without its comment.
fn bare(value: &Value) -> String {
    let mut bare = value.clone();
    bare.decor_mut().clear();
    bare.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Family;
    use input::shipped::TASKS;
    use insertion::task::Task;

    /// Writes a family's strategy into a task file and asserts that it reads back; returns text and task.
    fn arrives(text: &str, family: Family) -> (String, Task) {
        let after = family.strategy_for(&Task::parse(text, "own").unwrap()).unwrap();
        let written = with_strategy(text, &after).unwrap();
        let read = Task::parse(&written, "written").unwrap();
        assert!((read.strategy.tilt - after.tilt).abs() < 1e-6, "{written}");
        for (read, after) in read.strategy.phases.iter().zip(&after.phases) {
            let off = (0..3).map(|i| (read.displacement[i] - after.displacement[i]).abs());
            assert!(off.fold(0.0, f64::max) < 1e-7, "{written}");
        }
        (written, read)
    }

    #[test]
    fn a_changed_file_has_the_new_strategy_the_old_values_and_all_comments() {
        for file in TASKS {
            let task = Task::parse(file.text, file.file).unwrap();
            for family in Family::all() {
                let (written, _) = arrives(file.text, family);
                let comments = file.text.lines().filter_map(|line| line.split_once('#'));
                for (_, comment) in comments {
                    assert!(written.contains(comment.trim()), "{}: {comment}", file.name);
                }
            }
            let unchanged = with_strategy(file.text, &task.strategy).unwrap();
            assert_eq!(unchanged, file.text, "{}", file.name);
            // As some editors on Windows write it.
            let windows = format!("\u{feff}{}", file.text.replace('\n', "\r\n"));
            arrives(&windows, Family::Peg);
        }
    }

    #[test]
    fn a_new_key_has_no_comment_and_a_changed_one_keeps_its_own() {
        let [file, ..] = TASKS else { panic!() };
        let strategy = |text: &str| Task::parse(text, "own").unwrap().strategy;
        let more = "preload_mm = 0.3\ntouch_force_n = 2.5\nlatency_s = 0.02";
        let more = file.text.replacen("preload_mm = 0.3", more, 1);
        assert_eq!(with_strategy(file.text, &strategy(&more)).unwrap(), more);
        let comment = |text: &str| file.text.replacen("tilt_deg = 5.0", text, 1);
        let written = with_strategy(
            &comment("tilt_deg = 5.0 # a ; b"),
            &strategy(&comment("tilt_deg = 6.0")),
        );
        assert_eq!(written.unwrap(), comment("tilt_deg = 6.0 # a ; b; was 5.0"));
    }

    #[test]
    fn a_new_name_keeps_all_other_lines() {
        for file in TASKS {
            let [old, new] = [file.name, "other"].map(|name| format!("name = \"{name}\""));
            let expected = file.text.replacen(&old, &format!("{new} # was \"{}\"", file.name), 1);
            assert_eq!(with_name(file.text, "other").unwrap(), expected);
        }
    }

    #[test]
    fn inline_tables_are_changed_too() {
        let [file, ..] = TASKS else { panic!() };
        let mut fields: toml::Table = toml::from_str(file.text).unwrap();
        let strategy = fields.remove("strategy").unwrap();
        let text = format!("strategy = {strategy}\n{fields}");
        arrives(&text, Family::Peg);
    }

    #[test]
    fn other_phases_leave_the_old_ones_as_comments_and_a_rule_becomes_a_number() {
        let [file, ..] = TASKS else { panic!() };
        let text = file.text.replace("name = \"side\"", "name = \"along\"");
        let text = text.replacen("tilt_deg = 5.0", "start = \"taught\"\ntilt_deg = 5.0 # mine", 1);
        let (written, read) = arrives(&text, Family::Peg);
        assert_eq!(read.strategy.phases.len(), 6);
        assert_eq!(read.strategy.rule, insertion::task::StartRule::Given);
        for said in ["# name = \"along\"", "# start was \"taught\"", "# mine"] {
            assert!(written.contains(said), "{said} in {written}");
        }
        assert_eq!(read.success, Task::parse(&text, "own").unwrap().success);
    }
}
