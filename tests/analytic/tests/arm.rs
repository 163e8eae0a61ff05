//! Arm model against closed forms, finite differences and its own joints.

use analytic_checks::arm::{chain, flange, ur5e};
use contact::Engine;
use contact::direct::Direct;
use contact::scene::{BodyId, Pose, displacement};
use input::shipped::ROBOTS;
use input::units::{DEG, MM};
use insertion::arm::{Angles, Arm};
use insertion::robot::{Drive, Robot};
use nalgebra::{Matrix6, Translation3, UnitQuaternion, Vector3};

fn arm() -> Arm {
    ur5e().expect("the shipped arm stands at home").0
}

fn robot() -> Robot {
    let file = ROBOTS.iter().find(|file| file.name == "ur5e").unwrap();
    Robot::parse(file.text, file.file).unwrap()
}

fn bent() -> Angles {
    arm().home + Angles::new(0.3, -0.2, 0.25, 0.1, -0.3, 0.7)
}

#[test]
fn at_home_the_upper_arm_stands_the_forearm_lies_and_the_tool_points_down() {
    let tcp = arm().posture(&arm().home).tcp;
    let sides = 0.138 - 0.131 + 0.127;
    let expected = Vector3::new(sides, 0.392 + 0.100, 0.163 + 0.425 - 0.100 - 0.198);
    assert!((tcp.translation.vector - expected).norm() < 1e-12, "{tcp}");
    assert!(tcp.rotation.angle() < 1e-12, "{tcp}");
}

#[test]
fn the_jacobian_is_the_derivative_of_the_pose() {
    let (arm, angles, h) = (arm(), bent(), 1e-6);
    let jacobian = arm.posture(&angles).tcp_jacobian();
    for i in 0..6 {
        let moved = |by: f64| arm.posture(&(angles + Angles::ith(i, by))).tcp;
        let rate = displacement(&moved(-h), &moved(h)) / (2.0 * h);
        assert!((rate - jacobian.column(i)).norm() < 1e-8, "joint {i}");
    }
}

#[test]
fn the_mass_matrix_gives_the_links_kinetic_energy() {
    let (arm, angles, h) = (arm(), bent(), 1e-6);
    let rates = Angles::new(0.5, -0.4, 0.9, 1.1, -0.7, 0.8);
    let (before, after) = (arm.posture(&(angles - rates * h)), arm.posture(&(angles + rates * h)));
    let of_link = |i: usize| {
        let link = &arm.joints[i].link;
        let centre = |pose: Pose| pose * Pose::from(Translation3::from(link.centre.coords));
        let moved = displacement(&centre(before.links[i]), &centre(after.links[i])) / (2.0 * h);
        let turned = arm.posture(&angles).links[i].rotation.inverse() * moved.fixed_rows::<3>(3);
        let spin = turned.component_mul(&turned).dot(&link.moments);
        0.5 * (link.mass * moved.fixed_rows::<3>(0).norm_squared() + spin)
    };
    let energy: f64 = (0..6).map(of_link).sum();
    let mass = arm.mass_matrix(&arm.posture(&angles));
    assert!((0.5 * rates.dot(&(mass * rates)) / energy - 1.0).abs() < 1e-8, "{energy} J");
}

#[test]
fn the_inverse_kinematics_reaches_every_start_and_says_when_it_cannot() {
    let arm = arm();
    for turn in [0.0, -90.0, 90.0] {
        for tilt in [-45.0, 0.0, 10.0, 45.0] {
            assert!(arm.at_start(turn * DEG, tilt * DEG).is_ok(), "turn {turn}, tilt {tilt}");
        }
    }
    let target = arm.posture(&bent()).tcp;
    let found = arm.posture(&arm.inverse_kinematics(&target).unwrap()).tcp;
    assert!(displacement(&found, &target).norm() < 1e-9);
    let far = Pose::translation(2.0, 0.0, 0.5);
    let error = arm.inverse_kinematics(&far).unwrap_err().to_string();
    assert!(error.contains("does not reach") && error.contains("home_deg"), "{error}");
}

/// Turning the task turns the spring: the last joint, along the tool, has no part in it.
#[test]
fn a_turned_task_feels_the_same_arm_from_another_side() {
    let (arm, turn) = (arm(), -90.0 * DEG);
    let [straight, turned] = [0.0, turn].map(|turn| arm.at_start(turn, 0.0).unwrap().stiffness);
    let axes = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn).to_rotation_matrix();
    let block = |k: &Matrix6<f64>| k.fixed_view::<3, 3>(0, 0).into_owned();
    let expected = axes.inverse() * block(&straight) * axes;
    assert!((block(&turned) - expected).norm() < 1e-6 * expected.norm());
}

/// The chain of six links and the one body move alike in time, too.
#[test]
fn the_joint_chain_moves_like_the_reduction() {
    let (arm, mounted) = ur5e().unwrap();
    let engine = Direct::default();
    for axis in 0..3 {
        let one = flange(&mounted).moved(&engine, axis, 0.5).unwrap();
        let six = chain(&arm).moved(&engine, axis, 0.5).unwrap();
        let largest = one.iter().map(|moved| moved.norm()).fold(0.0, f64::max);
        let apart = one.iter().zip(&six).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(largest > 1.0 * MM && apart < 0.01 * largest, "{axis}: {apart} of {largest} m");
    }
}

/// With its speed fed forward the flange keeps up with a moving command; without, it
/// trails by the servos' time constant (both kinds have the same here, 0.2 s).
#[test]
fn an_arm_without_feed_forward_trails_its_command() {
    for (feed_forward, expected) in [(false, 0.2), (true, 0.0)] {
        let robot = Robot { drive: Drive::Arm(Box::new(Arm { feed_forward, ..arm() })), ..robot() };
        let loaded = flange(&robot.mount(0.0, 0.0).unwrap());
        let mut world = Direct::default().world(&loaded.scene);
        let (speed, steps) = (10.0 * MM, (3.0 / world.step_s()) as usize);
        for i in 1..=steps {
            let at = speed * i as f64 * world.step_s();
            world.drive(BodyId(0), Pose::translation(0.0, at, 0.0));
            world.step().unwrap();
        }
        let behind =
            (world.pose(BodyId(0)).translation.y - world.pose(loaded.end).translation.y) / speed;
        assert!((behind - expected).abs() < 1e-3, "{feed_forward}: {behind} s behind");
    }
}

/// Dependence of the reduction on its place: the search moves by some 10 mm about the start.
#[test]
fn ten_millimetres_change_the_compliance_by_less_than_two_percent() {
    let arm = arm();
    let home = arm.posture(&arm.home).tcp;
    let soft = |pose: &Pose| {
        let angles = arm.inverse_kinematics(pose).unwrap();
        let reduced = arm.reduced(&angles, &UnitQuaternion::identity()).unwrap();
        let compliance = reduced.stiffness.try_inverse().unwrap();
        compliance.fixed_view::<3, 3>(0, 0).into_owned()
    };
    let here = soft(&home);
    for axis in 0..3 {
        for way in [-10.0 * MM, 10.0 * MM] {
            let moved = Pose::from(Translation3::from(Vector3::ith(axis, way))) * home;
            let change = (soft(&moved) - here).norm() / here.norm();
            assert!(change < 0.02, "{axis} {way}: {change}");
        }
    }
}

#[test]
fn an_arm_file_is_checked() {
    let text = include_str!("../../../robots/ur5e.toml");
    for (from, to, part) in [
        ("assembly_force_n = 100.0", "assembly_force_n = 0.0", "assembly_force_n"),
        ("limit_nm = 28.0", "limit_nm = -28.0", "joint \"wrist 1\" limit_nm"),
        ("home_deg = [270.0,", "home_deg = [nan,", "home_deg"),
        ("link_mass_kg = 3.7", "mass = 3.7", "mass"),
        ("axis = \"z\"", "axis = \"w\"", "w"),
    ] {
        let bad = text.replacen(from, to, 1);
        let error = Robot::parse(&bad, "a.toml").unwrap_err().to_string();
        assert!(error.contains(part) && error.contains("a.toml"), "{error}");
    }
    let five = text.rsplit_once("[[joint]]").unwrap().0;
    let error = Robot::parse(five, "a.toml").unwrap_err().to_string();
    assert!(error.contains("there are 5 [[joint]]; an arm has six"), "{error}");
}
