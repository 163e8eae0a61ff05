//! The engines on the closed forms P1 to P11, and on random insertions of the planar referee.

use analytic_checks::planar::sample::draw;
use analytic_checks::slab::{Agreement, Case, Rounding, agreement, engine, forms, table};

/// Step of the referee's drive, m.
const STEP: f64 = 20e-6;

/// Checks that all forms of an engine pass but those of some names.
fn passes(name: &str, missed: &[&str]) {
    let rows = forms(name);
    let failed = |row: &&analytic_checks::CheckRow| !row.passed && !missed.contains(&row.check);
    assert!(rows.iter().find(failed).is_none(), "\n{}", analytic_checks::table(&rows));
    for n in 1..=11 {
        assert!(rows.iter().any(|row| row.check == format!("P{n}")), "P{n}");
    }
}

/// In two-point contact a contact of finite stiffness carries less at the same depth: the second
/// contact closes later, and the force lags. Both deviations halve with its compliance.
#[test]
fn direct_meets_the_forms() {
    passes("direct", &[]);
}

/// A tip of radius 0.3 mm at a friction of 0.2 wedges 0.013 mm deeper, whatever the stiffness.
#[test]
fn rapier_meets_the_forms_but_one() {
    passes("rapier", &["P7"]);
}

/// Without `multiccd` (docs/notes/simulation.md, "Round edges").
#[cfg(feature = "mujoco")]
#[test]
fn mujoco_meets_the_forms_but_one() {
    passes("mujoco", &["P7"]);
}

/// Returns the agreement with the referee, whose contacts are rigid.
fn compared(name: &str, stiffer: f64) -> Agreement {
    let engine = engine(name, stiffer).unwrap();
    let cases = (0..60).map(|index| {
        let trial = draw(index);
        let expected = trial.run(STEP).unwrap();
        Case::new(&*engine, (index, trial, expected), Rounding::Core)
    });
    let cases: Vec<Case> = cases.collect();
    let found = agreement(&cases);
    assert!(found.determinate >= 50, "{found:?}");
    assert!(100 * found.agreeing >= 95 * found.determinate, "{found:?}\n{}", table(&cases));
    found
}

/// Stiffer contacts, which are all but the referee's rigid ones, leave the geometry.
#[test]
fn engines_have_the_outcomes_of_the_referee() {
    assert!(compared("direct", 10.0).mean[0] < 0.02);
    compared("rapier", 1.0);
    #[cfg(feature = "mujoco")]
    compared("mujoco", 10.0);
}
