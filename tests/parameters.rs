//! Paths of numbers in cells: those that a task lacks are refused, all others can be rows.

use crate::common::{Studies, fake, optimize_line};

const CELL: &str = include_str!("fixtures/v0.5.0/cell.toml");
const EVALUATE: &str = "evaluate --task usb --density 20 --direction 10";
const CALIBRATE: &str = "calibrate --task usb --measurements published --simulations 20 --no-cache";

fn changed(text: &str, [from, to]: [&str; 2]) -> String {
    assert!(text.contains(from), "{from}");
    text.replace(from, to)
}

/// A path that other tasks may have, but not that of the cell.
#[test]
fn a_cell_of_a_task_sets_nothing_that_its_task_does_not_have() {
    let studies = Studies::new();
    let phase = ["phase.touch.preload_mm", "phase.tuoch.preload_mm"];
    let near = "did you mean `task.strategy.phase.touch.preload_mm`?";
    let file = studies.file("phase.toml", changed(CELL, phase));
    for option in ["--cell", "--uncertainty"] {
        fake(&format!("{EVALUATE} {option} {file}")).fails(2, &["phase.toml: preload", near]);
    }
    fake(&format!("{CALIBRATE} --priors {file}")).fails(2, &["phase.toml: preload", near]);
    // Rows of another task are left alone.
    let ket8 = EVALUATE.replace("usb", "ket8");
    fake(&format!("{ket8} --cell {file}")).succeeds();
}

/// Springs of the finger and numbers of the robot vary by a row alone, as those of files do.
#[test]
fn every_number_of_finger_and_robot_can_be_a_row_of_a_cell() {
    let studies = Studies::new();
    let row = |path: &str, transform: &str, low: f64, high: f64| {
        format!(
            "\n[[parameter]]\nname = \"added\"\nsets = \"{path}\"\nas = \"{transform}\"\nscale = \"linear\"\n\
             value = {high:?}\nsd = 0.1\nlow = {low:?}\nhigh = {high:?}\nshared = true\nsource = \"test\"\n"
        )
    };
    let trial = |name: &str, row: String| {
        let file = studies.file(name, format!("{CELL}{row}"));
        let trial = EVALUATE.replace("evaluate", "trial");
        optimize_line(&format!("{trial} --cell {file} --json"))
    };
    let force = |text: String| trial("cell.toml", text).json()["peak_force_n"].as_f64().unwrap();
    let own = force(String::new());
    for (path, transform, low, high) in [
        ("finger.mass_g", "value", 1.0, 200.0),
        ("robot.mass_kg", "factor", 0.5, 4.0),
        ("robot.damping_ratio", "value", 0.5, 4.0),
    ] {
        assert_ne!(force(row(path, transform, low, high)), own, "{path}");
    }
    trial("shift.toml", row("finger.mass_g", "shift", 1.0, 2.0)).fails(2, &["stays above 0"]);
    trial("low.toml", row("finger.mass_g", "value", -1.0, 2.0)).fails(2, &["must lie in 1e-9"]);
    trial("error.toml", row("cell.clearance_mm", "shift", 0.1, 0.2))
        .fails(2, &["`cell.clearance_mm` cannot be set by a cell"]);
}
