//! Commands of `lab` without a test file of their own; windows at half the time step and by the other search.

mod common;

use common::{Ran, lab};

/// Returns the words of each row of a task in a table of windows.
fn rows<'a>(ran: &'a Ran, task: &str) -> Vec<Vec<&'a str>> {
    let rows = ran.stdout.lines().filter(|line| line.starts_with(task));
    rows.map(|line| line.split_whitespace().collect()).collect()
}

#[test]
fn an_engine_agrees_with_itself_in_the_cross_check() {
    let check = ["cross-check", "--engine", "fake", "--against", "fake", "--task", "ket8"];
    let ran = lab(&check);
    ran.says(&["100.0 %"]);
    let alike = ran.stdout.split_once("alike in ").and_then(|(_, rest)| rest.split(' ').next());
    assert!(alike.is_some_and(|count| count.parse::<usize>().unwrap() > 20), "{}", ran.stdout);
}

/// The softest finger on usb is excepted: its positive end depends on the step (docs/notes/simulation.md, "Step size").
#[test]
fn windows_on_half_the_step_are_the_same() {
    for (task, excepted) in [("rj45", 0), ("usb", 1)] {
        let ran = lab(&["check", "--convergence", "--task", task]);
        let rows = rows(&ran, task);
        assert_eq!(rows.len(), 3, "{}", ran.stdout);
        for row in &rows[excepted..] {
            let [.., positive, _, _, _, _, _, verdict] = row[..] else { panic!("{row:?}") };
            assert_eq!(verdict, "ok", "{row:?}");
            assert!(positive.parse::<f64>().unwrap() > 2.0, "{row:?}");
        }
    }
}

#[test]
fn the_quick_search_finds_the_ends_of_the_walk() {
    let ran = lab(&["check", "--searches", "--task", "ket8"]);
    ran.succeeds();
    let rows = rows(&ran, "ket8");
    assert_eq!(rows.len(), 3, "{}", ran.stdout);
    assert!(rows.iter().all(|row| row.contains(&"strides") && row.last() == Some(&"ok")));
    let trials =
        ran.stdout.split_once("trials: ").and_then(|(_, rest)| rest.split_once(" against "));
    let (walk, strides) = trials.expect("both counts");
    let [walk, strides] = [walk, strides].map(|count| count.trim().parse::<u32>().unwrap());
    assert!(2 * strides < walk, "{}", ran.stdout);
}

#[test]
fn what_only_the_convergence_has_is_refused_without_it() {
    lab(&["check", "--robot", "rigid"]).fails(2, &["--convergence", "--searches"]);
    lab(&["check", "--convergence", "--engine", "fake"]).fails(2, &["fake"]);
    lab(&["check", "--convergence", "--robot", "nobody"]).fails(2, &["nobody", "servo"]);
    lab(&["check", "--convergence", "--robot", "ur5e", "--engine", "rapier"])
        .fails(2, &["--engine direct"]);
}
