//! Behaviour that the checks do not show.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![cfg(feature = "mujoco")]

use contact::mujoco::*;
use contact::scene::{Body, BodyId, Inertia, Joint, JointId, Motion, Pose, Scene, Spring, Springs};
use contact::{Engine, Unsupported, World, mjcf};
use insertion::robot::{Flange, Servo};
use insertion::trial::cell;
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};

/// A body of 0.1 kg on a servo of 1000 N/m and 5 N along y.
fn servo_scene() -> (Scene, BodyId, JointId) {
    let mut scene = Scene::default();
    let inertia = Inertia { mass: 0.1, centre: Point3::origin(), moments: Vector3::repeat(1e-4) };
    let body = |name: &str, motion| Body {
        name: name.into(),
        motion,
        pose: Pose::identity(),
        geoms: Vec::new(),
    };
    let base = scene.body(body("base", Motion::Fixed));
    let jaw = scene.body(body("jaw", Motion::Carried(inertia)));
    let mut axes = [None; 6];
    axes[1] = Some(Spring { limit: 5.0, ..Spring::new(1000.0, 30.0) });
    let slide = scene.joint(Joint {
        name: "slide".into(),
        parent: base,
        child: jaw,
        in_parent: Pose::identity(),
        in_child: Pose::identity(),
        springs: Springs::Axes(axes),
    });
    (scene, jaw, slide)
}

fn advance(world: &mut dyn World, time: f64) {
    for _ in 0..(time / world.step_s()).round() as usize {
        world.step().unwrap();
    }
}

#[test]
fn a_servo_pushes_to_its_limit_and_can_be_made_to_hold() {
    let (scene, jaw, slide) = servo_scene();
    let mut world = Mujoco::default().world(&scene);
    let at = |world: &dyn World| world.pose(jaw).translation.y;
    world.push(jaw, Vector3::new(0.0, 3.0, 0.0), Vector3::zeros());
    advance(&mut *world, 0.5);
    assert!((at(&*world) - 3e-3).abs() < 1e-6, "{}", at(&*world));
    let mut snapshot = world.snapshot();
    // Beyond the limit it gives way.
    world.push(jaw, Vector3::new(0.0, 6.0, 0.0), Vector3::zeros());
    advance(&mut *world, 0.5);
    assert!(at(&*world) > 0.1, "{}", at(&*world));
    // Held, it does not; and the model of one world is not that of the other.
    snapshot.set_spring(slide, 1, cell::holding(3e-3));
    snapshot.push(jaw, Vector3::new(0.0, 6.0, 0.0), Vector3::zeros());
    advance(&mut *snapshot, 0.5);
    assert!((at(&*snapshot) - 3e-3).abs() < 1e-6, "{}", at(&*snapshot));
}

/// Damper and spring act between command and flange, which does not trail at a steady speed.
#[test]
fn a_driven_body_carries_the_flange_along_and_turns_it() {
    let servo = Servo {
        stiffness: [1e4; 3],
        rotational_stiffness: [400.0; 3],
        mass: 2.0,
        inertia: 0.01,
        damping_ratio: 1.0,
    };
    let mut scene = Scene::default();
    let (command, flange) = cell::add_flange(&mut scene, &Flange::Servo(servo), Pose::identity());
    let mut world = Mujoco::default().world(&scene);
    let step = world.step_s();
    for i in 1..=8000 {
        let time = f64::from(i) * step;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.5 * time);
        world.drive(command, Pose::from_parts(Translation3::new(0.0, 0.1 * time, 0.0), turn));
        world.step().unwrap();
    }
    let off = world.pose(command).inv_mul(&world.pose(flange));
    assert!((world.pose(command).translation.y - 0.04).abs() < 1e-9);
    assert!((world.pose(command).rotation.angle() - 0.2).abs() < 1e-9);
    assert!(off.translation.vector.norm() < 1e-5 && off.rotation.angle() < 1e-5, "{off}");
}

#[test]
fn the_arm_is_refused_by_name() {
    let (mut scene, ..) = servo_scene();
    scene.bodies[1].motion = Motion::Mechanism(nalgebra::Matrix6::identity());
    let refused = Mujoco::default().supports(&scene).unwrap_err();
    let Unsupported::Lacking { engine, part, .. } = refused else { panic!("{refused}") };
    assert_eq!((part.as_str(), engine.as_str()), ("jaw", "mujoco 3.17.0"));
}

/// A body too light for MuJoCo is refused in its own words before anything is simulated.
#[test]
fn numbers_that_mujoco_refuses_are_no_panic() {
    let (mut scene, jaw, _) = servo_scene();
    let light = Inertia { mass: 1e-20, centre: Point3::origin(), moments: Vector3::repeat(1e-30) };
    scene.bodies[jaw.0].motion = Motion::Carried(light);
    let refused = Mujoco::default().supports(&scene).unwrap_err();
    assert!(refused.to_string().contains("mass and inertia"), "{refused}");
}

/// A latch weighs for a contact what MuJoCo gives it, so its contacts are as stiff as all others.
#[test]
fn a_latch_weighs_what_mujoco_gives_it() {
    let text = include_str!("../../../tasks/rj45_latch.toml");
    let task = insertion::task::Task::parse(text, "rj45_latch.toml").unwrap();
    let robot = input::shipped::ROBOTS[0];
    let robot = insertion::robot::Robot::parse(robot.text, robot.file).unwrap();
    let mounted = robot.mount(task.turn, task.strategy.tilt).unwrap();
    let finger = insertion::finger::Finger::new(2000.0, 45_000.0);
    let scene = cell::build(&task, &mounted, &finger).scene;
    let engine = Mujoco::default();
    let weight = engine.inverse_weight(&scene, "latch").unwrap();
    let text = mjcf::write(&scene, "scene", &engine.settings).unwrap();
    let document = roxmltree::Document::parse(&text).unwrap();
    let of_latch = |node: &roxmltree::Node| {
        let names = ["geom1", "geom2"].map(|side| node.attribute(side).unwrap_or(""));
        node.has_tag_name("pair") && names.iter().any(|name| name.starts_with("latch:"))
    };
    let pair = document.descendants().find(of_latch).unwrap();
    let impedance = pair.attribute("solimp").unwrap().split_whitespace().next().unwrap();
    let impedance: f64 = impedance.parse().unwrap();
    let regular = weight * (1.0 - impedance) / impedance;
    assert!((regular * engine.settings.contact_mass - 1.0).abs() < 1e-6, "{impedance}, {weight}");
}
