//! Random insertions, the same on every platform.

use super::{Assembly, Hole, Peg, Support, Trial};
use ask_tell::stream::stream;
use input::units::{MM, N_PER_MM};
use rand::{Rng, RngExt};

/// Seed of the insertions.
const SEED: u64 = 40;
/// Axial stiffness, N/m: an arm and a grasp.
const AXIAL: f64 = 40.0 * N_PER_MM;
/// Depth at which a peg is inserted, m, and force at which an insertion is given up, N.
const DEPTH: f64 = 8.0 * MM;
const LIMIT: f64 = 30.0;
/// Largest tilt at the start, rad.
const TILT: f64 = 0.06;
/// Largest start aside, in units of the way that clearance and rims capture without friction.
const ASIDE: f64 = 1.0;

/// Returns a number whose logarithm is uniform.
fn log_uniform(random: &mut impl Rng, low: f64, high: f64) -> f64 {
    low * libm::exp(random.random_range(0.0..1.0) * libm::log(high / low))
}

/// Returns the insertion with a number.
pub fn draw(index: u64) -> Trial {
    let random = &mut stream(SEED, index, "planar insertion");
    let half_width = random.random_range(2.0..5.0) * MM;
    let clearance = log_uniform(random, 0.02, 0.5) * MM;
    let [tip, rim] = [(); 2].map(|()| random.random_range(0.0..0.6) * MM);
    let assembly = Assembly {
        peg: Peg { half_width, radius: tip },
        hole: Hole { half_width: half_width + clearance / 2.0, radius: rim, chamfer: None },
        friction: random.random_range(0.05..0.4),
        support: Support {
            lateral: log_uniform(random, 1.0, 20.0) * N_PER_MM,
            axial: AXIAL,
            angular: log_uniform(random, 0.5, 20.0),
            centre: random.random_range(10.0..30.0) * MM,
        },
        compliance: 0.0,
    };
    let captured = clearance / 2.0 + tip + rim;
    let lateral = random.random_range(-ASIDE..ASIDE) * captured;
    let tilt = random.random_range(-TILT..TILT);
    Trial { assembly, lateral, tilt, depth: DEPTH, limit: LIMIT }
}
