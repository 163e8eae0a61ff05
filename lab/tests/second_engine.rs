//! The analytic checks on MuJoCo, with the settings of the cross-check.
#![cfg(feature = "mujoco")]

use contact::Engine;
use contact::mujoco::Mujoco;
use lab::analytic;

fn mujoco(factor: f64) -> Box<dyn Engine> {
    let mut engine = Mujoco::default();
    engine.settings.step_s *= factor;
    Box::new(engine)
}

/// What MuJoCo misses, and by how much: a block that slides askew at a friction of 1
/// hops from corner to corner (`docs/notes/simulation.md`, "Second engine").
const MISSED: (&str, f64) = ("friction, mu 1, heading 37 deg", 0.02);

#[test]
fn mujoco_passes_the_analytic_checks_but_one() {
    let rows = analytic::run(&mujoco);
    let table = analytic::table(&rows);
    println!("{table}");
    let (missed, error) = MISSED;
    for row in rows {
        let within = row.quantity == missed && row.error().abs() < error;
        assert!(row.passed || within, "{} {}\n{table}", row.check, row.quantity);
    }
}
