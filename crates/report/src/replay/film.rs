//! Data of a film (recorded trial) for the page that plays it.

use super::Film;
use crate::answer::words::rounded;
use contact::scene::{Geom, Pose};
use contact::{ContactPoint, shapes};
use input::units::MM;
use insertion::Part;
use insertion::outcome::stop_words;
use insertion::task::{Plug, Solid};
use insertion::trial::record::Frame;
use nalgebra::Vector3;
use serde_json::{Value, json};

/// Smallest time between two frames of the page, s.
const INTERVAL: f64 = 6e-3;
/// Approximate largest number of frames of a film on the page.
const MAX_FRAMES: f64 = 500.0;
/// Height at which the jaws are drawn above the shoulder of the part, mm.
const JAW_MM: f64 = 45.0;
/// Smallest gap along z between parts of a plug that is closed in the drawing, m.
const GAP: f64 = 0.1 * MM;

/// Returns kind, key of the poses and shapes of each body; the socket does not move, finger 0 is at -y.
fn bodies(film: &Film) -> [(&'static str, &'static str, Vec<Geom>); 8] {
    let task = film.task;
    let drawn = |body: usize| task.left_out[body].iter().map(|part| part.geom()).collect();
    let tip = |side| film.pad.geoms(film.task.grip.shoulder(), side);
    [
        ("socket", "socket", task.socket.iter().map(|part| part.geom()).collect()),
        ("plug", "plug", task.plug.rigid().map(|part| part.geom()).collect()),
        ("link", "plug", links(&task.plug)),
        ("finger", "finger0", tip(-1.0)),
        ("finger", "finger1", tip(1.0)),
        ("spring", "plug", drawn(0)),
        ("spring", "socket", drawn(1)),
        ("plug", "latch", task.plug.latch_parts().map(|part| part.geom()).collect()),
    ]
}

/// Returns boxes that fill the gaps along z between the parts of a plug: an imported plug has no parts where the socket
/// cannot touch it.
fn links(plug: &Plug) -> Vec<Geom> {
    type Bounds = [Vector3<f64>; 2];
    let join = |[a, b]: Bounds, [c, d]: Bounds| [a.inf(&c), b.sup(&d)];
    let bounds = |part: &Part| part.solid.corners().iter().map(|p| [p.coords; 2]).reduce(join);
    let mut parts: Vec<Bounds> = plug.rigid().filter_map(bounds).collect();
    parts.sort_by(|[a, _], [b, _]| a.z.total_cmp(&b.z));
    let link = |at: usize| {
        let [a, b] = parts[..at].iter().copied().reduce(join)?;
        let [c, d] = parts[at..].iter().copied().reduce(join)?;
        // The intersection of both in x and y, and the gap between them along z.
        let (low, high) = (a.sup(&c), b.inf(&d));
        let (min, max) = (low.xy().push(high.z), high.xy().push(low.z));
        let part = Part { name: String::new(), solid: Solid::Box { min, max }, friction: None };
        (max - min).iter().all(|size| *size > GAP).then(|| part.geom())
    };
    (1..parts.len()).filter_map(link).collect()
}

/// Returns the data of a film in mm, s, N and degrees.
pub(super) fn data(film: &Film) -> Value {
    let recording = film.recording;
    let trial = &recording.trial;
    let frames = thinned(&recording.frames, INTERVAL.max(trial.simulated_s / MAX_FRAMES));
    let each = |of: &dyn Fn(&Frame) -> f64, digits| -> Vec<f64> {
        frames.iter().map(|frame| rounded(of(frame), digits)).collect()
    };
    let poses = |of: &dyn Fn(&Frame) -> Pose| -> Vec<f64> {
        frames.iter().flat_map(|frame| pose(&of(frame))).collect()
    };
    let points = |of: &dyn Fn(&Frame) -> &[ContactPoint]| -> Vec<Vec<f64>> {
        frames.iter().map(|frame| of(frame).iter().flat_map(contact).collect()).collect()
    };
    let phases = trial.phases.iter().map(|p| (&*p.name, rounded(p.time_s, 4)));
    let mut trajectories = json!({
        "plug": poses(&|frame| frame.poses.plug),
        "finger0": poses(&|frame| frame.poses.fingers[0]),
        "finger1": poses(&|frame| frame.poses.fingers[1]),
        "jaw0": poses(&|frame| frame.jaws[0]),
        "jaw1": poses(&|frame| frame.jaws[1]),
    });
    if film.task.plug.latch.is_some() {
        trajectories["latch"] =
            json!(poses(&|frame| frame.poses.latch.unwrap_or(frame.poses.plug)));
    }
    json!({
        "label": film.label,
        "outcome": trial.outcome.to_string() + stop_words(trial.robot_stopped),
        "kind": trial.outcome.word(),
        // Rounded like the times of the frames, so that it is not after the last one.
        "decided_s": rounded(recording.decided_s, 4),
        "phases": phases.collect::<Vec<_>>(),
        "bodies": bodies(film).into_iter().flat_map(surfaces).collect::<Value>(),
        "beam": beam(film),
        "time": each(&|frame| frame.time_s, 4),
        "pose": trajectories,
        "force": each(&|frame| frame.force.norm(), 2),
        "depth": each(&|frame| frame.depth_mm(), 3),
        "tilt": each(&|frame| frame.tilt_deg(), 3),
        "slip": each(&|frame| frame.slip / MM, 3),
        "contact": points(&|frame| &frame.contacts),
        "grip": points(&|frame| &frame.grips),
    })
}

/// Returns the box that is drawn as the finger from the roof above its pad to its jaw, in the frame of the finger: half
/// width along x, thickness along y, and lower and upper end along z, mm.
fn beam(film: &Film) -> Value {
    let geoms = film.pad.geoms(film.task.grip.shoulder(), 1.0);
    let corners = geoms
        .iter()
        .flat_map(|geom| geom.shape.corners().into_iter().map(|p| (geom.pose * p).coords / MM));
    let high = corners.fold(nalgebra::Vector3::repeat(f64::NEG_INFINITY), |high, p| high.sup(&p));
    let high_mm = film.task.grip.shoulder() / MM + JAW_MM;
    json!({"half_mm": high.x, "thick_mm": high.y, "low_mm": high.z, "high_mm": high_mm})
}

/// Returns frames at least `interval` seconds apart, and the last frame.
pub(super) fn thinned(frames: &[Frame], interval: f64) -> Vec<&Frame> {
    let mut kept: Vec<&Frame> = Vec::new();
    for (i, frame) in frames.iter().enumerate() {
        // Tolerance for the rounding of summed steps.
        let due = kept.last().is_none_or(|last| frame.time_s - last.time_s > interval - 5e-7);
        if due || i + 1 == frames.len() {
            kept.push(frame);
        }
    }
    kept
}

/// Returns the triangles of each shape of a body.
fn surfaces((kind, of, geoms): (&'static str, &'static str, Vec<Geom>)) -> Vec<Value> {
    let surface = |geom: &Geom| {
        let (points, triangles) = shapes::surface(&geom.shape);
        let points = points.iter().flat_map(|p| <[f64; 3]>::from((geom.pose * p).coords / MM));
        let points: Vec<f64> = points.map(|mm| rounded(mm, 4)).collect();
        json!({"kind": kind, "of": of, "points": points, "triangles": triangles.concat()})
    };
    geoms.iter().map(surface).collect()
}

/// Returns a pose as its position, mm, and its quaternion x, y, z, w.
fn pose(pose: &Pose) -> Vec<f64> {
    let (p, q) = (pose.translation.vector / MM, pose.rotation.coords);
    let turn = q.iter().map(|value| rounded(*value, 5));
    p.iter().map(|mm| rounded(*mm, 3)).chain(turn).collect()
}

/// Returns a contact as its point, mm, and its force, N.
fn contact(contact: &ContactPoint) -> Vec<f64> {
    let point = contact.point.coords / MM;
    let force = contact.force.iter().map(|newtons| rounded(*newtons, 1));
    point.iter().map(|mm| rounded(*mm, 2)).chain(force).collect()
}
