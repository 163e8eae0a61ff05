//! A block on a face of facets: it sinks, tilts, slides and turns as on a whole one.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use contact::direct::Direct;
use contact::scene::{Body, BodyId, Friction, Geom, Inertia, Motion, Pose, Scene, Shape, Torsion};
use contact::{Engine, World};
use nalgebra::{Point3, Vector3};

const MM: f64 = 1e-3;
/// Block and ground, m.
const BLOCK: [f64; 3] = [12.0 * MM, 8.0 * MM, 6.0 * MM];
const GROUND: [f64; 3] = [32.0 * MM, 24.0 * MM, 4.0 * MM];
const MASS: f64 = 0.02;
const FRICTION: f64 = 0.3;
/// Force that presses the block down, N.
const PRESSED: f64 = 5.0;

/// Returns a box of this size about the origin as boxes, so many along x and y.
fn facets(size: [f64; 3], parts: usize) -> Vec<Geom> {
    let size = Vector3::from(size);
    let part = size.component_div(&Vector3::new(parts as f64, parts as f64, 1.0));
    let at = |i: usize, axis: usize| -size[axis] / 2.0 + (i as f64 + 0.5) * part[axis];
    let geom = |(i, j)| Geom {
        name: format!("part {i} {j}"),
        shape: Shape::Box { half: part / 2.0 },
        pose: Pose::translation(at(i, 0), at(j, 1), 0.0),
        friction: None,
    };
    (0..parts).flat_map(|i| (0..parts).map(move |j| (i, j))).map(geom).collect()
}

fn scene(ground: usize, block: usize, torsion: Torsion) -> Scene {
    let mut scene = Scene::default();
    let below = Pose::translation(0.0, 0.0, -GROUND[2] / 2.0);
    let geoms = facets(GROUND, ground);
    let name = "ground".into();
    let ground = scene.body(Body { name, motion: Motion::Fixed, pose: below, geoms });
    let square = Vector3::from(BLOCK).map(|side| side * side);
    let moments = (Vector3::repeat(square.sum()) - square) * (MASS / 12.0);
    let motion = Motion::Free(Inertia { mass: MASS, centre: Point3::origin(), moments });
    // Shifted, so that its edges do not coincide with those of the ground's parts.
    let pose = Pose::translation(0.7 * MM, 0.4 * MM, BLOCK[2] / 2.0);
    let name = "block".into();
    let block = scene.body(Body { name, motion, pose, geoms: facets(BLOCK, block) });
    scene.contact(ground, block, Friction { coefficient: FRICTION, torsion });
    scene
}

/// Returns how the block moves, m and rad, under a force and a moment, first beside the weight.
fn moved(world: &mut dyn World, force: Vector3<f64>, moment: Vector3<f64>, time: f64) -> [f64; 6] {
    let block = BodyId(1);
    let start = world.pose(block);
    world.push(block, force - Vector3::z() * PRESSED, moment);
    for _ in 0..(time / world.step_s()).round() as usize {
        world.step().expect("finite");
    }
    let end = world.pose(block);
    let way = end.translation.vector - start.translation.vector;
    let turn = (end.rotation * start.rotation.inverse()).scaled_axis();
    [way.x, way.y, way.z, turn.x, turn.y, turn.z]
}

/// Returns sinking, m; tilt about x and y, rad; slide, m, at a force above friction; turn, rad.
fn behaviour(ground: usize, block: usize, torsion: Torsion) -> [f64; 5] {
    let mut world = Direct::default().world(&scene(ground, block, torsion));
    let zero = Vector3::zeros();
    let sunk = moved(world.as_mut(), zero, zero, 0.05)[2];
    // The centre of pressure at a third of the way to the edge, along either axis.
    let mut tilted = world.snapshot();
    let moment = Vector3::new(BLOCK[1] / 6.0, BLOCK[0] / 6.0, 0.0) * PRESSED / 2.0;
    let tilt = moved(tilted.as_mut(), zero, moment, 0.05);
    // The couple moves the force to the height of the friction, so that the block does not tilt.
    let push = 1.2 * FRICTION * PRESSED;
    let mut slid = world.snapshot();
    let couple = Vector3::new(0.0, -push * BLOCK[2] / 2.0, 0.0);
    let slide = moved(slid.as_mut(), Vector3::x() * push, couple, 0.02)[0];
    let turn = moved(world.as_mut(), zero, Vector3::z() * 12.0 * MM, 0.02)[5];
    [sunk, tilt[3], tilt[4], slide, turn]
}

const CASES: [(usize, usize); 5] = [(1, 1), (4, 1), (16, 1), (1, 2), (4, 2)];

#[test]
fn a_block_on_facets_moves_as_on_a_whole_face() {
    for torsion in [Torsion::Radius(0.0), Torsion::Radius(2.0 * MM), Torsion::Patch] {
        let [whole, others @ ..] = CASES.map(|(ground, block)| behaviour(ground, block, torsion));
        // Four corners bear the load.
        let stiffness = 4.0 * Direct::default().contact_stiffness;
        assert!((whole[0] / (-PRESSED / stiffness) - 1.0).abs() < 1e-3, "{whole:?}");
        for (case, other) in CASES[1..].iter().zip(others) {
            for (one, other) in whole.iter().zip(other) {
                assert!((other / one - 1.0).abs() < 0.01, "{torsion:?} {case:?} {one} {other}");
            }
        }
    }
}
