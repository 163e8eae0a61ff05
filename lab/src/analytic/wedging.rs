//! T5: wedging of a peg in two-point contact.
//!
//! Whitney 1982 (J. Dyn. Sys. Meas. Control 104:65): two contacts can hold a peg by a force between
//! them alone if the line through them lies within both friction cones. That line spans the peg's
//! width d and the length l inside, so a peg wedges only where l/d < mu. Here the sliding wall at +y
//! presses on the tip's corner; beyond the threshold the normal forces turn the peg upright.

use super::build;
use super::peg::{Peg, REFERENCE};
use super::{CheckRow, Tolerance};
use contact::scene::{Body, Friction, Motion, Pose, Scene, Spring};
use contact::{Diverged, Engine};
use input::units::{GRAM, MM};
use nalgebra::{Point3, Vector3};

/// Frictions of the check; l/d = 0.2 is a plug 2.4 mm inside.
const FRICTIONS: [f64; 2] = [0.2, 0.3];
const SQUEEZE: f64 = 10.0;
/// The peg, kg: as light as an RJ45 plug, which an iterative solver finds hard.
const MASS: f64 = 5.0 * GRAM;
/// The sliding wall, kg, and the damping of its slide, N s/m.
const WALL_MASS: f64 = 50.0 * GRAM;
const WALL_DAMPING: f64 = 1.0;
/// Clearance of the hole, m: many times what the contacts yield.
const CLEARANCE: f64 = 0.02 * MM;
const SQUEEZING: f64 = 0.03;
/// The peg is wedged if it still has this share of its tilt.
const KEPT: f64 = 0.5;
/// l/d is sought between these multiples of the friction ...
const BRACKET: [f64; 2] = [0.5, 2.0];
/// ... by so many bisections, which leave 0.15 %.
const BISECTIONS: usize = 10;

/// Largest l/d at which a peg stays wedged, T5 rows.
pub fn t5(engine: &dyn Engine) -> Vec<CheckRow> {
    let row = |friction: f64| {
        let quantity = format!("l/d up to which a peg wedges, mu {friction}");
        let bracket = BRACKET.map(|share| share * friction);
        let measured =
            build::bisected(bracket, BISECTIONS, |depth| wedges(engine, friction, depth));
        CheckRow::new("T5", quantity, friction, measured, "-", Tolerance::Relative(0.02))
    };
    FRICTIONS.map(row).to_vec()
}

/// Whether a peg that is `depth` times its width inside stays wedged.
pub(super) fn wedges(engine: &dyn Engine, friction: f64, depth: f64) -> Result<bool, Diverged> {
    let (width, hole) = (REFERENCE.width, REFERENCE.width + CLEARANCE);
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
