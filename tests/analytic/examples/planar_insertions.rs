//! Agreement of the engines with the planar referee over random insertions.
//!
//! Arguments: engine (direct, rapier, mujoco), flats of an arc or `core`, number of insertions, factor of
//! the stiffness of the engine's contacts, and the stiffness of the referee's, N/m (0: rigid).

use analytic_checks::planar::Record;
use analytic_checks::planar::sample::draw;
use analytic_checks::slab::{Case, Rounding, agreement, engine, table};

/// Step of the referee's drive, m.
const STEP: f64 = 10e-6;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, flats, count, stiffer, stiffness] = arguments.as_slice() else {
        eprintln!(
            "arguments: engine, flats of an arc, number of insertions, factor, stiffness in N/m"
        );
        std::process::exit(2);
    };
    let numbers = [stiffer, stiffness].map(|number| number.parse::<f64>());
    let (Some(rounding), Ok(count), [Ok(stiffer), Ok(stiffness)]) =
        (Rounding::named(flats), count.parse(), numbers)
    else {
        eprintln!("flats: a whole number or core; numbers after it");
        std::process::exit(2);
    };
    let Some(engine) = engine(name, stiffer) else {
        eprintln!("engines: direct, rapier, mujoco (feature)");
        std::process::exit(2);
    };
    let started = std::time::Instant::now();
    let cases: Vec<Case> = (0..count)
        .filter_map(|index| {
            let mut trial = draw(index);
            let mut expected = trial.run(STEP).ok()?;
            if stiffness > 0.0 {
                // Rigid contacts decide which cases are determinate.
                if expected.indeterminate() {
                    return None;
                }
                trial.assembly.compliance = 1.0 / stiffness;
                expected = Record { could_wedge: false, ..trial.run(STEP).ok()? };
            }
            Some(Case::new(engine.as_ref(), (index, trial, expected), rounding))
        })
        .collect();
    print!("{}", table(&cases));
    println!(
        "{name}, {flats} flats, {stiffer} x as stiff: {:?}, {:.0} s",
        agreement(&cases),
        started.elapsed().as_secs_f64()
    );
}
