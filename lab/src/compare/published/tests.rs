//! Tables of windows that are known in closed form or published.

use super::table::CSV_HEADER;
use super::*;
use crate::compare::Subject;
use crate::compare::tests::window;
use insertion::evaluation::tolerance::{Search, evaluate};
use insertion::task::finger::FingerModel;
use insertion::trial::fake::FakeRig;

/// Returns the windows of every measured design on a task with the fake engine.
fn table(task: &str) -> TaskTable {
    let measured = insertion::stiffness::designs();
    let window = |m: &Measurement| {
        let subject = Subject::new(task, &FingerModel::default(), *m);
        evaluate(&FakeRig::default(), &subject.finger, Search::Strides).window
    };
    TaskTable::new(task, measured.iter().map(|m| (*m, window(m))))
}

#[test]
fn published_match_scores_are_the_papers() {
    for (task, score) in [("ket12", 100.0), ("ket8", 100.0), ("rj45", 54.5), ("usb", 27.3)] {
        let found = Agreement::new(&table(task).rows, [1, 2]);
        assert!((found.match_percent.unwrap() - score).abs() < 0.05, "{task}: {found:?}");
    }
}

#[test]
fn missing_bench_ranges_are_skipped() {
    let found = Agreement::new(&table("ket12").rows, [1, 2]);
    // |4.5-7.8| + |4.4-7.5| + |4.7-7.8| + |4.6-7.7| + |4.6-7.2| + |4.6-6.5| + |4.6-6.6|
    // = 3.3 + 3.1 + 3.1 + 3.1 + 2.6 + 1.9 + 2.0 = 19.1
    assert!((found.mean_absolute_error_mm.unwrap() - 19.1 / 7.0).abs() < 1e-9);
}

#[test]
fn agreement_of_three_designs_by_hand() {
    use FailureClass::{ContactLossInInsertion as Lost, Jammed, PlugMissed as Missed};
    let windows = [
        window([-50, 30], [Lost, Jammed]),   // 8.0; published 9.0, 4 | 3
        window([-50, 32], [Lost, Missed]),   // 8.2; published 7.6, 4 | 3
        window([-30, 30], [Jammed, Jammed]), // 6.0; published 6.3, 4 | 3
    ];
    let designs = insertion::stiffness::designs();
    let found = TaskTable::new("usb", designs.into_iter().zip(windows)).agreements()[0];
    assert!((found.mean_absolute_error_mm.unwrap() - (1.0 + 0.6 + 0.3) / 3.0).abs() < 1e-9);
    assert!((found.spearman.unwrap() - 0.5).abs() < 1e-12);
    assert!((found.match_percent.unwrap() - 100.0 * 4.0 / 6.0).abs() < 1e-9);
}

#[test]
fn a_nominal_start_that_does_not_insert_has_no_match_and_a_range_of_0_unless_it_diverges() {
    for (task, nominal, error_mm, cells) in [
        ("usb", Outcome::Diverged, None, ",diverged,0,0,,,,9.0"),
        ("ket8", Outcome::Failed(FailureClass::Jammed), Some(7.2), ",3,0,0,0.0,,,7.2"),
    ] {
        let end = Some(nominal);
        let (steps, ends) = ([0, 0], [FailureClass::Jammed; 2]);
        let failed =
            Window { nominal, end_negative: end, end_positive: end, ..window(steps, ends) };
        let table = TaskTable::new(task, insertion::stiffness::designs().into_iter().zip([failed]));
        let found = table.agreements()[0];
        assert_eq!(found.match_percent, Some(0.0));
        assert_eq!(found.mean_absolute_error_mm, error_mm);
        assert!(csv(&[table]).lines().nth(1).unwrap().contains(cells));
    }
}

#[test]
fn tables_are_complete() {
    let tables = ["ket8", "ket12", "rj45", "usb"].map(table);
    let found = csv(&tables);
    assert_eq!(found.lines().count(), 1 + 4 * 11);
    let cells = |line: &str| line.split(',').count();
    assert!(found.lines().all(|line| cells(line) == cells(CSV_HEADER)), "{found}");
    // Design 1: -(2 + 4 / 1.2) = -5.33 and 1 + 52.4 / 50 = 2.048 mm.
    let first =
        "ket8,1,10,0,52.4,1.2,inserted,-5.3,2,7.3,3,2,7.2,3,3,7.6,3,3,0.1,1.4,-0.3,3.9,-0.4,5.3";
    assert_eq!(found.lines().nth(1), Some(first));
    let accuracy = accuracy(&tables);
    assert!(accuracy.contains("2.73 mm, +0.00, 100.0 % |\n| rj45 |"), "{accuracy}");
}
