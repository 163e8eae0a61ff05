//! A task from a mesh of a plug and one of its socket.

pub use super::decompose::{COARSEST, MOST_PARTS};
use super::decompose::{Decomposed, Undone, decompose};
use super::intrusion::{self, Intrusion};
use super::surface::Surface;
use super::{MeshError, cut};
use crate::connector::body::{ConvexBody, span};
use crate::connector::seat::{Seating, section};
use crate::connector::{draft, hold, plan};
use input::units::MM;
use insertion::task::{Part, Task, geometry};
use nalgebra::{Matrix3, Point3, Vector3};

/// How far below the top the opening is looked at, m: as in the check of the walls.
const BELOW_TOP: f64 = 0.1 * MM;
/// The tip's middle is that of its lowest part of this height, m.
const TIP: f64 = 1.0 * MM;
/// Height of a face that pads must find, m.
const LEAST_COVER: f64 = 2.0 * MM;
/// Intrusion counts this far about the opening and below the tip's end, m.
const ABOUT: f64 = 0.5 * MM;
/// Share of the clearance that may be filled.
pub const ALLOWED: f64 = 0.1;

/// The direction, in the files, in which the plug goes in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Along {
    /// Along x
    #[value(name = "x", alias = "+x")]
    PlusX,
    /// Against x
    #[value(name = "-x")]
    MinusX,
    /// Along y
    #[value(name = "y", alias = "+y")]
    PlusY,
    /// Against y
    #[value(name = "-y")]
    MinusY,
    /// Along z
    #[value(name = "z", alias = "+z")]
    PlusZ,
    /// Against z
    #[value(name = "-z")]
    MinusZ,
}

impl Along {
    /// The turn that lets this direction be -z. The file's y stays y; where the plug goes in along
    /// y, the file's x becomes y.
    fn turn(self) -> Matrix3<f64> {
        let rows = match self {
            Along::MinusZ => [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
            Along::PlusZ => [[-1, 0, 0], [0, 1, 0], [0, 0, -1]],
            Along::MinusX => [[0, 0, -1], [0, 1, 0], [1, 0, 0]],
            Along::PlusX => [[0, 0, 1], [0, 1, 0], [-1, 0, 0]],
            Along::MinusY => [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
            Along::PlusY => [[0, 0, -1], [1, 0, 0], [0, -1, 0]],
        };
        Matrix3::from_fn(|i, j| f64::from(rows[i][j]))
    }
}

/// A mesh and what it is called.
pub struct Mesh {
    /// For messages.
    pub file: String,
    /// Its surface.
    pub surface: Surface,
}

/// How meshes are brought in.
pub struct Request<'a> {
    /// Name of the task.
    pub name: &'a str,
    /// Direction of the insertion.
    pub along: Along,
    /// Voxels along the longest side, where a mesh is approximated.
    pub resolution: u32,
    /// A task of which all but the shapes is taken.
    pub like: Option<&'a Task>,
    /// Told what is being done.
    pub say: &'a dyn Fn(&str),
}

/// A task and how well it stands for its meshes.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// The task.
    pub task: Task,
    /// Whether the parts of plug and socket are the meshes, not near them.
    pub exact: [bool; 2],
    /// How far the plug can be moved in its socket, the smaller of x and y, m.
    pub clearance: f64,
    /// The farthest that a part reaches into the clearance, and whose it is.
    pub intrusion: Option<(Intrusion, &'static str)>,
}

/// Brings two meshes in.
///
/// # Errors
/// If one of them cannot be made of convex parts, opened or held.
pub fn import(plug: Mesh, socket: Mesh, request: &Request) -> Result<Imported, MeshError> {
    let turn = request.along.turn();
    let turned = |surface: Surface| surface.moved(&turn, Vector3::zeros());
    let middles = request.like.map_or([[0.0; 2]; 2], middles);
    let plug_surface = stand(turned(plug.surface), middles[0]);
    let (socket_surface, opening) =
        open(turned(socket.surface), middles[1], &socket.file, request.along)?;
    let inner = convex(&plug_surface, &plug.file, "plug", request)?;
    let outer = convex(&socket_surface, &socket.file, "socket", request)?;
    let mut task = draft::blank(request.name, request.like);
    task.description = format!("from {} and {}", file_name(&plug.file), file_name(&socket.file));
    task.plug.mass = draft::DENSITY * plug_surface.volume();
    task.plug.parts = parts("plug", &inner);
    task.socket = parts("socket", &outer);
    task.opening = opening;
    let task = match request.like {
        Some(like) => Task {
            plug: insertion::task::Plug {
                mass: like.plug.mass,
                parts: task.plug.parts,
                latch: None,
            },
            grip: like.grip,
            strategy: like.strategy.clone(),
            success: like.success,
            ..task
        },
        None => planned(task, &plug.file)?,
    };
    let clearance = clearance(&task);
    let intrusion = intrude(&task, [&plug_surface, &socket_surface]);
    Ok(Imported { exact: [inner.exact, outer.exact], clearance, intrusion, task })
}

/// A body as convex parts.
fn convex(
    surface: &Surface,
    file: &str,
    body: &str,
    request: &Request,
) -> Result<Decomposed, MeshError> {
    let resolution = request.resolution;
    let say = |what: &str| (request.say)(&format!("{body}: {what}"));
    decompose(surface, resolution, &say).map_err(|undone| match undone {
        Undone::Long { finest } => MeshError::Long { file: file.to_owned(), resolution, finest },
        Undone::Many { parts } => MeshError::Many { file: file.to_owned(), parts },
    })
}

/// The smaller play of the two directions, at the depth of success.
fn clearance(task: &Task) -> f64 {
    let (plug, socket) = (ConvexBody::plug(&task.plug), ConvexBody::new(&task.socket));
    let seating = Seating::new(task, &plug, &socket);
    let seat = seating.deepest();
    let depth = task.success.depth.min(seat.depth);
    let play = |axis| seating.play(depth, seat.at, axis);
    play(0).min(play(1))
}

fn file_name(path: &str) -> String {
    let name = std::path::Path::new(path).file_name();
    name.map_or(path.to_owned(), |name| name.to_string_lossy().into_owned())
}

fn parts(body: &str, decomposed: &Decomposed) -> Vec<Part> {
    let part = |(i, solid): (usize, &insertion::task::Solid)| Part {
        name: format!("{body} {}", i + 1),
        solid: solid.clone(),
        friction: None,
    };
    decomposed.solids.iter().enumerate().map(part).collect()
}

/// Grip, strategy and success by the shapes.
fn planned(mut task: Task, file: &str) -> Result<Task, MeshError> {
    let found = hold::find(&ConvexBody::plug(&task.plug), LEAST_COVER);
    let (shoulder, faces) = found.ok_or_else(|| MeshError::NoGrip { file: file.to_owned() })?;
    (task.grip.shoulder_z, task.grip.faces_y) = (shoulder, faces);
    Ok(plan::complete(task)?)
}

/// Where the middle of a task's tip lies in its plug frame, and of its opening in the task frame.
fn middles(task: &Task) -> [[f64; 2]; 2] {
    let plug = ConvexBody::plug(&task.plug);
    let tip = section(&plug, plug.extent(2)[0] + TIP);
    [tip, task.opening].map(|ranges| ranges.map(|[low, high]| (low + high) / 2.0))
}

/// The plug with its lowest point at z = 0 and the middle of its tip at `place`.
fn stand(surface: Surface, place: [f64; 2]) -> Surface {
    let [bottom, _] = span(surface.points.iter().map(|p| p.z));
    let limit = bottom + TIP;
    let mut tip: Vec<Point3<f64>> = Vec::new();
    for face in &surface.faces {
        let corners = face.map(|corner| surface.points[corner]);
        tip.extend(crate::connector::body::clipped(&corners, 2, [bottom, limit]));
    }
    let middle = |axis: usize| {
        let [low, high] = span(tip.iter().map(|p| p[axis]));
        (low + high) / 2.0
    };
    let by = Vector3::new(place[0] - middle(0), place[1] - middle(1), -bottom);
    surface.moved(&Matrix3::identity(), by)
}

/// The socket with its top at z = 0 and the middle of its largest opening at `place`.
fn open(
    surface: Surface,
    place: [f64; 2],
    file: &str,
    along: Along,
) -> Result<(Surface, [[f64; 2]; 2]), MeshError> {
    let size = |[x, y]: &[[f64; 2]; 2]| (x[1] - x[0]) * (y[1] - y[0]);
    let holes = cut::openings(&surface, BELOW_TOP);
    let largest = holes.into_iter().max_by(|a, b| size(a).total_cmp(&size(b)));
    let Some(opening) = largest else {
        let value = clap::ValueEnum::to_possible_value(&along);
        return Err(MeshError::NoOpening {
            file: file.to_owned(),
            along: format!(
                "--insert-along {}",
                value.as_ref().map_or("", |value| value.get_name())
            ),
        });
    };
    let [_, top] = span(surface.points.iter().map(|p| p.z));
    let middle = opening.map(|[low, high]| (low + high) / 2.0);
    let by = Vector3::new(place[0] - middle[0], place[1] - middle[1], -top);
    let shifted = [0, 1].map(|axis| opening[axis].map(|v| v + by[axis]));
    Ok((surface.moved(&Matrix3::identity(), by), shifted))
}

/// The largest intrusion of plug or socket where they meet.
fn intrude(task: &Task, surfaces: [&Surface; 2]) -> Option<(Intrusion, &'static str)> {
    let deep = task.success.depth + ABOUT;
    let [x, y] = task.opening;
    let about = |v: f64, [low, high]: [f64; 2]| low - ABOUT < v && v < high + ABOUT;
    let plug = intrusion::largest(surfaces[0], &task.plug.parts, |p| p.z < deep);
    let socket = intrusion::largest(surfaces[1], &task.socket, |p| {
        p.z > -deep - ABOUT && about(p.x, x) && about(p.y, y)
    });
    let both = [plug.map(|found| (found, "plug")), socket.map(|found| (found, "socket"))];
    both.into_iter().flatten().max_by(|a, b| a.0.depth.total_cmp(&b.0.depth))
}

impl Imported {
    /// Number of parts of plug and socket.
    pub fn parts(&self) -> [usize; 2] {
        [self.task.plug.parts.len(), self.task.socket.len()]
    }

    /// Volumes of the parts of plug and socket, m3.
    pub fn volumes(&self) -> [f64; 2] {
        [&self.task.plug.parts, &self.task.socket]
            .map(|parts| parts.iter().map(|part| geometry::volume(&part.solid)).sum())
    }
}
