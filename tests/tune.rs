//! A start and a strategy by which a connector inserts, as a user looks for them.

use crate::common::{Studies, optimize, optimize_line};
use connector::tune::{Effort, Stage, Tuner, tune};
use finger_opt::setup::files::robot;
use insertion::task::Task;
use insertion::trial::engine::EngineKind;
use serde_json::Value;
use std::fs::read_to_string;
use std::sync::atomic::{AtomicBool, Ordering};

const KET8: &str = include_str!("../tasks/ket8.toml");

/// ket8 tilted by 14 degrees, its start 3 mm too far to one side: no finger inserts.
fn off() -> String {
    let text = KET8.replacen("tilt_deg = 5.0", "tilt_deg = 14.0 # steep", 1);
    let off = text.replace("start_mm = [-1.03, -0.08, 51.0]", "start_mm = [-1.03, -4.0, 51.0]");
    assert!(off.contains("# steep") && off.contains("-4.0, 51.0"));
    off
}

fn json(arguments: &[&str], code: i32) -> Value {
    let ran = optimize(&[&["task"], arguments, &["--json"]].concat());
    assert_eq!(ran.code, Some(code), "{}", ran.stderr);
    serde_json::from_str(&ran.stdout).unwrap()
}

#[test]
fn a_strategy_is_found_written_with_what_it_was_and_inserts() {
    let folder = Studies::new();
    let (own, svg) = (folder.file("own.toml", off()), folder.word("own.svg"));
    let checked = json(&["check", &own], 2);
    assert!(checked["mended_by"]["least_range_mm"].as_f64().unwrap() > 0.0, "{checked}");
    let done = json(&["tune", &own, "--svg", &svg, "--budget", "60"], 0);
    assert_eq!(done["inserts"], true);
    assert!(done["windows"].as_u64().unwrap() <= 60);
    assert_eq!(done["kept"].as_array().unwrap().len(), 5);
    let least = |state: &Value| {
        let ranges = state["fingers"].as_array().unwrap().iter();
        ranges.map(|finger| finger["range_mm"].as_f64().unwrap()).fold(f64::INFINITY, f64::min)
    };
    // The published strategy has 4.7 mm; half a millimetre less is allowed.
    assert_eq!(least(&done["before"]), 0.0);
    assert!(least(&done["after"]) >= 4.2, "{done}");
    let written = read_to_string(&own).unwrap();
    let task = Task::parse(&written, "own.toml").unwrap();
    assert!(written.contains("# steep; was 14.0"), "{written}");
    assert!((task.strategy.start[1] + 4e-3).abs() > 1e-3, "{written}");
    assert!(read_to_string(&svg).unwrap().contains("after: steel key"));
    let checked = json(&["check", &own], 0);
    assert_eq!(checked["nominal"]["outcome"], "inserted");
    assert_eq!(checked["mended_by"], Value::Null);
}

#[test]
fn where_nothing_inserts_it_is_said_with_what_stopped_the_plug() {
    let folder = Studies::new();
    let weak = KET8.replace("force_n = 5.0", "force_n = 0.05");
    let own = folder.file("own.toml", &weak);
    let found = json(&["tune", &own], 1);
    assert_eq!((&found["inserts"], &found["after"]), (&Value::Bool(false), &Value::Null));
    assert_eq!(found["nearest"]["outcome"], "contact loss before insertion");
    assert!(found["nearest"]["phase"].is_string(), "{found}");
    assert_eq!(read_to_string(&own).unwrap(), weak, "a file is written");
    optimize(&["task", "check", "usb"]).says(&["in this trial peak force "]);
    optimize(&["task", "tune", &own, "--out", &own]).fails(2, &["own.toml exists"]);
    optimize(&["task", "tune", "usb"]).fails(2, &["name the file to write with --out"]);
}

#[test]
fn a_tuned_copy_is_named_after_its_file() {
    let folder = Studies::new();
    let (usb, out) = (folder.file("mine.toml", include_str!("../tasks/usb.toml")), "usb v2.toml");
    let tuned = |out: &str| {
        optimize(&["task", "tune", &usb, "--engine", "fake", "--out", &folder.word(out)])
    };
    tuned(out).succeeds();
    assert_eq!(Task::parse(&folder.read(out), out).unwrap().name, "usb_v2");
    std::fs::create_dir(folder.dir("sub")).unwrap();
    tuned("sub/mine.toml").succeeds();
    assert_eq!(Task::parse(&folder.read("sub/mine.toml"), "mine.toml").unwrap().name, "usb");
}

#[test]
fn an_interrupt_leaves_what_was_tried_until_then() {
    let task = Task::parse(&off(), "own.toml").unwrap();
    let (robot, stop) = (robot("servo").unwrap(), AtomicBool::new(false));
    let tuner = Tuner::new(&task, &robot, EngineKind::Direct, &stop);
    let quiet = |_: &str, _, _, _| ();
    let effort =
        |last, progress| Effort { last, until_enough: false, budget: 150, seed: 0, progress };
    let whole = tune(&tuner, &effort(Stage::Families, &quiet)).unwrap();
    // In the middle of the search, whose first candidates have been told by then.
    let stop_in_search = |_: &str, _, windows, _| {
        stop.store(windows > whole.windows, Ordering::SeqCst);
    };
    let cut = tune(&tuner, &effort(Stage::Search, &stop_in_search)).unwrap();
    assert_eq!(cut.steps[..whole.steps.len()], whole.steps);
    assert!(cut.inserts() && cut.best > 0, "{:?}", cut.best());
    assert_eq!(cut.robustness, []);
    let costs: usize = cut.steps.iter().map(|step| step.tried.cost).sum();
    assert_eq!(cut.windows, costs);
}

#[test]
fn a_budget_limits_the_search_but_not_the_stages_before_it() {
    let tuned = |budget: &str| {
        let given = ["tune", "usb", "--engine", "fake", "--dry-run", "--budget", budget];
        let found = json(&given, 0);
        let steps = found["steps"].as_array().unwrap().iter();
        let of = |stage: &str| steps.clone().filter(|step| step["stage"] == stage).count();
        (found["windows"].as_u64().unwrap(), of("families"), of("search"))
    };
    let ((_, before, none), (windows, families, searched)) = (tuned("60"), tuned("100"));
    assert_eq!((none, before), (0, families));
    assert!(before > 0 && searched > 0 && windows <= 100, "{searched} in {windows}");
    let least = "task tune usb --engine fake --dry-run --budget 60";
    optimize_line(least).says(&["\nsearch        not started"]);
    optimize_line("task tune -h").says(&["at least 60"]);
}
