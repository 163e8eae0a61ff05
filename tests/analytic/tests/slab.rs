//! The engine `direct` on the closed forms P1 to P10, and on random insertions of the planar referee.
//!
//! Rounded edges are cores with a radius. The normals of P10 are those of a moving contact here, whose
//! points are found anew only after some way: they lag by up to 0.2 degrees. At rest they are exact
//! (tests of `contact`).

use analytic_checks::CheckRow;
use analytic_checks::planar::sample::draw;
use analytic_checks::slab::{Case, Rounding, agreement, rounded, sharp, table};
use contact::direct::Direct;

/// Step of the referee's drive, m.
const STEP: f64 = 20e-6;

/// Returns the engine with contacts that are stiffer by a factor, and as finer steps as they need.
fn direct(stiffer: f64) -> Direct {
    let usual = Direct::default();
    let contact_stiffness = stiffer * usual.contact_stiffness;
    Direct { contact_stiffness, step_s: usual.step_s / stiffer.sqrt(), ..usual }
}

fn passes(rows: &[CheckRow], counts: impl Fn(&CheckRow) -> bool) {
    let failed = rows.iter().filter(|row| counts(row) && !row.passed).count();
    assert!(failed == 0 && rows.iter().any(counts), "\n{}", analytic_checks::table(rows));
}

#[test]
fn direct_meets_the_forms_of_sharp_edges() {
    passes(&sharp(&direct(1.0)), |row| ["P1", "P2", "P10"].contains(&row.check));
}

/// In two-point contact a contact of finite stiffness carries less at the same depth: the second
/// contact closes later, and the force lags. Both deviations are proportional to its compliance, but
/// for the stiffness of a line of contact, which counts the 2 or 4 points that it happens to have.
#[test]
fn deviation_at_two_points_halves_with_the_compliance() {
    let rows = [1.0, 2.0, 4.0].map(|stiffer| sharp(&direct(stiffer)));
    for check in ["P3", "P4"] {
        let error = |rows: &Vec<CheckRow>| {
            rows.iter().find(|row| row.check == check).map_or(f64::NAN, CheckRow::error)
        };
        let [first, second, third] = [0, 1, 2].map(|i| error(&rows[i]));
        for ratio in [first / second, second / third] {
            assert!((1.4..3.0).contains(&ratio), "{check}: {first} {second} {third}");
        }
        assert!((3.0..6.0).contains(&(first / third)), "{check}: {first} {third}");
    }
}

#[test]
fn direct_meets_the_forms_of_rounded_edges() {
    passes(&rounded(&direct(1.0), Rounding::Core), |row| {
        ["P6", "P7", "P8", "P9"].contains(&row.check)
    });
}

/// Contacts ten times as stiff, which are all but the referee's rigid ones, leave the geometry.
#[test]
fn direct_has_the_outcomes_of_the_referee() {
    let cases = (0..60).map(|index| {
        let trial = draw(index);
        let expected = trial.run(STEP).unwrap();
        Case::new(&direct(10.0), (index, trial, expected), Rounding::Core)
    });
    let cases: Vec<Case> = cases.collect();
    let found = agreement(&cases);
    assert!(found.determinate >= 50, "{found:?}");
    assert!(100 * found.agreeing >= 95 * found.determinate, "{found:?}\n{}", table(&cases));
    assert!(found.mean[0] < 0.02, "{found:?}");
}
