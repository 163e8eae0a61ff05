//! Requests and responses as other programs use them.

use analysis::levers::Levers;
use finger_opt::command::Request as _;
use finger_opt::commands::{COMMANDS, evaluate, levers, study};
use finger_opt::context::Context;
use finger_opt::failure::Failure;
use finger_opt::keywords;
use finger_opt::setup::finger::{FingerRequest, InfillRequest};
use finger_opt::setup::request::{SetupRequest, TaskSource};
use finger_opt::setup::run::{CacheRequest, RunRequest};
use finger_opt::studies::request::AnyStudy;
use finger_opt::studies::sweep::Sweep;
use input::Place;
use input::shipped::{self, Source};
use insertion::evaluation::grid_mm;
use insertion::task::StartRule;
use insertion::trial::NEVER;
use insertion::trial::engine::EngineKind;
use serde_json::{Map, Value, json};
use std::sync::atomic::AtomicBool;

fn usb() -> SetupRequest {
    let tasks = TaskSource::list("usb");
    SetupRequest { tasks, engine: EngineKind::Fake, ..SetupRequest::default() }
}

fn middle() -> FingerRequest {
    FingerRequest { infill: InfillRequest::of(20.0, 10.0), ..FingerRequest::default() }
}

fn silent() -> Context<'static> {
    Context::silent(&NEVER)
}

/// Keywords of the fake engine's usb with the finger in the middle, and these.
fn words(more: Value) -> Map<String, Value> {
    let base = json!({"task": "usb", "engine": "fake", "density": 20.0, "direction": 10.0});
    let (Value::Object(mut base), Value::Object(more)) = (base, more) else { unreachable!() };
    base.extend(more);
    base
}

fn call(name: &str, more: Value) -> Result<Value, Failure> {
    keywords::call(COMMANDS, name, &words(more), &silent())?.value
}

/// The text of a failure by bad input.
fn refused<T>(done: Result<T, Failure>) -> String {
    match done {
        Err(failure @ (Failure::Input(_) | Failure::Task(_))) => failure.to_string(),
        Err(failure) => panic!("failed while running: {failure}"),
        Ok(_) => panic!("was not refused"),
    }
}

#[test]
fn keywords_are_refused_by_their_option() {
    let study = |more: Value| {
        let Value::Object(words) = more else { unreachable!() };
        let request = keywords::request::<study::Request>(&words);
        refused(request.and_then(|request| AnyStudy::Asked(Box::new(request)).create()))
    };
    for (more, said) in [
        (json!({"task": "usb", "budget": 0}), "--budget 0: must lie between 1 and "),
        (json!({"task": "usb", "budget": "abc"}), "--budget abc"),
        (json!({"task": "usb", "seed": u64::MAX}), "--seed"),
        (json!({"task": "usb", "batch": 0}), "--batch"),
        (json!({"task": "usb", "threads": 0}), "--threads"),
        (json!({"task": "usb", "samples": 1}), "--samples"),
        (json!({"task": "usb", "optimizer": "gpp"}), "--optimizer gpp"),
        (json!({"budget": 4}), "--task"),
        (json!({"task": "usb", "buget": 4}), "unknown option `buget`"),
    ] {
        let text = study(more);
        assert!(text.contains(said), "{text}");
    }
    let not_a_number = json!({"stiffness_compliance": "NaN", "stiffness_assembly": 20.0});
    for (name, more, said) in [
        ("evaluate", json!({"stiffness_compliance": 2.0}), "--stiffness-assembly"),
        ("evaluate", not_a_number, "must lie in 0.000001"),
        ("evaluate", json!({"repeat": 1}), "--repeat 1"),
        ("trial", json!({"offset_mm": "NaN"}), "--offset-mm"),
        ("trial", json!({"every_s": -1.0}), "--every-s"),
        ("evaluate", json!({"task.strategy.tilt_dg": 8.0}), "tilt_dg"),
    ] {
        let text = refused(call(name, more));
        assert!(text.contains(said), "{text}");
    }
    assert!(refused(call("evaluat", json!({}))).contains("unknown command `evaluat`"));
}

#[test]
fn a_call_gives_what_the_request_does() {
    let tilted = json!({"task.strategy.tilt_deg": 8.0, "no_ribs": true});
    let found = call("evaluate", tilted).ok().unwrap();
    let set = vec![("task.strategy.tilt_deg".to_owned(), 8.0)];
    let finger = FingerRequest { set, ..middle() };
    let request = evaluate::Request { setup: usb(), finger, ..Default::default() };
    let Ok(done) = request.evaluated(&silent()) else { panic!("refused") };
    assert_eq!(found["range_mm"], json!(done.evaluation.window.range_mm()));
    assert_eq!(found["set"], json!({"task.strategy.tilt_deg": 8.0}));
    let same = call("evaluate", json!({"set": {"task.strategy.tilt_deg": 8.0}, "walk": false}));
    assert_eq!(same.ok().map(|same| same["range_mm"].clone()), Some(found["range_mm"].clone()));
}

#[test]
fn a_cancelled_command_ends_as_interrupted() {
    let stop = AtomicBool::new(true);
    let context = Context::silent(&stop);
    let calibrate =
        json!({"task": "usb", "engine": "fake", "measurements": "published", "simulations": 16});
    for (name, words) in [
        ("evaluate", words(json!({}))),
        ("trial", words(json!({}))),
        ("levers", words(json!({}))),
        ("calibrate", calibrate.as_object().unwrap().clone()),
    ] {
        let ended = keywords::call(COMMANDS, name, &words, &context);
        assert!(matches!(ended.err(), Some(Failure::Interrupted(None))), "{name}");
    }
    let mut cached = calibrate.clone();
    cached["cache"] = json!("unused");
    let ended = keywords::call(COMMANDS, "calibrate", cached.as_object().unwrap(), &context);
    let hint = "interrupted; the same command continues from the cache";
    assert_eq!(ended.err().map(|failure| failure.to_string()).as_deref(), Some(hint));
}

#[test]
fn levers_begin_at_the_taught_window_and_keep_to_what_can_be() {
    let levers = |set: &[(&str, f64)]| {
        let set = set.iter().map(|&(key, value)| (key.to_owned(), value)).collect();
        let finger = FingerRequest { set, ..middle() };
        let request = levers::Request { setup: usb(), finger, svg: None };
        let found = request.run(&silent()).ok().unwrap().value.ok().unwrap();
        serde_json::from_value::<Levers>(found).unwrap()
    };
    let named = |found: &Levers, name: &str| {
        found.levers.iter().find(|lever| lever.name == name).unwrap().clone()
    };
    let found = levers(&[]);
    let setup = SetupRequest { start: Some(StartRule::Taught), ..usb() };
    let evaluate = evaluate::Request { setup, finger: middle(), ..Default::default() };
    let evaluation = evaluate.evaluated(&silent()).ok().unwrap().evaluation;
    assert_eq!(found.base.range_mm, evaluation.window.range_mm());
    assert_eq!(Some(found.base.taught_start_mm), evaluation.taught.map(grid_mm));
    assert!(found.windows <= 20 && found.levers.len() > 7, "{found:?}");
    assert_eq!(levers(&[]), found);
    // Where it is already, nothing is measured again.
    let chamfer = named(&found, "chamfer at the opening");
    assert_eq!((chamfer.low, chamfer.value), (0.0, 0.0));
    assert_eq!(chamfer.ends[0], Some(found.base.range_mm));
    // A tilt of more than 45 degrees is refused by the task, and no plug is wider than its opening.
    let walls = [("task.socket.opening_y_mm.0", -6.01), ("task.socket.opening_y_mm.1", 6.01)];
    let tight = levers(&[("task.strategy.tilt_deg", 43.0), walls[0], walls[1]]);
    let tilt = named(&tight, "tilt");
    assert_eq!([tilt.low, tilt.value, tilt.high], [38.0, 43.0, 45.0]);
    let clearance = named(&tight, "clearance");
    assert!((0.0..1e-3).contains(&clearance.low), "{clearance:?}");
    assert!((clearance.high - 0.07).abs() < 1e-9, "{clearance:?}");
}

#[test]
fn failures_say_where() {
    let place = |failure: Failure| {
        let Place { file, line, key } = failure.place();
        (matches!(failure, Failure::Task(_)), file.unwrap_or_default(), line, key)
    };
    let evaluate = |setup: SetupRequest| {
        let request = evaluate::Request { setup, finger: middle(), ..Default::default() };
        place(request.run(&silent()).err().unwrap())
    };
    let task = |text: String| {
        let tasks = vec![TaskSource::Given(Source { file: "mine.toml".to_owned(), text })];
        evaluate(SetupRequest { tasks, ..usb() })
    };
    let text = TaskSource::Named("usb".to_owned()).read().ok().unwrap().text;
    let mine = || "mine.toml".to_owned();
    let force = text.replace("\nforce_n = ", "\nforce_n = -");
    assert_eq!(task(force), (true, mine(), None, Some("grip.force_n".to_owned())));
    assert_eq!(task("name = 1\nname = 2\n".to_owned()), (true, mine(), Some(2), None));
    let dir = tempfile::tempdir().unwrap();
    let table = dir.path().join("mine.csv").display().to_string();
    let text = shipped::STIFFNESS[0].text.replacen("\n2,", "\n2,x", 1);
    std::fs::write(&table, text).unwrap();
    let setup = SetupRequest { stiffness_data: Some(table.clone()), ..usb() };
    let column = Some("infill_density_percent".to_owned());
    assert_eq!(evaluate(setup), (false, table, Some(3), column));
    let wrong = place(call("evaluate", json!({"repeat": 1})).err().unwrap());
    assert_eq!(wrong, (false, String::new(), None, Some("repeat".to_owned())));
}

#[test]
fn tasks_go_as_texts_through_keywords() {
    let text = TaskSource::Named("usb".to_owned()).read().ok().unwrap().text;
    let text = text.replace("name = \"usb\"", "name = \"mine\"");
    let given = json!([{"file": "mine.toml", "text": text}]);
    let found = call("evaluate", json!({"task": format!("\0{given}")})).ok().unwrap();
    assert_eq!(found["task"], "mine");
}

#[test]
fn a_sweep_measures_what_evaluate_does_in_its_order_and_keeps_it() {
    let dir = tempfile::tempdir().unwrap();
    let cache = CacheRequest { dir: Some(dir.path().to_owned()), off: false };
    let run = RunRequest { threads: Some(3), cache, ..RunRequest::default() };
    let windows = evaluate::Request { setup: usb(), walk: true, ..Default::default() };
    let finger = |density| FingerRequest { infill: InfillRequest::of(density, 10.0), ..middle() };
    let fingers = [12.0, 30.0, 17.0].map(finger);
    let sweep = Sweep::new(&windows, &run).ok().unwrap();
    for _ in 0..2 {
        let found = sweep.measure(&fingers, &NEVER).ok().unwrap();
        for (finger, found) in fingers.iter().zip(found) {
            let alone = evaluate::Request { finger: finger.clone(), ..windows.clone() };
            assert_eq!(found.evaluation, alone.evaluated(&silent()).ok().unwrap().evaluation);
        }
    }
    let folders = std::fs::read_dir(dir.path()).unwrap();
    let files =
        |folder: std::io::Result<std::fs::DirEntry>| std::fs::read_dir(folder.unwrap().path());
    assert_eq!(folders.flat_map(|folder| files(folder).unwrap()).count(), 3);
    let wrong = refused(sweep.measure(&[finger(20.0), finger(99.0)], &NEVER));
    assert!(wrong.contains("--density 99"), "{wrong}");
    assert!(sweep.measure(&fingers, &AtomicBool::new(true)).is_err());
}
