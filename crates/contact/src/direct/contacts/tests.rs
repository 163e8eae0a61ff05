//! Detector: reused contact points against newly computed ones, patches, and scenes of many parts.

use super::*;
use crate::scene::{Body, BodyId, Inertia, Motion, Shape};
use nalgebra::{Translation3, UnitQuaternion};

/// Two cubes of 10 mm, the second at a pose.
fn cubes(pose: Pose) -> (Detector, Vec<MovingBody>) {
    let mut scene = Scene::default();
    for pose in [Pose::identity(), pose] {
        let shape = Shape::Box { half: Vector3::repeat(5e-3) };
        let geom = Geom { name: String::new(), shape, pose: Pose::identity(), friction: None };
        scene.body(Body { name: String::new(), motion: Motion::Fixed, pose, geoms: vec![geom] });
    }
    scene.contact(BodyId(0), BodyId(1), Friction::hard(0.3));
    let bodies = scene.bodies.iter().map(|body| MovingBody::new(body, None)).collect();
    (Detector::new(&scene, 0.2e-3), bodies)
}

fn found((detector, bodies): &mut (Detector, Vec<MovingBody>)) -> Vec<Touch> {
    let mut found = Vec::new();
    detector.detect(bodies, 5e-4, &mut found);
    found.sort_by(|a, b| a.gap.total_cmp(&b.gap));
    found
}

fn at(x: f64, y: f64, z: f64, turn: Vector3<f64>) -> Pose {
    Pose::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_scaled_axis(turn))
}

#[test]
fn reused_points_have_the_gaps_of_new_points() {
    let turned = |x: f64| Vector3::new(x, 0.5e-4, 0.3);
    let start = at(0.0, 0.0, 10.05e-3, turned(1e-4));
    for (pose, along, across) in [
        (at(3e-6, 2e-6, 10.047e-3, turned(3e-4)), 1e-8, REUSE_DISTANCE),
        (at(30e-6, 2e-6, 10.047e-3, turned(3e-4)), 1e-12, 1e-12),
    ] {
        let mut carried = cubes(start);
        assert_eq!(found(&mut carried).len(), 4);
        carried.1[1].put(pose);
        let (carried, anew) = (found(&mut carried), found(&mut cubes(pose)));
        assert_eq!(carried.len(), 4);
        for (a, b) in carried.iter().zip(&anew) {
            assert!((a.gap - b.gap).abs() < along, "{} {}", a.gap, b.gap);
            assert!((a.point - b.point).norm() < across, "{} {}", a.point, b.point);
        }
    }
}

#[test]
fn boxes_separated_by_a_face_of_one_are_recognized() {
    let turn = Vector3::z() * std::f64::consts::FRAC_PI_4;
    // Along the diagonal the first reaches 7.07 mm, the second 5 mm.
    for (side, apart) in [(8.5e-3, false), (8.7e-3, true)] {
        let mut cubes = cubes(at(side, side, 0.0, turn));
        found(&mut cubes);
        let [first, second] = &cubes.0.solids[..] else { panic!("two") };
        assert!(!first.apart(second, 0.0));
        assert_eq!([first.separated(second, 0.1e-3), second.separated(first, 0.1e-3)], [apart; 2]);
    }
}

#[test]
fn no_point_of_a_body_that_turns_about_a_distant_centre_is_faster_than_the_bound() {
    let (detector, mut bodies) = cubes(at(0.0, 0.0, 12e-3, Vector3::zeros()));
    let (centre, moments) = (Point3::new(0.0, 0.0, 50e-3), Vector3::repeat(1e-5));
    let (name, pose) = (String::new(), bodies[1].pose);
    let motion = Motion::Free(Inertia { mass: 0.1, centre, moments });
    bodies[1] = MovingBody::new(&Body { name, motion, pose, geoms: Vec::new() }, None);
    bodies[1].velocity[3] = 10.0;
    // The lower edges are 55 mm below the centre and 5 mm beside the axis.
    let fastest = 10.0 * libm::hypot(55e-3, 5e-3);
    let bound = detector.lists[0].speed(&bodies);
    assert!((fastest..1.1 * fastest).contains(&bound), "{bound} m/s of {fastest} m/s");
}

/// Returns touches of two bodies at points of a plane, given as x, y and gap, each of another geom pair.
fn touches(points: &[[f64; 3]]) -> Vec<Touch> {
    let touch = |(geoms, [x, y, gap]): (usize, &[f64; 3])| {
        let (point, normal) = (Point3::new(*x, *y, 0.5 * gap), Vector3::z());
        Touch { pair: 0, geoms, point, normal, gap: *gap, friction: Friction::hard(0.3) }
    };
    points.iter().enumerate().map(touch).collect()
}

fn joined(points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut touches = touches(points);
    patches::join(&mut touches);
    touches.iter().map(|touch| [touch.point.x, touch.point.y, touch.gap]).collect()
}

#[test]
fn a_patch_is_reduced_to_the_corners_that_span_it() {
    let grid = (0..25).map(|i| [f64::from(i % 5) * 1e-3, f64::from(i / 5) * 1e-3]);
    let tilted: Vec<_> = grid.map(|[x, y]| [x, y, -1e-6 + 2e-3 * x - 1e-3 * y]).collect();
    let found = joined(&tilted);
    let expected = [0, 4, 20, 24].map(|i| tilted[i]);
    assert_eq!(found, expected);
    // Points in a row are reduced to the two ends, points close together to one.
    assert_eq!(joined(&tilted[..5]), [tilted[0], tilted[4]]);
    assert_eq!(joined(&[[0.0; 3], [5e-5, 0.0, 0.0], [0.0, 5e-5, 0.0]]).len(), 1);
}

#[test]
fn faces_of_different_height_friction_or_direction_are_not_joined() {
    let square = [[0.0, 0.0], [2e-3, 0.0], [0.0, 2e-3], [2e-3, 2e-3]];
    let face = |gap: f64, shift: f64| square.map(|[x, y]| [x + shift, y, gap]);
    let count = |gap, shift| joined(&[face(0.0, 0.0), face(gap, shift)].concat()).len();
    assert_eq!(count(0.0, 3e-3), 4);
    assert_eq!(count(50e-6, 3e-3), 8, "a step");
    let all = touches(&[face(0.0, 0.0), face(0.0, 3e-3)].concat());
    for change in [
        |touch: &mut Touch| touch.friction = Friction::hard(0.1),
        |touch: &mut Touch| touch.pair = 1,
        |touch: &mut Touch| touch.normal = Vector3::new(0.1, 0.0, 0.995),
        |touch: &mut Touch| touch.point.z += 1e-3,
    ] {
        let mut all = all.clone();
        all[4..].iter_mut().for_each(change);
        patches::join(&mut all);
        assert_eq!(all.len(), 8);
    }
}

/// Point and gap of each touch.
type Gaps = Vec<(Point3<f64>, f64)>;

/// Returns the touches of a cube of 2 mm at each of these poses with a socket of `count` x `count` boxes of 1 mm, and
/// the number of candidate pairs.
fn touches_of_tiles(count: i32, poses: &[Pose]) -> (Vec<Gaps>, usize) {
    let cube = |half: f64, x: f64, y: f64, z: f64| {
        let shape = Shape::Box { half: Vector3::repeat(half) };
        Geom { name: String::new(), shape, pose: Pose::translation(x, y, z), friction: None }
    };
    let middle = count / 2;
    let place = |i: i32| f64::from(i - middle) * 1e-3;
    let tiles =
        (0..count * count).map(|i| cube(0.5e-3, place(i % count), place(i / count), -0.5e-3));
    let mut scene = Scene::default();
    for geoms in [tiles.collect(), vec![cube(1e-3, 0.0, 0.0, 1e-3)]] {
        let (name, pose) = (String::new(), Pose::identity());
        scene.body(Body { name, motion: Motion::Fixed, pose, geoms });
    }
    scene.contact(BodyId(0), BodyId(1), Friction::hard(0.3));
    let mut bodies: Vec<_> = scene.bodies.iter().map(|body| MovingBody::new(body, None)).collect();
    let mut detector = Detector::new(&scene, 0.2e-3);
    let mut touched = Vec::new();
    for pose in poses {
        bodies[1].put(*pose);
        let mut found = Vec::new();
        detector.detect(&bodies, 5e-4, &mut found);
        // With many geom pairs, contacts with wider gaps are omitted unless the gap closes within the step.
        let near = found.iter().filter(|touch| touch.gap < NEAR);
        touched.push(near.map(|touch| (touch.point, touch.gap)).collect());
    }
    (touched, detector.lists[0].candidates.len())
}

/// A socket of 3 000 parts has the same contacts as one of the 25 parts around the plug.
#[test]
fn distant_parts_change_no_contact_and_are_no_candidates() {
    let poses: Vec<_> = (0..40)
        .map(|i| {
            at(
                0.02e-3 * f64::from(i),
                0.013e-3 * f64::from(i),
                0.01e-3,
                Vector3::z() * 0.01 * f64::from(i),
            )
        })
        .collect();
    let (few, _) = touches_of_tiles(5, &poses);
    let (many, candidates) = touches_of_tiles(55, &poses);
    assert!(few.iter().all(|touches| touches.len() >= 4), "{few:?}");
    assert_eq!(few, many);
    assert!(candidates <= 40, "{candidates} of 3025");
}
