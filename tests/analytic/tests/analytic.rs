//! The analytic checks on the engines with their production settings; a failure prints the table.

use analytic_checks::CheckRow;
use contact::Engine;
use contact::direct::Direct;
use contact::rapier::Rapier;

fn rapier(factor: f64) -> Box<dyn Engine> {
    let mut engine = Rapier::default();
    engine.step_s *= factor;
    Box::new(engine)
}

fn direct(factor: f64) -> Box<dyn Engine> {
    let mut engine = Direct::default();
    engine.step_s *= factor;
    Box::new(engine)
}

/// Number of rows by check; all pass but those of `missed`.
fn passed(rows: &[CheckRow], missed: &str) -> impl Fn(&str) -> usize + use<> {
    let table = analytic_checks::table(rows);
    assert!(rows.iter().all(|row| row.passed || row.check == missed), "\n{table}");
    let checks: Vec<_> = rows.iter().map(|row| row.check).collect();
    move |check| checks.iter().filter(|name| **name == check).count()
}

#[test]
fn direct_passes_all_checks() {
    let rows_of = passed(&analytic_checks::run(&direct), "none");
    for n in (1..=16).filter(|&n| n != 9) {
        assert!(rows_of(&format!("T{n}")) > 0, "T{n}");
    }
    assert!((1..=4).all(|n| rows_of(&format!("F{n}")) > 0));
}

/// rapier's friction acts at the middle of a face, wherever the face is loaded, so only `direct`
/// and MuJoCo are held to T12 (docs/notes/simulation.md, "Engines").
#[test]
fn rapier_passes_the_checks_of_what_it_has() {
    let rows_of = passed(&analytic_checks::contact(&rapier), "T12");
    assert_eq!(rows_of("T11"), 0, "it has no coupled springs");
    assert_eq!(rows_of("T12"), 2, "it has no torsional friction");
    for n in (1..=16).filter(|n| ![9, 11, 15].contains(n)) {
        assert!(rows_of(&format!("T{n}")) > 0, "T{n}");
    }
}

/// A block that slides askew at a friction of 1 hops from corner to corner in MuJoCo
/// (docs/notes/simulation.md, "Second engine").
#[cfg(feature = "mujoco")]
#[test]
fn mujoco_passes_all_checks_but_one() {
    let mujoco = |factor: f64| -> Box<dyn Engine> {
        let mut engine = contact::mujoco::Mujoco::default();
        engine.settings.step_s *= factor;
        Box::new(engine)
    };
    let mut rows = analytic_checks::run(&mujoco);
    rows.retain(|row| {
        row.quantity != "friction, mu 1, heading 37 deg" || row.error().abs() >= 0.02
    });
    assert!(passed(&rows, "none")("T1") > 0);
}
