use super::*;
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
        Err(failure @ Failure::Input(_)) => failure.to_string(),
        Err(Failure::Run(error)) => panic!("failed while running: {error}"),
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
        assert!(
            matches!(&failure, Some(Failure::Run(error)) if error.to_string() == "interrupted")
        );
    };
    let (setup, finger) = (usb(), middle());
    let evaluate = EvaluateRequest { setup, finger, ..Default::default() };
    interrupted(evaluate.run(&stop).err());
    let (setup, finger) = (usb(), middle());
    interrupted(TrialRequest { setup, finger, ..Default::default() }.run(&stop).err());
    let bench = BenchRequest { setup: usb(), measurements: "published".to_owned() };
    let how = HowCalibrated {
        priors: "bench".to_owned(),
        effort: EffortRequest { simulations: Some(16), samples: None },
        seed: 0,
        cache: CacheRequest::default(),
    };
    interrupted(CalibrateRequest { bench, how }.run(&stop, &mut |_| ()).err());
}
