//! The commands that bring bench and simulation together, on the fake engine.

mod common;

use common::{Studies, optimize, read};

#[test]
fn measurements_are_added_checked_and_refused() {
    let folder = Studies::new();
    let path = folder.dir("bench.csv");
    let file = path.to_str().expect("a path in UTF-8");
    let add = |more: &[&str]| {
        optimize(&[&["measure", "add", file, "--task", "ket8", "--density", "20"], more].concat())
    };
    add(&["--direction", "0", "--range-mm", "5.7"]).succeeds();
    add(&["--direction", "10", "--negative-mm", "-1.5", "--failure-negative", "3"]).succeeds();
    let before = read(&path);
    add(&["--direction", "0", "--range-mm", "5.8"]).fails(2, &["line 4: task: ", "line 2"]);
    add(&["--direction", "0.35", "--range-mm", "5.8"]).fails(2, &["degrees, as in 20"]);
    assert_eq!(read(&path), before);
    let checked = optimize(&["measure", "check", file, "--json"]).json();
    assert_eq!((&checked["lines"], &checked["tasks"][0]["bounds"]), (&2.into(), &1.into()));
    std::fs::write(&path, before.replace("ket8", "ket80")).expect("the file is written");
    optimize(&["measure", "check", file]).fails(2, &["line 2: task: ", "did you mean `ket8`"]);
    assert_eq!(optimize(&["measure", "check", "published", "--json"]).json()["lines"], 44);
}

#[test]
fn calibration_and_the_next_print_answer_in_the_agreed_form() {
    let few = ["--task", "ket8", "--engine", "fake", "--simulations", "24", "--samples", "20"];
    let run = |command: &str, more: &[&str]| {
        optimize(&[&[command], &few[..], &["--json"], more].concat()).json()
    };
    let found = run("calibrate", &["--measurements", "published"]);
    let task = &found["tasks"][0];
    assert_eq!((&task["task"], &task["designs"]), (&"ket8".into(), &11.into()));
    for key in ["loo_mean_deviation_percent", "loo_spearman", "loo_coverage_80_percent"] {
        assert!(task[key].is_number(), "{key}: {}", task[key]);
    }
    let predictions = task["predictions"].as_array().expect("a list");
    assert_eq!(predictions.len(), 21 * 41);
    let best: f64 = predictions.iter().filter_map(|p| p["probability_best"].as_f64()).sum();
    assert!((best - 1.0).abs() < 1e-9, "{best}");
    assert!(found["parameters"][0]["moved"].is_boolean());
    let folder = Studies::new();
    let empty = folder.dir("empty.csv");
    std::fs::write(&empty, "").expect("the file is written");
    let empty = empty.to_str().expect("a path in UTF-8");
    let next = run("next", &["--measurements", empty, "--count", "2", "--among", "published"]);
    assert_eq!((next["next"].as_array().map(Vec::len), &next["stop"]), (Some(2), &false.into()));
    assert!(next["next"][0]["reason"].as_str().is_some_and(|reason| !reason.is_empty()));
    assert!(next["next"][0]["expected_gain_mm"].as_f64().is_some_and(|gain| gain > 0.0));
}
