//! Cases beyond the analytic checks: turns of many degrees, coupled springs under moments, a
//! servo at its limit, free flight, a state that is not finite.

use super::Direct;
use super::body::MovingBody;
use super::world::DirectWorld;
use crate::World;
use crate::scene::{Body, BodyId, Inertia, Joint, JointId, Motion, Pose, Scene, Spring, Springs};
use nalgebra::{Matrix6, Point3, Vector3, Vector6};

fn world(scene: &Scene, step_s: f64) -> DirectWorld {
    DirectWorld::new(scene, &Direct { step_s, ..Direct::default() })
}

fn run(world: &mut DirectWorld, time: f64) {
    for _ in 0..(time / world.step_s()).round() as usize {
        world.step().expect("finite");
    }
}

fn body(name: &str, motion: Motion) -> Body {
    Body { name: name.into(), motion, pose: Pose::identity(), geoms: Vec::new() }
}

/// A body of 0.1 kg on six springs to the world, loaded by gravity.
fn sprung(springs: [f64; 6], gravity: Vector3<f64>, arm: Vector3<f64>) -> Scene {
    let mut scene = Scene { gravity, ..Scene::default() };
    let base = scene.body(body("base", Motion::Fixed));
    let heavy = Inertia { mass: 0.1, centre: Point3::from(arm), moments: Vector3::repeat(1e-5) };
    let child = scene.body(body("body", Motion::Free(heavy)));
    scene.joint(Joint {
        name: "springs".into(),
        parent: base,
        child,
        in_parent: Pose::identity(),
        in_child: Pose::identity(),
        springs: Springs::Axes(std::array::from_fn(|i| {
            Some(Spring::new(springs[i], if i < 3 { 20.0 } else { 0.02 }))
        })),
    });
    scene
}

/// Coupled springs: a load along one axis displaces all, by the inverse of the matrix.
#[test]
fn coupled_springs_give_by_their_inverse() {
    let springs = [1e5f64, 2e3, 4e4, 1.0, 10.0, 10.0];
    let mut stiffness = Matrix6::from_diagonal(&springs.into());
    for (i, j, share) in [(1, 2, 0.4), (1, 3, -0.5), (0, 4, 0.3)] {
        let mixed = share * (springs[i] * springs[j]).sqrt();
        (stiffness[(i, j)], stiffness[(j, i)]) = (mixed, mixed);
    }
    let damping = Matrix6::from_diagonal(&[20.0, 20.0, 20.0, 0.02, 0.02, 0.02].into());
    let mut scene = sprung([1.0; 6], Vector3::zeros(), Vector3::zeros());
    scene.joints[0].springs = Springs::Coupled { stiffness, damping };
    for axis in 0..6 {
        let load = Vector6::ith(axis, if axis < 3 { 0.5 } else { 2e-3 });
        let mut world = world(&scene, 5e-4);
        let [force, moment] = [load.fixed_rows::<3>(0), load.fixed_rows::<3>(3)];
        world.push(BodyId(1), force.into_owned(), moment.into_owned());
        run(&mut world, 2.0);
        let Pose { translation, rotation } = world.pose(BodyId(1));
        let turn = rotation.scaled_axis();
        let found = Vector6::from_iterator(translation.vector.iter().chain(turn.iter()).copied());
        let expected = stiffness.try_inverse().unwrap() * load;
        // Moment about fixed axes, coordinate a rotation vector: a difference of second order.
        assert!((found - expected).norm() < 1e-3 * expected.norm(), "{axis}: {found} {expected}");
    }
}

#[test]
fn a_spring_turned_by_16_degrees_balances_the_weight() {
    // A weight of 5 N on an arm of 50 mm about x: k t = 0.25 cos t.
    let stiffness = [1e5, 1e5, 1e5, 0.8, 10.0, 10.0];
    let scene = sprung(stiffness, Vector3::new(0.0, 0.0, -50.0), Vector3::new(0.0, 0.05, 0.0));
    let mut world = world(&scene, 2.5e-4);
    run(&mut world, 3.0);
    let turned = world.pose(BodyId(1)).rotation.scaled_axis().x;
    assert!(turned < -0.28);
    assert!((turned / (-0.25 * libm::cos(turned) / 0.8) - 1.0).abs() < 1e-6, "{turned}");
}

#[test]
fn a_servo_pushes_with_its_limit_and_no_more() {
    let scene = sprung([1e4, 1e4, 1e4, 1.0, 1.0, 1.0], Vector3::zeros(), Vector3::zeros());
    let mut world = world(&scene, 5e-4);
    let servo = Spring { stiffness: 1e4, damping: 0.0, target: 1.0, limit: 0.5 };
    world.set_spring(JointId(0), 1, servo);
    run(&mut world, 0.1);
    // 0.5 N on 0.1 kg.
    let speed = world.bodies[1].velocity[1];
    assert!((speed - 0.5).abs() < 1e-9, "{speed}");
}

/// A body in free flight at this velocity, with three different moments of inertia.
fn flying(velocity: Vector6<f64>) -> DirectWorld {
    let moments = Vector3::new(8.3e-7, 6.2e-6, 6.7e-6);
    let mut scene = Scene::default();
    let inertia = Inertia { mass: 0.02, centre: Point3::origin(), moments };
    scene.body(body("body", Motion::Free(inertia)));
    let mut world = world(&scene, 1e-4);
    let body = &mut world.bodies[0];
    (body.velocity, body.momentum) = (velocity, body.mass() * velocity);
    world
}

#[test]
fn a_free_body_keeps_its_momentum_and_gains_no_energy() {
    let start = Vector6::new(0.1, 0.2, 0.3, 5.0, 0.5, 3.0);
    let mut world = flying(start);
    let energy = |body: &MovingBody| 0.5 * body.velocity.dot(&(body.mass() * body.velocity));
    let spin = |body: &MovingBody| body.momentum.fixed_rows::<3>(3).into_owned();
    let first = world.bodies[0].clone();
    run(&mut world, 1.0);
    let last = &world.bodies[0];
    assert!((spin(last) - spin(&first)).norm() < 1e-12 * spin(&first).norm());
    assert!((energy(last) / energy(&first) - 1.0).abs() < 2e-3);
    assert!((last.velocity - start).rows(0, 3).norm() < 1e-14);
}

#[test]
fn a_state_that_is_not_finite_is_reported() {
    assert!(flying(Vector6::new(f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0)).step().is_err());
}
