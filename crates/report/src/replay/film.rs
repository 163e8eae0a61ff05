//! A film as JSON for the page: mm, s, N.

use super::Film;
use contact::ContactPoint;
use contact::scene::{Geom, Pose};
use contact::shapes::surface;
use input::units::MM;
use insertion::outcome::Outcome;
use insertion::trial::record::Frame;
use serde_json::{Value, json};

/// Time between two frames of a page, s, unless there would be too many.
const INTERVAL: f64 = 6e-3;
const MOST: f64 = 500.0;
/// Height of the jaws above the grasp point, mm: for the eye.
const JAW_MM: f64 = 45.0;

/// The bodies of a film: kind, whose pose they have, shapes.
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

pub(super) fn to_json(film: &Film) -> Value {
    let trial = &film.recording.trial;
    let every = INTERVAL.max(trial.simulated_s / MOST);
    let frames = thinned(&film.recording.frames, every);
    let each = |of: &dyn Fn(&Frame) -> f64, digits| -> Vec<f64> {
        frames.iter().map(|frame| round(of(frame), digits)).collect()
    };
    let poses = |of: &dyn Fn(&Frame) -> Pose| -> Vec<f64> {
        frames.iter().flat_map(|frame| pose(&of(frame))).collect()
    };
    let points = |of: &dyn Fn(&Frame) -> &[ContactPoint]| -> Vec<Vec<f64>> {
        frames.iter().map(|frame| of(frame).iter().flat_map(contact).collect()).collect()
    };
    let phases: Vec<_> = trial.phases.iter().map(|p| (&p.name, round(p.time_s, 4))).collect();
    let outcome = match trial.outcome {
        Outcome::Failed(class) => format!("failed: {} (class {})", class.label(), class.number()),
        outcome => outcome.word().to_owned(),
    };
    let mut page = json!({
        "label": film.label,
        "outcome": outcome,
        "kind": trial.outcome.word(),
        // Rounded as the times are, so that the last frame has its outcome.
        "decided_s": round(film.recording.decided_s, 4),
        "phases": phases,
        "bodies": bodies(film).iter().flat_map(shapes).collect::<Vec<_>>(),
        "beam": beam(film),
        "time": each(&|frame| frame.time_s, 4),
        "pose": {
            "plug": poses(&|frame| frame.poses.plug),
            "finger0": poses(&|frame| frame.poses.fingers[0]),
            "finger1": poses(&|frame| frame.poses.fingers[1]),
            "jaw0": poses(&|frame| frame.jaws[0]),
            "jaw1": poses(&|frame| frame.jaws[1]),
        },
        "force": each(&|frame| frame.force.norm(), 2),
        "depth": each(&|frame| frame.depth_mm(), 3),
        "tilt": each(&|frame| frame.tilt_deg(), 3),
        "slip": each(&|frame| frame.slip / MM, 3),
        "contact": points(&|frame| &frame.contacts),
        "grip": points(&|frame| &frame.grips),
    });
    if film.task.plug.latch.is_some() {
        page["pose"]["latch"] = json!(poses(&Frame::latch));
    }
    page
}

/// The finger between the roof of its tip and its jaw, mm, about its frame.
fn beam(film: &Film) -> Value {
    let top = |corner: nalgebra::Point3<f64>| corner.coords / MM;
    let geoms = film.pad.geoms(film.task.grip.shoulder(), 1.0);
    let corners =
        geoms.iter().flat_map(|geom| geom.shape.corners().into_iter().map(|p| top(geom.pose * p)));
    let high = corners.fold(nalgebra::Vector3::repeat(f64::NEG_INFINITY), |high, p| high.sup(&p));
    let shoulder = film.task.grip.shoulder() / MM;
    json!({"half_mm": high.x, "thick_mm": high.y, "low_mm": high.z, "high_mm": shoulder + JAW_MM})
}

/// Frames at least so many seconds apart, and the last.
pub(super) fn thinned(frames: &[Frame], every: f64) -> Vec<&Frame> {
    let mut kept: Vec<&Frame> = Vec::new();
    for (i, frame) in frames.iter().enumerate() {
        // Half a microsecond for the noise of adding up steps.
        let due = kept.last().is_none_or(|last| frame.time_s - last.time_s > every - 5e-7);
        if due || i + 1 == frames.len() {
            kept.push(frame);
        }
    }
    kept
}

fn shapes((kind, of, geoms): &(&str, &str, Vec<Geom>)) -> Vec<Value> {
    let one = |geom: &Geom| {
        let (points, triangles) = surface(&geom.shape);
        let points: Vec<f64> = points
            .iter()
            .flat_map(|p| <[f64; 3]>::from((geom.pose * p).coords / MM))
            .map(|mm| round(mm, 4))
            .collect();
        let triangles: Vec<u32> = triangles.into_iter().flatten().collect();
        json!({"kind": kind, "of": of, "points": points, "triangles": triangles})
    };
    geoms.iter().map(one).collect()
}

/// Position, mm, and quaternion x, y, z, w.
fn pose(pose: &Pose) -> [f64; 7] {
    let (p, q) = (pose.translation.vector / MM, pose.rotation.coords);
    let [x, y, z] = [p.x, p.y, p.z].map(|mm| round(mm, 3));
    let [i, j, k, w] = [q.x, q.y, q.z, q.w].map(|value| round(value, 5));
    [x, y, z, i, j, k, w]
}

/// Point, mm, and force, N.
fn contact(contact: &ContactPoint) -> [f64; 6] {
    let (p, f) = (contact.point.coords / MM, contact.force);
    [round(p.x, 2), round(p.y, 2), round(p.z, 2), round(f.x, 1), round(f.y, 1), round(f.z, 1)]
}

fn round(value: f64, digits: i32) -> f64 {
    let scale = 10f64.powi(digits);
    // Adding 0 turns -0 into 0.
    (value * scale).round() / scale + 0.0
}
