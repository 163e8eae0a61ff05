//! `optimize identify`: hidden numbers, found again from the logs of their attempts.

mod common;

use common::{Studies, optimize_line};
use input::shipped::ROBOTS;
use serde_json::Value;

/// Priors of two numbers, so that few replays are enough.
const FEW: &str = "name = \"few\"\ndescription = \"of a test\"\n\
    [[parameter]]\nname = \"friction\"\nsets = \"task.friction.plug_socket\"\nas = \"factor\"\n\
    scale = \"log\"\nlow = 0.5\nhigh = 2.0\nshared = false\nsource = \"made up\"\n\
    [[parameter]]\nname = \"flange\"\nsets = \"robot.stiffness_n_per_mm\"\nas = \"factor\"\n\
    scale = \"log\"\nlow = 0.4\nhigh = 10.0\nshared = true\nsource = \"made up\"\n";

/// Twice as stiff as the robot `servo`, N/mm.
const STIFF: [f64; 3] = [20.0, 20.0, 40.0];

/// Logs two fingers' probes and attempts from three starts each, and their table; gives its path.
fn logged(folder: &Studies) -> String {
    let servo = ROBOTS.iter().find(|robot| robot.name == "servo").unwrap().text;
    let stiff = servo.replace("[10.0, 10.0, 20.0]", &format!("{STIFF:?}"));
    assert_ne!(stiff, servo);
    let robot = folder.file("stiff.toml", stiff);
    let mut runs = "log,infill_density_percent,infill_direction_deg,offset_mm,outcome\n".to_owned();
    for density in [10, 30] {
        for (i, offset) in ["-2", "0", "2", ""].into_iter().enumerate() {
            let name = format!("{density}-{i}.csv");
            let what =
                if offset.is_empty() { "--probe".into() } else { format!("--offset-mm {offset}") };
            let line = format!(
                "trial --task usb --density {density} --direction 0 --robot {robot} {what} --json \
                 --set task.friction.plug_socket=0.3 --log {}",
                folder.word(&name)
            );
            let found = optimize_line(&line).json();
            let outcome = match (offset, &found["failure"]) {
                ("", _) => "probe".to_owned(),
                (_, Value::Null) => "inserted".to_owned(),
                (_, class) => class.to_string(),
            };
            runs += &format!("{name},{density},0,{offset},{outcome}\n");
        }
    }
    folder.file("runs.csv", runs)
}

#[test]
fn what_was_hidden_is_found_and_goes_into_every_command() {
    let folder = Studies::new();
    let runs = logged(&folder);
    let priors = folder.file("few.toml", FEW);
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

    let evaluate = format!("evaluate --task usb --density 20 --direction 10 --json --cell {cell}");
    let with = optimize_line(&evaluate).json();
    assert_eq!(with["cell"], "cell");
    optimize_line(&format!("{evaluate} --robot servo")).fails(2, &["--cell holds a robot"]);
}

#[test]
fn a_bad_log_is_named_and_nothing_is_written() {
    let folder = Studies::new();
    let runs = logged(&folder);
    let bad = folder.read("30-1.csv");
    let line = bad.lines().nth(99).unwrap();
    let (most, _) = line.rsplit_once(',').unwrap();
    folder.file("30-1.csv", bad.replace(line, &format!("{most},NaN")));
    let (cell, page) = (folder.word("cell.toml"), folder.word("page.html"));
    let identify = format!("identify --task usb --runs {runs} --out {cell} --report {page}");
    optimize_line(&identify).fails(2, &["30-1.csv: line 100: target_z_mm", "is no finite number"]);
    assert!(!folder.dir("cell.toml").exists() && !folder.dir("page.html").exists());
}

/// A fault of a log: scales columns, or swaps two.
enum Fault {
    Scaled(&'static [&'static str], f64),
    Swapped([&'static str; 2]),
}

impl Fault {
    /// The text of a log with this fault.
    fn of(&self, log: &str) -> String {
        let header = log.lines().next().unwrap();
        let place = |name: &str| header.split(',').position(|other| other == name).unwrap();
        let line = |line: &str| {
            let mut cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            match self {
                Fault::Scaled(names, by) => names.iter().for_each(|name| cells[place(name)] *= by),
                Fault::Swapped([a, b]) => cells.swap(place(a), place(b)),
            }
            cells.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
        };
        let lines: Vec<String> = log.lines().skip(1).map(line).collect();
        format!("{header}\n{}\n", lines.join("\n"))
    }
}

#[test]
fn each_fault_of_the_columns_draws_its_own_remark() {
    let folder = Studies::new();
    logged(&folder);
    let runs = folder.read("runs.csv");
    // One finger is enough, and so is one unknown.
    let few: Vec<&str> = runs.lines().filter(|line| !line.starts_with("30-")).collect();
    let table = folder.file("few.csv", few.join("\n"));
    let (head, _) = FEW.rsplit_once("[[parameter]]").unwrap();
    let priors = folder.file("one.toml", head);
    let identify = format!("identify --task usb --runs {table} --priors {priors}");
    let remarks = || {
        let found = optimize_line(&format!("{identify} --json")).json();
        let all: Vec<Value> = found["remarks"].as_array().unwrap().clone();
        all.iter().map(|one| format!("{} {}\n", one["serious"], one["text"])).collect::<String>()
    };
    let names = few[1..].iter().map(|line| line.split(',').next().unwrap());
    let logs: Vec<(&str, String)> = names.map(|name| (name, folder.read(name))).collect();
    assert_eq!(remarks(), "");
    let (forces, targets) =
        (&["fx_n", "fy_n", "fz_n"], &["target_x_mm", "target_y_mm", "target_z_mm"]);
    for (fault, words) in [
        (Fault::Scaled(forces, 1.0 / 9.80665), "the forces look too small, "),
        (Fault::Scaled(forces, 10.0), "the forces look too large, "),
        (Fault::Scaled(&["fy_n"], -1.0), "y_mm or fy_n is mirrored"),
        (Fault::Scaled(targets, 1e-3), "they look like metres; give millimetres"),
        (Fault::Scaled(&["y_mm", "target_y_mm"], -1.0), "y looks mirrored"),
        (Fault::Swapped(["fx_n", "fy_n"]), "fy_n is mirrored, or swapped"),
        (Fault::Swapped(["x_mm", "y_mm"]), "two columns look swapped"),
    ] {
        for (name, log) in &logs {
            folder.file(name, fault.of(log));
        }
        let found = remarks();
        let said = found.lines().any(|line| line.starts_with("true") && line.contains(words));
        assert!(said, "{words}: {found}");
    }
    // The text says the same as JSON.
    let text = optimize_line(&identify);
    let text = text.succeeds().split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("measured along y: two columns look swapped"), "{text}");

    // Upside down, nothing touches: nothing is learnt, and no cell is written.
    for (name, log) in logs.iter().filter(|(name, _)| !name.ends_with("-3.csv")) {
        folder.file(name, Fault::Scaled(forces, -1.0).of(log));
    }
    let attempts: Vec<&str> = few.iter().copied().filter(|line| !line.contains("probe")).collect();
    folder.file("few.csv", attempts.join("\n"));
    let cell = folder.word("cell.toml");
    optimize_line(&format!("{identify} --out {cell}"))
        .fails(1, &["these logs tell nothing of the cell; no cell is written", "`force_sign`"]);
    assert!(!folder.dir("cell.toml").exists());
}
