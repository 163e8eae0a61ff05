//! Offsets of the trials and totals, with the fake engine.

use super::*;
use crate::compare::tests;
use insertion::outcome::FailureClass;
use insertion::stiffness::designs;
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
