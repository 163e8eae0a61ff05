//! Does an outcome stay when nothing that matters changes?

mod common;

use common::optimize;

/// Window of -3.33 to 1.40 mm; friction moves its lower end by a tenth.
const CLOSED_FORM: [&str; 8] = [
    "--task",
    "usb",
    "--engine",
    "fake",
    "--stiffness-compliance",
    "3",
    "--stiffness-assembly",
    "20",
];

#[test]
fn windows_on_half_the_step_are_the_same() {
    let rows = optimize(&["check", "--convergence", "--task", "rj45", "--json"]).json();
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

/// Not with the softest finger: its positive end is not firm (docs/simulation.md, "The step").
#[test]
fn windows_of_the_stiffer_fingers_on_usb_are_the_same_on_half_the_step() {
    let ran = optimize(&["check", "--convergence", "--task", "usb", "--json"]);
    let rows: serde_json::Value = serde_json::from_str(&ran.stdout).expect("JSON");
    let stiffer: Vec<&serde_json::Value> = rows
        .as_array()
        .expect("an array")
        .iter()
        .filter(|row| row["stiffness_compliance_n_per_mm"].as_f64() > Some(1.5))
        .collect();
    assert_eq!(stiffer.len(), 2);
    assert!(stiffer.iter().all(|row| row["passed"] == true), "{rows}");
}

#[test]
fn repeats_inside_a_window_all_insert_and_at_its_end_they_part() {
    let repeats = |offset| {
        let trial = ["trial", "--repeat", "40", "--json", "--offset-mm", offset];
        optimize(&[&trial[..], &CLOSED_FORM].concat()).json()["repeats"].clone()
    };
    assert_eq!(repeats("-2"), serde_json::json!({"inserted": 40}));
    let at_the_end = repeats("-3.3");
    let count = |outcome: &str| at_the_end[outcome].as_u64().unwrap_or(0);
    assert!(count("inserted") > 5 && count("failed: jammed") > 5, "{at_the_end}");
    assert_eq!(count("inserted") + count("failed: jammed"), 40);
}

#[test]
fn an_evaluation_gives_the_widths_of_the_unsure_bands() {
    let evaluate = ["evaluate", "--repeat", "100"];
    let json = optimize(&[&evaluate[..], &["--json"], &CLOSED_FORM].concat()).json();
    let width = |side: &str| json["bands"][side].as_f64().expect("a width");
    assert!((0.4..=0.7).contains(&width("negative_band_mm")), "{json}");
    assert!((0.0..=0.1).contains(&width("positive_band_mm")), "{json}");
    assert_eq!(json["bands"]["unsure_inside_mm"], serde_json::json!([]));
    let text = optimize(&[&evaluate[..], &CLOSED_FORM].concat());
    assert!(text.succeeds().contains("unsure bands"), "{}", text.stdout);
}

#[test]
fn the_quick_search_finds_the_ends_of_the_walk() {
    let check = ["check", "--searches", "--task", "ket8", "--json"];
    let rows = optimize(&check).json();
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
    optimize(&["check", "--robot", "rigid"]).fails(2, &["--convergence", "--searches"]);
    optimize(&["check", "--convergence", "--engine", "fake"]).fails(2, &["fake"]);
    optimize(&["check", "--convergence", "--robot", "nobody"]).fails(2, &["nobody", "servo"]);
    optimize(&["check", "--convergence", "--robot", "ur5e", "--engine", "rapier"])
        .fails(2, &["--engine direct"]);
}
