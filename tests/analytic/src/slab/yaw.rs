//! P11: yaw at which a box touches the walls of its hole, with sharp and with rounded edges.

use crate::build::{self, Measured};
use crate::{CheckRow, Tolerance};
use contact::Engine;
use contact::scene::{Body, Friction, Geom, Motion, Pose, Scene, Shape, Spring};
use input::units::{GRAM, MM};
use nalgebra::{Point3, UnitQuaternion, Vector3};

/// Sizes of box and hole, m.
const BOX: [f64; 2] = [8.0 * MM, 7.0 * MM];
const HOLE: [f64; 2] = [8.05 * MM, 7.05 * MM];
/// Height of the box, and size of a wall, m.
const HEIGHT: f64 = 20.0 * MM;
const WALL: f64 = 40.0 * MM;
/// Mass of the box, kg, and its lateral springs, N/m; that of the yaw, N m/rad; damping ratio.
const MASS: f64 = 20.0 * GRAM;
const LATERAL: f64 = 2e3;
const ANGULAR: f64 = 2.0;
const DAMPING: f64 = 0.1;
/// Rate of the drive, rad/s, and yaw at which it ends, rad.
const RATE: f64 = 0.02;
const LAST: f64 = 0.02;
/// Force that counts as a contact, N.
const TOUCHES: f64 = 0.01;

/// Returns the least yaw, rad, at which a box of sizes `a` and `b` with edges of a radius touches a hole of
/// sizes `A` and `B`: `(a - 2 rho) cos y + (b - 2 rho) sin y + 2 rho = A`, or the same across.
pub fn yaw(size: [f64; 2], hole: [f64; 2], radius: f64) -> f64 {
    let [a, b] = size.map(|side| side - 2.0 * radius);
    let excess = |y: f64| {
        let (sin, cos) = libm::sincos(y);
        let [along, across] = [a * cos + b * sin, b * cos + a * sin];
        (along + 2.0 * radius - hole[0]).max(across + 2.0 * radius - hole[1])
    };
    let (mut low, mut high) = (0.0, 0.2);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if excess(middle) < 0.0 { low = middle } else { high = middle }
    }
    low
}

fn geom(name: &str, shape: Shape, pose: Pose) -> Geom {
    Geom { name: name.into(), shape, pose, friction: None }
}

fn walls() -> Vec<Geom> {
    let wall = |axis: usize, side: f64| {
        let middle = Vector3::ith(axis, side * (HOLE[axis] / 2.0 + WALL / 2.0));
        let shape = Shape::Box { half: Vector3::repeat(WALL / 2.0) };
        geom(
            &format!("wall {axis} {side}"),
            shape,
            Pose::from_parts(middle.into(), UnitQuaternion::identity()),
        )
    };
    vec![wall(0, -1.0), wall(0, 1.0), wall(1, -1.0), wall(1, 1.0)]
}

/// Turns the box until it touches, and returns its yaw, rad.
fn measured(engine: &dyn Engine, radius: f64) -> Measured {
    let half = Vector3::new(BOX[0], BOX[1], HEIGHT) / 2.0;
    let core = half.map(|half| half - radius);
    let shape = if radius > 0.0 { Shape::RoundBox { core, radius } } else { Shape::Box { half } };
    let mut scene = Scene::default();
    let flange = scene.body(build::driven("flange", Pose::identity(), Vec::new()));
    let inertia = build::box_inertia(MASS, 2.0 * half, Point3::origin());
    let peg = scene.body(Body {
        name: "box".into(),
        motion: Motion::Carried(inertia),
        pose: Pose::identity(),
        geoms: vec![geom("box", shape, Pose::identity())],
    });
    let spring = |stiffness: f64, mass: f64| {
        Some(Spring::new(stiffness, 2.0 * DAMPING * (stiffness * mass).sqrt()))
    };
    let [side, turn] = [spring(LATERAL, MASS), spring(ANGULAR, inertia.moments.z)];
    build::joint(
        &mut scene,
        "springs",
        [flange, peg],
        [Pose::identity(); 2],
        [side, side, side, None, None, turn],
    );
    let hole = scene.body(build::fixed("hole", Pose::identity(), walls()));
    scene.contact(hole, peg, Friction::hard(0.0));
    let mut world = engine.world(&scene);
    let steps = build::steps(world.as_ref(), LAST / RATE);
    for i in 1..=steps {
        let angle = RATE * world.step_s() * i as f64;
        let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        world.drive(flange, Pose::from_parts(Vector3::zeros().into(), turned));
        world.step()?;
        if world.contact(hole, peg).normal_sum > TOUCHES {
            return Ok(world.pose(peg).rotation.scaled_axis().z);
        }
    }
    Ok(f64::NAN)
}

/// Returns the rows P11.
pub fn turned(engine: &dyn Engine) -> Vec<CheckRow> {
    let row = |rho: f64| {
        let expected = yaw(BOX, HOLE, rho * MM) / 1e-3;
        let found = measured(engine, rho * MM).map(|yaw| yaw / 1e-3);
        let text = format!("yaw of 8 x 7 mm in 8.05 x 7.05 mm, rho {rho} mm");
        CheckRow::new("P11", text, expected, found, "mrad", Tolerance::Relative(0.01))
    };
    [0.0, 0.3].map(row).to_vec()
}
