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
//!
//! T5: wedging of a peg in two-point contact.
//!
//! Whitney 1982 (J. Dyn. Sys. Meas. Control 104:65): two contacts can hold a peg by a force between
//! them alone if the line through them lies within both friction cones. That line spans the peg's
//! width d and the length l inside, so a peg wedges only where l/d < mu. Here the sliding wall at +y
//! presses on the tip's corner; beyond the threshold the normal forces turn the peg upright.

use super::build;
use super::peg::{Peg, REFERENCE, turning};
use super::{CheckRow, Tolerance};
use contact::scene::{Body, Friction, Motion, Pose, Scene, Spring};
use contact::{Diverged, Engine};
use input::units::{GRAM, MM};
use nalgebra::{Point3, Vector2, Vector3};

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

/// Returns the peg with so little play that the formula holds.
fn tight() -> Peg {
    Peg { hole: REFERENCE.width + CLEARANCE, ..REFERENCE }
}

/// Returns M/(r F_z) at which the peg jams, by the formula above.
fn threshold(peg: &Peg, side: f64) -> f64 {
    let lambda = peg.inside / (peg.width * peg.friction);
    lambda - peg.friction * (1.0 + lambda) * side
}

/// Returns M/(r F_z) at which the peg jams at its true tilt t. Across and along the hole, from the tip: the
/// tip's corner lies at c = r (cos t, sin t), its wall presses with N2 (-1, mu);
/// the rim's point lies at p = -r (cos t, sin t) + l (-sin t, cos t), where the
/// flank is pressed with N1 ((cos t, sin t) + mu (-sin t, cos t)). The balance of
/// forces with the load (F_x, -F_z) gives N1 and N2, that of moments gives M.
fn threshold_tilted(peg: &Peg, side: f64) -> f64 {
    let (half_width, friction) = (peg.width / 2.0, peg.friction);
    let (sin, cos) = libm::sincos(peg.tilt());
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

/// Returns whether the peg stays where it is under a moment of `ratio` r F_z.
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

/// Returns whether a peg jams under a share of the moment of the threshold, without a side force.
pub(super) fn jams_at(engine: &dyn Engine, share: f64) -> Result<bool, Diverged> {
    let peg = tight();
    jams(engine, &peg, 0.0, share * threshold(&peg, 0.0))
}

/// Frictions of the check; l/d = 0.2 is a plug 2.4 mm inside.
const FRICTIONS: [f64; 2] = [0.2, 0.3];
const SQUEEZE: f64 = 10.0;
/// The peg, kg: as light as an RJ45 plug, which an iterative solver finds hard.
const MASS: f64 = 5.0 * GRAM;
/// The sliding wall, kg, and the damping of its slide, N s/m.
const WALL_MASS: f64 = 50.0 * GRAM;
const WALL_DAMPING: f64 = 1.0;
/// Clearance of the hole, m: many times what the contacts yield.
const SLACK: f64 = 0.02 * MM;
const SQUEEZING: f64 = 0.03;
/// The peg is wedged if it still has this share of its tilt.
const KEPT: f64 = 0.5;
/// l/d is sought between these multiples of the friction ...
const DEPTHS: [f64; 2] = [0.5, 2.0];
/// ... by so many bisections, which leave 0.15 %.
const DEPTH_BISECTIONS: usize = 10;

pub fn t5(engine: &dyn Engine) -> Vec<CheckRow> {
    let row = |friction: f64| {
        let quantity = format!("l/d up to which a peg wedges, mu {friction}");
        let bracket = DEPTHS.map(|share| share * friction);
        let measured =
            build::bisected(bracket, DEPTH_BISECTIONS, |depth| wedges(engine, friction, depth));
        CheckRow::new("T5", quantity, friction, measured, "-", Tolerance::Relative(0.02))
    };
    FRICTIONS.map(row).to_vec()
}

/// Returns whether a peg that is `depth` times its width inside stays wedged.
pub(super) fn wedges(engine: &dyn Engine, friction: f64, depth: f64) -> Result<bool, Diverged> {
    let (width, hole) = (REFERENCE.width, REFERENCE.width + SLACK);
    let peg = Peg { hole, inside: depth * width, friction, mass: MASS, ..REFERENCE };
    let mut scene = Scene::default();
    let body = scene.body(peg.body(peg.tilted()));
    let fixed = scene.body(peg.wall(-1.0));
    let wall = peg.wall(1.0);
    let size = Vector3::repeat(10.0 * MM);
    let inertia = build::box_inertia(WALL_MASS, size, Point3::origin());
    let wall = scene.body(Body { motion: Motion::Carried(inertia), ..wall });
    let slide = scene.bodies[wall.0].pose;
    let mut axes = [None; 6];
    axes[1] = Some(Spring::new(0.0, WALL_DAMPING));
    let ground = scene.body(build::fixed("ground", Pose::identity(), Vec::new()));
    build::joint(&mut scene, "slide", [ground, wall], [slide, Pose::identity()], axes);
    for side in [fixed, wall] {
        scene.contact(side, body, Friction::hard(friction));
    }

    let mut world = engine.world(&scene);
    world.push(wall, Vector3::new(0.0, -SQUEEZE, 0.0), Vector3::zeros());
    build::advance(world.as_mut(), SQUEEZING)?;
    Ok(world.pose(body).rotation.scaled_axis().x > KEPT * peg.tilt())
}
