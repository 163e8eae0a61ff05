//! The planar referee on closed forms: forces and depths within 1e-6.

mod rounded;
mod sample;
mod small;

use analytic_checks::planar::Assembly;
use analytic_checks::slab;
use ask_tell::stream::stream;
use rand::{Rng, RngExt};

pub const MM: f64 = 1e-3;
pub const DEG: f64 = std::f64::consts::PI / 180.0;
/// Largest error, as a share.
pub const ALLOWED: f64 = 1e-6;
/// Number of random cases of a form.
const CASES: u64 = 20;

pub fn close(found: f64, expected: f64, what: &str) {
    let error = (found / expected - 1.0).abs();
    assert!(error < ALLOWED, "{what}: found {found}, expected {expected}, error {error:.1e}");
}

/// Lateral 2.6 N/mm, angular 2000 N mm/rad about a centre 21 mm above the tip of a peg 8 mm wide.
pub fn base() -> Assembly {
    let mut assembly = slab::base();
    assembly.hole.chamfer = None;
    assembly
}

/// Varies friction, clearance and the radii of a case.
fn varied(random: &mut impl Rng, rounded: bool) -> Assembly {
    let mut assembly = base();
    assembly.friction = random.random_range(0.05..0.4);
    let slack = random.random_range(0.02..0.5) * MM;
    assembly.hole.half_width = assembly.peg.half_width + slack / 2.0;
    if rounded {
        assembly.peg.radius = random.random_range(0.05..0.6) * MM;
        assembly.hole.radius = random.random_range(0.05..0.6) * MM;
    }
    assembly
}

/// Base case, then random ones.
pub fn cases(form: &str, rounded: bool) -> impl Iterator<Item = Assembly> {
    let varied = move |i| varied(&mut stream(40, i, form), rounded);
    std::iter::once(base()).chain((0..CASES).map(varied).collect::<Vec<_>>())
}
