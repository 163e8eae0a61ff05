//! Task from the meshes of a plug and a socket whose mated pose is known: convex parts along their surfaces, grasp,
//! strategy and success criterion.

mod closeup;
pub mod gaps;
mod grip;
mod overlap;
mod reach;
pub mod verify;

use super::Triangle;
use super::skin::skin;
use super::surface::snap;
use crate::body::{clipped, extent, span, width};
use crate::draft::{self, Size};
use crate::plan;
use contact::scene::Pose;
pub use grip::{Grasp, Rejected, check_handle};
use input::units::MM;
use insertion::task::geometry;
use insertion::{Part, Solid, Task};
use nalgebra::{Matrix3, Point3, Vector3};
pub use overlap::{GAP, Interference};
use reach::Reach;
pub use verify::{Deviation, TOLERANCE};
use verify::{Drawn, worst};

/// Size of the handle that is added to a plug without faces to hold.
pub const HANDLE: Size = Size { width: 10.0 * MM, height: 12.0 * MM, length: 20.0 * MM };
/// Height of the tip of the plug, m; its axis goes through the middle of the tip.
const TIP: f64 = 1.0 * MM;
/// Smallest play assumed between plug and opening, m.
const MIN_PLAY: f64 = 0.02 * MM;

/// Meshes of a plug and a socket in their mated pose.
pub struct Pair<'a> {
    /// Plug, mated, m.
    pub plug: &'a [Triangle],
    /// Socket in the same axes, m.
    pub socket: &'a [Triangle],
    /// Plug and socket as in their files, before gaps are closed and faces reduced, m.
    pub drawn: [&'a [Triangle]; 2],
    /// Direction in which the plug is withdrawn.
    pub out: Vector3<f64>,
    /// Directions perpendicular to `out` along which the jaws may close, the preferred one first.
    pub jaws: &'a [Vector3<f64>],
    /// Depth of the plug's tip below the socket's opening, m.
    pub depth: f64,
    /// Length of the plug's tip that enters the opening without being guided, m.
    pub nose: f64,
    /// Two directions perpendicular to `out`, and the total play along each, m.
    pub play: [(Vector3<f64>, f64); 2],
}

/// Task derived from a pair.
#[derive(Debug, Clone, PartialEq)]
pub struct PairTask {
    /// Task.
    pub task: Task,
    /// Whether plug and socket are probably swapped: only the socket, which is inside the plug, has faces to hold.
    pub swapped: bool,
    /// Direction along which the jaws close.
    pub jaws: Vector3<f64>,
    /// Total play of the mated plug in x and in y, m.
    pub play: [f64; 2],
    /// Width in x of the part between the pads, m.
    pub held: f64,
    /// Height of the highest point of the socket, task frame, m.
    pub top: f64,
    /// Whether the plug is held by a handle that its drawing lacks.
    pub handle: bool,
    /// Larger faces that the fingers cannot hold.
    pub rejected: Option<Rejected>,
    /// Interference that was removed from the parts.
    pub interference: Vec<Interference>,
    /// Worst place at which the parts of a body (0 plug, 1 socket) are not as drawn, task frame, plug mated, if any.
    pub deviation: Option<(usize, Deviation)>,
    /// Pose at which the gap between the parts is not as drawn, if any.
    pub difference: Option<gaps::Difference>,
    /// SVG of the place of this deviation or difference.
    pub closeup: Option<String>,
}

impl PairTask {
    /// Returns the height of the mated plug's tip, task frame, m.
    pub fn mated_z(&self) -> f64 {
        self.task.success.mated.map_or(0.0, |mated| mated.tip[2])
    }
}

/// Pair in the task's axes: the plug in its own frame, the socket in that of the task.
struct AlignedPair {
    plug: Vec<Triangle>,
    socket: Vec<Triangle>,
    drawn: [Vec<Triangle>; 2],
    /// Direction along which the jaws close, in the axes of the [`Pair`].
    jaws: Vector3<f64>,
    /// Total play in x and in y, m.
    play: [f64; 2],
}

impl AlignedPair {
    fn new(pair: &Pair, jaws: Vector3<f64>) -> Self {
        let turn =
            Matrix3::from_rows(&[jaws.cross(&pair.out), jaws, pair.out].map(|v| v.transpose()));
        let turned = |triangles: &[Triangle], by: Vector3<f64>| -> Vec<Triangle> {
            triangles.iter().map(|t| t.map(|p| Point3::from(turn * p.coords + by))).collect()
        };
        let plug = turned(pair.plug, Vector3::zeros());
        let [low, _] = extent(plug.iter().flatten(), 2);
        let tip = plug.iter().flat_map(|face| clipped(face, 2, [low, low + TIP]));
        let tip: Vec<Point3<f64>> = tip.collect();
        let [x, y] = [0, 1].map(|axis| extent(&tip, axis)).map(|[a, b]| (a + b) / 2.0);
        let play = [0, 1].map(|axis| {
            let along = |(v, _): &&(Vector3<f64>, f64)| (turn * v)[axis].abs() > 0.7;
            pair.play.iter().find(along).map_or(0.0, |(_, play)| *play)
        });
        let own = Vector3::new(-x, -y, -low);
        let task = own - Vector3::z() * pair.depth;
        AlignedPair {
            plug: turned(pair.plug, own),
            socket: turned(pair.socket, task),
            drawn: [turned(pair.drawn[0], own), turned(pair.drawn[1], task)],
            jaws,
            play,
        }
    }
}

/// Returns the task of a pair in its mated pose, with an upright strategy; friction, fingers, grasp force and limits are
/// those of `like`, if it is given. With a `size`, the plug is held by a handle of this size, else by its own faces if
/// possible.
pub fn task(pair: &Pair, name: &str, like: Option<&Task>, size: Option<Size>) -> PairTask {
    // Rounded to the grid of files, so that corners stay on it.
    let pair = &Pair { depth: snap(pair.depth), ..*pair };
    let first = pair.jaws.first().copied().unwrap_or_else(Vector3::y);
    let top = |placed: &AlignedPair| extent(placed.socket.iter().flatten(), 2)[1];
    let held = |pair: &Pair, jaws: &Vector3<f64>| {
        let placed = AlignedPair::new(pair, *jaws);
        let (grasp, larger) = grip::own(&placed.plug, pair.depth + top(&placed).max(0.0));
        (placed, grasp, larger)
    };
    let axes = if size.is_some() { &[] } else { pair.jaws };
    let (mut own, mut refused): (Option<(AlignedPair, Grasp)>, Vec<Rejected>) = (None, Vec::new());
    for (placed, grasp, larger) in axes.iter().map(|jaws| held(pair, jaws)) {
        refused.extend(larger);
        let Some(grasp) = grasp else { continue };
        if own.as_ref().is_none_or(|(_, first)| grasp.replaces(first)) {
            own = Some((placed, grasp));
        }
    }
    let area = own.as_ref().map_or(0.0, |(_, grasp)| grasp.area);
    let rejected = refused.into_iter().find(|faces| faces.area > area);
    let handle = own.is_none();
    let other = Pair { plug: pair.socket, socket: pair.plug, out: -pair.out, ..*pair };
    let swapped = handle && axes.iter().any(|jaws| held(&other, jaws).1.is_some());
    let (placed, grasp) = own.unwrap_or_else(|| {
        let placed = AlignedPair::new(pair, first);
        let size = size.unwrap_or(HANDLE);
        let grasp = grip::handle(&placed.plug, size, pair.depth + top(&placed).max(0.0));
        (placed, grasp)
    });
    // The parts of plug (0) and socket (1) that the other body can touch, and the worst deviation of either from its
    // drawing.
    let mated: Vec<Triangle> =
        placed.plug.iter().map(|t| t.map(|p| p - Vector3::z() * pair.depth)).collect();
    let reach = Reach::new(&mated, &placed.socket, placed.play[0].max(placed.play[1]));
    let ((plug, off), (socket, its)) = rayon::join(
        || checked_skin("plug", &mated, |face, normal| reach.of_plug(face, normal)),
        || checked_skin("socket", &placed.socket, |face, normal| reach.of_socket(face, normal)),
    );
    let up = |part: Part| Part { solid: raised(part.solid, pair.depth), ..part };
    let mut parts = [plug.into_iter().map(up).collect(), socket];
    let deviation = worst([off, its]);
    let tight = placed.play.iter().any(|play| *play < MIN_PLAY);
    let (interference, left_out) = overlap::cut(&mut parts, pair.depth, tight);
    let drawn = [&placed.drawn[0][..], &placed.drawn[1]];
    let ([plug, socket], play) = (&parts, placed.play);
    let bodies = gaps::Bodies { drawn, parts: [plug, socket], depth: pair.depth, play };
    let difference =
        if deviation.is_some() { None } else { gaps::difference(&bodies, &interference) };
    let mated = Pose::translation(0.0, 0.0, -pair.depth);
    let place = deviation.map(|(_, off)| (mated, off.place));
    let place = place.or(difference.map(|off| (off.pose, off.place)));
    let closeup = place.map(|(pose, place)| closeup::svg(&bodies, &pose, place));
    let [mut plug, socket] = parts;
    plug.push(grasp.part.clone());
    let mut task = draft::blank(name, like);
    task.plug.mass = draft::DENSITY * volume(&placed.plug).max(geometry::volume(&grasp.part.solid));
    (task.plug.parts, task.socket, task.left_out) = (plug, socket, left_out);
    let play = placed.play.map(|play| play.max(MIN_PLAY));
    task.opening = opening(&placed.plug, pair.depth, play);
    (task.grip.shoulder_z, task.grip.faces_y) = (grasp.shoulder, grasp.faces);
    let task = plan::mated(task, pair.depth, pair.nose, play);
    PairTask {
        swapped: swapped && plan::has_core(&task),
        task,
        jaws: placed.jaws,
        play: placed.play,
        held: width(extent(grasp.part.solid.corners(), 0)),
        top: top(&placed),
        handle,
        rejected,
        interference,
        deviation,
        difference,
        closeup,
    }
}

/// Returns the parts for the faces that can be touched, and their deviations from the drawing.
fn checked_skin(
    name: &str,
    triangles: &[Triangle],
    reached: impl Fn(&Triangle, &Vector3<f64>) -> bool,
) -> (Vec<Part>, Vec<Deviation>) {
    let drawn = Drawn::new(triangles);
    let (solids, kept) = skin(triangles, reached, |solid| drawn.trimmed(solid));
    let called = |i: usize, solid: &Solid| format!("{name} {i} {}", side(solid));
    let parts = (1..).zip(solids).map(|(i, solid)| draft::part(&called(i, &solid), solid));
    let parts: Vec<Part> = parts.collect();
    let found = drawn.deviations(&kept, &parts);
    (parts, found)
}

/// Returns the side of the plug's axis on which a solid lies.
fn side(solid: &Solid) -> &'static str {
    let corners = solid.corners();
    // Largest distance by which the axis is outside of the solid, along x and y; below 0 inside.
    let beyond = [0, 1].map(|axis| extent(&corners, axis)).map(|[low, high]| [low, -high]);
    let [[right, left], [back, front]] = beyond;
    let sides = [(right, "at +x"), (left, "at -x"), (back, "at +y"), (front, "at -y")];
    let most = sides.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
    most.filter(|(distance, _)| *distance > 0.0).map_or("on the axis", |(_, side)| side)
}

/// Moves a solid along z, m.
fn raised(solid: Solid, by: f64) -> Solid {
    let up = Vector3::z() * by;
    match solid {
        Solid::Box { min, max } => Solid::Box { min: min + up, max: max + up },
        Solid::Prism { axis: 2, outline, span } => {
            Solid::Prism { axis: 2, outline, span: span.map(|z| z + by) }
        }
        Solid::Prism { axis, outline, span } => {
            let outline = outline.into_iter().map(|[a, z]| [a, z + by]).collect();
            Solid::Prism { axis, outline, span }
        }
        other => Solid::Hull { points: other.corners().into_iter().map(|p| p + up).collect() },
    }
}

/// Returns the opening: the extent of the plug below the socket's top, without a shoulder that rests on it, plus the
/// play, m.
fn opening(plug: &[Triangle], depth: f64, play: [f64; 2]) -> [[f64; 2]; 2] {
    let below = [f64::NEG_INFINITY, depth - plan::BELOW_TOP];
    let below: Vec<Point3<f64>> = plug.iter().flat_map(|face| clipped(face, 2, below)).collect();
    [0, 1].map(|axis| {
        let [low, high] = span(below.iter().map(|p| p[axis]));
        [low - play[axis] / 2.0, high + play[axis] / 2.0]
    })
}

fn volume(triangles: &[Triangle]) -> f64 {
    let of = |[a, b, c]: &Triangle| a.coords.dot(&b.coords.cross(&c.coords)) / 6.0;
    triangles.iter().map(of).sum()
}
