//! What version 0.5.0 wrote opens, reports and goes on.

use crate::common::{self, FRICTION, Studies, lines, optimize, optimize_line, read};
use calibration::identify::runs;
use insertion::outcome::Outcome;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use study::StudyRecord;

const FIXTURE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/v0.5.0");

/// All files of a folder, by their path in it.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let of = |path: PathBuf| {
        let text = std::fs::read(&path).expect("a file");
        (path.strip_prefix(folder).expect("below it").to_owned(), text)
    };
    common::files(folder).into_iter().map(of).collect()
}

/// A copy of the fixture.
fn copied() -> Studies {
    let copy = Studies::new();
    for (path, text) in files(Path::new(FIXTURE)) {
        let path = copy.dir("").join(path);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("it is made");
        std::fs::write(path, text).expect("it is copied");
    }
    copy
}

#[test]
fn a_study_opens_with_its_walk_and_its_bench_prediction() {
    let copy = copied();
    let record = StudyRecord::load(&copy.dir("study")).expect("a study");
    assert_eq!(record.evaluations.len(), 12);
    assert_eq!(record.best().map(|best| best.index), Some(4));
    let walked: Vec<u64> = record.walked.iter().map(|walked| walked.recorded.index).collect();
    assert_eq!(walked, [4]);
    assert_eq!(record.firm_values.keys().copied().collect::<Vec<_>>(), [4, 8]);
    let bench = record.on_bench.expect("its prediction");
    assert_eq!((bench.measured, bench.fingers), (11, 861));
    assert_eq!(bench.best[0].design.labelled(), "infill density 14 %, infill direction 31°");
}

#[test]
fn a_report_shows_bench_levers_and_maps_and_leaves_the_rest_as_it_was() {
    let copy = copied();
    copy.report("study").succeeds();
    let page = copy.read("study/report.html");
    for section in ["bench", "levers", "maps", "provenance"] {
        assert!(page.contains(&format!("<section id=\"{section}\"")), "no {section}");
    }
    let found = files(&copy.dir("study"));
    for (path, text) in files(&Path::new(FIXTURE).join("study")) {
        assert_eq!(found.get(&path), Some(&text), "{}", path.display());
    }
    let out = copy.word("finger.dxf");
    optimize(&["export", "finger", &copy.word("study"), "--format", "dxf", "--out", &out])
        .succeeds();
    // What lies beside the journal is of this finger and provenance only.
    copy.file("study/levers.json", copy.read("study/levers.json").replace("14.0", "15.0"));
    copy.report("study").succeeds();
    assert!(!copy.read("study/report.html").contains("<section id=\"levers\""));
}

#[test]
fn resuming_asks_about_the_provenance_and_uses_no_cache_of_another_simulation() {
    let copy = copied();
    let kept = files(&copy.dir("cache"));
    assert_eq!(kept.len(), 3);
    let resume = |more: &[&str]| {
        let (dir, cache) = (copy.word("study"), copy.word("cache"));
        let quick = ["--no-confirm", "--no-levers", "--no-map", "--quiet", "--json"];
        optimize(&[&["resume", &dir, "--cache", &cache], &quick[..], more].concat())
    };
    let parts = ["measured with different settings", "source_sha256", "--accept-changed"];
    resume(&[]).fails(2, &parts);
    resume(&["--accept-changed"]).fails(2, &["all its 12 evaluations are done", "raise --budget"]);
    assert_eq!(copy.journal("study"), common::strip_times(&read_fixture("study/journal.jsonl")));
    // Interrupted before its last evaluation.
    let journal = copy.read("study/journal.jsonl");
    let begun: Vec<&str> = journal.lines().take(2 + 11).collect();
    copy.file("study/journal.jsonl", begun.join("\n") + "\n");
    resume(&[]).fails(2, &parts);
    let found = resume(&["--accept-changed"]).json();
    assert_eq!((&found["evaluations"], &found["cached"]), (&12.into(), &0.into()));
    assert_eq!(found["segments"][0]["provenance"]["program"], "0.5.0");
    assert_eq!(found["segments"][1]["first"], 11);
    assert_eq!(lines(&copy.dir("study/journal.jsonl")), 2 + 12 + 1, "a line for the new segment");
    let now = files(&copy.dir("cache"));
    assert!(kept.iter().all(|(path, text)| now.get(path) == Some(text)) && now.len() > 3);
    copy.report("study").succeeds();
}

fn read_fixture(name: &str) -> String {
    read(&Path::new(FIXTURE).join(name))
}

#[test]
fn every_command_reads_a_cell() {
    let copy = copied();
    let (cell, out) = (copy.word("cell.toml"), copy.word("out.xml"));
    let infill = "--density 20 --direction 10";
    let bench = "--no-cache --measurements published --simulations 16 --samples 20";
    let fake = "--engine fake";
    let (runs, few) = (copy.word("robot/runs.csv"), copy.file("few.toml", FRICTION));
    for line in [
        format!("evaluate {infill} {fake} --json --cell"),
        format!("evaluate {infill} {fake} --json --uncertainty"),
        format!("trial {infill} {fake} --json --cell"),
        format!("map {infill} {fake} --json --cell"),
        format!("levers {infill} {fake} --json --cell"),
        format!("sensitivity --samples 4 {fake} --json --cell"),
        format!("calibrate {bench} {fake} --json --cell"),
        format!("calibrate {bench} {fake} --json --priors"),
        format!("next {bench} {fake} --json --cell"),
        format!("next {bench} {fake} --json --priors"),
        format!("export mjcf {infill} --out {out} --cell"),
        // Few numbers: eleven take a minute.
        format!("identify --task ket8 --runs {runs} --priors {few} --cell"),
        format!("--budget 4 --no-cache {fake} --quiet --out {} --cell", copy.word("s")),
    ] {
        let task = if line.contains("--task") { "" } else { "--task usb" };
        optimize_line(&format!("{line} {cell} {task}")).succeeds();
    }
    // With its friction of 0.29 for 0.2, and its softer flange, the peak force is another.
    let trial = |more: &str| {
        optimize_line(&format!("trial --task usb {infill} --json {more}")).json()["peak_force_n"]
            .clone()
    };
    assert_ne!(trial(&format!("--cell {cell}")), trial(""));
}

#[test]
fn measurements_and_logs_are_read() {
    let copy = copied();
    let bench = copy.word("bench.csv");
    optimize_line(&format!("measure check {bench}")).says(&["1 line, no problems found"]);
    let few = "--task ket8 --engine fake --no-cache --simulations 16 --samples 20 --json";
    let of = |name: &str| optimize_line(&format!("{name} {few} --measurements {bench}")).json();
    assert_eq!(of("calibrate")["tasks"][0]["leave_one_out"][0]["measured_mm"], 4.0);
    assert_eq!(of("next")["measured"], 1);
    let runs = runs::read(&copy.dir("robot/runs.csv"), None, calibration::identify::read::text)
        .expect("a table of logs");
    assert_eq!((runs.len(), runs[0].outcome, runs[0].offset), (1, Some(Outcome::Inserted), 0.0));
    assert_eq!(runs[0].log.samples.len(), 363);
}

#[test]
fn the_tables_of_a_calibration_are_those_that_it_writes_now() {
    let copy = copied();
    let line = "calibrate --task ket8 --measurements published --engine fake --no-cache";
    let few = "--simulations 16 --samples 20 --out";
    optimize_line(&format!("{line} {few} {}", copy.word("now"))).succeeds();
    for table in ["leave_one_out.csv", "parameters.csv"] {
        let head = |name: &str| {
            let text = copy.read(&format!("{name}/{table}"));
            text.lines().next().unwrap_or_default().to_owned()
        };
        assert_eq!(head("now"), head("calibration"), "{table}");
    }
}
