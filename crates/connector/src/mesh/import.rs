//! Task from a mesh of a plug and one of its socket.

use super::axes::value;
pub use super::axes::{Along, Jaws, Unit};
use super::cut::Mouth;
use super::decompose::{decompose, intrusion};
use super::reduce::{MANY_FACES, TOLERANCE, reduced};
use super::surface::Surface;
use super::{MeshError, cut};
use crate::body::{ConvexBody, clipped, extent, width};
use crate::check::FACES_MM;
use crate::seat::{Seating, section};
use crate::{draft, hold, plan};
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
/// Most faces that are cut into convex parts: more take minutes.
const MOST_FACES: usize = 8000;
/// Least play of a plug that goes in, m.
const LEAST_PLAY: f64 = 3e-3 * MM;
/// Largest share of the clearance that intrusion may fill.
pub const ALLOWED: f64 = 0.1;

/// Fault of a plug that no pads hold.
const NO_GRIP: &str = "no place to hold the plug was found: two faces across y, with a shoulder above \
                       them for the fingers' roofs; give --like T, whose grip fits, or write [grip] by hand";

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
    /// Axis along which the jaws close; otherwise the first across which the plug is held.
    pub jaws: Option<Jaws>,
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
    /// Axis of the files along which the jaws close.
    pub jaws: Jaws,
    /// Play of the plug in its socket in x and in y, both ways together, m.
    pub play: [f64; 2],
    /// Width of the chamfer of the opening in x and in y, and its depth, m.
    pub chamfer: [f64; 3],
    /// Body that the fingers hold: width between the jaws, height in x, length above the seated socket, m.
    pub body: [f64; 3],
    /// Largest intrusion of a part into the clearance, m, its point, m, and its body.
    pub intrusion: Option<(f64, Point3<f64>, &'static str)>,
}

/// Smallest volume of a plug or socket, mm3.
const LEAST_MM3: f64 = 1.0;

/// Returns the mesh with faces that can be cut, few enough to be cut in seconds, and what was reduced.
pub fn few_faces(mesh: Mesh) -> Result<(Mesh, Option<String>), MeshError> {
    let Mesh { file, surface } = mesh;
    let volume_mm3 = surface.volume() / (MM * MM * MM);
    if volume_mm3 < LEAST_MM3 {
        let problem = format!(
            "its faces enclose {volume_mm3:.3} mm3, at least {LEAST_MM3} mm3 are expected: they cross one another or \
             are turned inside out; repair the body where it was drawn"
        );
        return Err(MeshError::File(file, problem));
    }
    let before = surface.faces.len();
    if before <= MANY_FACES {
        return Ok((Mesh { file, surface }, None));
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
    let said = format!("{file}: {before} faces reduced to {after}, within {tolerance} mm");
    Ok((Mesh { file, surface }, Some(said)))
}

/// Plug as the jaws of an axis hold it.
struct Standing {
    jaws: Jaws,
    surface: Surface,
    parts: Vec<Part>,
}

impl Standing {
    /// Shoulder and faces, m, by which pads hold it: flat ones, or any.
    fn grasp(&self, flat: bool) -> Option<(f64, [f64; 2])> {
        let found = hold::grasp(&ConvexBody::new(&self.parts), LEAST_COVER, flat)?;
        (width(found.1) <= FACES_MM[1] * MM).then_some(found)
    }
}

/// Imports a plug and its socket.
///
/// # Errors
/// If a mesh has no convex parts, the socket no opening, or the plug no grasp or strategy.
pub fn import(plug: Mesh, socket: Mesh, request: &Request) -> Result<Imported, MeshError> {
    let Request { along, like, .. } = *request;
    let middles = like.map_or([[0.0; 2]; 2], middles);
    let description = format!("from {} and {}", file_name(&plug.file), file_name(&socket.file));
    let (plug, grasp) = grasped(&plug, middles[0], request)?;
    let turned = socket.surface.moved(&along.turn(plug.jaws), Vector3::zeros());
    let (socket_surface, mouth) = open(turned, middles[1], &socket.file, along)?;
    let socket_parts = convex(&socket_surface, &socket.file, "socket", request)?;
    let mut task = draft::blank(request.name, like);
    task.description = description;
    task.plug.mass = draft::DENSITY * plug.surface.volume();
    (task.plug.parts, task.socket) = (plug.parts, socket_parts);
    task.opening = mouth.opening;
    let task = match like {
        Some(like) => Task {
            plug: Plug { mass: like.plug.mass, ..task.plug },
            grip: like.grip,
            strategy: like.strategy.clone(),
            success: like.success,
            ..task
        },
        None => {
            (task.grip.shoulder_z, task.grip.faces_y) = grasp;
            plan::complete(task)?
        }
    };
    let (plug_body, socket_body) = (ConvexBody::plug(&task.plug), ConvexBody::new(&task.socket));
    let seating = Seating::new(&task, &plug_body, &socket_body);
    let seat = seating.deepest();
    let depth = task.success.depth.min(seat.depth);
    let play = [0, 1].map(|axis| seating.play(depth, seat.at, axis));
    if let (None, Some(axis)) = (like, (0..2).find(|&axis| play[axis] < LEAST_PLAY)) {
        let (name, wide) = (["x", "y"][axis], mouth.throat[axis] / MM);
        let fault = format!(
            "has no play in {name} (of the task), where the opening is {wide:.3} mm wide: make the opening \
             wider or the plug smaller"
        );
        return Err(MeshError::File(socket.file, fault));
    }
    let [x, y] = [0, 1].map(|axis| (mouth.rim[axis] - mouth.throat[axis]) / 2.0);
    let pads = hold::pad_z(task.grip.shoulder_z);
    let between = task.plug.parts.iter().flat_map(|part| clipped(&part.solid.corners(), 2, pads));
    let body =
        [width(task.grip.faces_y), width(extent(between, 0)), task.grip.shoulder_z - seat.depth];
    let intrusion = intrude(&task, [&plug.surface, &socket_surface]);
    Ok(Imported {
        exact: [true; 2],
        jaws: plug.jaws,
        play,
        chamfer: [x, y, mouth.depth],
        body,
        intrusion,
        task,
    })
}

/// Returns the plug as the first axis has it across which pads hold flat faces, or else any; shoulder
/// and faces, m. With a task whose grip is taken, the first axis.
fn grasped(
    plug: &Mesh,
    middle: [f64; 2],
    request: &Request,
) -> Result<(Standing, (f64, [f64; 2])), MeshError> {
    let mut found: Vec<Standing> = Vec::new();
    for jaws in request.jaws.map_or(request.along.across().to_vec(), |jaws| vec![jaws]) {
        let turned = plug.surface.clone().moved(&request.along.turn(jaws), Vector3::zeros());
        let surface = stand(turned, middle);
        let parts = convex(&surface, &plug.file, "plug", request)?;
        let way = Standing { jaws, surface, parts };
        let taken = request.like.map(|like| (like.grip.shoulder_z, like.grip.faces_y));
        if let Some(grasp) = taken.or_else(|| way.grasp(true)) {
            return Ok((way, grasp));
        }
        found.push(way);
    }
    let any = found.into_iter().find_map(|way| way.grasp(false).map(|grasp| (way, grasp)));
    any.ok_or_else(|| MeshError::File(plug.file.clone(), NO_GRIP.to_owned()))
}

fn convex(
    surface: &Surface,
    file: &str,
    body: &str,
    request: &Request,
) -> Result<Vec<Part>, MeshError> {
    let faces = surface.faces.len();
    (request.say)(&format!("{body}: cutting {faces} faces into convex pieces"));
    let solids = decompose(surface).map_err(|fault| MeshError::File(file.to_owned(), fault))?;
    let part = |(i, solid)| Part { name: format!("{body} {i}"), solid, friction: None };
    Ok((1..).zip(solids).map(part).collect())
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
) -> Result<(Surface, Mouth), MeshError> {
    let Some(mouth) = cut::mouth(&surface, BELOW_TOP) else {
        let fault = format!(
            "has no opening on its top (--insert-along {}): no closed hole goes in from there",
            value(along)
        );
        return Err(MeshError::File(file.to_owned(), fault));
    };
    let [_, top] = extent(&surface.points, 2);
    let middle = mouth.opening.map(middle);
    let by = Vector3::new(place[0] - middle[0], place[1] - middle[1], -top);
    let opening = [0, 1].map(|axis| mouth.opening[axis].map(|v| v + by[axis]));
    Ok((surface.moved(&Matrix3::identity(), by), Mouth { opening, ..mouth }))
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
    /// Returns the smaller play of x and y, m.
    pub fn clearance(&self) -> f64 {
        self.play[0].min(self.play[1])
    }

    /// Number of parts of plug and of socket.
    pub fn parts(&self) -> [usize; 2] {
        [self.task.plug.parts.len(), self.task.socket.len()]
    }
}
