//! The closed forms P1 to P10 in an engine.
//!
//! Arguments: engine (direct, rapier, mujoco), flats of an arc or `core`, factor of the stiffness of direct's
//! contacts.

use analytic_checks::slab::{Rounding, rounded, sharp};
use contact::Engine;
use contact::direct::Direct;
use contact::rapier::Rapier;

fn engine(name: &str, stiffer: f64) -> Option<Box<dyn Engine>> {
    match name {
        "direct" => {
            let soft = Direct::default();
            let contact_stiffness = stiffer * soft.contact_stiffness;
            let step_s = soft.step_s / stiffer.sqrt();
            Some(Box::new(Direct { step_s, contact_stiffness, ..soft }))
        }
        "rapier" => Some(Box::new(Rapier::default())),
        #[cfg(feature = "mujoco")]
        "mujoco" => Some(Box::new(contact::mujoco::Mujoco::default())),
        _ => None,
    }
}

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
