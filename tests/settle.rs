//! Studies without a budget: they end when no design is expected to gain, wherever they were
//! interrupted, and their confirmations are kept with them.

use crate::common::{Ran, Studies, answer, command, kill, run, setting, start};
use ask_tell::stream::stream;
use rand::RngExt;
use serde_json::Value;
use std::process::Command;
use std::time::Duration;

/// Kills of a study; set the environment variable `KILLS` for more.
const KILLS: u64 = 6;

/// A quiet study on the fake engine without a budget, not yet started.
fn settling(folder: &Studies, name: &str, more: &[&str]) -> Command {
    let mut command = command(&["--engine", "fake", "--quiet", "--json", "--task", "usb"]);
    command.arg("--out").arg(folder.dir(name)).args(more);
    command
}

/// A file of usb whose plug is held so far from the remote centre that only stiff fingers insert.
fn far(folder: &Studies, name: &str, rcc_mm: f64) -> String {
    let finger = format!("[finger]\nrcc_mm = {rcc_mm}\n[friction]");
    folder.file(name, include_str!("../tasks/usb.toml").replace("[friction]", &finger))
}

/// Evaluations and ending of a study that failed because nothing inserts.
fn in_vain(ran: &Ran) -> (Value, Value) {
    ran.fails(1, &["no design of the study inserts"]);
    let found: Value = serde_json::from_str(&ran.stdout).expect("JSON");
    assert_eq!(found["answer"]["verdict"], "nothing_inserts");
    (found["evaluations"].clone(), found["ending"].clone())
}

#[test]
fn a_study_of_which_nothing_inserts_ends_after_twelve_evaluations() {
    let folder = Studies::new();
    let task = far(&folder, "never.toml", 60.0);
    let ended = (Value::from(12), Value::from("nothing_inserts"));
    for (name, more) in [
        ("batch", &[][..]),
        ("within", &["--batch", "5"]),
        ("generations", &["--optimizer", "cma-es", "--batch", "7"]),
        ("polished", &["--optimizer", "random", "--polish", "--batch", "32"]),
        ("async", &["--async", "--batch", "9", "--threads", "4"]),
    ] {
        let ran = folder.study(name, 40, &[&["--task", &task, "--json"], more].concat());
        assert_eq!(in_vain(&ran), ended, "{name}");
        let tune = format!("optimize task tune {task}");
        assert!(ran.stderr.lines().next().is_some_and(|line| line.contains(&tune)), "{name}");
        assert!(ran.stdout.contains(&tune), "{name}");
        // Nor does it go on.
        let journal = folder.journal(name);
        let resumed = run(command(&["resume", "--quiet", "--json"]).arg(folder.dir(name)));
        assert_eq!(in_vain(&resumed), ended, "{name}");
        assert!(!resumed.stderr.contains("warning"), "it has begun: {}", resumed.stderr);
        assert_eq!(folder.journal(name), journal);
    }
    let short = folder.study("short", 8, &["--task", &task, "--json"]);
    assert_eq!(in_vain(&short), (8.into(), "budget_spent".into()));
    // On another task they do.
    let both = folder.study("both", 16, &["--json", "--task", &format!("{task},rj45")]);
    assert_eq!(in_vain(&both), (16.into(), "budget_spent".into()));
}

#[test]
fn a_study_goes_on_once_a_design_has_inserted() {
    let folder = Studies::new();
    // The closed form inserts from an assembly stiffness of 51.5 N/mm on: the fifth has 57.1.
    let task = far(&folder, "far.toml", 41.3);
    let more = ["--optimizer", "random", "--batch", "16", "--seed", "5", "--json", "--task", &task];
    let whole = folder.study("whole", 40, &more).json();
    assert_eq!((&whole["evaluations"], &whole["ending"]), (&40.into(), &"budget_spent".into()));
    let inserts = |line: &str| line.contains("\"nominal\":\"inserted\"");
    assert_eq!(folder.journal("whole").lines().skip(2).position(inserts), Some(4));
    // The batch that waited for it is the same, wherever it was interrupted.
    for budget in [3, 5, 14, 40] {
        folder.study("parts", budget, &more);
    }
    assert_eq!(folder.journal("parts"), folder.journal("whole"));
    let asynchronous = folder.study("async", 40, &[&more[..], &["--async"]].concat());
    assert_eq!(asynchronous.json()["evaluations"], 40);
}

/// Confirmations, without the provenance.
fn confirmed(folder: &Studies, name: &str) -> Value {
    let mut file: Value =
        serde_json::from_str(&folder.read(&format!("{name}/walk.json"))).expect("JSON");
    file.as_object_mut().expect("an object").remove("provenance");
    file
}

#[test]
fn a_study_without_a_budget_settles_and_stays_settled() {
    let folder = Studies::new();
    let found = answer(&run(&mut settling(&folder, "s", &[])));
    let evaluations = found["evaluations"].as_u64().expect("a number");
    assert_eq!((&found["settled"], &found["ending"]), (&Value::Bool(true), &"settled".into()));
    assert!((28..500).contains(&evaluations), "{found}");
    assert_eq!(confirmed(&folder, "s")["settled_after"], evaluations);
    let (journal, kept) = (folder.journal("s"), confirmed(&folder, "s"));
    assert_eq!(answer(&run(&mut settling(&folder, "s", &[]))), found);
    assert_eq!((folder.journal("s"), confirmed(&folder, "s")), (journal.clone(), kept));
    folder.resume("s").says_in_any_lines(&format!(
        "settled after {evaluations} evaluations: no finger is expected to gain 0.3 mm"
    ));
    assert_eq!(folder.journal("s"), journal);
    // No better finger is there: every design of the space, none of them as firm by 0.3 mm more.
    let all = folder.study("all", 861, &["--optimizer", "grid", "--json"]).json();
    let firm = |json: &Value| json["recommended"]["firm_range_mm"].as_f64().expect("a firm range");
    assert!(firm(&all) - firm(&found) <= 0.3 + 1e-9, "{} and {}", firm(&all), firm(&found));
}

#[test]
fn a_budget_goes_on_from_where_a_study_settled() {
    let folder = Studies::new();
    let settled = answer(&run(&mut settling(&folder, "s", &[])));
    let whole = answer(&folder.study("whole", 90, &["--json"]));
    assert_eq!(whole["settled"], false);
    let more = answer(&folder.study("s", 90, &["--json"]));
    assert_eq!(folder.journal("s"), folder.journal("whole"));
    assert_eq!((&more, confirmed(&folder, "s")), (&whole, confirmed(&folder, "whole")));
    assert!(settled["evaluations"].as_u64() < more["evaluations"].as_u64());
    // And back: judged anew, it ends with what it has.
    let back = answer(&run(&mut settling(&folder, "s", &[])));
    assert_eq!(back["evaluations"], 90, "{back}");
    // Less than was measured takes nothing away.
    let fewer = answer(&folder.study("t", 20, &["--json"]));
    assert_eq!(fewer["evaluations"], 20);
}

#[test]
fn neither_threads_nor_kills_change_a_study_that_settles() {
    let folder = Studies::new();
    // Fingers that drop when they are confirmed keep it confirming.
    let more = ["--threads", "1"];
    let whole = answer(&run(&mut settling(&folder, "whole", &more)));
    let threads = answer(&run(&mut settling(&folder, "threads", &["--threads", "4"])));
    assert_eq!((&threads, confirmed(&folder, "threads")), (&whole, confirmed(&folder, "whole")));
    assert_eq!(folder.journal("threads"), folder.journal("whole"));
    let mut random = stream(0, 0, "kills of settling studies");
    for round in 0..setting("KILLS", KILLS) {
        let name = format!("killed-{round}");
        // Some in the search, most while something is confirmed.
        let mut child = start(&mut settling(&folder, &name, &more));
        folder.wait_for_lines(&name, if round % 4 == 0 { 10 } else { 29 }, &mut child);
        std::thread::sleep(Duration::from_millis(random.random_range(0..60)));
        kill(child, "KILL");
        let resumed = run(&mut settling(&folder, &name, &more));
        assert_eq!(answer(&resumed), whole);
        assert_eq!(confirmed(&folder, &name), confirmed(&folder, "whole"));
        assert_eq!(folder.journal(&name), folder.journal("whole"));
    }
}

#[test]
fn what_cannot_settle_has_a_budget() {
    let folder = Studies::new();
    for more in [
        &["--optimizer", "random"][..],
        &["--objective", "peak-force"],
        &["--constraint", "peak-force<=900"],
        &["--polish", "4"],
    ] {
        let found = answer(&run(&mut settling(&folder, more[1], more)));
        assert_eq!((&found["settled"], &found["budget"]), (&Value::Bool(false), &200.into()));
    }
    let unconfirmed = answer(&run(&mut settling(&folder, "unconfirmed", &["--no-confirm"])));
    assert_eq!(unconfirmed["settled"], true);
    assert!(unconfirmed.get("walked").is_none());
    assert_eq!(confirmed(&folder, "unconfirmed")["designs"].as_array().map(Vec::len), Some(0));
    assert!(folder.read("unconfirmed/study.toml").contains("no_confirm = true"));
    assert!(folder.read("unconfirmed/report.html").contains(", not confirmed; "));
    let asynchronous = answer(&run(&mut settling(&folder, "async", &["--async"])));
    assert_eq!(asynchronous["settled"], true);
    let again = answer(&run(&mut settling(&folder, "async", &["--async"])));
    assert_eq!(again["evaluations"], asynchronous["evaluations"]);
}
