//! `optimize identify`: hidden numbers, found again from the logs of their attempts.

use crate::common::{FRICTION, Studies, logged, optimize_line};
use serde_json::Value;

/// A prior of the flange's stiffness.
const FLANGE: &str = "[[parameter]]\nname = \"flange\"\nsets = \"robot.stiffness_n_per_mm\"\n\
    as = \"factor\"\nscale = \"log\"\nlow = 0.4\nhigh = 10.0\nshared = true\nsource = \"made up\"\n";

/// Twice as stiff as the robot `servo`, N/mm.
const STIFF: [f64; 3] = [20.0, 20.0, 40.0];

/// Logs two fingers' probes and attempts from three starts each, and their table; gives its path.
fn hidden(folder: &Studies) -> String {
    let servo = include_str!("../robots/servo.toml");
    let stiff = servo.replace("[10.0, 10.0, 20.0]", &format!("{STIFF:?}"));
    assert_ne!(stiff, servo);
    let robot = folder.file("stiff.toml", stiff);
    let more = format!("--robot {robot} --set task.friction.plug_socket=0.3");
    let runs = logged(folder, "", [[10, 0], [30, 0]], ["-2", "0", "2", ""], &more);
    folder.file("runs.csv", runs)
}

#[test]
fn what_was_hidden_is_found_and_goes_into_every_command() {
    let folder = Studies::new();
    let runs = hidden(&folder);
    let priors = folder.file("few.toml", FRICTION.to_owned() + FLANGE);
    let (cell, again) = (folder.word("cell.toml"), folder.word("again.toml"));
    let identify = format!("identify --task usb --runs {runs} --priors {priors} --json --out");
    let found = optimize_line(&format!("{identify} {cell}")).json();
    for (axis, stiff) in ["x", "y", "z"].into_iter().zip(STIFF) {
        let is = found["robot"][axis]["stiffness_n_per_mm"].as_f64().unwrap();
        assert!((is / stiff - 1.0).abs() < 0.1, "{axis}: {is} for {stiff}");
    }
    let friction =
        found["unknowns"].as_array().unwrap().iter().find(|one| one["name"] == "friction");
    let friction = friction.unwrap();
    let value = friction["value"].as_f64().unwrap();
    assert!((value / 0.3 - 1.0).abs() < 0.1 && friction["from"] == "formula", "{friction}");

    assert_eq!(optimize_line(&format!("{identify} {again} --seed 0")).json(), found);
    assert_eq!(folder.read("again.toml"), folder.read("cell.toml"));

    let trial = format!("trial --task usb --density 20 --direction 10 --json --cell {cell}");
    let with = optimize_line(&trial).json();
    assert_eq!(with["cell"], "cell");
    optimize_line(&format!("{trial} --robot servo")).fails(2, &["--cell contains a robot"]);
}

/// The text of a log with the columns of these names multiplied.
fn scaled(log: &str, names: &[&str], by: f64) -> String {
    let (header, rows) = log.split_once('\n').unwrap();
    let columns: Vec<&str> = header.split(',').collect();
    let row = |line: &str| {
        let cells = columns.iter().zip(line.split(',')).map(|(name, cell)| {
            let value: f64 = cell.parse().unwrap();
            (if names.contains(name) { by * value } else { value }).to_string()
        });
        cells.collect::<Vec<_>>().join(",")
    };
    let rows: Vec<String> = rows.lines().map(row).collect();
    format!("{header}\n{}\n", rows.join("\n"))
}

#[test]
fn a_fault_of_the_columns_is_a_remark_and_logs_that_tell_nothing_are_an_error() {
    let folder = Studies::new();
    hidden(&folder);
    let log = folder.read("30-1.csv");
    let header = "log,infill_density_percent,infill_direction_deg,offset_mm,outcome";
    let runs = folder.file("one.csv", format!("{header}\na.csv,30,0,0,inserted\n"));
    let priors = folder.file("one.toml", FRICTION);
    let (cell, page) = (folder.word("cell.toml"), folder.word("page.html"));
    let identify = format!("identify --task usb --runs {runs} --priors {priors} --robot servo");
    let forces = ["fx_n", "fy_n", "fz_n"];
    folder.file("a.csv", scaled(&log, &["target_x_mm", "target_y_mm", "target_z_mm"], 1e-3));
    let cause = "the commanded positions look like metres";
    let found = optimize_line(&format!("{identify} --json")).json();
    let of = |remark: &Value| remark["serious"] == true && remark.to_string().contains(cause);
    assert!(found["remarks"].as_array().unwrap().iter().any(of), "{found}");
    optimize_line(&identify).says_in_any_lines(cause);
    let refused = |code: i32, words: &[&str]| {
        optimize_line(&format!("{identify} --out {cell} --report {page}")).fails(code, words);
        assert!(!folder.dir("cell.toml").exists() && !folder.dir("page.html").exists());
    };
    for (by, cause) in [(-1.0, "`force_sign`"), (1.0 / 9.80665, "another unit than newtons")] {
        folder.file("a.csv", scaled(&log, &forces, by));
        refused(1, &["these logs determine no parameter of the cell", cause]);
    }
    let (most, _) = log.rsplit_once(',').unwrap();
    folder.file("a.csv", format!("{most},NaN\n"));
    let line = format!("a.csv: line {}: ", log.lines().count());
    refused(2, &[&line, "`NaN` is not a finite number"]);
}
