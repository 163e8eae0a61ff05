//! `--cell`: a cell's robot and numbers in every command that takes a task.

use crate::common::{Studies, optimize_line};
use serde_json::json;

/// A row of a cell file.
fn row(name: &str, sets: &str, way: &str, numbers: &str, shared: bool) -> String {
    format!(
        "[[parameter]]\nname = \"{name}\"\nsets = \"{sets}\"\nas = \"{way}\"\nscale = \"linear\"\n\
         {numbers}\nshared = {shared}\nsource = \"made up\"\n"
    )
}

/// The file of a cell with the robot `servo` and these rows.
fn cell(rows: &str) -> String {
    let servo = include_str!("../robots/servo.toml");
    format!("name = \"mine\"\ndescription = \"made up\"\ntask = \"usb\"\n[robot]\n{servo}\n{rows}")
}

fn friction(value: f64) -> String {
    let numbers = format!("value = {value}\nsd = 0.02\nlow = 0.05\nhigh = 0.8");
    row("friction", "task.friction.plug_socket", "value", &numbers, false)
}

/// Returns the JSON of a command without the time it took and the cell.
fn printed(line: &str) -> serde_json::Value {
    let mut found = optimize_line(&format!("{line} --json")).json();
    let keys = found.as_object_mut().unwrap();
    for key in ["wall_s", "cell", "cell_applied", "cell_not_applied", "set"] {
        keys.remove(key);
    }
    found
}

const TRIAL: &str = "trial --density 20 --direction 10 --task";

/// A cell identified on one task stays with it, and that is said, in words and in JSON.
#[test]
fn a_cell_of_another_task_says_what_it_leaves_out() {
    let folder = Studies::new();
    let around = "low = 0.5\nhigh = 2.0\nvalue = 1.0\nsd = 0.1";
    let rows = friction(0.4) + &row("modulus", "finger.stiffness", "factor", around, true);
    let file = folder.file("cell.toml", cell(&rows));
    for (task, applied, left_out) in [
        ("usb", json!(["task.friction.plug_socket", "finger.stiffness"]), json!([])),
        ("ket8", json!(["finger.stiffness"]), json!(["task.friction.plug_socket"])),
    ] {
        let line = format!("{TRIAL} {task} --engine fake --cell {file}");
        let found = optimize_line(&format!("{line} --json")).json();
        assert_eq!((&found["cell_applied"], &found["cell_not_applied"]), (&applied, &left_out));
        let said = optimize_line(&line)
            .stdout
            .replace("\n              ", " ")
            .contains("not applied to ket8: task.friction.plug_socket");
        assert_eq!(said, task == "ket8");
        optimize_line(&line).says(&["robot         servo, of the cell `mine`\n"]);
    }
}

#[test]
fn a_nominal_cell_changes_nothing_and_a_row_is_as_if_set() {
    let folder = Studies::new();
    let around = "low = 0.5\nhigh = 2.0\nvalue = 1.0\nsd = 0.1";
    let nominal = [
        friction(0.2),
        row("modulus", "finger.stiffness", "factor", around, true),
        row("centre", "finger.rcc_mm", "factor", around, true),
        row("flange", "robot.stiffness_n_per_mm", "factor", around, true),
        row("gap", "task.clearance_mm", "shift", "low = -0.05\nhigh = 0.05", false),
    ];
    let file = folder.file("cell.toml", cell(&nominal.concat()));
    let evaluate = "evaluate --task usb --density 20 --direction 10";
    let with = format!("{evaluate} --cell {file}");
    assert_eq!(optimize_line(&format!("{with} --engine fake --json")).json()["cell"], "mine");
    assert_eq!(printed(&with), printed(evaluate));

    let rough = folder.file("rough.toml", cell(&friction(0.4)));
    let set = "--set task.friction.plug_socket";
    let (in_cell, as_set) =
        (format!("{TRIAL} usb --cell {rough}"), format!("{TRIAL} usb {set}=0.4"));
    assert_eq!(printed(&in_cell), printed(&as_set));
    assert_ne!(printed(&in_cell), printed(&format!("{TRIAL} usb")));
    let smooth = printed(&format!("{in_cell} {set}=0.3"));
    assert_eq!(smooth, printed(&format!("{TRIAL} usb {set}=0.3")));
    // A row that is usb's alone.
    assert_eq!(printed(&format!("{TRIAL} ket8 --cell {rough}")), printed(&format!("{TRIAL} ket8")));
}

#[test]
fn what_does_not_go_with_a_cell_is_named() {
    let folder = Studies::new();
    let file = folder.file("cell.toml", cell(&friction(0.3)));
    let bare = folder.file("bare.toml", "name = \"a\"\ndescription = \"b\"\nparameter = []\n");
    for (more, parts) in [
        (format!("--cell {file} --robot rigid"), ["--cell contains a robot", "--robot"]),
        (format!("--cell {bare}"), ["bare.toml: robot: missing", "[robot]"]),
        ("--cell none.toml".to_owned(), ["none.toml", "cannot read the cell"]),
    ] {
        optimize_line(&format!("{TRIAL} usb --engine fake {more}")).fails(2, &parts);
    }
    let few = "--task usb --engine fake --measurements published --simulations 24 --samples 20";
    let calibrate = format!("calibrate {few} --json --no-cache --priors {file}");
    optimize_line(&format!("{calibrate} --robot servo")).fails(2, &["--priors contains a robot"]);
    optimize_line(&format!("{calibrate} --cell {file}")).fails(2, &["--priors and --cell both"]);
}

#[test]
fn a_study_in_a_cell_goes_on_from_its_copy() {
    let folder = Studies::new();
    let file = folder.file("cell.toml", cell(&friction(0.3)));
    folder.study("s", 4, &["--cell", &file]).succeeds();
    assert_eq!(folder.read("s/inputs/cell.toml"), folder.read("cell.toml"));
    folder.file("cell.toml", cell(&friction(0.35)));
    folder.study("s", 8, &["--cell", &file]).fails(2, &["input_sha256.cell"]);
    folder.resume("s").succeeds();
    let page = folder.read("s/report.html");
    assert!(page.contains("--cell inputs/cell"), "{page}");
}

#[test]
fn each_draw_under_a_cell_is_another_cell() {
    let folder = Studies::new();
    let modulus = |sd: f64| {
        let numbers = format!("value = 1.0\nsd = {sd}\nlow = 0.2\nhigh = 5.0");
        row("modulus", "finger.stiffness", "factor", &numbers, true)
    };
    let line = "evaluate --task usb --density 20 --direction 10 --engine fake --json";
    let ranges = |sd: f64| {
        let file = folder.file("cell.toml", cell(&modulus(sd)));
        let found = optimize_line(&format!("{line} --uncertainty {file}")).json();
        assert_eq!(found["success_rate"], 1.0, "every start is the nominal one");
        let ranges = found["robust_ranges_mm"].as_array().unwrap().clone();
        (ranges.iter().filter(|range| **range != found["range_mm"]).count(), ranges.len())
    };
    let (differ, all) = ranges(0.4);
    assert!(differ > all / 2 && all == 12, "{differ} of {all}");
    assert_eq!(ranges(0.0).0, 0);
    let firm_mm = |sd: f64| {
        let file = folder.file("cell.toml", cell(&modulus(sd)));
        let bands =
            optimize_line(&format!("{line} --repeat 6 --cell {file}")).json()["bands"].take();
        let [from, to] = ["firm_negative_mm", "firm_positive_mm"].map(|key| bands[key].as_f64());
        to.unwrap() - from.unwrap()
    };
    assert!(firm_mm(0.4) < firm_mm(0.0) - 0.15, "{} and {}", firm_mm(0.4), firm_mm(0.0));
    // The faces are 12.4 mm apart.
    let numbers = "value = 0.0\nsd = 20.0\nlow = -5.0\nhigh = 30.0";
    let faces = row("faces", "task.grip.faces_y_mm.0", "shift", numbers, false);
    let repeats = format!("{line} --repeat 12 --cell {}", folder.file("cell.toml", cell(&faces)));
    let bands = optimize_line(&repeats).json()["bands"].take();
    assert!((1..12).contains(&bands["impossible_draws"].as_u64().unwrap()), "{bands}");
    optimize_line(&repeats.replace(" --json", "")).says(&["impossible on this task"]);
    let trial = repeats.replace("evaluate", "trial");
    assert_eq!(optimize_line(&trial).json()["impossible_draws"], bands["impossible_draws"]);
    optimize_line(&trial.replace(" --json", "")).says(&["impossible on this task"]);
}
