//! Peg without springs between two walls, one of which presses.

use super::{MASS, Rounding, inertia, peg_body};
use crate::build::{self, Measured};
use crate::planar::{Assembly, two_point_pose};
use contact::Engine;
use contact::scene::{Body, Friction, Motion, Pose, Scene, Spring};
use input::units::GRAM;
use nalgebra::{Point3, Vector3};

/// Force of the wall, N: so little that the contacts hardly yield.
const SQUEEZE: f64 = 0.05;
/// Mass of the wall, kg, and damping of its slide, N s/m.
const WALL_MASS: f64 = 50.0 * GRAM;
const WALL_DAMPING: f64 = 1.0;
const TIME: f64 = 0.2;
/// Share of its tilt that a wedged peg keeps. One that slips comes to rest, less tilted, where the line
/// between its contacts lies in both cones again.
const KEPT: f64 = 0.997;

/// Returns whether a peg in two-point contact at a tilt to the right stays wedged.
pub(super) fn wedges(
    engine: &dyn Engine,
    assembly: &Assembly,
    tilt: f64,
    rounding: Rounding,
) -> Measured<bool> {
    let pose = two_point_pose(assembly, -tilt);
    let mut scene = Scene::default();
    let ground = scene.body(build::fixed("ground", Pose::identity(), Vec::new()));
    let peg = scene.body(peg_body(assembly, &pose, rounding));
    let free = |share: f64| Some(Spring::new(0.0, 1e-3 * share));
    let axes = [free(MASS), None, free(MASS), None, free(inertia(assembly).moments.y), None];
    let start = scene.bodies[peg.0].pose;
    build::joint(&mut scene, "plane", [ground, peg], [start, Pose::identity()], axes);
    let [left, right] = rounding.hole(&assembly.hole);
    let fixed = scene.body(build::fixed("right", Pose::identity(), vec![right]));
    let size = Vector3::repeat(0.01);
    let wall = scene.body(Body {
        name: "left".into(),
        motion: Motion::Carried(build::box_inertia(WALL_MASS, size, Point3::origin())),
        pose: Pose::identity(),
        geoms: vec![left],
    });
    let mut slide = [None; 6];
    slide[0] = Some(Spring::new(0.0, WALL_DAMPING));
    build::joint(&mut scene, "slide", [ground, wall], [Pose::identity(); 2], slide);
    for body in [fixed, wall] {
        scene.contact(body, peg, Friction::hard(assembly.friction));
    }
    let mut world = engine.world(&scene);
    world.push(wall, Vector3::new(SQUEEZE, 0.0, 0.0), Vector3::zeros());
    build::advance(world.as_mut(), TIME)?;
    Ok(world.pose(peg).rotation.scaled_axis().y.abs() > KEPT * tilt)
}
