//! Data of a film for the page.

use super::Film;
use contact::ContactPoint;
use contact::scene::{Geom, Pose};
use contact::shapes::surface;
use input::units::MM;
use insertion::outcome::Outcome;
use insertion::trial::record::Frame;
use serde::Serialize;

/// Time between two frames of a page, s.
const INTERVAL: f64 = 6e-3;
/// Largest number of frames.
const MOST: f64 = 500.0;
/// Drawn height of the jaws above the grasp point, mm.
const JAW_MM: f64 = 45.0;

/// Returns the bodies of a film: kind, key of their pose, shapes.
pub(super) fn bodies(film: &Film) -> Vec<(&'static str, &'static str, Vec<Geom>)> {
    let task = film.task;
    let tip = |side| film.pad.geoms(film.task.grip.shoulder(), side);
    let mut bodies = vec![
        ("socket", "socket", task.socket.iter().map(|part| part.geom()).collect()),
        ("plug", "plug", task.plug.rigid().map(|part| part.geom()).collect()),
        ("finger", "finger0", tip(-1.0)),
        ("finger", "finger1", tip(1.0)),
    ];
    let sprung: Vec<Geom> = task.plug.sprung().map(|part| part.geom()).collect();
    if !sprung.is_empty() {
        bodies.push(("plug", "latch", sprung));
    }
    bodies
}

/// Data of a film: mm, s, N, degrees.
#[derive(Serialize)]
pub(super) struct Data<'a> {
    label: &'a str,
    outcome: String,
    kind: &'a str,
    decided_s: f64,
    phases: Vec<(&'a str, f64)>,
    bodies: Vec<Surface>,
    beam: Beam,
    time: Vec<f64>,
    pose: Poses,
    force: Vec<f64>,
    depth: Vec<f64>,
    tilt: Vec<f64>,
    slip: Vec<f64>,
    contact: Vec<Vec<f64>>,
    grip: Vec<Vec<f64>>,
}

/// Triangles of a shape of a body.
#[derive(Serialize)]
struct Surface {
    kind: &'static str,
    of: &'static str,
    points: Vec<f64>,
    triangles: Vec<u32>,
}

/// Poses of the bodies, frame by frame.
#[derive(Serialize)]
struct Poses {
    plug: Vec<f64>,
    finger0: Vec<f64>,
    finger1: Vec<f64>,
    jaw0: Vec<f64>,
    jaw1: Vec<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    latch: Option<Vec<f64>>,
}

/// The finger between the roof of its tip and its jaw, about its frame.
#[derive(Serialize)]
struct Beam {
    half_mm: f64,
    thick_mm: f64,
    low_mm: f64,
    high_mm: f64,
}

impl<'a> Data<'a> {
    pub(super) fn new(film: &Film<'a>) -> Self {
        let recording = film.recording;
        let trial = &recording.trial;
        let frames = thinned(&recording.frames, INTERVAL.max(trial.simulated_s / MOST));
        let each = |of: &dyn Fn(&Frame) -> f64, digits| -> Vec<f64> {
            frames.iter().map(|frame| round(of(frame), digits)).collect()
        };
        let poses = |of: &dyn Fn(&Frame) -> Pose| -> Vec<f64> {
            frames.iter().flat_map(|frame| pose(&of(frame))).collect()
        };
        let points = |of: &dyn Fn(&Frame) -> &[ContactPoint]| -> Vec<Vec<f64>> {
            frames.iter().map(|frame| of(frame).iter().flat_map(contact).collect()).collect()
        };
        Data {
            label: film.label,
            outcome: match trial.outcome {
                Outcome::Failed(class) => {
                    format!("failed: {} (class {})", class.label(), class.number())
                }
                outcome => outcome.word().to_owned(),
            },
            kind: trial.outcome.word(),
            // Rounded like the times, so that the last frame has its outcome.
            decided_s: round(recording.decided_s, 4),
            phases: trial.phases.iter().map(|p| (&*p.name, round(p.time_s, 4))).collect(),
            bodies: bodies(film).into_iter().flat_map(surfaces).collect(),
            beam: beam(film),
            time: each(&|frame| frame.time_s, 4),
            pose: Poses {
                plug: poses(&|frame| frame.poses.plug),
                finger0: poses(&|frame| frame.poses.fingers[0]),
                finger1: poses(&|frame| frame.poses.fingers[1]),
                jaw0: poses(&|frame| frame.jaws[0]),
                jaw1: poses(&|frame| frame.jaws[1]),
                latch: film.task.plug.latch.is_some().then(|| poses(&Frame::latch)),
            },
            force: each(&|frame| frame.force.norm(), 2),
            depth: each(&|frame| frame.depth_mm(), 3),
            tilt: each(&|frame| frame.tilt_deg(), 3),
            slip: each(&|frame| frame.slip / MM, 3),
            contact: points(&|frame| &frame.contacts),
            grip: points(&|frame| &frame.grips),
        }
    }
}

fn beam(film: &Film) -> Beam {
    let geoms = film.pad.geoms(film.task.grip.shoulder(), 1.0);
    let corners = geoms
        .iter()
        .flat_map(|geom| geom.shape.corners().into_iter().map(|p| (geom.pose * p).coords / MM));
    let high = corners.fold(nalgebra::Vector3::repeat(f64::NEG_INFINITY), |high, p| high.sup(&p));
    let high_mm = film.task.grip.shoulder() / MM + JAW_MM;
    Beam { half_mm: high.x, thick_mm: high.y, low_mm: high.z, high_mm }
}

/// Returns frames at least `every` seconds apart, and the last.
pub(super) fn thinned(frames: &[Frame], every: f64) -> Vec<&Frame> {
    let mut kept: Vec<&Frame> = Vec::new();
    for (i, frame) in frames.iter().enumerate() {
        // Tolerance for the rounding of summed steps.
        let due = kept.last().is_none_or(|last| frame.time_s - last.time_s > every - 5e-7);
        if due || i + 1 == frames.len() {
            kept.push(frame);
        }
    }
    kept
}

fn surfaces(
    (kind, of, geoms): (&'static str, &'static str, Vec<Geom>),
) -> impl Iterator<Item = Surface> {
    geoms.into_iter().map(move |geom| {
        let (points, triangles) = surface(&geom.shape);
        let points = points.iter().flat_map(|p| <[f64; 3]>::from((geom.pose * p).coords / MM));
        let points = points.map(|mm| round(mm, 4)).collect();
        Surface { kind, of, points, triangles: triangles.into_iter().flatten().collect() }
    })
}

/// Returns position, mm, and quaternion x, y, z, w.
fn pose(pose: &Pose) -> [f64; 7] {
    let (p, q) = (pose.translation.vector / MM, pose.rotation.coords);
    let [x, y, z] = [p.x, p.y, p.z].map(|mm| round(mm, 3));
    let [i, j, k, w] = [q.x, q.y, q.z, q.w].map(|value| round(value, 5));
    [x, y, z, i, j, k, w]
}

/// Returns point, mm, and force, N.
fn contact(contact: &ContactPoint) -> [f64; 6] {
    let (p, f) = (contact.point.coords / MM, contact.force);
    [round(p.x, 2), round(p.y, 2), round(p.z, 2), round(f.x, 1), round(f.y, 1), round(f.z, 1)]
}

fn round(value: f64, digits: i32) -> f64 {
    let scale = 10f64.powi(digits);
    // Adding 0 turns -0 into 0.
    (value * scale).round() / scale + 0.0
}
