use super::*;
use analysis::levers::Levers;
use input::Place;
use input::shipped::{self, Source};
use insertion::evaluation::grid_mm;
use insertion::task::StartRule;
use insertion::trial::NEVER;
use insertion::trial::engine::EngineKind;
use std::sync::atomic::AtomicBool;

fn usb() -> SetupRequest {
    let tasks = TaskSource::list("usb");
    SetupRequest { tasks, engine: EngineKind::Fake, ..SetupRequest::default() }
}

fn middle() -> FingerRequest {
    FingerRequest { density: Some(20.0), direction: Some(10.0), ..FingerRequest::default() }
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
fn what_no_command_line_has_checked_is_refused_by_its_option() {
    let study = |change: &dyn Fn(&mut StudyRequest)| {
        let mut request = StudyRequest::new(usb(), Some(4));
        change(&mut request);
        refused(AnyStudy::Asked(Box::new(request)).folder())
    };
    for (said, option) in [
        (study(&|study| study.budget = Some(0)), "--budget 0: must lie between 1 and"),
        (study(&|study| study.seed = u64::MAX), "--seed"),
        (study(&|study| study.batch = Some(0)), "--batch"),
        (study(&|study| study.run.threads = Some(0)), "--threads"),
        (study(&|study| study.run.effort.samples = Some(1)), "--samples"),
        (study(&|study| study.setup.tasks.clear()), "--task"),
    ] {
        assert!(said.contains(option), "{said}");
    }
    let evaluate = |finger, repeat| {
        let request = EvaluateRequest { setup: usb(), finger, repeat, ..Default::default() };
        refused(request.run(&NEVER))
    };
    let springs =
        |a, b| FingerRequest { stiffness_compliance: a, stiffness_assembly: b, ..middle() };
    assert!(evaluate(springs(Some(2.0), None), None).contains("give both"));
    assert!(evaluate(springs(Some(f64::NAN), Some(20.0)), None).contains("above 0"));
    let once = Some(RepeatRequest { count: 1, seed: 0 });
    assert!(evaluate(middle(), once).contains("--repeat 1"));
    let trial = |offset_mm, every_s| {
        let (setup, finger) = (usb(), middle());
        let request = TrialRequest { setup, finger, offset_mm, every_s, ..Default::default() };
        refused(request.run(&NEVER))
    };
    assert!(trial(f64::NAN, None).contains("--offset-mm"));
    assert!(trial(0.0, Some(-1.0)).contains("every_s"));
}

#[test]
fn what_is_stopped_ends_as_interrupted() {
    let stop = AtomicBool::new(true);
    let interrupted = |failure: Option<Failure>| {
        assert!(matches!(&failure, Some(Failure::Interrupted(None))));
    };
    let (setup, finger) = (usb(), middle());
    let evaluate = EvaluateRequest { setup, finger, ..Default::default() };
    interrupted(evaluate.run(&stop).err());
    let (setup, finger) = (usb(), middle());
    interrupted(TrialRequest { setup, finger, ..Default::default() }.run(&stop).err());
    interrupted(LeversRequest { setup: usb(), finger: middle() }.run(&stop).err());
    let bench = BenchRequest { setup: usb(), measurements: "published".to_owned() };
    let how = HowCalibrated {
        priors: "bench".to_owned(),
        effort: EffortRequest { simulations: Some(16), samples: None },
        seed: 0,
        cache: CacheRequest::default(),
    };
    interrupted(CalibrateRequest { bench, how }.run(&stop, &mut |_| ()).err());
}

#[test]
fn levers_begin_at_the_taught_window_and_keep_to_what_can_be() {
    let finger = |set: &[(&str, f64)]| {
        let set = set.iter().map(|&(key, value)| (key.to_owned(), value)).collect();
        FingerRequest { set, ..middle() }
    };
    let levers = |set: &[(&str, f64)]| {
        let request = LeversRequest { setup: usb(), finger: finger(set) };
        request.run(&NEVER).unwrap()
    };
    let named = |found: &Levers, name: &str| {
        found.levers.iter().find(|lever| lever.name == name).unwrap().clone()
    };
    let found = levers(&[]);
    let setup = SetupRequest { start: Some(StartRule::Taught), ..usb() };
    let evaluate = EvaluateRequest { setup, finger: middle(), ..Default::default() };
    let evaluation = evaluate.run(&NEVER).unwrap().evaluation;
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
    let evaluate = |setup: SetupRequest, finger: FingerRequest, repeat| {
        let request = EvaluateRequest { setup, finger, repeat, ..Default::default() };
        let failure = request.run(&NEVER).err().unwrap();
        let Place { file, line, key } = failure.place();
        (matches!(failure, Failure::Task(_)), file.unwrap_or_default(), line, key)
    };
    let task = |text: String| {
        let tasks = vec![TaskSource::Given(Source { file: "mine.toml".to_owned(), text })];
        evaluate(SetupRequest { tasks, ..usb() }, middle(), None)
    };
    let text = TaskSource::Named("usb".to_owned()).read().unwrap().text;
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
    assert_eq!(evaluate(setup, middle(), None), (false, table, Some(3), column));
    let once = Some(RepeatRequest { count: 1, seed: 0 });
    let wrong = evaluate(usb(), middle(), once);
    assert_eq!(wrong, (false, String::new(), None, Some("repeat".to_owned())));
}

#[test]
fn a_sweep_measures_what_evaluate_does_in_its_order_and_keeps_it() {
    let dir = tempfile::tempdir().unwrap();
    let cache = CacheRequest { dir: Some(dir.path().to_owned()), off: false };
    let run = RunRequest { threads: Some(3), cache, ..RunRequest::default() };
    let windows = EvaluateRequest { setup: usb(), walk: true, ..Default::default() };
    let finger = |density| FingerRequest { density: Some(density), ..middle() };
    let fingers = [12.0, 30.0, 17.0].map(finger);
    let sweep = Sweep::new(&windows, &run).unwrap();
    for _ in 0..2 {
        let found = sweep.measure(&fingers, &NEVER).unwrap();
        for (finger, found) in fingers.iter().zip(found) {
            let alone = EvaluateRequest { finger: finger.clone(), ..windows.clone() };
            assert_eq!(found.evaluation, alone.run(&NEVER).unwrap().evaluation);
        }
    }
    assert_eq!(sweep.known(), 3);
    let wrong = refused(sweep.measure(&[finger(20.0), finger(99.0)], &NEVER));
    assert!(wrong.contains("--density 99"), "{wrong}");
    assert!(sweep.measure(&fingers, &AtomicBool::new(true)).is_err());
}
