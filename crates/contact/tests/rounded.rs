//! Contacts of round edges: normals, the force needed to cross a round rim, the largest overlap that is crossed.
//!
//! A peg with an edge of radius `a` on a lateral spring `k` moves down beside a rim of radius `b`,
//! which it overlaps by `e`. With `s = a + b`, the line between the centres of the two arcs is first at the angle
//! `p0` to the horizontal, `cos p0 = (s - e)/s`. Later, at the angle `p`, the spring is deflected by
//! `s (cos p - cos p0)`, and the force on the peg is inclined to the line by the friction angle `f`:
//! `Fz = k s (cos p - cos p0) tan(p + f)`. If `p0 + f` is a right angle or more, the peg stays on the rim; the
//! limit is `e = s (1 - sin f)`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use contact::direct::Direct;
use contact::rapier::Rapier;
use contact::scene::{
    Body, BodyId, Friction, Geom, Inertia, Joint, Motion, Pose, Scene, Shape, Spring, Springs,
};
use contact::{Engine, World};
use nalgebra::{Point3, Vector3};

const MM: f64 = 1e-3;
const FRICTION: f64 = 0.2;
/// Lateral stiffness, N/m.
const LATERAL: f64 = 2600.0;
/// Radii of the peg's edge and of the rim, m.
const RADII: [f64; 2] = [0.3 * MM, 0.2 * MM];

fn body(name: &str, motion: Motion, pose: Pose, shapes: Vec<(Shape, Pose)>) -> Body {
    let geom = |(shape, pose)| Geom { name: name.into(), shape, pose, friction: None };
    Body { name: name.into(), motion, pose, geoms: shapes.into_iter().map(geom).collect() }
}

/// Returns a box with round edges, one side at x = 0, its upper or lower face at z = 0. `sides` are the signs of its
/// centre along x and z.
fn rounded(size: [f64; 3], radius: f64, sides: [f64; 2]) -> (Shape, Pose) {
    let half = Vector3::from(size) / 2.0;
    let pose = Pose::translation(sides[0] * half.x, 0.0, sides[1] * half.z);
    if radius == 0.0 {
        return (Shape::Box { half }, pose);
    }
    (Shape::RoundBox { core: half - Vector3::repeat(radius), radius }, pose)
}

fn free() -> Motion {
    let moments = Vector3::repeat(1e-6);
    Motion::Carried(Inertia { mass: 0.02, centre: Point3::origin(), moments })
}

/// Returns the direction of the contact force on a peg with a round edge that touches a rim of radius `rim` at an angle
/// to the horizontal, rad.
fn normal(engine: &dyn Engine, angle: f64, rim: f64) -> Vector3<f64> {
    let mut scene = Scene::default();
    let socket = rounded([8.0 * MM, 30.0 * MM, 6.0 * MM], rim, [-1.0, -1.0]);
    let socket = scene.body(body("socket", Motion::Fixed, Pose::identity(), vec![socket]));
    let radius = RADII[0];
    let apart = radius + rim - 2e-6;
    let [x, z] = [libm::cos(angle), libm::sin(angle)].map(|part| part * apart - rim - radius);
    let shape = rounded([7.0 * MM, 8.0 * MM, 9.0 * MM], radius, [1.0, 1.0]);
    let peg = scene.body(body("peg", free(), Pose::translation(x, 0.0, z), vec![shape]));
    scene.contact(socket, peg, Friction::hard(0.0));
    let mut world = engine.world(&scene);
    let inward = -Vector3::new(libm::cos(angle), 0.0, libm::sin(angle)) * 0.5;
    world.push(peg, inward, Vector3::zeros());
    // rapier reports no force in some first steps.
    for _ in 0..4 {
        world.step().expect("finite");
        if let Some(normal) = world.contact(socket, peg).net.try_normalize(0.0) {
            return normal;
        }
    }
    Vector3::zeros()
}

fn engines() -> Vec<Box<dyn Engine>> {
    vec![
        Box::new(Direct::default()),
        Box::new(Rapier::default()),
        #[cfg(feature = "mujoco")]
        Box::new(contact::mujoco::Mujoco::default()),
    ]
}

#[test]
fn the_normal_is_the_line_between_the_cores() {
    for engine in engines() {
        for rim in [0.0, RADII[1]] {
            for degrees in 10..=80 {
                let angle = f64::from(degrees).to_radians();
                let found = normal(&*engine, angle, rim);
                let off = (libm::atan2(found.z, found.x) - angle).to_degrees();
                assert!(off.abs() < 0.01, "{} {rim} {degrees}: {off}", engine.version());
                assert!(found.y.abs() < 1e-4, "{} {found}", engine.version());
            }
        }
    }
}

/// Peg on its spring over a rim.
struct Crossing {
    world: Box<dyn World>,
    time: f64,
}

const SOCKET: BodyId = BodyId(0);
const CARRIAGE: BodyId = BodyId(1);
const PEG: BodyId = BodyId(2);
/// Time constant of the low-pass filter of the force, s.
const SMOOTHING: f64 = 5e-3;
/// Speed of the carriage, m/s.
const SPEED: f64 = 0.5 * MM;

impl Crossing {
    /// Creates a crossing with an overlap, m, and a spring along z, N/m, locked if `None`.
    fn new(engine: &dyn Engine, overlap: f64, along: Option<f64>) -> Self {
        let mut scene = Scene::default();
        let fixed = rounded([8.0 * MM, 30.0 * MM, 6.0 * MM], RADII[1], [-1.0, -1.0]);
        scene.body(body("socket", Motion::Fixed, Pose::identity(), vec![fixed]));
        let start = Pose::translation(-overlap, 0.0, 1e-6);
        scene.body(body("carriage", Motion::Driven, start, Vec::new()));
        let shape = rounded([7.0 * MM, 8.0 * MM, 9.0 * MM], RADII[0], [1.0, 1.0]);
        scene.body(body("peg", free(), start, vec![shape]));
        let mut axes = [None; 6];
        axes[0] = Some(Spring::new(LATERAL, 1.0));
        axes[2] = along.map(|stiffness| Spring::new(stiffness, 20.0));
        scene.joint(Joint {
            name: "springs".into(),
            parent: CARRIAGE,
            child: PEG,
            in_parent: Pose::identity(),
            in_child: Pose::identity(),
            springs: Springs::Axes(axes),
        });
        scene.contact(SOCKET, PEG, Friction::hard(FRICTION));
        let mut crossing = Crossing { world: engine.world(&scene), time: 0.0 };
        crossing.world.drive(CARRIAGE, start);
        crossing
    }

    /// Takes a step; returns the force on the peg along z, N, and its lateral deflection, m.
    fn step(&mut self, overlap: f64) -> (f64, f64) {
        self.time += self.world.step_s();
        self.world.drive(CARRIAGE, Pose::translation(-overlap, 0.0, 1e-6 - SPEED * self.time));
        self.world.step().expect("finite");
        let force = self.world.contact(SOCKET, PEG).net.z;
        (force, self.world.pose(PEG).translation.x + overlap)
    }
}

#[test]
fn the_force_to_cross_a_round_rim_follows_the_formula() {
    let sum = RADII[0] + RADII[1];
    let friction = libm::atan(FRICTION);
    for engine in engines() {
        // rapier keeps the normal of a contact while its points slide.
        if engine.version().starts_with("rapier") {
            continue;
        }
        for overlap in [0.15 * MM, 0.3 * MM] {
            let mut crossing = Crossing::new(&*engine, overlap, None);
            let (mut peak, mut expected, mut mean) = (0.0f64, 0.0f64, 0.0);
            let share = crossing.world.step_s() / SMOOTHING;
            let first = libm::acos((sum - overlap) / sum);
            while crossing.time * SPEED < sum {
                let (force, _) = crossing.step(overlap);
                mean += (force - mean) * share;
                peak = peak.max(mean);
                let p =
                    libm::asin((1.0 - crossing.time * SPEED / sum).clamp(0.0, libm::sin(first)));
                let off = sum * (libm::cos(p) - libm::cos(first));
                expected = expected.max(LATERAL * off * libm::tan(p + friction));
            }
            let error = peak / expected - 1.0;
            assert!(error.abs() < 0.01, "{} {overlap}: {peak} of {expected} N", engine.version());
        }
    }
}

#[test]
fn a_peg_crosses_a_rim_up_to_the_limit_of_overlap() {
    let limit = (RADII[0] + RADII[1]) * (1.0 - libm::sin(libm::atan(FRICTION)));
    for engine in engines() {
        let slides = |overlap: f64| {
            let mut crossing = Crossing::new(&*engine, overlap, Some(45e3));
            while crossing.time * SPEED < 0.2 * MM {
                crossing.step(overlap);
            }
            crossing.step(overlap).1 > 10e-6
        };
        let (mut low, mut high) = (0.3 * MM, 0.5 * MM);
        for _ in 0..10 {
            let middle = (low + high) / 2.0;
            let end = if slides(middle) { &mut low } else { &mut high };
            *end = middle;
        }
        assert!((low - limit).abs() < 0.01 * MM, "{} {low} of {limit}", engine.version());
    }
}
