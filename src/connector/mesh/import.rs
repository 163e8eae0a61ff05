//! Task from a mesh of a plug and one of its socket.

pub use super::decompose::{COARSEST, MOST_PARTS};
use super::decompose::{decompose, intrusion};
use super::reduce::{TOLERANCE, reduced};
use super::surface::Surface;
use super::{MeshError, cut};
use crate::connector::body::{ConvexBody, clipped, extent};
use crate::connector::seat::{Seating, section};
use crate::connector::{draft, hold, plan};
use input::units::MM;
use insertion::task::{Part, Plug, Task};
use nalgebra::{Matrix3, Point3, Vector3};

/// Depth at which the opening is measured, m: as in the check of the walls.
const BELOW_TOP: f64 = 0.1 * MM;
/// Height of the tip, whose middle is centred, m.
const TIP: f64 = 1.0 * MM;
/// Least height of a face that pads must meet, m.
const LEAST_COVER: f64 = 2.0 * MM;
/// Margin about the opening and below the seated tip within which intrusion counts, m.
const ABOUT: f64 = 0.5 * MM;
/// Faces from which on a mesh is reduced.
const MANY_FACES: usize = 2000;
/// Most faces that are cut into convex parts: more take minutes.
const MOST_FACES: usize = 8000;
/// Largest share of the clearance that intrusion may fill.
pub const ALLOWED: f64 = 0.1;

/// Fault of a plug that no pads hold.
const NO_GRIP: &str = "no place to hold the plug was found: two faces across y, with a shoulder above \
                       them for the fingers' roofs; give --like T, whose grip fits, or write [grip] by hand";

/// Unit of length of a mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Unit {
    /// Millimetres
    Mm,
    /// Inches
    In,
    /// Metres
    M,
}

impl Unit {
    /// Its length, m.
    pub fn metres(self) -> f64 {
        match self {
            Unit::Mm => MM,
            Unit::In => 25.4 * MM,
            Unit::M => 1.0,
        }
    }
}

/// Direction of insertion in the axes of the files.
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
    /// Rotation of this direction to -z. y stays y; if the plug goes in along y, x becomes y.
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

/// Mesh of a file.
pub struct Mesh {
    /// File name for messages.
    pub file: String,
    /// Closed surface, m.
    pub surface: Surface,
}

/// Settings of an import.
pub struct Request<'a> {
    /// Name of the new task.
    pub name: &'a str,
    /// Direction of insertion.
    pub along: Along,
    /// Voxels along the longest side, where a mesh is approximated.
    pub resolution: u32,
    /// Task whose keys are taken, all but the shapes.
    pub like: Option<&'a Task>,
    /// Callback for progress messages.
    pub say: &'a dyn Fn(&str),
}

/// Imported task and its deviation from the meshes.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// Task with the parts of plug and socket.
    pub task: Task,
    /// Whether the parts of plug and of socket equal the meshes, not approximate them.
    pub exact: [bool; 2],
    /// Play of the plug in its socket, the smaller of x and y, m.
    pub clearance: f64,
    /// Largest intrusion of a part into the clearance, m, its point, m, and its body.
    pub intrusion: Option<(f64, Point3<f64>, &'static str)>,
}

/// The mesh with faces that can be cut, few enough to be cut in seconds.
fn few_faces(mesh: Mesh, say: &dyn Fn(&str)) -> Result<Mesh, MeshError> {
    let Mesh { file, surface } = mesh;
    let before = surface.faces.len();
    if before <= MANY_FACES {
        return Ok(Mesh { file, surface });
    }
    let surface = reduced(surface);
    let (after, tolerance) = (surface.faces.len(), TOLERANCE / MM);
    if after > MOST_FACES {
        let problem = format!(
            "has {before} faces, and {after} where all within {tolerance} mm is made flat; at most \
             {MOST_FACES} are taken: leave out threads, text and knurls, or export the mesh more coarsely"
        );
        return Err(MeshError::File(file, problem));
    }
    say(&format!("{file}: {before} faces reduced to {after}, within {tolerance} mm"));
    Ok(Mesh { file, surface })
}

/// Imports a plug and its socket.
///
/// # Errors
/// If a mesh has no convex parts, the socket no opening, or the plug no grasp or strategy.
pub fn import(plug: Mesh, socket: Mesh, request: &Request) -> Result<Imported, MeshError> {
    let plug = few_faces(plug, request.say)?;
    let socket = few_faces(socket, request.say)?;
    let turn = request.along.turn();
    let turned = |surface: Surface| surface.moved(&turn, Vector3::zeros());
    let middles = request.like.map_or([[0.0; 2]; 2], middles);
    let plug_surface = stand(turned(plug.surface), middles[0]);
    let (socket_surface, opening) =
        open(turned(socket.surface), middles[1], &socket.file, request.along)?;
    let convex = |surface: &Surface, file: &str, body: &str| {
        let say = |what: &str| (request.say)(&format!("{body}: {what}"));
        let found = decompose(surface, request.resolution, &say);
        let (solids, exact) = found.map_err(|fault| MeshError::File(file.to_owned(), fault))?;
        let part = |(i, solid)| Part { name: format!("{body} {i}"), solid, friction: None };
        Ok::<_, MeshError>(((1..).zip(solids).map(part).collect(), exact))
    };
    let (plug_parts, plug_exact) = convex(&plug_surface, &plug.file, "plug")?;
    let (socket_parts, socket_exact) = convex(&socket_surface, &socket.file, "socket")?;
    let mut task = draft::blank(request.name, request.like);
    task.description = format!("from {} and {}", file_name(&plug.file), file_name(&socket.file));
    task.plug.mass = draft::DENSITY * plug_surface.volume();
    (task.plug.parts, task.socket) = (plug_parts, socket_parts);
    task.opening = opening;
    let task = match request.like {
        Some(like) => Task {
            plug: Plug { mass: like.plug.mass, ..task.plug },
            grip: like.grip,
            strategy: like.strategy.clone(),
            success: like.success,
            ..task
        },
        None => {
            let found = hold::find(&ConvexBody::plug(&task.plug), LEAST_COVER);
            let found = found.ok_or_else(|| MeshError::File(plug.file, NO_GRIP.to_owned()))?;
            (task.grip.shoulder_z, task.grip.faces_y) = found;
            plan::complete(task)?
        }
    };
    let (plug_body, socket_body) = (ConvexBody::plug(&task.plug), ConvexBody::new(&task.socket));
    let seating = Seating::new(&task, &plug_body, &socket_body);
    let seat = seating.deepest();
    let depth = task.success.depth.min(seat.depth);
    let play = |axis| seating.play(depth, seat.at, axis);
    let clearance = play(0).min(play(1));
    let intrusion = intrude(&task, [&plug_surface, &socket_surface]);
    Ok(Imported { exact: [plug_exact, socket_exact], clearance, intrusion, task })
}

fn file_name(path: &str) -> String {
    let name = std::path::Path::new(path).file_name();
    name.map_or(path.to_owned(), |name| name.to_string_lossy().into_owned())
}

/// Middle of a task's tip in the plug frame, and of its opening in the task frame, m.
fn middles(task: &Task) -> [[f64; 2]; 2] {
    let plug = ConvexBody::plug(&task.plug);
    let tip = section(&plug, plug.extent(2)[0] + TIP);
    [tip, task.opening].map(|ranges| ranges.map(middle))
}

fn middle([low, high]: [f64; 2]) -> f64 {
    (low + high) / 2.0
}

/// Plug with its lowest point at z = 0 and the middle of its tip at `place`.
fn stand(surface: Surface, place: [f64; 2]) -> Surface {
    let [bottom, _] = extent(&surface.points, 2);
    let faces = surface.faces.iter().map(|face| face.map(|corner| surface.points[corner]));
    let tip: Vec<Point3<f64>> =
        faces.flat_map(|corners| clipped(&corners, 2, [bottom, bottom + TIP])).collect();
    let middle = [0, 1].map(|axis| middle(extent(&tip, axis)));
    let by = Vector3::new(place[0] - middle[0], place[1] - middle[1], -bottom);
    surface.moved(&Matrix3::identity(), by)
}

/// Socket with its top at z = 0, its largest opening's middle at `place`; and that opening.
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
        let value = value.as_ref().map_or("", |value| value.get_name());
        let fault = format!(
            "has no opening on its top (--insert-along {value}): no closed hole goes in from there"
        );
        return Err(MeshError::File(file.to_owned(), fault));
    };
    let [_, top] = extent(&surface.points, 2);
    let middle = opening.map(middle);
    let by = Vector3::new(place[0] - middle[0], place[1] - middle[1], -top);
    let shifted = [0, 1].map(|axis| opening[axis].map(|v| v + by[axis]));
    Ok((surface.moved(&Matrix3::identity(), by), shifted))
}

/// Largest intrusion of plug or socket where they meet, and its body.
fn intrude(task: &Task, surfaces: [&Surface; 2]) -> Option<(f64, Point3<f64>, &'static str)> {
    let deep = task.success.depth + ABOUT;
    let [x, y] = task.opening;
    let about = |v: f64, [low, high]: [f64; 2]| low - ABOUT < v && v < high + ABOUT;
    let plug = intrusion(surfaces[0], &task.plug.parts, |p| p.z < deep);
    let socket = intrusion(surfaces[1], &task.socket, |p| {
        p.z > -deep - ABOUT && about(p.x, x) && about(p.y, y)
    });
    let plug = plug.map(|(depth, at)| (depth, at, "plug"));
    let socket = socket.map(|(depth, at)| (depth, at, "socket"));
    plug.into_iter().chain(socket).max_by(|a, b| a.0.total_cmp(&b.0))
}

impl Imported {
    /// Number of parts of plug and of socket.
    pub fn parts(&self) -> [usize; 2] {
        [self.task.plug.parts.len(), self.task.socket.len()]
    }
}
