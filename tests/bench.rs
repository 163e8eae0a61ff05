//! The commands that bring bench and simulation together, on the fake engine.

use crate::common::{FEW, HEAD, Studies, command, fake, optimize, optimize_line, run};

#[test]
fn measurements_are_added_checked_and_refused() {
    let folder = Studies::new();
    let file = folder.word("bench.csv");
    let add = |more: &str| {
        optimize_line(&format!("measure add {file} --task ket8 --density 20 --direction {more}"))
    };
    optimize_line("measure add --out bench.csv").fails(2, &["'--out", "optimize measure add FILE"]);
    add("0 --range-mm 5.73")
        .says(&["added         ket8, 20 % infill at 0°: 5.73 mm\n", ": 1 line\n"]);
    let one_end = "added         ket8, 20 % infill at 10°: at least 1.5 mm (-1.5)\n";
    add("10 --negative-mm -1.5 --failure-negative 3").says(&[one_end, "bench.csv: 2 lines\n"]);
    let both = add("15 --negative-mm -4.1 --positive-mm 5.2 --dry-run --json").json();
    assert_eq!((&both["lines"], &both["added"]["positive_mm"]), (&3.into(), &5.2.into()));
    let before = folder.read("bench.csv");
    // What was typed is named, not the line that it would make.
    add("0 --range-mm 5.8").fails(2, &["error: --task: same finger as in line 2"]);
    add("0.35 --range-mm 5.8")
        .fails(2, &["error: --direction: 0.35 degrees", "0.35 rad is 20.1 degrees"]);
    add("0 --range-mm 5 --failure-negative jamed")
        .fails(2, &["did you mean `jammed`", "1 (contact"]);
    let two = ["error: --set task.strategy.tilt_deg: `y` is not a number\n--range-mm: `x` is not"];
    add("5 --set task.strategy.tilt_deg=y --range-mm x").fails(2, &two);
    assert_eq!(folder.read("bench.csv"), before);
    let checked = optimize_line(&format!("measure check --measurements {file} --json")).json();
    assert_eq!((&checked["lines"], &checked["tasks"][0]["bounds"]), (&2.into(), &1.into()));
    folder.file("bench.csv", before.replace("ket8", "ket80"));
    optimize_line(&format!("measure check {file}"))
        .fails(2, &["line 2: task: ", "did you mean `ket8`"]);
    assert_eq!(optimize_line("measure check published --json").json()["lines"], 44);
}

#[test]
fn an_evaluation_shows_what_was_measured_and_warns_where_it_is_far_off() {
    let folder = Studies::new();
    let head = "task,infill_density_percent,infill_direction_deg,range_mm,negative_mm\n";
    let lines = "usb,20,10,0.1,\nusb,20,20,,-20\nket8,20,10,7,\nusb,20,30,not measurable,\n";
    let file = folder.file("bench.csv", format!("{head}{lines}"));
    let of = |direction: u32, more: &str| {
        let finger = format!("--task usb --density 20 --direction {direction}");
        fake(&format!("evaluate {finger} --measurements {file} {more}"))
    };
    let found = of(10, "--json").json();
    assert_eq!(found["measured"].as_array().map(Vec::len), Some(1), "{found}");
    assert_eq!(found["measured"][0]["range_mm"], 0.1);
    of(10, "").says(&["measured      0.1 mm on the bench\nwarning       do not trust"]);
    of(20, "").says(&["measured      20.0 mm or more, on the bench\nwarning       do not trust"]);
    of(30, "").says_in_any_lines(&format!("measured no range of it in {file}"));
}

#[test]
fn calibration_and_the_next_print_answer_in_the_agreed_form() {
    let few = "--task ket8 --engine fake --simulations 24 --samples 20 --json --measurements";
    let found = optimize_line(&format!("calibrate {few} published")).json();
    let task = &found["tasks"][0];
    assert_eq!((&task["task"], &task["designs"]), (&"ket8".into(), &11.into()));
    for key in ["loo_mean_deviation_percent", "loo_spearman", "loo_coverage_80_percent"] {
        assert!(task[key].is_number(), "{key}: {}", task[key]);
    }
    let predictions = task["predictions"].as_array().expect("a list");
    assert_eq!(predictions.len(), 21 * 41);
    let best: f64 = predictions.iter().filter_map(|p| p["probability_best"].as_f64()).sum();
    assert!((best - 1.0).abs() < 1e-9, "{best}");
    let first = &found["parameters"][0];
    assert!(first["moved"].is_boolean());
    assert_eq!([&first["sets"], &first["as"]], ["task.friction.plug_socket", "factor"]);
    let folder = Studies::new();
    let two = folder.file("two.csv", format!("{HEAD}ket8,10,6,8\nket8,11,40,2\n"));
    let shown = optimize_line(&format!("calibrate {few} {two}").replace("--json ", ""));
    assert!(shown.stdout.starts_with("ket8: do not rely on these predictions yet"));
    for (name, unit) in [("preload", "  × "), ("clearance", " mm  ")] {
        let line = shown.stdout.lines().find(|line| line.starts_with(name));
        assert!(line.is_some_and(|line| line.contains(unit)), "{}", shown.stdout);
    }
    shown.says_in_any_lines("measure 3 more, or identify the cell from logs");
    shown.says_in_any_lines("by the mean of the others 188 %");
    let begins = "ket8: simulations with drawn parameters of the cell: 0/24\n";
    assert!(shown.stderr.starts_with(begins), "{}", shown.stderr);
    let more = format!("{} --count 2 --among published", folder.file("empty.csv", ""));
    let next = optimize_line(&format!("next {few} {more}")).json();
    assert_eq!((next["next"].as_array().map(Vec::len), &next["stop"]), (Some(2), &false.into()));
    assert!(next["next"][0]["reason"].as_str().is_some_and(|reason| !reason.is_empty()));
    assert!(next["next"][0]["expected_gain_mm"].as_f64().is_some_and(|gain| gain > 0.0));
    // A finger that is expected to be wider than those measured is worth a print, though its measurement decides nothing.
    let lines = format!("{HEAD}usb,10,0,5.6\nusb,20,40,4.1\nusb,30,20,6.1\n");
    let file = folder.file("usb.csv", lines);
    let usb = few.replace("ket8", "usb").replace("--simulations 24", "--simulations 40");
    let wider = optimize_line(&format!("next {usb} {file}")).json();
    let gain = |key| wider["next"][0][key].as_f64().expect("a gain");
    assert!(gain("expected_gain_mm") < 0.1 && gain("gain_in_use_mm") > 0.3, "{wider}");
    assert_eq!(wider["stop"], false, "{wider}");
    // A finger that was printed and inserts from no start is not printed again, nor chosen.
    let finger = ["infill_density_percent", "infill_direction_deg"].map(|key| {
        next["next"][0]["values"].get(key).or(next["next"][0].get(key)).unwrap().to_string()
    });
    let text = format!("{HEAD}ket8,{},{},not measurable\n", finger[0], finger[1]);
    let more = format!("{} --count 11 --among published", folder.file("failed.csv", text));
    let again = optimize_line(&format!("next {few} {more}")).json();
    assert_eq!(again["not_measurable"].as_array().map(Vec::len), Some(1), "{again}");
    assert_eq!((again["next"].as_array().map(Vec::len), &again["measured"]), (Some(10), &0.into()));
}

/// Another strategy for a printed finger needs no print; everything else does.
#[test]
fn a_strategy_is_advised_for_a_printed_finger_without_a_print() {
    let folder = Studies::new();
    let file = folder.file("bench.csv", format!("{HEAD}ket8,20,10,5.0\n"));
    let few = "--task ket8 --engine fake --simulations 24 --samples 20 --json --measurements";
    let found = optimize_line(&format!("next {few} {file} --space codesign --count 20")).json();
    let prints = found["next"].as_array().unwrap();
    let own = |print: &serde_json::Value| {
        print["infill_density_percent"] == 20.0 && print["infill_direction_deg"] == 10.0
    };
    let needs = |print: &serde_json::Value| print["needs_print"].as_bool().unwrap();
    assert!(prints.iter().any(|print| !needs(print)), "{found}");
    assert!(prints.iter().filter(|print| !needs(print)).all(own), "{found}");
    let words = format!("next {few} {file} --space codesign --count 20").replace("--json ", "");
    optimize_line(&words).says(&["no print: this finger was printed"]);
}

#[test]
fn a_study_with_measurements_leads_with_the_finger_that_is_best_on_the_bench() {
    let folder = Studies::new();
    let json = [&FEW[..], &["--json", "--measurements", "published"]].concat();
    let found = folder.study("a", 12, &json).json();
    let best = &found["recommended"];
    for key in ["range_mm", "low_mm", "high_mm", "probability_best"] {
        assert!(best["bench"][key].is_number(), "{key}: {best}");
    }
    assert!(best["range_mm"].is_number() && found["bench"]["loo_spearman"].is_number(), "{found}");
    // The best of the table is the one that is named.
    let table = folder.read("a/bench_predictions.csv");
    let rows = table.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
    let number = |cell: &str| cell.parse::<f64>().expect("a number");
    let first = rows.max_by(|a, b| number(a[3]).total_cmp(&number(b[3]))).expect("a line");
    assert!((number(first[3]) - best["bench"]["range_mm"].as_f64().unwrap()).abs() < 1e-3);
    // Printed and measured before, it is not to be printed again.
    assert_eq!(found["answer"]["verdict"], "print");
    assert_eq!(found["answer"]["finger"], best["values"]);
    // A finger that exists is used until the better one is printed and measured.
    let answer = &found["answer"];
    assert_eq!(answer["use_now"]["range_mm"], 8.6, "{answer}");
    let headline = answer["headline"].as_str().expect("words");
    assert!(headline.ends_with("now: the best of 11 measured fingers, 8.6 mm on a robot"));
    let expectation = answer["expectation"].as_str().expect("words");
    assert!(expectation.starts_with("largest expected range: "), "{expectation}");
    assert!(expectation.contains(" at 80 %), not measured; "), "{expectation}");
    let kept = folder.read("a/bench.json");
    let mut known: serde_json::Value = serde_json::from_str(&kept).expect("JSON");
    known["ranges"] = serde_json::json!([[best["values"], 9.9]]);
    folder.file("a/bench.json", known.to_string());
    let before = folder.study("a", 12, &json).json();
    assert_eq!(before["answer"]["verdict"], "measured_before", "{before}");
    let headline = before["answer"]["headline"].as_str().expect("words");
    assert!(headline.ends_with("now: the only measured finger, 9.9 mm on a robot"), "{headline}");
    let expectation = before["answer"]["expectation"].as_str().expect("words");
    assert!(expectation.starts_with("expect "), "{expectation}");
    let words = "another print is worth it";
    assert!(before["answer"]["next"]["why"].as_str().is_some_and(|why| why.contains(words)));
    known["ranges"] = serde_json::json!([]);
    known["bounds"] = serde_json::json!([[best["values"], 1.5]]);
    folder.file("a/bench.json", known.to_string());
    let bound = folder.study("a", 12, &json).json()["answer"]["headline"].to_string();
    assert!(bound.contains("measured finger, 1.5 mm or more on a robot"), "{bound}");
    folder.file("a/bench.json", kept);
    // A finger that inserted from no start is not the one to print.
    let [density, direction] = ["density_percent", "direction_deg"]
        .map(|key| best["values"][format!("infill_{key}")].clone());
    let failed = format!("{HEAD}ket8,20,10,5.0\nket8,{density},{direction},not measurable\n");
    let failed = folder.file("failed.csv", failed);
    let other = folder.study("c", 12, &[&FEW[..], &["--json", "--measurements", &failed]].concat());
    let (other, chosen) =
        (other.json(), |found: &serde_json::Value| found["recommended"]["values"].clone());
    assert!(chosen(&other).is_object() && chosen(&other) != best["values"], "{other}");
    // The search did not know of it.
    let plain = folder.study("b", 12, &["--task", "ket8", "--json"]).json();
    assert_eq!(found["recommended_by_simulation"], plain["recommended"]);
    let evaluations = |name| folder.journal(name).lines().skip(2).collect::<Vec<_>>().join("\n");
    assert_eq!(evaluations("a"), evaluations("b"));
    let page = folder.read("a/report.html");
    let places = ["<section id=\"bench\">", "<section id=\"set\">"].map(|words| page.find(words));
    assert!(places[0].is_some() && places[0] < places[1], "{places:?}");
    assert!(!folder.read("b/report.html").contains("for the bench</h2>"));
}

#[test]
fn measurements_are_kept_with_a_study_and_new_ones_leave_its_evaluations() {
    let folder = Studies::new();
    let lines = format!("{HEAD}ket8,10,0,7.6\nket8,20,0,5.7\nusb,20,0,5.7\n");
    let file = folder.file("bench.csv", &lines);
    let with = |more: &[&str]| {
        folder.study("a", 12, &[&FEW[..], &["--json", "--measurements", &file], more].concat())
    };
    // A study without measurements takes its first ones, too.
    folder.study("a", 12, &FEW).succeeds();
    let first = with(&[]);
    assert!(first.stderr.contains("2 new measurements\n"), "{}", first.stderr);
    let before = first.json();
    assert_eq!(before["bench"]["measured"], 2);
    folder.study("a", 12, &FEW).fails(2, &["input_sha256.measurements", "--accept-changed"]);
    std::fs::remove_file(&file).expect("the file is removed");
    folder.resume("a").succeeds();
    // Changed or removed lines ask.
    for other in [lines.replace("7.6", "7.7"), lines.replace("usb,20,0,5.7\n", "")] {
        folder.file("bench.csv", other + "ket8,25,20,9.9\n");
        with(&[]).fails(2, &["input_sha256.measurements", "--accept-changed"]);
    }
    // Those that follow do not, be there a comment or a column more.
    let more = lines.replace("range_mm\n", "range_mm,note\n").replace("6\n", "6,\n");
    let more = more.replace("5.7\n", "5.7,\n") + "# measured on Monday\nket8,25,20,9.9,\n";
    folder.file("bench.csv", more + "usb,25,20,9.9,\n");
    let grown = with(&[]);
    assert!(grown.stderr.contains("1 new measurement\n"), "{}", grown.stderr);
    let after = grown.json();
    assert_eq!(after["bench"]["measured"], 3);
    assert_eq!(after["segments"][2]["first"], 12);
    assert_eq!(after["recommended_by_simulation"], before["recommended_by_simulation"]);
    assert_ne!(after["recommended"]["bench"], before["recommended"]["bench"]);
    assert_eq!(after["evaluations"], 12);
    // Whoever asks from now on gets the same answer, and nobody has to accept anything again.
    let dir = folder.word("a");
    assert_eq!(with(&[]).stderr, "");
    for again in [with(&[]), optimize(&["resume", &dir, "--quiet", "--json"])] {
        assert_eq!(again.json()["recommended"], after["recommended"]);
    }
    folder.report("a").succeeds();
    assert!(folder.read("a/report.html").contains("Predicted for the bench"));
    let title = optimize(&["export", "finger", &dir, "--format", "dxf", "--out", "/dev/null"]);
    let density = after["recommended"]["values"]["infill_density_percent"].to_string();
    title.says(&[&format!("{} %", density.trim_end_matches(".0"))]);
}

#[test]
fn measurements_that_a_study_cannot_use_are_refused_before_it_begins() {
    let folder = Studies::new();
    let refused = |lines: &str, more: &[&str], parts: &[&str]| {
        let file = folder.file("bench.csv", format!("{HEAD}{lines}"));
        folder.study("a", 12, &[more, &["--measurements", &file]].concat()).fails(2, parts);
        assert!(!folder.dir("a").exists());
    };
    let line = "ket8,10,0,7.6\n";
    refused("usb,20,0,5.7\n", &["--task", "ket8"], &["no line has a range of the task `ket8`"]);
    refused("ket8,20,0,not measurable\n", &["--task", "ket8"], &["no line has a range"]);
    refused("ket8,50,0,5.7\n", &["--task", "ket8"], &["line 2", "infill_density_percent: 50"]);
    refused(line, &["--task", "ket8,rj45"], &["--measurements", "give one --task"]);
    let objective = ["--task", "ket8", "--objective", "centred-range"];
    refused(line, &objective, &["centred-range is not measured on the bench"]);
    let constraint = ["--task", "ket8", "--constraint", "peak-force<=30"];
    refused(line, &constraint, &["a --constraint is not measured on the bench"]);
}

#[test]
fn a_finger_of_a_task_of_ones_own_is_measured_without_naming_it_twice() {
    let folder = Studies::new();
    let few = "--engine fake --simulations 24 --samples 20 --measurements";
    let line = |line: &str| run(command(&[]).args(line.split_whitespace()).current_dir(&folder.0));
    // For `next` alone, a missing file is empty: the default file and that of the project.
    let next = line(&format!("next --task ket8 {few} bench.csv"));
    let words = "No finger to use yet: none measured on ket8 (bench.csv does not exist)\n";
    assert!(next.succeeds().starts_with(words), "{}", next.stdout);
    let first = "bench.csv does not exist: fingers are chosen by simulation alone\n";
    assert!(next.stderr.starts_with(first), "{}", next.stderr);
    line(&format!("next {few} bench.csv"))
        .fails(2, &["bench.csv: has no measurements yet", "give --task"]);
    line(&format!("calibrate --task ket8 {few} bench.csv")).fails(2, &["bench.csv: cannot read"]);
    line(&format!("next --task ket8 {few} bensh")).fails(2, &["unknown measurement file `bensh`"]);
    folder.file("finger-opt.toml", "measurements = \"mine.csv\"\n");
    let words = "none measured on ket8 (mine.csv does not exist)";
    line("next --task ket8 --engine fake --simulations 24 --samples 20").says(&[words]);
    folder.file("finger-opt.toml", "");
    assert!(!folder.dir("bench.csv").exists());
    // The task is that of the lines, and its file that of the comment line.
    let own = include_str!("../tasks/ket8.toml").replace("\"ket8\"", "\"mine\"");
    std::fs::create_dir(folder.dir("own")).expect("a folder");
    folder.file("own/mine.toml", &own);
    let add = "measure add own/bench.csv --density 20 --direction";
    line(&format!("{add} 0 --range-mm 5.7 --task own/mine.toml")).succeeds();
    assert!(folder.read("own/bench.csv").starts_with("# task mine: mine.toml\ntask,"));
    let add = "measure add --measurements own/bench.csv --density 20 --direction";
    let second = "10 --range-mm 6.1 --failure-positive jammed --task";
    line(&format!("{add} {second} mine")).succeeds();
    line(&format!("{add} 11 --range-mm 6 --task mein")).fails(2, &["unknown task `mein`"]);
    assert_eq!(folder.read("own/bench.csv").matches('#').count(), 1);
    line("measure check own/bench.csv").succeeds();
    let next = line(&format!("next {few} own/bench.csv"));
    let best = "Use 20 % infill at 10° now: the best of 2 measured fingers, 6.1 mm on a robot\n";
    assert!(next.succeeds().starts_with(best), "{}", next.stdout);
    // Predictions carry their interval and the verdict on them, as in `calibrate`.
    next.says(&[" % likely to be wider than the best measured, else keep that", "(80 %: "]);
    next.says(&["\npredictions   do not rely on these predictions yet: measure 3 more,"]);
    assert!(next.stdout.lines().all(|line| line.chars().count() <= 80), "{}", next.stdout);
    // A study recommends the finger that `next` would choose without a further print.
    let found = line(&format!("next --json {few} own/bench.csv")).json();
    assert_eq!((&found["loo_designs"], &found["use_now"]["fingers"]), (&2.into(), &2.into()));
    let choice = found["choice"].clone();
    let study = "--budget 4 --no-levers --no-map --json --out s --task own/mine.toml";
    let study = line(&format!("{study} {few} own/bench.csv")).json();
    for (key, value) in study["recommended"]["values"].as_object().expect("a finger") {
        assert_eq!(choice[key], *value, "{choice} {}", study["recommended"]);
    }
    let bench = &study["recommended"]["bench"];
    for (key, of_study) in
        [("expected_mm", "range_mm"), ("low_mm", "low_mm"), ("high_mm", "high_mm")]
    {
        assert_eq!(choice[key], bench[of_study], "{key}");
    }
    let found = line(&format!("calibrate --json {few} own/bench.csv")).json();
    assert_eq!(found["tasks"][0]["task"], "mine");
    let text = folder.read("own/bench.csv").replace("# task mine: mine.toml\n", "");
    folder.file("hand.csv", text);
    line(&format!("next {few} hand.csv")).fails(2, &["the file of the task `mine` is unknown"]);
    // A file that has gone, or has another task, is not taken for it.
    folder.file("own/mine.toml", own.replace("\"mine\"", "\"other\""));
    line("measure check own/bench.csv").fails(2, &["is called `other`", "# task mine: .."]);
    std::fs::remove_file(folder.dir("own/mine.toml")).expect("it is removed");
    line(&format!("next {few} own/bench.csv")).fails(2, &["mine.toml: cannot read the task"]);
    let two = folder.file("two.csv", format!("{HEAD}ket8,10,0,7.6\nusb,20,0,5.7\n"));
    line(&format!("next {few} {two}")).fails(2, &["has lines of ket8, usb; give --task"]);
}

#[test]
fn a_sheet_has_a_page_for_each_finger_and_a_picture_of_each_outcome() {
    let folder = Studies::new();
    let out = folder.file("sheet.html", "");
    optimize_line(&format!("measure sheet --task usb --finger 10,0 --finger 30,0 --out {out}"))
        .succeeds();
    let page = folder.read("sheet.html");
    assert_eq!((page.matches("<section>").count(), page.matches("<img ").count()), (3, 5));
    assert!(page.contains("--density 30 --direction 0") && page.contains("12.0 mm below"));
    // The probe comes before the starts.
    let [probe, starts] =
        ["First the probe", "Which starts"].map(|title| page.find(title).unwrap());
    assert!(probe < starts && page.contains("with 5 N and slide it 8 mm along y"));
}
