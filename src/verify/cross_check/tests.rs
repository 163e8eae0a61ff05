//! The rule of the set and the totals, on the closed form.

use super::*;
use crate::outcome::FailureClass;
use crate::trial::fake::FakeRig;
use crate::units::N_PER_MM;

fn window(negative: OffsetStep, positive: OffsetStep) -> Window {
    Window {
        nominal: Outcome::Inserted,
        negative_steps: negative,
        positive_steps: positive,
        end_negative: Some(Outcome::Failed(FailureClass::Jammed)),
        end_positive: Some(Outcome::Failed(FailureClass::PlugMissed)),
    }
}

#[test]
fn offsets_lie_about_both_ends_and_in_the_middle() {
    let wide = Set::Full.offsets(&window(-60, 20));
    let negative = [-100, -80, -70, -63, -61, -59, -57, -50, -40];
    let positive = [0, 10, 17, 19, 21, 23, 30, 40, 60];
    assert_eq!(wide, [&negative[..], &[-20], &positive].concat());
    // 1 mm inside is beyond the middle of a window of 1 mm.
    let narrow = Set::Full.offsets(&window(-3, 7));
    assert_eq!(narrow, [-43, -23, -13, -6, -4, -2, 0, 2, 4, 6, 8, 10, 17, 27, 47]);
    assert_eq!(Set::Reduced.offsets(&window(-60, 20)), [-80, -50, -20, 10, 40]);
}

fn finger(compliance: f64, assembly: f64) -> Finger {
    Finger::new(compliance * N_PER_MM, assembly * N_PER_MM)
}

#[test]
fn an_engine_agrees_with_itself() {
    let rig = FakeRig::default();
    let pair = |name: &str, finger| Pair {
        task: "usb".into(),
        finger_name: name.into(),
        finger,
        rigs: [&rig, &rig],
    };
    let pairs = [pair("soft", finger(1.0, 20.0)), pair("stiff", finger(3.0, 50.0))];
    let check = run(&pairs, Set::Full);
    assert_eq!((check.agreement(), check.end_difference_mm()), (1.0, Some(0.0)));
    assert!(
        check.passed() && check.cases.iter().all(|case| case.tip_mm.is_none_or(|by| by == 0.0))
    );
    // What is inside the window inserts, what is outside does not.
    let inside = |case: &Case| case.from_end <= 0;
    assert!(check.cases.iter().all(|case| inside(case) == (case.outcomes[0] == Outcome::Inserted)));
    assert!(text(&check, ["fake", "fake"]).contains("100.0 %"));
    let reduced = run(&pairs, Set::Reduced);
    assert_eq!((reduced.cases.len(), reduced.windows.len()), (10, 0));
}

#[test]
fn a_disagreement_is_counted_and_listed() {
    let case = |offset, second| Case {
        task: "usb".into(),
        finger: "soft".into(),
        offset,
        from_end: 1,
        outcomes: [Outcome::Failed(FailureClass::Jammed), second],
        tip_mm: None,
    };
    let missed = Outcome::Failed(FailureClass::PlugMissed);
    // Another failure class is no disagreement.
    let cases = vec![case(5, missed), case(7, Outcome::Inserted)];
    let windows = Windows {
        task: "usb".into(),
        finger: "soft".into(),
        windows: [window(-4, 5), window(-10, 7)],
    };
    let check = CrossCheck { cases, windows: vec![windows] };
    assert_eq!(check.agreement(), 0.5);
    assert!((check.end_difference_mm().unwrap() - 0.4).abs() < 1e-12);
    assert!(!check.passed());
    let text = text(&check, ["direct", "mujoco"]);
    assert!(text.contains("0.7            0.1  jammed"), "{text}");
    assert!(!text.contains("plug missed"), "{text}");
    assert_eq!(json(&check, ["direct", "mujoco"])["trials"][1]["agrees"], false);
}
