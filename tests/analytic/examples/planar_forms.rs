//! The closed forms P1 to P10 in an engine.
//!
//! Arguments: engine (direct, rapier, mujoco), flats of an arc or `core`, factor of the stiffness of contacts.

use analytic_checks::slab::{Rounding, engine, rounded, sharp};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, flats, stiffer] = arguments.as_slice() else {
        eprintln!("arguments: engine, flats of an arc, factor of the stiffness");
        std::process::exit(2);
    };
    let (Some(rounding), Ok(stiffer)) = (Rounding::named(flats), stiffer.parse()) else {
        eprintln!("flats: a whole number or core; factor: a number");
        std::process::exit(2);
    };
    let Some(engine) = engine(name, stiffer) else {
        eprintln!("engines: direct, rapier, mujoco (feature)");
        std::process::exit(2);
    };
    let mut rows = sharp(engine.as_ref());
    rows.extend(rounded(engine.as_ref(), rounding));
    print!("{}", analytic_checks::table(&rows));
}
