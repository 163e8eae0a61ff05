//! T4: jamming of a peg in two-point contact.
//!
//! Whitney 1982 (J. Dyn. Sys. Meas. Control 104:65): a peg of half width r that is pushed into its
//! hole by a force F_z, with a side force F_x and a moment M at its tip, slides with friction mu at
//! both contacts where M/(r F_z) = +-lambda - mu (1 + lambda) F_x/F_z, lambda = l/(2 r mu). Between
//! the two lines it goes in, beyond them it jams. Here F_x acts along +y and the peg leans so that
//! the line of +lambda counts; the other is its mirror image.
//!
//! The formula is the limit of a small tilt, which at a connector's clearance lowers the threshold by
//! up to 3 %. So the engine is compared with the formula in a tight hole, and with the statics of the
//! tilted peg in a hole of the reference clearance.

use super::build;
use super::peg::{Peg, REFERENCE, turning};
use super::{CheckRow, Tolerance};
use contact::{Diverged, Engine};
use input::units::MM;
use nalgebra::{Vector2, Vector3};

/// Side forces as shares of the insertion force.
const SIDE: [f64; 3] = [0.0, 0.5, -0.5];
const INSERTION: f64 = 10.0;
/// Clearance at which the neglected tilt (2.5 mrad) is worth 0.5 % only.
const CLEARANCE: f64 = 0.02 * MM;
/// Time under the moment alone, so that both contacts hold, s.
const PRELOADING: f64 = 0.005;
/// Time under the full load, s, and the way that counts as sliding, m.
const LOADING: f64 = 0.02;
const SLIDING: f64 = 0.1 * MM;
/// Thresholds are sought between these multiples of the expected one ...
const BRACKET: [f64; 2] = [0.5, 3.5];
/// ... by so many bisections, which leave 0.15 %.
const BISECTIONS: usize = 11;

/// Peg with so little play that the formula holds.
fn tight() -> Peg {
    Peg { hole: REFERENCE.width + CLEARANCE, ..REFERENCE }
}

/// M/(r F_z) at which the peg jams, by the formula above.
fn threshold(peg: &Peg, side: f64) -> f64 {
    let lambda = peg.inside / (peg.width * peg.friction);
    lambda - peg.friction * (1.0 + lambda) * side
}

/// M/(r F_z) at which the peg jams at its true tilt t. Across and along the hole, from the tip: the
/// tip's corner lies at c = r (cos t, sin t), its wall presses with N2 (-1, mu);
/// the rim's point lies at p = -r (cos t, sin t) + l (-sin t, cos t), where the
/// flank is pressed with N1 ((cos t, sin t) + mu (-sin t, cos t)). The balance of
/// forces with the load (F_x, -F_z) gives N1 and N2, that of moments gives M.
fn threshold_tilted(peg: &Peg, side: f64) -> f64 {
    let (half_width, friction) = (peg.width / 2.0, peg.friction);
    let (sin, cos) = peg.tilt().sin_cos();
    let (across, along) = (Vector2::new(cos, sin), Vector2::new(-sin, cos));
    let rim = along * peg.inside - across * half_width;
    let corner = across * half_width;
    let at_rim = across + along * friction;
    let at_corner = Vector2::new(-1.0, friction);
    // N1 at_rim + N2 at_corner = (-side, 1), per F_z, by Cramer's rule.
    let held = Vector2::new(-side, 1.0);
    let determinant = at_rim.perp(&at_corner);
    let [n1, n2] = [held.perp(&at_corner), at_rim.perp(&held)].map(|d| d / determinant);
    -(n1 * rim.perp(&at_rim) + n2 * corner.perp(&at_corner)) / half_width
}

/// Jamming thresholds, T4 rows.
pub fn t4(engine: &dyn Engine) -> Vec<CheckRow> {
    let row = |peg: Peg, side: f64, expected: f64, case: &str| {
        let bracket = BRACKET.map(|share| share * expected);
        let slides = |moment| Ok(!jams(engine, &peg, side, moment)?);
        let measured = build::bisected(bracket, BISECTIONS, slides);
        let quantity = format!("M/(r Fz) that jams, Fx/Fz {side}, {case}");
        CheckRow::new("T4", quantity, expected, measured, "-", Tolerance::Relative(0.02))
    };
    let small = SIDE.map(|side| row(tight(), side, threshold(&tight(), side), "tight"));
    let large = SIDE.map(|side| row(REFERENCE, side, threshold_tilted(&REFERENCE, side), "loose"));
    [small, large].concat()
}

/// Whether the peg stays where it is under a moment of `ratio` r F_z.
fn jams(engine: &dyn Engine, peg: &Peg, side: f64, ratio: f64) -> Result<bool, Diverged> {
    let (scene, body) = peg.scene(peg.tilted());
    let mut world = engine.world(&scene);
    let preload = turning(ratio * INSERTION * peg.width / 2.0);
    peg.load(world.as_mut(), body, preload, PRELOADING)?;
    let from = world.pose(body).translation.z;
    let force = INSERTION * Vector3::new(0.0, side, -1.0);
    peg.load(world.as_mut(), body, [force, preload[1]], LOADING)?;
    Ok(from - world.pose(body).translation.z < SLIDING)
}

/// Whether a peg jams under a share of the moment of the threshold, without a side force.
pub(super) fn jams_at(engine: &dyn Engine, share: f64) -> Result<bool, Diverged> {
    let peg = tight();
    jams(engine, &peg, 0.0, share * threshold(&peg, 0.0))
}
