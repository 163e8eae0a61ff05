//! What interruptions, other programs, lying workers and changed files must not cost.

use crate::common::{FEW, HEAD, Studies, answer, command, kill, optimize, read, run, setting};
use ask_tell::stream::stream;
use rand::RngExt;
use std::fs;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// How long after a signal a process may still take on a busy machine; what is ended here would go on
/// for longer.
const SOON: Duration = Duration::from_secs(4);
/// Kills of each flag; set the environment variable `KILLS` for more.
const KILLS: u64 = 2;

#[test]
fn a_resumed_study_answers_as_if_it_had_not_been_killed_whatever_its_flags() {
    let folder = Studies::new();
    let file = folder.file("bench.csv", format!("{HEAD}ket8,10,0,7.6\nket8,20,0,5.7\n"));
    let with_bench = [&FEW[..], &["--measurements", &file]].concat();
    let flags: [&[&str]; 16] = [
        &with_bench,
        &["--no-confirm"],
        &["--indifference-mm", "1"],
        &["--optimizer", "cma-es"],
        &["--polish", "6"],
        &["--objective", "centred-range"],
        &["--objective", "success-rate", "--uncertainty", "typical"],
        &["--objective", "robust-range", "--uncertainty", "typical"],
        &["--objective", "range,peak-force"],
        &["--constraint", "peak-force<=30"],
        &["--task", "usb,ket8", "--aggregate", "weighted", "--weights", "1,2"],
        &["--space", "codesign"],
        &["--robot", "rigid"],
        &["--start", "taught"],
        &["--batch", "3", "--seed", "5"],
        &["--finger-model", "computed"],
    ];
    let mut random = stream(0, 0, "kills of flags");
    for (i, flags) in flags.into_iter().enumerate() {
        let whole = folder.study(&format!("whole-{i}"), 20, &[flags, &["--json"]].concat());
        let whole = answer(&whole);
        for round in 0..setting("KILLS", KILLS) {
            let name = format!("killed-{i}-{round}");
            // Before the first line, the study may not exist yet.
            let lines = random.random_range(0..24);
            let child = folder.begun(&name, 20, flags, lines);
            std::thread::sleep(Duration::from_millis(random.random_range(0..40)));
            kill(child, "KILL");
            let resumed = answer(&match folder.dir(&name).join("study.toml").exists() {
                true => optimize(&["resume", &folder.word(&name), "--quiet", "--json"]),
                false => folder.study(&name, 20, &[flags, &["--json"]].concat()),
            });
            assert_eq!(resumed, whole, "{flags:?}");
            assert_eq!(folder.journal(&name), folder.journal(&format!("whole-{i}")), "{flags:?}");
        }
    }
}

#[test]
fn one_signal_ends_a_study_soon_in_every_phase() {
    let folder = Studies::new();
    // While it searches, and while it predicts the bench.
    let many = ["--task", "ket8", "--samples", "20000", "--measurements", "published"];
    for (signal, budget, flags, wait_ms) in
        [("INT", 400, &[][..], 0), ("TERM", 400, &[], 0), ("HUP", 8, &many, 1500)]
    {
        let mut child = folder.begun(signal, budget, flags, 10);
        std::thread::sleep(Duration::from_millis(wait_ms));
        assert!(child.try_wait().expect("it can be asked").is_none(), "{signal}: it has ended");
        let took = kill(child, signal);
        assert!(took < SOON, "{took:?} after SIG{signal}");
        folder.report(signal).succeeds();
    }
}

#[test]
fn one_signal_ends_every_command_that_simulates() {
    let finger = "--density 20 --direction 10";
    let bench = "--task ket8 --no-cache --measurements published";
    // One of the signals each: how they end a study is tested above.
    let mut signals = ["INT", "TERM", "HUP"].into_iter().cycle();
    for line in [
        format!("evaluate --task usb {finger} --walk --repeat 900"),
        format!("evaluate --task usb {finger} --uncertainty typical"),
        format!("trial --task usb {finger} --repeat 900"),
        "sensitivity --task usb --samples 64".to_owned(),
        format!("calibrate {bench}"),
        format!("next {bench}"),
    ] {
        // What is begun in a shell's background inherits that Ctrl-C is ignored.
        let mut child = std::process::Command::new("env");
        child.args(["--default-signal=INT,HUP", env!("CARGO_BIN_EXE_optimize")]);
        let child = child.args(line.split_whitespace());
        let child = child.stdout(Stdio::null()).stderr(Stdio::null()).spawn();
        let mut child = child.expect("the command starts");
        std::thread::sleep(Duration::from_millis(400));
        assert!(child.try_wait().expect("it can be asked").is_none(), "{line} has ended");
        let signal = signals.next().expect("endless");
        let took = kill(child, signal);
        assert!(took < SOON, "{line}: {took:?} after SIG{signal}");
    }
}

#[test]
fn what_another_program_adds_to_a_journal_is_passed_over() {
    let folder = Studies::new();
    let expected = answer(&folder.study("whole", 24, &["--json"]));
    folder.study("s", 16, &[]).succeeds();
    let path = folder.dir("s/journal.jsonl");
    let foreign = [
        r#"{"op_code":3,"worker_id":"5b0e-140","study_id":0,"system_attr":{"dashboard:note_id":1}}"#,
        r#"{"op_code":4,"worker_id":"5b0e-140","study_id":0,"datetime_start":"2026-01-01T00:00:00"}"#,
    ];
    let text = read(&path) + &foreign.join("\n") + "\n";
    fs::write(&path, text).expect("the journal is written");
    folder.report("s").succeeds();
    assert_eq!(answer(&folder.study("s", 24, &["--json"])), expected);
    let kept = read(&path);
    assert!(foreign.iter().all(|line| kept.contains(line)), "they stay where they are");
    // A line of our own that is damaged is still an error.
    let torn = kept.replacen("\"evaluation\":3,", "\"evaluation\":3, ", 1);
    fs::write(&path, torn).expect("the journal is written");
    folder.resume("s").fails(2, &["line 6", "damaged"]);
}

#[test]
fn twenty_who_add_measurements_at_once_lose_none() {
    let folder = Studies::new();
    let (path, file) = (folder.dir("bench.csv"), &folder.word("bench.csv"));
    let add = |direction: usize, more: &[&str]| {
        let direction = direction.to_string();
        let line = ["measure", "add", file, "--task", "usb", "--density", "20"];
        command(&[&line, &["--direction", &direction, "--range-mm", "5.7"][..], more].concat())
    };
    let mut children: Vec<Child> = (0..20)
        .map(|i| add(i, &[]).stdout(Stdio::null()).spawn().expect("the command starts"))
        .collect();
    assert!(children.iter_mut().all(|child| child.wait().expect("it ends").success()));
    let lines =
        |file: &str| optimize(&["measure", "check", file, "--json"]).json()["lines"].clone();
    assert_eq!(lines(file), 20);
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, PermissionsExt};
        // Mode and symbolic links stay, also where a column is new.
        let link = folder.dir("link.csv");
        std::os::unix::fs::symlink(&path, &link).expect("a second name");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).expect("a mode");
        let line = ["measure", "add", &folder.word("link.csv"), "--task", "usb", "--density", "20"];
        let more = ["--direction", "30", "--range-mm", "5.7", "--set", "task.strategy.tilt_deg=8"];
        optimize(&[&line[..], &more].concat()).succeeds();
        assert!(fs::symlink_metadata(&link).expect("it is there").is_symlink());
        assert_eq!(fs::metadata(&path).expect("it is there").mode() & 0o777, 0o640);
        assert_eq!(lines(file), 21);
        fs::set_permissions(&path, fs::Permissions::from_mode(0o440)).expect("a mode");
        run(&mut add(31, &[])).fails(2, &["bench.csv", "read-only"]);
        assert_eq!(lines(file), 21);
    }
}

#[test]
fn the_order_of_measured_lines_changes_no_answer() {
    let folder = Studies::new();
    let lines = ["ket8,10,0,7.6\n", "ket8,20.5,0,5.7\n", "ket8,12.5,13,6.4\n"];
    let asked = |lines: &[&str], command: &str, more: &[&str]| {
        let file = folder.file("bench.csv", HEAD.to_owned() + &lines.concat());
        let all =
            [&[command, "--engine", "fake", "--json", "--measurements", &file], &FEW[..], more];
        optimize(&all.concat()).json()
    };
    let turned = [lines[2], lines[0], lines[1]];
    for (command, more) in [("next", &["--count", "2"][..]), ("calibrate", &[])] {
        assert_eq!(asked(&lines, command, more), asked(&turned, command, more), "{command}");
    }
}

#[test]
fn files_that_are_too_much_are_refused_at_once() {
    let folder = Studies::new();
    let finger = |i: u32| format!("ket8,{}.{:02},{},5.7\n", 10 + i % 20, i / 20, i % 41);
    let many: String = (0..201).map(finger).collect();
    let file = &folder.file("bench.csv", HEAD.to_owned() + &many);
    let next = || optimize(&["next", "--task", "ket8", "--measurements", file]);
    next().fails(2, &["201 different fingers", "at most 200"]);
    // Sparse: nothing of it is on the disk.
    fs::File::options().write(true).open(file).and_then(|f| f.set_len(3 << 30)).expect("a size");
    let begun = Instant::now();
    next().fails(2, &["longer than"]);
    assert!(begun.elapsed() < Duration::from_secs(5));
    folder.file("bench.csv", "x".repeat(5_000_000));
    let long = optimize(&["measure", "check", file]);
    assert_eq!(long.code, Some(2));
    assert!(long.stderr.len() < 3000, "{} bytes", long.stderr.len());
}

#[test]
fn a_task_path_may_have_a_comma() {
    let folder = Studies::new();
    let task = folder.file("usb,old.toml", include_str!("../tasks/usb.toml"));
    folder.study("s", 4, &["--task", &task]).succeeds();
}
