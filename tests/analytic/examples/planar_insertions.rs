//! Agreement of the engines with the planar referee over random insertions.
//!
//! Arguments: engine (direct, rapier, mujoco), flats of an arc or `core`, number of insertions, and the
//! stiffness of the referee's contacts, N/m (0: rigid).

use analytic_checks::planar::Record;
use analytic_checks::planar::sample::draw;
use analytic_checks::slab::{Case, Rounding, agreement, table};
use contact::Engine;
use contact::direct::Direct;
use contact::rapier::Rapier;

/// Step of the referee's drive, m.
const STEP: f64 = 10e-6;

fn engine(name: &str) -> Option<Box<dyn Engine>> {
    match name {
        "direct" => Some(Box::new(Direct::default())),
        "direct-fine" => Some(Box::new(Direct { step_s: 1.25e-4, ..Direct::default() })),
        "direct-stiff" => {
            let stiff = Direct::default();
            let (step_s, contact_stiffness) = (1.25e-4, 10.0 * stiff.contact_stiffness);
            Some(Box::new(Direct { step_s, contact_stiffness, ..stiff }))
        }
        "rapier" => Some(Box::new(Rapier::default())),
        #[cfg(feature = "mujoco")]
        "mujoco" => Some(Box::new(contact::mujoco::Mujoco::default())),
        _ => None,
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, flats, count, stiffness] = arguments.as_slice() else {
        eprintln!("arguments: engine, flats of an arc, number of insertions, stiffness in N/m");
        std::process::exit(2);
    };
    let (Some(engine), Some(rounding), Ok(count), Ok(stiffness)) =
        (engine(name), Rounding::named(flats), count.parse(), stiffness.parse::<f64>())
    else {
        eprintln!(
            "engines: direct, direct-fine, direct-stiff, rapier, mujoco (feature); whole numbers after it"
        );
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
        "{name}, {flats} flats: {:?}, {:.0} s",
        agreement(&cases),
        started.elapsed().as_secs_f64()
    );
}
