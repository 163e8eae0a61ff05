//! Pairs of windows, and the compared fingers.

use super::*;
use crate::compare::pairs::WindowPair;
use input::shipped::TASKS;
use insertion::evaluation::OffsetStep;
use insertion::outcome::FailureClass;
use insertion::stiffness::representative_designs;
use insertion::tests::fake::FakeRig;

pub(super) fn window(steps: [OffsetStep; 2], ends: [FailureClass; 2]) -> Window {
    let [negative_steps, positive_steps] = steps;
    let [end_negative, end_positive] = ends.map(|class| Some(Outcome::Failed(class)));
    let nominal = Outcome::Inserted;
    Window { nominal, negative_steps, positive_steps, end_negative, end_positive }
}

/// Returns a setting of this name with the fake engine.
fn setting(name: &str, search: Search) -> Setting {
    Setting { name: name.into(), rig: Arc::new(FakeRig::default()), search }
}

fn jammed(negative: OffsetStep, positive: OffsetStep) -> Window {
    window([negative, positive], [FailureClass::Jammed; 2])
}

fn pair(second: Window) -> WindowPair {
    WindowPair {
        subject: Subject::new("usb", &FingerModel::default(), representative_designs()[0]),
        settings: ["production", "half the step"].map(str::to_owned),
        windows: [jammed(-33, 14), second],
        trials: [18, 19],
    }
}

#[test]
fn an_end_may_move_by_as_much_as_is_allowed() {
    let moved = pair(jammed(-34, 13));
    assert_eq!(moved.moved_mm(), [0.1, -0.1]);
    assert!(moved.agrees(1) && !moved.agrees(0));
    assert!(!pair(jammed(-33, 16)).agrees(1));
    let jams = Window { nominal: Outcome::Failed(FailureClass::Jammed), ..jammed(-33, 14) };
    assert!(!pair(jams).agrees(1));
    let difference_mm =
        |windows| engines::CrossCheck { trials: Vec::new(), windows }.end_difference_mm();
    assert_eq!(difference_mm(vec![moved, pair(jammed(-38, 14))]), Some(0.175));
    assert_eq!(difference_mm(Vec::new()), None);
}

#[test]
fn both_searches_make_a_pair_and_the_table_fits_a_terminal() {
    let task = Task::parse(TASKS[0].text, TASKS[0].file).unwrap();
    let settings = [setting("walk", Search::Walk), setting("strides", Search::Strides)];
    let found = pairs::simulate(&[TaskSettings { task, settings }], &representative_designs());
    let names: Vec<&str> = found.iter().map(|pair| pair.settings[1].as_str()).collect();
    assert_eq!(names, ["strides"; 3]);
    assert!(found.iter().all(|pair| pair.agrees(0) && pair.trials[0] > 10));
    let table = pairs::text(&[found, vec![pair(jammed(-33, 19))]].concat(), Some(1));
    assert!(table.lines().all(|line| line.len() <= 80), "{table}");
    assert_eq!((table.matches("FAIL").count(), table.matches(" ok\n").count()), (1, 3), "{table}");
}
