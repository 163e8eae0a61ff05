//! `lab validate`: output, files and errors on the fake engine; windows of the real one.

mod common;

use common::{lab, read};

fn validate(more: &[&str], out: &std::path::Path) -> common::Ran {
    let out = out.to_str().expect("a path in UTF-8");
    lab(&[&["validate", "--engine", "fake", "--out", out], more].concat())
}

#[test]
fn all_tasks_are_compared_and_written() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path().join("all");
    let ran = validate(&[], &dir);
    ran.says(&["ket8", "ket12", "rj45", "usb", "27.3", "54.5", "100.0", "- bench |"]);
    let fits = |line: &str| line.starts_with("tables are in") || line.chars().count() <= 100;
    assert!(ran.stdout.lines().all(fits), "{}", ran.stdout);
    let csv = read(&dir.join("validation.csv"));
    assert!(csv.starts_with("task,design,infill_density_percent,infill_direction_deg,"));
    assert_eq!(csv.lines().count(), 45);
    assert_eq!(read(&dir.join("accuracy.md")).lines().count(), 6);
}

#[test]
fn one_task_has_a_table_that_threads_do_not_change() {
    let folder = tempfile::tempdir().unwrap();
    let table = |name: &str, threads: &str| {
        let out = folder.path().join(name);
        let mut command =
            common::command(&["validate", "--engine", "fake", "--task", "usb", "--out"]);
        let ran = common::run(command.arg(&out).env("RAYON_NUM_THREADS", threads));
        ran.says(&["engine fake, walk", "usb"]);
        read(&out.join("validation.csv"))
    };
    let found = table("one", "1");
    assert_eq!(found.lines().count(), 1 + 11);
    // The measured stiffness, not the surrogate's.
    assert!(found.contains("\nusb,5,20,20,45,2.6,inserted,"), "{found}");
    assert_eq!(table("eight", "8"), found);
}

#[test]
fn a_task_that_is_not_published_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    validate(&["--task", "rj54"], &folder.path().join("a"))
        .fails(2, &["rj54", "did you mean `rj45`"]);
    let mine = folder.path().join("mine.toml");
    let text = std::fs::read_to_string("../tasks/usb.toml").unwrap();
    std::fs::write(&mine, text.replacen("name = \"usb\"", "name = \"mine\"", 1)).unwrap();
    let mine = mine.to_str().unwrap();
    validate(&["--task", mine], &folder.path().join("b"))
        .fails(2, &["mine.toml", "has no published windows"]);
}

const REFERENCE: &str = "../results/reference/validation";

/// Windows of three fingers by the real engine; `scripts/reference.sh validation` measures all 44.
#[test]
fn the_windows_are_the_committed_ones() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().expect("a path in UTF-8");
    lab(&["validate", "--fingers", "three", "--out", path]).succeeds();
    let found = read(&folder.path().join("validation.csv"));
    let golden = read(&std::path::Path::new(REFERENCE).join("validation.csv"));
    let golden: Vec<&str> = golden.lines().collect();
    let changed: Vec<&str> = found.lines().filter(|line| !golden.contains(line)).collect();
    assert_eq!(found.lines().count(), 1 + 4 * 3);
    assert!(
        changed.is_empty(),
        "the windows are not those of {REFERENCE}/validation.csv. If physics was changed on \
         purpose: scripts/reference.sh validation, mend docs/notes/calibration.md, and say in the commit what moved them.\n{}",
        changed.join("\n")
    );
}
