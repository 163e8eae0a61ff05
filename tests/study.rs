//! Studies: the same seed gives the same journal, whatever happens on the way.

use crate::common::{HEAD, SEARCH, SLOW, Studies, command, end, optimize_line, read, run};
use ask_tell::OptimizerKind;
use ask_tell::stream::stream;
use rand::RngExt;
use std::fs;
use std::io::Write;
use std::process::Command;

/// Ends within a batch of 4.
const BUDGET: u32 = 22;

fn reference(studies: &Studies) -> String {
    studies.study("reference", BUDGET, &SEARCH).succeeds();
    studies.journal("reference")
}

#[test]
fn the_same_seed_gives_the_same_journal_whatever_the_threads() {
    let studies = Studies::new();
    let expected = reference(&studies);
    assert_eq!(expected.lines().count(), 2 + BUDGET as usize);
    for threads in ["1", "2", "8"] {
        let name = format!("threads-{threads}");
        let study = &mut studies.command(&name, BUDGET, &SEARCH);
        run(study.args(["--threads", threads]).env(SLOW.0, SLOW.1)).succeeds();
        assert_eq!(studies.journal(&name), expected, "{threads} threads");
    }
    studies.study("seed", BUDGET, &["--seed", "1"]).succeeds();
    assert_ne!(studies.journal("seed").lines().nth(2), expected.lines().nth(2));
}

#[test]
fn every_optimizer_goes_on_under_a_raised_budget_as_if_it_had_been_so_from_the_start() {
    let studies = Studies::new();
    for optimizer in OptimizerKind::all().map(OptimizerKind::name) {
        let more = [&["--optimizer", optimizer][..], &SEARCH].concat();
        studies.study(&format!("{optimizer}-once"), 40, &more).succeeds();
        let raised = format!("{optimizer}-raised");
        for budget in [1, 3, 4, 9, 31, 40] {
            studies.study(&raised, budget, &more).succeeds();
            assert_eq!(studies.journal(&raised).lines().count(), 2 + budget as usize);
        }
        let expected = studies.journal(&format!("{optimizer}-once"));
        assert_eq!(studies.journal(&raised), expected, "{optimizer}");
        studies.study(&raised, 5, &more).fails(2, &["budget: the study has 40, now has 5"]);
        assert_eq!(studies.journal(&raised), expected, "{optimizer}");
    }
}

#[test]
fn a_study_of_every_design_ends_when_there_are_no_more() {
    let studies = Studies::new();
    let infill = include_str!("../spaces/infill.toml");
    let text = infill.replace("high = 30.0", "high = 15.0").replace("high = 40.0", "high = 0.0");
    let space = studies.file("small.toml", text);
    let result = studies.study("small", 50, &["--json", "--space", &space]).json();
    assert_eq!((&result["evaluations"], &result["ending"]), (&6.into(), &"space_exhausted".into()));
    // The copy in the study's folder is enough to go on.
    fs::remove_file(space).unwrap();
    studies.resume("small").succeeds();
}

#[test]
fn any_torn_tail_is_cut_off_and_measured_again() {
    let studies = Studies::new();
    let expected = reference(&studies);
    let path = studies.dir("reference").join("journal.jsonl");
    let whole = fs::read(&path).unwrap();
    let mut random = stream(0, 0, "tear");
    let resume = || run(command(&["resume", "--quiet"]).args(SEARCH).arg(studies.dir("reference")));
    for _ in 0..12 {
        fs::write(&path, &whole[..random.random_range(0..whole.len())]).unwrap();
        resume().succeeds();
        assert_eq!(studies.journal("reference"), expected);
    }
    fs::OpenOptions::new().append(true).open(&path).unwrap().write_all(&[0; 100]).unwrap();
    studies.resume("reference").succeeds();
    assert_eq!(studies.journal("reference"), expected);
}

#[test]
fn damage_in_the_middle_names_the_file_and_the_line() {
    let studies = Studies::new();
    reference(&studies);
    let path = studies.dir("reference").join("journal.jsonl");
    let whole = read(&path);
    let lines: Vec<String> = whole.lines().map(str::to_owned).collect();
    let with = |change: &dyn Fn(&mut Vec<String>)| {
        let mut lines = lines.clone();
        change(&mut lines);
        fs::write(&path, lines.join("\n") + "\n").unwrap();
        let written = fs::read(&path).unwrap();
        let ran = studies.resume("reference");
        assert_eq!(fs::read(&path).unwrap(), written, "a damaged journal is left as it is");
        ran
    };
    let other = lines[6].replace("\"slip_mm\":0.1", "\"slip_mm\":0.2");
    with(&|lines| lines[6] = other.clone())
        .fails(2, &["journal.jsonl: line 7", "damaged", "delete line 7"]);
    with(&|lines| lines[5].clear()).fails(2, &["journal.jsonl: line 6"]);
    with(&|lines| drop(lines.remove(8))).fails(2, &["line 9", "evaluation 7 is found where"]);
    with(&|lines| lines.swap(3, 4)).fails(2, &["line 4"]);
    with(&|lines| lines[0] = "{}".to_owned()).fails(2, &["journal.jsonl", "line 1"]);
    fs::write(&path, "the list of my bees").unwrap();
    studies.resume("reference").fails(2, &["journal.jsonl", "not the journal of this study"]);
    assert_eq!(read(&path), "the list of my bees");
}

#[test]
fn a_journal_of_another_study_is_refused() {
    let studies = Studies::new();
    reference(&studies);
    studies.study("other", BUDGET, &["--seed", "7"]).succeeds();
    let journal = |name| studies.dir(name).join("journal.jsonl");
    fs::copy(journal("other"), journal("reference")).unwrap();
    studies.resume("reference").fails(2, &["journal.jsonl", "seed: the journal has 7"]);
    // Without its study.toml a journal could be anybody's.
    fs::remove_file(studies.dir("other").join("study.toml")).unwrap();
    studies.study("other", BUDGET, &["--seed", "7"]).fails(2, &["no study.toml beside it"]);
    studies.resume("other").fails(2, &["not a study"]);
}

#[test]
fn another_configuration_is_refused_field_by_field() {
    let studies = Studies::new();
    let expected = reference(&studies);
    for (more, field) in [
        (["--seed", "1"], "seed: the study has 0, now has 1"),
        (["--batch", "5"], "batch: the study has 4, now has 5"),
        (["--optimizer", "random"], "optimizer: the study has \"gp\", now has \"random\""),
        (["--objective", "centred-range"], "objective: the study has \"range\""),
    ] {
        studies.study("reference", BUDGET, &more).fails(2, &[field, "another configuration"]);
    }
    let text = studies.read("reference/study.toml");
    studies.file("reference/study.toml", text.replace("seed = 0", "sead = 0"));
    studies.resume("reference").fails(2, &["study.toml", "sead"]);
    for (from, to, words) in [
        ("batch = 4", "batch = 0", ["study.toml", "batch", "must lie in"]),
        ("budget = 22", "budget = 9223372036854775807", ["study.toml", "budge", "must lie in"]),
        ("high = 30.0", "high = 60.0", ["study.toml", "space", "high"]),
    ] {
        assert!(text.contains(from), "{from}");
        studies.file("reference/study.toml", text.replacen(from, to, 1));
        studies.resume("reference").fails(2, &words);
    }
    studies.file("reference/study.toml", text);
    studies.file("reference/inputs/task_1.toml", "name = 'x'");
    studies.resume("reference").fails(2, &["task_1.toml", "was changed"]);
    assert_eq!(studies.journal("reference"), expected);
}

#[cfg(unix)]
#[test]
fn an_interrupt_stops_soon_and_leaves_whole_evaluations_in_journal_and_cache() {
    let studies = Studies::new();
    let expected = reference(&studies);
    let cache = studies.word("cache");
    let child = studies.begun("it stopped", BUDGET, &["--cache", &cache], 5);
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(kill.expect("kill").success());
    let (code, stderr) = end(child);
    let resume = format!("optimize resume '{}'", studies.word("it stopped"));
    assert!(code == Some(1) && stderr.contains(&resume), "{stderr}");
    let lines = studies.journal("it stopped").lines().count();
    assert!(lines < expected.lines().count(), "it ran on for {lines} lines");
    studies.study("other", BUDGET, &["--cache", &cache]).succeeds();
    studies.resume("it stopped").succeeds();
    assert_eq!(studies.journal("other"), expected);
    assert_eq!(studies.journal("it stopped"), expected);
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let studies = Studies::new();
    studies.file("file", "");
    studies.study("file/study", 4, &[]).fails(1, &["file/study", "cannot create the folder"]);
    studies.study("file", 4, &[]).fails(1, &["file: cannot create the folder"]);
    // A folder where a file belongs refuses writing even to root.
    fs::create_dir_all(studies.dir("odd/journal.jsonl")).unwrap();
    studies.study("odd", 4, &[]).fails(2, &["odd/journal.jsonl"]);
    fs::create_dir_all(studies.dir("locked/.lock")).unwrap();
    studies.study("locked", 4, &[]).fails(1, &["locked/.lock", "cannot open"]);
}

#[test]
fn a_polish_follows_the_search_and_is_as_durable() {
    let studies = Studies::new();
    let expected = reference(&studies);
    let polish = |name: &str, more: &[&str]| {
        studies.study(name, BUDGET, &[&["--polish", "9"][..], more].concat())
    };
    let json = polish("polished", &["--json"]).json();
    let (all, searched) = (studies.journal("polished"), expected.lines().count());
    let evaluations = all.lines().count() - 2;
    assert!(evaluations > BUDGET as usize && evaluations <= BUDGET as usize + 9, "{evaluations}");
    assert_eq!((&json["budget"], &json["polish"]), (&BUDGET.into(), &9.into()));
    let lines = |text: &str| text.lines().skip(2).take(searched - 2).collect::<String>();
    assert_eq!(lines(&all), lines(&expected), "the search does not know of the polish");
    // Any beginning goes on to the same end.
    let whole = studies.read("polished/journal.jsonl");
    for kept in [2, 2 + 20, 2 + BUDGET as usize, 2 + BUDGET as usize + 1] {
        let beginning: String = whole.lines().take(kept).map(|line| format!("{line}\n")).collect();
        studies.file("polished/journal.jsonl", beginning);
        studies.resume("polished").succeeds();
        assert_eq!(studies.journal("polished"), all, "{kept} lines kept");
    }
    studies.study("polished", BUDGET + 4, &["--polish", "9"]).fails(2, &["budget", "--out"]);
    studies.study("polished", BUDGET, &[]).fails(2, &["polish: the study has 9, now has nothing"]);
    studies.study("reference", BUDGET, &["--polish"]).fails(2, &["polish: the study has nothing"]);
}

#[test]
fn a_known_evaluation_leaves_the_journal_that_a_measured_one_does() {
    let studies = Studies::new();
    let expected = reference(&studies);
    let dir = studies.word("cache");
    let cached = |name: &str, budget: u32, more: &[&str]| {
        let more = [&["--cache", &dir, "--json"][..], more].concat();
        studies.study(name, budget, &more).json()["cached"].clone()
    };
    assert_eq!(cached("first", BUDGET, &[]), 0);
    assert_eq!(cached("second", BUDGET, &["--threads", "8"]), BUDGET);
    assert_eq!((studies.journal("first"), studies.journal("second")), (expected.clone(), expected));
    let recorded = |name: &str| {
        studies.read(&format!("{name}/journal.jsonl")).matches("\"cached\":[true]").count()
    };
    assert_eq!((recorded("first"), recorded("second")), (0, BUDGET as usize));
    // Whatever the optimizer, it is the same design; with another robot it is not.
    assert_eq!(cached("all", 21 * 41, &["--optimizer", "grid"]), BUDGET);
    assert_eq!(cached("rigid", 4, &["--robot", "rigid"]), 0);
    assert_eq!(cached("codesign", 4, &["--space", "codesign"]), 0);
}

/// The strategy of the task is among the designs, and neither speed nor force goes beyond the limits.
#[test]
fn finger_and_strategy_start_from_the_task_and_keep_to_its_limits() {
    let studies = Studies::new();
    let limits = "\n[limits]\nforce_n = 90.0\nspeed_mm_per_s = 155.0\n";
    let usb = studies.file("usb.toml", include_str!("../tasks/usb.toml").to_owned() + limits);
    let found =
        studies.study("both", 12, &["--task", &usb, "--space", "codesign", "--json"]).json();
    assert_eq!(found["constraints"], serde_json::json!(["peak-force<=90"]));
    let speeds = studies.numbers("both", "task.strategy.phase.assembly.speed_mm_per_s");
    assert!(speeds.len() == 12 && speeds.iter().all(|speed| *speed <= 150.0), "{speeds:?}");
    let own = [
        ("infill_density_percent", "20"),
        ("task.strategy.tilt_deg", "10"),
        ("task.strategy.phase.touch.preload_mm", "0.3"),
        ("task.strategy.phase.side.move_mm.y", "-10"),
        ("task.grip.force_n", "5"),
    ]
    .map(|(key, value)| (studies.column("both", key), value));
    assert!((0..12).any(|row| own.iter().all(|(column, value)| column[row] == *value)));
    // A limit that is given counts.
    let more = ["--task", &usb, "--space", "codesign", "--json", "--constraint", "peak-force<=80"];
    let found = studies.study("given", 2, &more).json();
    assert_eq!(found["constraints"], serde_json::json!(["peak-force<=80"]));
    // A bench prediction knows no forces.
    let bench = studies.file("bench.csv", format!("{HEAD}usb,20,10,5.0\n"));
    let few = ["--task", &usb, "--space", "codesign", "--simulations", "24", "--samples", "20"];
    studies.study("bench", 2, &[&few[..], &["--measurements", &bench]].concat()).succeeds();
}

/// Returns the best design in a study's JSON, and its evaluation.
fn best_of(json: &serde_json::Value) -> u64 {
    json["best"]["evaluation"].as_u64().expect("a best design")
}

#[test]
fn a_study_measured_with_other_settings_is_refused_unless_that_is_accepted() {
    let studies = Studies::new();
    let expected = reference(&studies);
    let usb = include_str!("../tasks/usb.toml");
    let own = ["--task", &studies.file("usb.toml", usb), "--json"];
    let before = studies.study("changed", 12, &own).json();
    assert!(studies.journal("changed").lines().count() == 2 + 12 && best_of(&before) < 12);
    // The file changes: neither the same command nor, of its copies, a newer program goes on.
    studies.file("usb.toml", format!("# another comment\n{usb}"));
    let journal = studies.journal("changed");
    let differs = "input_sha256.task_1: the input file differs from its copy in the study's folder";
    let remedies = ["different settings", differs, "--accept-changed", "--out"];
    studies.study("changed", BUDGET, &own).fails(2, &remedies);
    let accepted = [&own[..], &["--accept-changed"]].concat();
    let parts = ["simulated differently", "all its 12 evaluations", "raise --budget"];
    studies.study("changed", 12, &accepted).fails(2, &parts);
    assert_eq!(studies.journal("changed"), journal, "nothing is written");
    studies.report("changed").succeeds();

    let after = studies.study("changed", BUDGET, &accepted).json();
    assert!(best_of(&after) >= 12, "the best is of the last segment: {after}");
    assert_eq!(after["segments"][1]["first"], 12);
    let journal = studies.journal("changed");
    assert_eq!(journal.lines().count(), 2 + BUDGET as usize + 1, "one line for the segment");
    let [found, whole] = [&journal, &expected]
        .map(|text| text.lines().filter(|line| line.contains("\"op_code\":4")).collect::<Vec<_>>());
    assert_eq!(found, whole, "a comment changes no value");
    let page = studies.read("changed/report.html");
    assert!(page.contains("segment 2 (from evaluation 12)"), "the report shows it");
    // From now on it is measured with the changed file.
    studies.study("changed", BUDGET, &own).succeeds();
    studies.resume("changed").succeeds();
    let text = studies.study("changed", BUDGET, &own[..2]);
    text.says(&["segment       2, since evaluation 12"]);
    // Another change, accepted before anything was measured with the first one.
    let journal = studies.read("changed/journal.jsonl");
    let begun: Vec<&str> = journal.lines().take(2 + 12 + 1).collect();
    studies.file("changed/journal.jsonl", begun.join("\n") + "\n");
    studies.file("usb.toml", format!("# a third comment\n{usb}"));
    studies.study("changed", BUDGET, &accepted).succeeds();
    studies.resume("changed").succeeds();
}

#[test]
fn the_best_designs_are_walked_beside_the_journal() {
    let studies = Studies::new();
    let json = studies.study("s", 8, &["--json"]).json();
    let walked = json["walked"].as_array().expect("what was walked");
    assert!(!walked.is_empty());
    let firm = |row: &serde_json::Value| row["firm_range_mm"].as_f64().expect("a firm range");
    let recommended = &json["recommended"];
    assert_eq!(recommended["evaluation"], walked[0]["evaluation"]);
    assert_eq!(recommended["range_mm"], walked[0]["range_mm"]);
    let by_ribs = recommended["computed"]["tasks"][0]["range_mm"].as_f64().expect("both ranges");
    assert!(by_ribs > 0.0 && walked[0]["range_mm"].as_f64() != Some(by_ribs), "other springs");
    let report = studies.read("s/report.html");
    assert!(report.contains("from its ribs") && report.contains(&format!("{by_ribs:.1} mm (")));
    // The lower end of the closed form moves with friction.
    assert!(firm(recommended) < recommended["range_mm"].as_f64().unwrap());
    assert!(walked[0]["trials"].as_u64() > json["best"]["trials"].as_u64(), "step by step");
    assert_eq!(studies.journal("s").lines().count(), 2 + 8, "not counted in the budget");
    let kept = studies.read("s/walk.json");
    // It can be made again, and a damaged one is.
    studies.file("s/walk.json", "{");
    studies.resume("s").succeeds();
    assert_eq!(studies.read("s/walk.json"), kept);
    let from_ribs = format!("from its ribs {by_ribs:.1} mm (");
    studies.study("s", 8, &["--verbose"]).says(&["walked        step by step", &from_ribs]);
    // What a kill left is gone on from.
    let mut begun: serde_json::Value = serde_json::from_str(&kept).unwrap();
    begun["complete"] = false.into();
    let designs = begun["designs"].as_array_mut().unwrap();
    designs.truncate(designs.len().div_ceil(2));
    designs[0].as_object_mut().unwrap().remove("walked");
    studies.file("s/walk.json", begun.to_string());
    studies.report("s").succeeds();
    let unfinished = || studies.read("s/report.html").contains(" (confirmation incomplete)");
    assert!(unfinished());
    studies.resume("s").succeeds();
    assert!(!unfinished());
    assert_eq!(studies.read("s/walk.json"), kept);
    let forced = studies.study("force", 8, &["--objective", "peak-force", "--json"]).json();
    assert!(forced.get("walked").is_none(), "windows do not decide there");
}

#[test]
fn the_order_on_the_bench_says_whose_it_is() {
    let studies = Studies::new();
    let paper = studies.study("paper", 4, &["--no-confirm", "--verbose"]);
    paper.says(&["(model 6.8 mm)", "ranks 11 fingers no better than chance (Spearman -0.07)"]);
    for (name, other) in [("ribs", ["--finger-model", "computed"]), ("robot", ["--robot", "rigid"])]
    {
        let found = studies.study(name, 4, &[&other[..], &["--no-confirm", "--verbose"]].concat());
        found.says_in_any_lines("(model with paper fingers on servo 6.8 mm)");
    }
}

#[test]
fn confirming_costs_a_quarter_of_a_study_at_most() {
    let studies = Studies::new();
    studies.study("s", 200, &[]).succeeds();
    let kept: serde_json::Value = serde_json::from_str(&studies.read("s/walk.json")).unwrap();
    let mut trials = 0;
    for design in kept["designs"].as_array().expect("designs") {
        trials += design["firm"][0]["trials"].as_u64().unwrap();
        if let Some(walked) = design.get("walked") {
            trials += walked["firm"][0]["trials"].as_u64().unwrap();
            trials += walked["tasks"][0]["trials"].as_u64().unwrap();
            trials += walked["computed"][0]["trials"].as_u64().unwrap();
        }
    }
    let spent = studies.numbers("s", "trials").iter().sum::<f64>() as u64;
    assert!(trials > 0 && 4 * trials <= spent, "{trials} of {spent}");
}

#[test]
fn a_task_that_no_design_does_ends_with_what_went_wrong() {
    let studies = Studies::new();
    // The closed form's window closes with the remote centre so far up.
    let infill = include_str!("../spaces/infill.toml");
    let centre = "[[parameter]]\nkey = \"finger.rcc_mm\"\nlow = 60.0\nhigh = 62.0\nstep = 1.0\n\
                  source = \"too high\"\n";
    let space = ["--space", &studies.file("high.toml", format!("{infill}\n{centre}"))];
    let failed = studies.study("s", 8, &space);
    failed.fails(
        1,
        &["nominal start of usb", "plug missed (class 2)", "nominal.svg", "--start taught"],
    );
    assert!(failed.stdout.contains("No finger inserts on usb"), "{}", failed.stdout);
    let json = studies.study("s", 8, &[&space[..], &["--json"]].concat());
    json.fails(1, &["nominal start"]);
    let json: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!(json["recommended"], serde_json::Value::Null);
    assert!(studies.dir("s").join("nominal.svg").exists());
}

#[test]
fn a_robot_without_whose_stop_the_start_inserts_is_the_verdict() {
    let studies = Studies::new();
    let servo = include_str!("../robots/servo.toml");
    let weak = servo.replace("stop_force_n = 150.0", "stop_force_n = 5.0");
    let robot = studies.file("weak.toml", weak);
    let more = "--budget 8 --no-confirm --no-levers --no-map --json --out";
    let line = format!("--task usb --robot {robot} {more} {}", studies.word("s"));
    let ran = optimize_line(&line);
    ran.fails(1, &["no design of the study inserts", "use a robot with higher limits"]);
    let error = &ran.stderr;
    let answer: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert!(answer["recommended"].is_null(), "{answer}");
    let answer = &answer["answer"];
    assert_eq!(answer["verdict"], "robot_stops", "{answer}");
    assert!(answer["headline"].as_str().unwrap().starts_with("Not usable as it is: the robot"));
    assert!(!error.contains("--start taught") && !error.contains("the plug misses"), "{error}");
    let page = studies.read("s/report.html");
    assert!(page.contains("<h1>Not usable as it is: the robot stops in 1 of 1 trials"));
    assert!(page.contains("robot with higher limits") && !page.contains("the plug misses"));
}

#[test]
fn the_next_command_names_the_files_of_ones_own_task_and_robot() {
    let studies = Studies::new();
    let text = include_str!("../tasks/usb.toml").replace("name = \"usb\"", "name = \"mine\"");
    let own = studies.file("mine.toml", text);
    let robot =
        studies.file("robot.toml", format!("# mine\n{}", include_str!("../robots/servo.toml")));
    let more =
        format!("--robot {robot} --engine fake --budget 4 --no-levers --no-map --json --out");
    let found = optimize_line(&format!("--task {own} {more} {}", studies.word("s"))).json();
    let next = &found["answer"]["next"]["command"];
    let options = format!("--measurements bench.csv --count 3 --robot {robot} --engine fake");
    assert_eq!(next, &format!("optimize next --task {own} {options}"));
}
