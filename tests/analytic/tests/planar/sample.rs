//! Random insertions of the referee.

use analytic_checks::planar::sample::draw;
use analytic_checks::planar::{Outcome, Record};

/// Number of random insertions.
const INSERTIONS: u64 = 200;

/// The rule for indeterminate cases leaves most of the sample, and all three outcomes are in it.
#[test]
fn sample_has_all_outcomes_and_few_indeterminate_cases() {
    let records: Vec<_> = (0..INSERTIONS).step_by(2).map(|i| draw(i).run(20e-6).unwrap()).collect();
    let indeterminate = records.iter().filter(|record| record.indeterminate()).count();
    assert!(indeterminate * 100 <= 15 * records.len(), "{indeterminate}");
    for outcome in [Outcome::Inserted, Outcome::Missed, Outcome::Jammed] {
        let count = records.iter().filter(|record| record.outcome == outcome).count();
        assert!(count >= 10, "{outcome:?}: {count}");
    }
}

/// Half the step of the drive changes no outcome, and the force at the end hardly.
#[test]
fn half_the_step_changes_no_outcome() {
    for trial in (0..INSERTIONS).step_by(8).map(draw) {
        let [whole, half] = [20e-6, 10e-6].map(|step| trial.run(step).unwrap());
        assert_eq!(whole.outcome, half.outcome, "{trial:?}");
        assert_eq!(whole.indeterminate(), half.indeterminate(), "{trial:?}");
        let end = |record: &Record| record.forces.last().unwrap()[1];
        if whole.outcome == Outcome::Inserted {
            assert!((end(&whole) - end(&half)).abs() < 0.1, "{trial:?}");
        }
    }
}
