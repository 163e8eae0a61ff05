//! Windows under half the step and under another search.

mod common;

use common::lab;

#[test]
fn windows_on_half_the_step_are_the_same() {
    let rows = lab(&["check", "--convergence", "--task", "rj45", "--json"]).json();
    let rows = rows.as_array().expect("an array");
    assert_eq!(rows.len(), 3);
    for row in rows {
        assert_eq!(row["passed"], true, "{row}");
        assert!(row["production"]["positive_mm"].as_f64() > Some(2.0), "{row}");
    }
    let stiffness: Vec<f64> =
        rows.iter().filter_map(|row| row["stiffness_compliance_n_per_mm"].as_f64()).collect();
    assert!(stiffness.len() == 3 && stiffness.is_sorted(), "{stiffness:?}");
}

/// Not with the softest finger: its positive end is not firm (docs/notes/simulation.md, "The step").
#[test]
fn windows_of_the_stiffer_fingers_on_usb_are_the_same_on_half_the_step() {
    let ran = lab(&["check", "--convergence", "--task", "usb", "--json"]);
    let rows: serde_json::Value = serde_json::from_str(&ran.stdout).expect("JSON");
    let mut stiffer = rows.as_array().expect("an array").clone();
    stiffer.retain(|row| row["stiffness_compliance_n_per_mm"].as_f64() > Some(1.5));
    assert_eq!(stiffer.len(), 2);
    assert!(stiffer.iter().all(|row| row["passed"] == true), "{rows}");
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
