//! Commands of `lab` without a test file of their own; windows at half the time step and by the other search.

mod common;

use common::lab;

#[test]
fn an_engine_agrees_with_itself_in_the_cross_check() {
    let check = ["cross-check", "--engine", "fake", "--against", "fake", "--task", "ket8"];
    let result = lab(&[&check[..], &["--json"]].concat()).json();
    assert_eq!((&result["agreement"], &result["passed"]), (&1.0.into(), &true.into()));
    assert!(result["trials"].as_array().is_some_and(|trials| trials.len() > 20), "{result}");
    lab(&check).says(&["100.0 %"]);
}

#[test]
fn every_help_shows_an_example() {
    for command in ["check", "cross-check", "validate"] {
        lab(&[command, "--help"]).says(&[&format!("Example: lab {command}")]);
    }
}

/// The softest finger on usb is excepted: its positive end depends on the step (docs/notes/simulation.md, "Step size").
#[test]
fn windows_on_half_the_step_are_the_same() {
    for (task, softest, count) in [("rj45", 0.0, 3), ("usb", 1.5, 2)] {
        let ran = lab(&["check", "--convergence", "--task", task, "--json"]);
        let rows: Vec<serde_json::Value> = serde_json::from_str(&ran.stdout).expect("JSON");
        let stiffness = |row: &serde_json::Value| row["stiffness_compliance_n_per_mm"].as_f64();
        assert!(rows.len() == 3 && rows.iter().map(stiffness).is_sorted(), "{rows:?}");
        let stiffer: Vec<_> = rows.iter().filter(|row| stiffness(row) > Some(softest)).collect();
        assert_eq!(stiffer.len(), count);
        for row in stiffer {
            assert_eq!(row["passed"], true, "{row}");
            assert!(row["production"]["positive_mm"].as_f64() > Some(2.0), "{row}");
        }
    }
}

#[test]
fn the_quick_search_finds_the_ends_of_the_walk() {
    let check = ["check", "--searches", "--task", "ket8", "--json"];
    let rows = lab(&check).json();
    for row in rows.as_array().expect("an array") {
        assert_eq!((&row["passed"], &row["search"]), (&true.into(), &"strides".into()), "{row}");
        assert_eq!(row["walk"]["failure_negative"], 3, "{row}");
        let [walk, strides] = [0, 1].map(|way| row["trials"][way].as_u64().expect("a count"));
        assert!(2 * strides < walk, "{row}");
    }
    assert_eq!(rows.as_array().map(Vec::len), Some(3));
}

#[test]
fn what_only_the_convergence_has_is_refused_without_it() {
    lab(&["check", "--robot", "rigid"]).fails(2, &["--convergence", "--searches"]);
    lab(&["check", "--convergence", "--engine", "fake"]).fails(2, &["fake"]);
    lab(&["check", "--convergence", "--robot", "nobody"]).fails(2, &["nobody", "servo"]);
    lab(&["check", "--convergence", "--robot", "ur5e", "--engine", "rapier"])
        .fails(2, &["--engine direct"]);
}
