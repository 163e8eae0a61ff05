//! Checks against closed forms; the steps are those that trials use, and finer ones.

use super::Settings;
use super::world::DirectWorld;
use crate::input::finger::Coupling;
use crate::physics::World;
use crate::scene::{
    Axis, Body, BodyId, Coupled, Geom, Inertia, Joint, JointId, Motion, Pose, Scene, Shape, Spring,
    Springs,
};
use nalgebra::{Point3, UnitQuaternion, Vector3};

const STEPS: [f64; 3] = [5e-4, 2.5e-4, 1e-4];
const G: f64 = 9.81;

fn world(scene: &Scene, step_s: f64) -> DirectWorld {
    DirectWorld::new(scene, &Settings { step_s, ..Settings::default() })
}

fn run(world: &mut DirectWorld, time: f64) {
    for _ in 0..(time / world.step_s()).round() as usize {
        world.step().expect("finite");
    }
}

fn inertia(mass: f64, half: Vector3<f64>) -> Inertia {
    let [x, y, z] = [half.x * half.x, half.y * half.y, half.z * half.z];
    let moments = Vector3::new(y + z, x + z, x + y) * (mass / 3.0);
    Inertia { mass, centre: Point3::origin(), moments }
}

fn cuboid(name: &str, motion: Motion, half: [f64; 3], pose: Pose, friction: f64) -> Body {
    let shape = Shape::Box { half: Vector3::from(half) };
    let geom = Geom { name: name.into(), shape, pose: Pose::identity(), friction, patch: 0.0 };
    Body { name: name.into(), motion, pose, geoms: vec![geom] }
}

fn free(mass: f64, half: [f64; 3]) -> Motion {
    Motion::Free(inertia(mass, Vector3::from(half)))
}

/// A 20 x 20 x 10 mm block of 20 g on an incline with a heading about its normal.
fn incline(mu: f64, slope: f64, heading: f64, step: f64) -> (DirectWorld, BodyId, Vector3<f64>) {
    let turn = UnitQuaternion::from_euler_angles(0.0, slope, 0.0);
    let tilt = Pose::from_parts(nalgebra::Translation3::identity(), turn);
    let spin = UnitQuaternion::from_euler_angles(0.0, 0.0, heading);
    let half = [10e-3, 10e-3, 5e-3];
    let on_top = Pose::from_parts(nalgebra::Translation3::new(0.0, 0.0, 10e-3), spin);
    let mut scene = Scene { gravity: Vector3::new(0.0, 0.0, -G), ..Scene::default() };
    let floor = cuboid("floor", Motion::Fixed, [1.0, 0.1, 5e-3], tilt, mu);
    let floor = scene.body(floor);
    let block = scene.body(cuboid("block", free(0.02, half), half, tilt * on_top, 1.0));
    scene.contacts.push((floor, block));
    (world(&scene, step), block, turn * Vector3::x())
}

#[test]
fn a_block_slides_down_an_incline_as_coulomb_says() {
    for step in STEPS {
        for heading in [0.0_f64, 37.0] {
            let (mu, slope) = (0.3, 25.0_f64.to_radians());
            let (mut world, block, down) = incline(mu, slope, heading.to_radians(), step);
            run(&mut world, 0.05);
            let from = world.bodies[block.0].velocity.fixed_rows::<3>(0).dot(&down);
            run(&mut world, 0.1);
            let to = world.bodies[block.0].velocity.fixed_rows::<3>(0).dot(&down);
            let found = slope.tan() - (to - from) / 0.1 / (G * slope.cos());
            assert!((found / mu - 1.0).abs() < 5e-3, "step {step} heading {heading}: mu {found}");
        }
    }
}

#[test]
fn a_block_sticks_on_an_incline() {
    for step in STEPS {
        for heading in [0.0_f64, 37.0] {
            let slope = 16.0_f64.to_radians();
            let (mut world, block, _) = incline(0.3, slope, heading.to_radians(), step);
            run(&mut world, 0.1);
            let from = world.pose(block).translation.vector;
            run(&mut world, 0.5);
            let creep = (world.pose(block).translation.vector - from).norm() / 0.5;
            assert!(creep < 1e-5, "step {step} heading {heading}: {creep} m/s");
        }
    }
}

/// A body on six springs to the world, loaded by gravity.
fn sprung(springs: [f64; 6], gravity: Vector3<f64>, arm: Vector3<f64>) -> Scene {
    let mut scene = Scene { gravity, ..Scene::default() };
    let base = scene.body(cuboid("base", Motion::Fixed, [1e-3; 3], Pose::identity(), 1.0));
    let heavy = Inertia { mass: 0.1, centre: Point3::from(arm), moments: Vector3::repeat(1e-5) };
    let body = cuboid("body", Motion::Free(heavy), [1e-3; 3], Pose::identity(), 1.0);
    let body = scene.body(body);
    scene.joint(Joint {
        name: "springs".into(),
        parent: base,
        child: body,
        in_parent: Pose::identity(),
        in_child: Pose::identity(),
        springs: Springs::Axes(std::array::from_fn(|i| {
            Axis::Sprung(Spring::new(springs[i], if i < 3 { 20.0 } else { 0.02 }))
        })),
    });
    scene
}

/// Coupled springs: a load along one axis displaces all, by the inverse of the matrix.
#[test]
fn coupled_springs_give_by_their_inverse() {
    let coefficients = Coupling::new([(1, 2, 0.4), (1, 3, -0.5), (0, 4, 0.3)]).unwrap();
    let stiffness = coefficients.stiffness([1e5, 2e3, 4e4, 1.0, 10.0, 10.0], -1.0);
    let damping = nalgebra::Matrix6::from_diagonal(&[20.0, 20.0, 20.0, 0.02, 0.02, 0.02].into());
    let mut scene = sprung([1.0; 6], Vector3::zeros(), Vector3::zeros());
    scene.joints[0].springs = Springs::Coupled(Coupled { stiffness, damping });
    for axis in 0..6 {
        let load = nalgebra::Vector6::ith(axis, if axis < 3 { 0.5 } else { 2e-3 });
        let mut world = world(&scene, 5e-4);
        let [force, moment] = [load.fixed_rows::<3>(0), load.fixed_rows::<3>(3)];
        world.push(BodyId(1), force.into_owned(), moment.into_owned());
        run(&mut world, 2.0);
        let Pose { translation, rotation } = world.pose(BodyId(1));
        let found: Vec<f64> =
            translation.vector.iter().chain(rotation.scaled_axis().iter()).copied().collect();
        let found = nalgebra::Vector6::from_column_slice(&found);
        let expected = stiffness.try_inverse().unwrap() * load;
        // The moment is about fixed axes, the coordinate is a rotation vector: they differ
        // at second order in the angle.
        assert!((found - expected).norm() < 1e-3 * expected.norm(), "{axis}: {found} {expected}");
    }
}

/// Torsional friction: a face of friction mu whose corners lie at r from its middle, of
/// patch radius rho, resists a turn about its normal with `mu N sqrt(r^2 + rho^2)`, and
/// sliding with mu N as ever.
#[test]
fn a_patch_resists_a_turn_with_its_radius() {
    let (mass, mu, rho) = (0.1, 0.5, 30e-3_f64);
    let half = [5e-3, 5e-3, 2e-3];
    let limit = mu * mass * G * rho.hypot(f64::hypot(half[0], half[1]));
    let push = mu * mass * G;
    for (moment, force, moves) in [
        (0.98 * limit, 0.0, false),
        (1.02 * limit, 0.0, true),
        (0.0, 0.98 * push, false),
        (0.0, 1.02 * push, true),
    ] {
        let mut scene = Scene { gravity: Vector3::new(0.0, 0.0, -G), ..Scene::default() };
        let under = Pose::translation(0.0, 0.0, -5e-3);
        let mut floor = cuboid("floor", Motion::Fixed, [0.1, 0.1, 5e-3], under, mu);
        floor.geoms[0].patch = rho;
        let floor = scene.body(floor);
        let on_top = Pose::translation(0.0, 0.0, 2e-3);
        let mut block = cuboid("block", free(mass, half), half, on_top, mu);
        block.geoms[0].patch = f64::INFINITY;
        let block = scene.body(block);
        scene.contacts.push((floor, block));
        let mut world = world(&scene, 5e-4);
        run(&mut world, 0.05);
        world.push(block, Vector3::x() * force, Vector3::z() * moment);
        run(&mut world, 0.1);
        let velocity = world.bodies[block.0].velocity;
        let moved = velocity[5].abs() > 1e-2 || velocity[0].abs() > 1e-3;
        assert_eq!(moved, moves, "moment {moment} N m, force {force} N: {velocity}");
    }
}

#[test]
fn a_spring_yields_by_force_over_stiffness() {
    for step in STEPS {
        let load = Vector3::new(5.0, -7.0, 9.0);
        let stiffness = [1.2e3, 52e3, 100e3, 1.0, 10.0, 10.0];
        let mut world = world(&sprung(stiffness, load / 0.1, Vector3::zeros()), step);
        run(&mut world, 2.0);
        let moved = world.pose(BodyId(1)).translation.vector;
        for i in 0..3 {
            let expected = load[i] / stiffness[i];
            assert!((moved[i] / expected - 1.0).abs() < 1e-6, "step {step} axis {i}: {}", moved[i]);
        }
    }
}

#[test]
fn a_rotational_spring_turns_by_moment_over_stiffness() {
    // A weight of 5 N on an arm of 50 mm about x: k t = 0.25 cos t.
    let stiffness = [1e5, 1e5, 1e5, 0.8, 10.0, 10.0];
    let scene = sprung(stiffness, Vector3::new(0.0, 0.0, -50.0), Vector3::new(0.0, 0.05, 0.0));
    let mut world = world(&scene, 2.5e-4);
    run(&mut world, 3.0);
    let turned = world.pose(BodyId(1)).rotation.scaled_axis().x;
    assert!(turned < -0.28);
    assert!((turned / (-0.25 * turned.cos() / 0.8) - 1.0).abs() < 1e-6, "{turned}");
}

#[test]
fn a_servo_pushes_with_its_limit_and_no_more() {
    let mut scene = sprung([1e4, 1e4, 1e4, 1.0, 1.0, 1.0], Vector3::zeros(), Vector3::zeros());
    scene.gravity = Vector3::new(0.0, 0.0, 0.0);
    let mut world = world(&scene, 5e-4);
    let servo = Spring { stiffness: 1e4, damping: 0.0, target: 1.0, limit: 0.5 };
    world.set_spring(JointId(0), 1, servo);
    run(&mut world, 0.1);
    // 0.5 N on 0.1 kg.
    let speed = world.bodies[1].velocity[1];
    assert!((speed - 0.5).abs() < 1e-9, "{speed}");
}

#[test]
fn a_locked_joint_holds_a_swinging_arm() {
    let mut scene = sprung([1.0; 6], Vector3::new(0.0, 0.0, -G), Vector3::new(0.0, 0.05, 0.0));
    scene.joints[0].springs = Springs::Axes([Axis::Locked; 6]);
    let mut world = world(&scene, 5e-4);
    run(&mut world, 1.0);
    let pose = world.pose(BodyId(1));
    assert!(pose.translation.vector.norm() < 1e-8 && pose.rotation.angle() < 1e-6);
}

#[test]
fn a_peg_in_a_hole_tilts_to_two_points() {
    // Width 12 in 12.1 mm at a depth of 8 mm: 12.1 = 12 cos t + 8 sin t.
    let peg = [6e-3, 6e-3, 20e-3];
    let mut scene = Scene::default();
    let wall = |y: f64| {
        let pose = Pose::translation(0.0, y, -10e-3);
        cuboid("wall", Motion::Fixed, [20e-3, 10e-3, 10e-3], pose, 0.0)
    };
    let walls = [16.05e-3, -16.05e-3].map(|y| scene.body(wall(y)));
    let pose = Pose::translation(0.0, 0.0, 12e-3);
    let body = scene.body(cuboid("peg", free(0.05, peg), peg, pose, 0.0));
    scene.contacts.extend(walls.map(|wall| (wall, body)));
    let post = scene.body(cuboid("post", Motion::Driven, [1e-3; 3], Pose::identity(), 0.0));
    const TURN: f64 = 0.05;
    // A weak spring turns it, so weak that contacts yield next to nothing; another
    // holds its tip's height.
    let mut axes = [0.0, 0.0, 2e4, TURN, 10.0, 10.0].map(|k| Axis::Sprung(Spring::new(k, 0.1)));
    axes[3] = Axis::Sprung(Spring { target: 0.1, ..Spring::new(TURN, 0.1) });
    let in_child = Pose::translation(0.0, 0.0, -20e-3);
    let in_parent = Pose::translation(0.0, 0.0, -8e-3);
    let name = "hold".into();
    let springs = Springs::Axes(axes);
    scene.joint(Joint { name, parent: post, child: body, in_parent, in_child, springs });
    for step in STEPS {
        let mut world = world(&scene, step);
        run(&mut world, 2.0);
        let pose = world.pose(body);
        let tilt = pose.rotation.scaled_axis().x;
        let lowest = [-6e-3, 6e-3].map(|y| (pose * Point3::new(0.0, y, -20e-3)).z);
        let depth = -lowest[0].min(lowest[1]);
        // D = d cos t + l sin t, with l along the peg from its lower corner to the hole's edge.
        let mut expected = 0.0_f64;
        for _ in 0..50 {
            let along = depth / expected.cos();
            expected = ((12.1e-3 - 12e-3 * expected.cos()) / along).asin();
        }
        assert!((tilt.abs() / expected - 1.0).abs() < 0.02, "{step}: {tilt} {expected} at {depth}");
    }
}

#[test]
fn a_block_tips_where_its_centre_crosses_the_edge() {
    for step in STEPS {
        let half = [10e-3, 10e-3, 5e-3];
        let mut scene = Scene { gravity: Vector3::new(0.0, 0.0, -G), ..Scene::default() };
        let table = [0.1, 0.05, 5e-3];
        let under = Pose::translation(-0.1, 0.0, -5e-3);
        let floor = scene.body(cuboid("table", Motion::Fixed, table, under, 0.2));
        let pose = Pose::translation(-15e-3, 0.0, 5e-3);
        let block = scene.body(cuboid("block", free(0.02, half), half, pose, 0.2));
        scene.contacts.push((floor, block));
        let pusher = scene.body(cuboid("pusher", Motion::Driven, [1e-3; 3], pose, 0.0));
        // Pushed along x at its bottom, free to tip: only x is held.
        let mut axes = [Axis::Sprung(Spring::new(0.0, 0.0)); 6];
        axes[0] = Axis::Sprung(Spring::new(1e5, 10.0));
        let at = Pose::translation(0.0, 0.0, -5e-3);
        let (name, in_parent, in_child) = ("push".into(), at, at);
        let springs = Springs::Axes(axes);
        scene.joint(Joint { name, parent: pusher, child: block, in_parent, in_child, springs });
        let mut world = world(&scene, step);
        let speed = 2e-3;
        let mut time = 0.0;
        let tipped = loop {
            time += step;
            world.drive(pusher, Pose::translation(speed * time, 0.0, 0.0) * pose);
            world.step().expect("finite");
            if world.pose(block).rotation.angle() > 0.02 || time > 20.0 {
                break world.pose(block).translation.x;
            }
        };
        assert!(tipped.abs() < 0.5e-3, "step {step}: {tipped}");
    }
}

#[test]
fn a_wedged_plug_hardly_sinks() {
    // 5 g between a press with 70 N and a wall.
    for step in STEPS {
        let half = [5e-3, 5e-3, 10e-3];
        let mut scene = Scene::default();
        let below = Pose::translation(0.0, 0.0, -5e-3);
        let wall = scene.body(cuboid("wall", Motion::Fixed, [0.05, 0.05, 5e-3], below, 0.2));
        let pose = Pose::translation(0.0, 0.0, 10e-3);
        let plug = scene.body(cuboid("plug", free(5e-3, half), half, pose, 0.2));
        let press = Motion::Carried(inertia(2e-3, Vector3::repeat(5e-3)));
        let above = Pose::translation(0.0, 0.0, 22e-3);
        let press = scene.body(cuboid("press", press, [5e-3, 5e-3, 2e-3], above, 1.0));
        scene.contacts.extend([(wall, plug), (plug, press)]);
        let top = scene.body(cuboid("top", Motion::Driven, [1e-3; 3], above, 1.0));
        let mut axes = [1e5, 1e5, 1e5, 10.0, 10.0, 10.0].map(|k| Axis::Sprung(Spring::new(k, 0.1)));
        let target = -70.0 / 1e5;
        axes[2] = Axis::Sprung(Spring { target, ..Spring::new(1e5, 10.0) });
        let (in_parent, in_child) = (Pose::identity(), Pose::identity());
        let name = "spring".into();
        let springs = Springs::Axes(axes);
        scene.joint(Joint { name, parent: top, child: press, in_parent, in_child, springs });
        let mut world = world(&scene, step);
        run(&mut world, 0.5);
        let sunk = pose.translation.z - world.pose(plug).translation.z;
        // Two corners carry it, each a spring of the contact stiffness, and the
        // engine may not sink further than twice that.
        let give = 70.0 / (2.0 * Settings::default().contact_stiffness);
        assert!((0.0..2.0 * give).contains(&sunk), "step {step}: {sunk} of {give}");
        let force = world.contact(wall, plug);
        // The press is a spring: what the contacts give way, it pushes less.
        let pushed = 70.0 - 4.0 * 1e5 * give..=70.0;
        assert!(pushed.contains(&force.net.z) && pushed.contains(&force.normal_sum), "{force:?}");
        assert_eq!(world.contact(plug, wall).net, -force.net);
    }
}

#[test]
fn a_free_body_keeps_its_momentum_and_gains_no_energy() {
    let motion = free(0.02, [30e-3, 10e-3, 5e-3]);
    let mut scene = Scene::default();
    scene.body(cuboid("body", motion, [1e-3; 3], Pose::identity(), 1.0));
    let mut world = world(&scene, 1e-4);
    let start = [0.1, 0.2, 0.3, 5.0, 0.5, 3.0];
    world.bodies[0].spin_up(start.into());
    let (energy, spin) = (world.bodies[0].kinetic_energy(), world.bodies[0].spin());
    run(&mut world, 1.0);
    assert!((world.bodies[0].spin() - spin).norm() < 1e-12 * spin.norm());
    assert!((world.bodies[0].kinetic_energy() / energy - 1.0).abs() < 2e-3);
    assert!((world.bodies[0].velocity - nalgebra::Vector6::from(start)).rows(0, 3).norm() < 1e-14);
}

#[test]
fn a_snapshot_continues_bit_for_bit() {
    let (mut world, block, _) = incline(0.3, 0.5, 0.6, 5e-4);
    run(&mut world, 0.05);
    let mut copy = World::snapshot(&world);
    for _ in 0..300 {
        world.step().expect("finite");
        copy.step().expect("finite");
    }
    assert_eq!(world.pose(block), copy.pose(block));
}

#[test]
fn a_state_that_is_not_finite_is_reported() {
    let (mut world, block, _) = incline(0.3, 0.5, 0.6, 5e-4);
    world.bodies[block.0].spin_up([f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0].into());
    assert!(world.step().is_err());
}
