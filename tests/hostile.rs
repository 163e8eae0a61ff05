//! Interference of others with a study while it runs, and files that are not what they should be.
#![cfg(unix)]

use crate::common::{SLOW, Studies, command, end, kill, lines, optimize, read, run, start};
use std::fs;
use std::os::unix::fs::{FileTypeExt, MetadataExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// The binary by a line of shell, in which it is `"$0"`; gives exit code and output.
fn shell(line: &str, arguments: &[&str]) -> crate::common::Ran {
    let mut shell = Command::new("bash");
    shell.args(["-c", line, env!("CARGO_BIN_EXE_optimize")]).args(arguments);
    run(shell.stdin(Stdio::null()).env(SLOW.0, "20"))
}

/// Paths in a folder, sorted.
fn paths(folder: &Path) -> Vec<PathBuf> {
    let mut paths: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}

/// Entries of a cache.
fn cached(cache: &Path) -> Vec<PathBuf> {
    paths(cache).iter().flat_map(|folder| paths(folder)).collect()
}

fn mkfifo(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().expect("mkfifo").success());
}

#[test]
fn a_standard_error_that_has_gone_or_is_full_ends_nothing() {
    let studies = Studies::new();
    let study = "--task usb --engine fake --budget 60 --batch 1 --no-cache --threads 1 --out";
    let ends = [
        ("head", "2>&1 >/dev/null | head -2 >/dev/null"),
        ("full", "2>/dev/full >/dev/null"),
        ("closed", "2>&- >/dev/null"),
    ];
    for (name, end) in ends {
        let line = |words: &str| format!("set -o pipefail; \"$0\" {words} {end}");
        shell(&line(&format!("{study} \"$1\"")), &[&studies.word(name)]).succeeds();
        assert_eq!(studies.journal(name).lines().count(), 62, "{name}");
        // A plain error says what it can and keeps its exit code.
        for words in ["--task usd --budget 3", "--task usb --budget x"] {
            assert_eq!(shell(&line(words), &[]).code, Some(2), "{name}");
        }
    }
    shell("\"$0\" tasks > /dev/full", &[]).fails(1, &["cannot write the output"]);
    shell("set -o pipefail; \"$0\" tasks | head -1", &[]).succeeds();
}

#[test]
fn an_output_that_is_no_plain_file_is_written_in_place() {
    let studies = Studies::new();
    let node = studies.dir("null");
    let made = Command::new("mknod").arg(&node).args(["c", "1", "3"]).status();
    let svg = |path: &Path| optimize(&["stiffness", "--svg", path.to_str().unwrap()]);
    // Only root may make devices.
    if made.is_ok_and(|status| status.success()) {
        svg(&node).succeeds();
        assert!(fs::symlink_metadata(&node).unwrap().file_type().is_char_device());
    }
    let (victim, link) = (studies.dir("model.svg"), studies.dir("link"));
    symlink(&victim, &link).unwrap();
    svg(&link).succeeds();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink() && read(&victim).contains("<svg"));
    let pipe = studies.dir("pipe");
    mkfifo(&pipe);
    let reader = Command::new("cat").arg(&pipe).stdout(Stdio::piped()).spawn().unwrap();
    svg(&pipe).succeeds();
    assert_eq!(end(reader).0, Some(0));
    assert!(fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo());
    svg(Path::new("/dev/full")).fails(1, &["/dev/full: cannot write"]);
    // A name that others write to beside it is never touched.
    studies.file("plain.svg.new", "mine");
    svg(&studies.dir("plain.svg")).succeeds();
    assert_eq!(studies.read("plain.svg.new"), "mine");
}

#[test]
fn twenty_reports_at_once_all_succeed() {
    let studies = Studies::new();
    studies.study("s", 12, &[]).succeeds();
    let dir = studies.dir("s");
    let before = paths(&dir);
    let report = || start(command(&["report"]).arg(&dir));
    let reports: Vec<Child> = (0..20).map(|_| report()).collect();
    for report in reports {
        assert_eq!(end(report), (Some(0), String::new()));
    }
    assert_eq!(paths(&dir), before, "nothing is left beside");
}

#[test]
fn a_huge_file_does_not_fill_the_memory_and_a_damaged_cache_is_measured_again() {
    let studies = Studies::new();
    let cache = studies.word("cache");
    studies.study("s", 4, &["--cache", &cache]).succeeds();
    let config = studies.dir("s/study.toml");
    let text = read(&config);
    fs::File::create(&config).unwrap().set_len(3 << 30).unwrap();
    studies.resume("s").fails(1, &["study.toml", "is longer than"]);
    fs::write(&config, &text).unwrap();
    // The cache: its entries are then measured again.
    let entries = cached(&studies.dir("cache"));
    assert!(entries.len() >= 4, "evaluations and walks");
    for entry in &entries {
        fs::File::create(entry).unwrap().set_len(3 << 30).unwrap();
    }
    studies.study("t", 4, &["--cache", &cache]).succeeds();
    assert_eq!(studies.journal("t"), studies.journal("s"));
}

/// A running study of which `interfere` changes the journal or its folder: exit code and message.
fn interfered(studies: &Studies, name: &str, interfere: impl Fn(&Path)) -> String {
    let dir = studies.dir(name);
    let child = studies.begun(name, 100_000, &["--optimizer", "random"], 13);
    interfere(&dir);
    let (code, stderr) = end(child);
    assert_eq!(code, Some(1), "{name}: {stderr}");
    assert!(stderr.contains("while the study ran"), "{name}: {stderr}");
    stderr
}

#[test]
fn a_journal_that_others_change_stops_the_study() {
    let studies = Studies::new();
    let journal = |dir: &Path| dir.join("journal.jsonl");
    type Interference<'a> = (&'a str, &'a str, &'a dyn Fn(&Path));
    let shorten = |dir: &Path| {
        fs::OpenOptions::new().write(true).open(journal(dir)).unwrap().set_len(700).unwrap();
    };
    let replace = |dir: &Path| {
        fs::copy(journal(dir), dir.join("copy")).unwrap();
        fs::rename(dir.join("copy"), journal(dir)).unwrap();
    };
    let cases: [Interference; 5] = [
        ("removed", "was removed", &|dir| fs::remove_file(journal(dir)).unwrap()),
        ("renamed", "was removed", &|dir| fs::rename(journal(dir), dir.join("x")).unwrap()),
        ("shortened", "was changed", &shorten),
        ("replaced", "was changed", &replace),
        ("folder", "was removed", &|dir| {
            fs::rename(dir, dir.with_extension("moved")).unwrap();
        }),
    ];
    for (name, words, interfere) in cases {
        let stderr = interfered(&studies, name, interfere);
        assert!(stderr.contains(words), "{name}: {stderr}");
        assert!(stderr.contains("restore the file and resume"), "{name}: {stderr}");
    }
}

#[test]
fn a_second_writer_is_refused() {
    let studies = Studies::new();
    let more = ["--optimizer", "random"];
    let first = studies.begun("s", 100_000, &more, 5);
    let owner = first.id().to_string();
    studies.study("s", 100_000, &more).fails(1, &["another process", &owner, "--out"]);
    studies.report("s").succeeds();
    kill(first, "KILL");
    // The lock of a dead process blocks nobody.
    let inode = || fs::metadata(studies.dir("s/.lock")).unwrap().ino();
    let before = inode();
    let done = lines(&studies.dir("s/journal.jsonl"));
    let mut second = start(command(&["resume", "--quiet"]).arg(studies.dir("s")));
    studies.wait_for_lines("s", done + 1, &mut second);
    assert_eq!(inode(), before);
    kill(second, "KILL");
}

/// A copy of a shipped file in which the first line that begins with `key` is another.
fn changed(studies: &Studies, name: &str, text: &str, key: &str, by: &str) -> String {
    let line = text.lines().find(|line| line.starts_with(key)).expect("the key is there");
    studies.file(name, text.replacen(line, by, 1))
}

#[test]
fn input_files_that_mean_nothing_are_refused_before_anything_is_simulated() {
    let studies = Studies::new();
    let usb = include_str!("../tasks/usb.toml");
    let parts = |count: usize| {
        let part = |i| {
            format!(
                "[[socket.part]]\nname = \"p{i}\"\nshape = \"cylinder\"\ncentre_mm = [0, 0]\n\
                 diameter_mm = 1\nz_mm = [0, 1]\n"
            )
        };
        (0..count).map(part).collect::<String>() + "[grip]"
    };
    let (few, many) = (parts(3_000), parts(100_000));
    let cylinder = "[[plug.part]]\nname = \"c\"\nshape = \"cylinder\"\ncentre_mm = [0, 0]\n\
                    diameter_mm = 1e160\nz_mm = [0, 1]\n[grip]";
    for (key, by, words) in [
        ("[grip]", cylinder, "diameter_mm: is 1e160"),
        ("[grip]", &few, "there must be 1 to 3000"),
        ("[grip]", &many, "is longer than"),
        ("finger_plug =", "finger_plug = 0.0", "finger_plug_torsion_mm: is"),
    ] {
        let task = changed(&studies, "task.toml", usb, key, by);
        studies.study("s", 3, &["--task", &task]).fails(2, &["task.toml", words]);
    }
    let codesign = include_str!("../spaces/codesign.toml");
    let mass = "[[parameter]]\nkey = \"finger.mass_g\"\nlow = 1e300\nhigh = 1e300\nstep = 1.0\n\
                source = \"\"\n[[parameter]]";
    let space = changed(&studies, "mass.toml", codesign, "[[parameter]]", mass);
    studies.study("s", 3, &["--space", &space]).fails(2, &["mass.toml", "finger.mass_g"]);
    assert!(!studies.dir("s").exists(), "no study was begun");
}

#[test]
fn what_a_terminal_would_obey_is_shown_instead() {
    let studies = Studies::new();
    let ran = optimize(&["--task", "\u{1b}[31mred\u{9b}2J", "--budget", "3"]);
    ran.fails(2, &["\\u001b[31mred\\u009b2J"]);
    let usage = optimize(&["--task", "usb", "--budget", "\u{1b}[31m"]);
    usage.fails(2, &["--budget"]);
    for said in [ran.stderr, usage.stderr] {
        assert!(!said.chars().any(|c| c.is_control() && c != '\n'), "{said:?}");
    }
    let name = "e\u{1b}[31m";
    studies.study(name, 6, &[]).succeeds();
    let svg = studies.dir("compare.svg");
    let compare = run(command(&["compare"]).arg(studies.dir(name)).arg("--svg").arg(&svg));
    for text in [compare.succeeds(), &read(&svg), &studies.read(&format!("{name}/report.html"))] {
        assert!(!text.chars().any(|c| c.is_control() && !"\n\t\r".contains(c)));
    }
}

/// No file may have a single block, as on a full disk: each command that writes says which file, with
/// exit code 1, and leaves nothing behind.
#[test]
fn no_room_for_an_output_is_a_message_and_leaves_nothing() {
    let studies = Studies::new();
    studies.study("study", 6, &[]).succeeds();
    let finger = "--density 20 --direction 10";
    let calibrate = "calibrate --task usb --engine fake --simulations 16 --samples 20 --no-cache --quiet \
                     --measurements published --out";
    fs::create_dir(studies.dir("full")).unwrap();
    let full = studies.dir("full");
    let study = studies.dir("study");
    for (words, file) in [
        (calibrate.to_owned(), ""),
        (format!("measure add --task usb {finger} --range-mm 5"), "m.csv"),
        ("task new mine --engine fake --like usb --out".to_owned(), "m.toml"),
        (format!("export finger --format 3mf {finger} --out"), "f.3mf"),
        (format!("trial --task usb {finger} --record"), "t.html"),
        (format!("compare {} --svg", study.display()), "c.svg"),
    ] {
        let path = full.join(file);
        let line = format!("ulimit -f 0; exec \"$0\" {words} \"$1\"");
        shell(&line, &[path.to_str().unwrap()]).fails(1, &[full.to_str().unwrap(), "cannot write"]);
        assert_eq!(paths(&full), Vec::<PathBuf>::new(), "{words}");
    }
    // What was there stays as it was.
    let add = |limit: &str| {
        let words = format!("measure add --task usb {finger} --range-mm 5 --date");
        let line = format!("{limit} exec \"$0\" {words} \"$1\" \"$2\"");
        let day = if limit.is_empty() { "2026-01-01" } else { "2026-01-02" };
        shell(&line, &[day, &studies.word("kept.csv")])
    };
    add("").succeeds();
    let before = studies.read("kept.csv");
    add("ulimit -f 0;").fails(1, &["kept.csv: cannot write"]);
    assert_eq!(studies.read("kept.csv"), before);
    let folder = || (paths(&study), studies.read("study/report.html"));
    let before = folder();
    shell("ulimit -f 0; exec \"$0\" report \"$1\"", &[&studies.word("study")])
        .fails(1, &["cannot write"]);
    assert_eq!(folder(), before);
}

#[test]
fn a_limit_of_the_file_size_is_a_message_and_leaves_a_whole_journal() {
    let studies = Studies::new();
    studies.study("reference", 22, &[]).succeeds();
    let expected = studies.journal("reference");
    let study = "--task usb --engine fake --budget 22 --no-cache --quiet --out";
    // The first write that does not fit is cut at another place of its line.
    for kibibytes in [7, 11, 15, 19] {
        let name = format!("limited-{kibibytes}");
        let line = format!("ulimit -f {kibibytes}; exec \"$0\" {study} \"$1\"");
        shell(&line, &[&studies.word(&name)])
            .fails(1, &["journal.jsonl: cannot write", "optimize resume"]);
        let kept = studies.journal(&name);
        assert!(kept.lines().count() > 3 && expected.starts_with(&kept), "{name}");
        studies.resume(&name).succeeds();
        assert_eq!(studies.journal(&name), expected, "{name}");
    }
}
