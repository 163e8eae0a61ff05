//! Offsets of the trials and totals, with the fake engine.

use super::*;
use crate::compare::tests;
use input::shipped::TASKS;
use insertion::evaluation::tolerance::Search;
use insertion::outcome::FailureClass;
use insertion::stiffness::designs;
use insertion::task::Task;
use insertion::task::finger::FingerModel;

fn window(negative: OffsetStep, positive: OffsetStep) -> Window {
    tests::window([negative, positive], [FailureClass::Jammed, FailureClass::PlugMissed])
}

#[test]
fn offsets_lie_about_both_ends_and_in_the_middle() {
    let wide = offsets(&window(-60, 20), false);
    let negative = [-100, -80, -70, -63, -61, -59, -57, -50, -40];
    let positive = [0, 10, 17, 19, 21, 23, 30, 40, 60];
    assert_eq!(wide, [&negative[..], &[-20], &positive].concat());
    // 1 mm inside is beyond the middle of a window of 1 mm.
    let narrow = offsets(&window(-3, 7), false);
    assert_eq!(narrow, [-43, -23, -13, -6, -4, -2, 0, 2, 4, 6, 8, 10, 17, 27, 47]);
    assert_eq!(offsets(&window(-60, 20), true), [-80, -50, -20, 10, 40]);
}

#[test]
fn an_engine_agrees_with_itself() {
    let setting = |name| tests::setting(name, Search::Strides);
    let task = Task::parse(TASKS[0].text, TASKS[0].file).unwrap();
    let tasks = [TaskSettings { task, settings: ["fake", "again"].map(setting) }];
    let designs = [designs()[0], designs()[10]];
    let check = run(&tasks, &designs, false);
    assert_eq!((check.agreement(), check.end_difference_mm()), (1.0, Some(0.0)));
    assert!(check.passed());
    assert!(check.trials.iter().all(|pair| pair.tip_mm.is_none_or(|by| by == 0.0)));
    // Starts inside the window insert, others do not.
    let inside = |pair: &TrialPair| pair.from_end <= 0;
    let inserts = |pair: &TrialPair| pair.outcomes[0] == Outcome::Inserted;
    assert!(check.trials.iter().all(|pair| inside(pair) == inserts(pair)));
    assert!(text(&check, ["fake", "again"]).contains("100.0 %"));
    let reduced = run(&tasks, &designs, true);
    assert_eq!((reduced.trials.len(), reduced.windows.len()), (10, 0));
}

#[test]
fn a_disagreement_is_counted_and_listed() {
    let subject = Subject::new("usb", &FingerModel::default(), designs()[0]);
    let trial = |offset, second| TrialPair {
        subject: subject.clone(),
        offset,
        from_end: 1,
        outcomes: [Outcome::Failed(FailureClass::Jammed), second],
        tip_mm: None,
    };
    let missed = Outcome::Failed(FailureClass::PlugMissed);
    // Trials that fail in different classes agree.
    let trials = vec![trial(5, missed), trial(7, Outcome::Inserted)];
    let windows = WindowPair {
        subject: subject.clone(),
        settings: ["direct", "mujoco"].map(str::to_owned),
        trials: [20, 20],
        windows: [window(-4, 5), window(-10, 7)],
    };
    let check = CrossCheck { trials, windows: vec![windows] };
    assert_eq!(check.agreement(), 0.5);
    assert!((check.end_difference_mm().unwrap() - 0.4).abs() < 1e-12);
    assert!(!check.passed());
    let text = text(&check, ["direct", "mujoco"]);
    assert!(text.contains("0.7            0.1  jammed"), "{text}");
    assert!(!text.contains("plug missed"), "{text}");
    assert!(!check.trials[1].agrees());
}
