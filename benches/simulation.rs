//! Time of what is simulated: `cargo bench --bench simulation`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use connector::mating::mates;
use connector::mesh::mated::{self, Pair};
use contact::direct::Direct;
use contact::scene::{Body, Friction, Geom, Inertia, Motion, Pose, Scene, Shape};
use contact::{Engine, World};
use divan::{Bencher, black_box};
use finray::geometry::Geometry;
use finray::infill::InfillDesign;
use finray::mechanics;
use finray::printed::PrintedFinger;
use input::shipped::{FINGERS, ROBOTS, Shipped, TASKS};
use input::units::{MM, N_PER_MM};
use insertion::evaluation::tolerance::{self, Search};
use insertion::finger::Finger;
use insertion::robot::Robot;
use insertion::task::Task;
use insertion::trial::engine::EngineKind;
use insertion::trial::{Grasp, Rig};
use nalgebra::{Point3, Vector3};
use std::sync::atomic::AtomicBool;

fn main() {
    divan::main();
}

const TASK_NAMES: [&str; 4] = ["usb", "ket8", "ket12", "rj45"];

fn shipped<'a>(files: &'a [Shipped], name: &str) -> &'a Shipped {
    files.iter().find(|file| file.name == name).expect("it is shipped")
}

fn task(name: &str) -> Task {
    let file = shipped(TASKS, name);
    Task::parse(file.text, file.file).expect("a task")
}

/// The finger of measured design 5 on a task, with the robot `servo`.
fn rig(task: &Task, engine: EngineKind) -> (Box<dyn Rig>, Finger) {
    let robot = shipped(ROBOTS, "servo");
    let robot = Robot::parse(robot.text, robot.file).expect("a robot");
    let finger = Finger::new(2.6 * N_PER_MM, 45.0 * N_PER_MM).with_model(&task.finger, 0.0);
    (engine.rig(task, &robot, &finger, 1.0).expect("the engine has it all"), finger)
}

fn trial(bencher: Bencher, task: &Task, engine: EngineKind) {
    let (rig, finger) = rig(task, engine);
    bencher.bench(|| rig.grasp(Grasp::of(black_box(&finger))).trial(0.0));
}

#[divan::bench(args = TASK_NAMES, sample_count = 10, sample_size = 1)]
fn trial_direct(bencher: Bencher, name: &str) {
    trial(bencher, &task(name), EngineKind::Direct);
}

#[divan::bench(args = TASK_NAMES, sample_count = 3, sample_size = 1)]
fn trial_rapier(bencher: Bencher, name: &str) {
    trial(bencher, &task(name), EngineKind::Rapier);
}

#[divan::bench(args = TASK_NAMES, sample_count = 5, sample_size = 1)]
fn evaluation(bencher: Bencher, name: &str) {
    let (rig, finger) = rig(&task(name), EngineKind::Direct);
    bencher.bench(|| tolerance::evaluate(&*rig, black_box(&finger), Search::default()));
}

fn cuboid(name: &str, size_mm: [f64; 3], middle_mm: [f64; 3]) -> Geom {
    let [x, y, z] = middle_mm.map(|mm| mm * MM);
    let half = Vector3::from(size_mm) * (MM / 2.0);
    let pose = Pose::translation(x, y, z);
    Geom { name: name.into(), shape: Shape::Box { half }, pose, friction: None }
}

/// A plug of 20 g, 8 mm wide, its edges sharp or round, in a bore with this gap on all sides, and that
/// above its floor.
fn plug_in_bore(gap_mm: f64, floor_mm: f64, gravity: f64, radius_mm: f64) -> Box<dyn World> {
    let middle = 4.0 + gap_mm + 5.0;
    let walls = [
        cuboid("wall -x", [10.0, 40.0, 20.0], [-middle, 0.0, 10.0]),
        cuboid("wall +x", [10.0, 40.0, 20.0], [middle, 0.0, 10.0]),
        cuboid("wall -y", [40.0, 10.0, 20.0], [0.0, -middle, 10.0]),
        cuboid("wall +y", [40.0, 10.0, 20.0], [0.0, middle, 10.0]),
        cuboid("floor", [40.0, 40.0, 10.0], [0.0, 0.0, -5.0]),
    ];
    let mut body = cuboid("plug", [8.0, 8.0, 15.0], [0.0; 3]);
    if radius_mm > 0.0 {
        let half = Vector3::new(4.0, 4.0, 7.5);
        let core = half.map(|half| (half - radius_mm) * MM);
        body.shape = Shape::RoundBox { core, radius: radius_mm * MM };
    }
    let inertia = Inertia { mass: 0.02, centre: Point3::origin(), moments: Vector3::repeat(4e-7) };
    let mut scene = Scene { gravity: Vector3::new(0.0, 0.0, -gravity), ..Scene::default() };
    let socket = scene.body(Body {
        name: "socket".into(),
        motion: Motion::Fixed,
        pose: Pose::identity(),
        geoms: walls.into(),
    });
    let plug = scene.body(Body {
        name: "plug".into(),
        motion: Motion::Free(inertia),
        pose: Pose::translation(0.0, 0.0, (7.5 + floor_mm) * MM),
        geoms: vec![body],
    });
    scene.contact(socket, plug, Friction::hard(0.2));
    Direct::default().world(&scene)
}

/// Ten steps from the same state: the carried contact points are not yet known in the first.
fn ten_steps(bencher: Bencher, world: &dyn World) {
    bencher.with_inputs(|| world.snapshot()).bench_local_values(|mut world| {
        (0..10).for_each(|_| world.step().expect("it is finite"));
        world
    });
}

/// So near its walls and floor that contacts are foreseen, and pressed by nothing; by its radius, mm.
#[divan::bench(args = [0.0, 0.3], sample_count = 100, sample_size = 10)]
fn contact_detection_10_steps(bencher: Bencher, radius_mm: f64) {
    ten_steps(bencher, &*plug_in_bore(0.1, 0.1, 0.0, radius_mm));
}

/// Standing on the floor between walls that it touches.
#[divan::bench(sample_count = 100, sample_size = 10)]
fn solver_10_steps(bencher: Bencher) {
    ten_steps(bencher, &*plug_in_bore(0.0, 0.0, 9.81, 0.0));
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn stiffness_of_a_printed_finger(bencher: Bencher) {
    let finger = PrintedFinger::parse(FINGERS[0].text, FINGERS[0].file).expect("a finger");
    let design = InfillDesign { density_percent: 20.0, direction_deg: 10.0, phase_mm: None };
    bencher.bench(|| {
        let geometry = Geometry::new(black_box(&finger), &design).expect("it fits");
        mechanics::compute(&geometry).expect("a stiffness")
    });
}

/// Triangles between squares about z, of half width and height in mm, counter-clockwise.
fn squares(outline: &[[f64; 2]]) -> Vec<[Point3<f64>; 3]> {
    let corners = [[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]];
    let at = |[half, z]: [f64; 2], corner: usize| {
        let [x, y] = corners[corner % 4];
        Point3::new(half * x, half * y, z)
    };
    let side = |(i, corner): (usize, usize)| {
        let (low, high) = (outline[i], outline[(i + 1) % outline.len()]);
        let [a, b] = [at(low, corner), at(low, corner + 1)];
        let [c, d] = [at(high, corner), at(high, corner + 1)];
        [[a, b, d], [a, d, c]]
    };
    let sides = (0..outline.len()).flat_map(|i| (0..4).map(move |corner| (i, corner)));
    sides.flat_map(side).collect()
}

/// A square plug and the chamfered hole that it goes into.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn mated_pose(bencher: Bencher) {
    let plug = [[0.0, 0.0], [3.9, 0.0], [3.9, 10.0], [6.0, 10.0], [6.0, 25.0], [0.0, 25.0]];
    let socket = [
        [0.0, -12.0],
        [9.0, -12.0],
        [9.0, 0.0],
        [4.8, 0.0],
        [4.0, -0.8],
        [4.0, -10.0],
        [0.0, -10.0],
    ];
    let metres = |outline: &[[f64; 2]]| -> Vec<_> {
        squares(outline).into_iter().map(|face| face.map(|p| p * MM)).collect()
    };
    let (plug, socket) = (metres(&plug), metres(&socket));
    let stop = AtomicBool::new(false);
    bencher.bench_local(|| mates(&plug, &socket, &stop).expect("a mated pose"));
}

/// Corners of a rectangle with round corners, mm, counter-clockwise.
fn rounded([x, y]: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    const EACH: u32 = 12;
    let corner = |quarter: u32, i: u32| {
        let angle = f64::from(quarter * EACH + i) * std::f64::consts::FRAC_PI_2 / f64::from(EACH);
        let middle = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]][quarter as usize];
        [
            middle[0] * (x / 2.0 - radius) + radius * libm::cos(angle),
            middle[1] * (y / 2.0 - radius) + radius * libm::sin(angle),
        ]
    };
    (0..4).flat_map(|quarter| (0..=EACH).map(move |i| corner(quarter, i))).collect()
}

/// Triangles, m, between outlines at heights, mm; the first and the last are closed.
fn between(outlines: &[(&[[f64; 2]], f64)]) -> Vec<[Point3<f64>; 3]> {
    let point = |[x, y]: [f64; 2], z: f64| Point3::new(x, y, z) * MM;
    let mut faces = Vec::new();
    for pair in outlines.windows(2) {
        let [(low, z), (high, top)] = [pair[0], pair[1]];
        for i in 0..low.len() {
            let j = (i + 1) % low.len();
            let [a, b] = [point(low[i], z), point(low[j], z)];
            let [c, d] = [point(high[i], top), point(high[j], top)];
            faces.extend([[a, b, d], [a, d, c]]);
        }
    }
    for ((outline, z), turned) in [(outlines[0], true), (outlines[outlines.len() - 1], false)] {
        for i in 1..outline.len() - 1 {
            let [a, b, c] = [0, i, i + 1].map(|i| point(outline[i], z));
            faces.push(if turned { [a, c, b] } else { [a, b, c] });
        }
    }
    faces
}

/// A stamped shell of the size of USB-C about its tongue, with faces of 0.2 mm at its corners.
fn shell() -> Task {
    let [outer, inner] = [rounded([8.25, 2.4], 1.15), rounded([7.65, 1.8], 0.85)];
    let [cavity, tongue] = [rounded([8.35, 2.5], 1.2), rounded([6.7, 0.7], 0.3)];
    let [handle, block] = [rounded([12.0, 10.0], 1.0), rounded([16.0, 10.0], 1.0)];
    let plug = between(&[
        (&inner, 0.2),
        (&inner, -6.2),
        (&outer, -6.2),
        (&outer, 0.5),
        (&handle, 0.5),
        (&handle, 20.5),
    ]);
    let socket = between(&[
        (&block, -9.0),
        (&block, 0.0),
        (&cavity, 0.0),
        (&cavity, -6.5),
        (&tongue, -6.5),
        (&tongue, -0.6),
    ]);
    let pair = Pair {
        plug: &plug,
        socket: &socket,
        drawn: [&plug, &socket],
        out: Vector3::z(),
        jaws: &[Vector3::y()],
        depth: 6.2 * MM,
        nose: 0.0,
        play: [0, 1].map(|axis| (Vector3::ith(axis, 1.0), 0.1 * MM)),
    };
    let made = mated::task(&pair, "shell", None, None);
    assert_eq!(made.difference, None);
    made.task
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn import_of_a_shell(bencher: Bencher) {
    bencher.bench(shell);
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn trial_of_a_shell(bencher: Bencher) {
    let task = shell();
    trial(bencher, &task, EngineKind::Direct);
}
