//! Bodies of plug and socket in the files that a user names.

use super::mated::unit;
use crate::python::Format;
use crate::{Context, Failure};
use connector::body::{extent, width};
use connector::draft::Size;
use connector::mating::plugs;
use connector::mesh::axes::{InsertionAxis, JawAxis, Unit, value};
use connector::mesh::{Body, Files, Triangle, is_step, pick, read, shells};
use input::units::MM;
use insertion::task::is_of_name;
use std::path::{Path, PathBuf};

/// Largest mesh file, bytes.
const LARGEST_FILE: u64 = 200 << 20;
/// Largest number of bodies that a message lists.
const MAX_LISTED: usize = 12;

/// STEP file, converted to bodies in OBJ, mm.
const STEP: Format = Format {
    name: "a STEP file",
    extra: "step",
    reader: "from finger_opt import _step
    sys.stdout.write(_step.obj(_step.read(sys.argv[1], 0.01)))",
    otherwise: "or export STL",
};

/// Plug and socket, what is known of their mate, and the task to make of them.
#[derive(Debug, Clone, clap::Args)]
#[command(group = clap::ArgGroup::new("files").required(true))]
pub struct PairRequest {
    /// Mesh of plug and socket in their mated pose; the plug is the part that can be withdrawn
    #[arg(group = "files", conflicts_with = "socket")]
    pub assembly: Option<PathBuf>,
    /// Mesh of the plug, or of both
    #[arg(long, value_name = "P.stl", group = "files")]
    pub plug: Option<PathBuf>,
    /// Mesh of the socket [default: the rest of the plug's file without --plug-body]
    #[arg(long, value_name = "S.stl")]
    pub socket: Option<PathBuf>,
    /// Body of the file that belongs to the plug: `o` or `g` of an OBJ, `solid` of a text STL, or the number of
    /// a shell, from 1; may be repeated [default: all, or the rest without --socket-body]
    #[arg(long, value_name = "NAME")]
    pub plug_body: Vec<String>,
    /// Body of the socket's file that belongs to the socket; may be repeated
    #[arg(long, value_name = "NAME")]
    pub socket_body: Vec<String>,
    /// Unit of both files [default: the one that makes plug and clearance plausible]
    #[arg(long, value_enum)]
    pub unit: Option<Unit>,
    /// Direction of insertion in the socket's file [default: the one in which most walls of the two engage]
    #[arg(long, value_name = "AXIS", value_enum, allow_hyphen_values = true)]
    pub insert_along: Option<InsertionAxis>,
    /// Pose to take, by its number in the list that is printed if several are possible
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub pose: usize,
    /// Axis of the socket's file along which the jaws close [default: the one across which the plug has two parallel
    /// faces for the pads]
    #[arg(long, value_name = "AXIS", value_enum)]
    pub jaws: Option<JawAxis>,
    /// Task for grip force, friction, fingers, limits and strategy
    #[arg(long, value_name = "T")]
    pub like: Option<String>,
    /// Handle on a plug that has no faces to grip, width between the jaws x height x length in mm
    /// [default: 10x12x20 where one is needed]
    #[arg(long, value_name = "WxHxL")]
    pub body: Option<Size>,
    /// Depth to be reached in a through hole, mm [default: the depth over which plug and socket engage]
    #[arg(long, value_name = "MM")]
    pub depth_mm: Option<f64>,
    /// File to write [default: the plug's name with .toml]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

impl PairRequest {
    /// Returns the file of the plug.
    pub fn plug(&self) -> &Path {
        // clap requires one of the two.
        self.assembly.as_ref().or(self.plug.as_ref()).map_or(Path::new(""), PathBuf::as_path)
    }

    /// Returns the file of the socket.
    pub fn socket(&self) -> &Path {
        self.socket.as_ref().map_or(self.plug(), PathBuf::as_path)
    }

    /// Returns the file to write.
    pub fn out(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.toml", name_of(self.plug()))))
    }

    /// Returns the name of the task.
    pub fn name(&self) -> String {
        name_of(&self.out())
    }
}

/// Returns the name of a task that is called like a file, with - for what a name may not contain.
fn name_of(file: &Path) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    stem.chars().map(|c| if is_of_name(c) { c } else { '-' }).collect()
}

/// Meshes of a plug and its socket.
pub struct Parts {
    /// Triangles of plug and of socket, in the unit of the files.
    pub triangles: [Vec<Triangle>; 2],
    /// Unit, if it is known.
    pub unit: Option<Unit>,
    /// Finding about the bodies of an assembly: its title and text.
    pub finding: Option<(&'static str, String)>,
}

/// Reads plug and socket; if one file contains both, the bodies that are not named belong to the other part.
///
/// # Errors
/// If a file cannot be read or lacks a named body, or if the bodies of the plug are unknown.
pub fn parts(files: Files, request: &PairRequest, context: &Context<'_>) -> Result<Parts, Failure> {
    let (plug, plug_step) = bodies(request.plug(), files[0], context)?;
    let both = request.socket() == request.plug();
    let (socket, socket_step) =
        if both { (plug.clone(), plug_step) } else { bodies(request.socket(), files[1], context)? };
    let unit = if plug_step || socket_step { Some(Unit::Mm) } else { request.unit };
    if let Some(other) = request.unit.filter(|given| Some(*given) != unit) {
        let problem =
            format!("--unit {}: STEP files contain their unit; leave it out", value(other));
        return Err(Failure::usage(problem));
    }
    let mut finding = None;
    let pick = |of: &[Body], names: &[String], file: &str| {
        (!names.is_empty()).then(|| pick(of, names, file)).transpose().map_err(Failure::input)
    };
    let plug_body = pick(&plug, &request.plug_body, files[0])?;
    let socket_body = pick(&socket, &request.socket_body, files[1])?;
    let all = |bodies: Vec<Body>| bodies.into_iter().flat_map(|body| body.triangles).collect();
    let triangles = match (plug_body, socket_body) {
        (Some([plug, _]), Some([socket, _])) => [plug, socket],
        (Some([plug, rest]), None) => [plug, if both { rest } else { all(socket) }],
        (None, Some([socket, rest])) => [if both { rest } else { all(plug) }, socket],
        (None, None) if request.assembly.is_some() => {
            let (parts, names) = split(files[0], plug, unit)?;
            finding = Some(("plug's bodies", format!("{names}; --plug-body names others")));
            parts
        }
        (None, None) if both => {
            // A body on its own is named by its shells.
            let bodies = if plug.len() > 1 { plug } else { shells(&plug) };
            let names: Vec<_> = bodies.into_iter().map(|body| body.name).collect();
            let (file, names) = (files[0], quoted(&names));
            return Err(Failure::usage(format!(
                "{file} has the bodies {names}: give --socket, or name those of the plug with --plug-body"
            )));
        }
        (None, None) => [all(plug), all(socket)],
    };
    Ok(Parts { triangles, unit, finding })
}

/// Reads the bodies of a file; returns them, and whether the file is STEP, which the extra `step` of the Python package
/// converts to meshes in mm, within 0.01 mm.
fn bodies(path: &Path, file: &str, context: &Context<'_>) -> Result<(Vec<Body>, bool), Failure> {
    let unreadable =
        |error: std::io::Error| Failure::in_file(file, format!("cannot read the mesh: {error}"));
    let opened = std::fs::File::open(path).map_err(unreadable)?;
    let bytes = input::files::read_up_to(opened, LARGEST_FILE).map_err(unreadable)?;
    if is_step(&bytes, &path.display().to_string()) {
        let (found, warnings) = STEP.read(path, file)?;
        warnings.iter().for_each(|warning| context.note(warning));
        return Ok((read(&found, &format!("{file}.obj"))?, true));
    }
    Ok((read(&bytes, file)?, false))
}

/// Returns the plug, which can be withdrawn, and the socket of an assembly, and the names of the plug's bodies.
///
/// # Errors
/// If no body can be withdrawn from the others, or if several can.
fn split(
    file: &str,
    bodies: Vec<Body>,
    given: Option<Unit>,
) -> Result<([Vec<Triangle>; 2], String), Failure> {
    let bodies = if bodies.len() > 1 { bodies } else { shells(&bodies) };
    let whole: Vec<Triangle> = bodies.iter().flat_map(|body| body.triangles.clone()).collect();
    let (unit, _) = unit([file, file], [&whole, &whole], given)?;
    let metres = unit.metres();
    let scaled = |body: &Body| body.triangles.iter().map(|t| t.map(|p| p * metres)).collect();
    let found = plugs(&bodies.iter().map(scaled).collect::<Vec<Vec<Triangle>>>());
    let names = |of: &[usize]| of.iter().map(|i| bodies[*i].name.clone()).collect::<Vec<_>>();
    let problem = match found.as_deref() {
        Ok([plug]) => {
            return Ok((pick(&bodies, &names(plug), file)?, quoted(&names(plug))));
        }
        Ok(several) => {
            let sets: Vec<_> = several.iter().map(|of| quoted(&names(of))).collect();
            format!("several bodies can be withdrawn: {}", sets.join("; or "))
        }
        Err(error) => format!("{error}; it has {}", listed(&bodies, metres)),
    };
    Err(Failure::in_file(file, format!("{problem}; name those of the plug with --plug-body")))
}

/// Formats names of bodies.
fn quoted(names: &[String]) -> String {
    joined(names.iter().map(|name| format!("`{name}`")))
}

/// Formats names and sizes of bodies; `metres` is the length unit of the file, m.
fn listed(bodies: &[Body], metres: f64) -> String {
    let size = |body: &Body| {
        let side = |axis| width(extent(body.triangles.iter().flatten(), axis)) * metres / MM;
        format!("`{}` ({:.1} x {:.1} x {:.1} mm)", body.name, side(0), side(1), side(2))
    };
    joined(bodies.iter().map(size))
}

/// Joins at most [`MAX_LISTED`] items by commas, and appends the number of the others.
fn joined(items: impl ExactSizeIterator<Item = String>) -> String {
    let more = items.len().saturating_sub(MAX_LISTED);
    let shown = items.take(MAX_LISTED).collect::<Vec<_>>().join(", ");
    if more > 0 { format!("{shown} and {more} more") } else { shown }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_task_is_called_like_the_file_of_a_maker() {
        let name = name_of(Path::new("parts/USB-C plug v1.2 (JAE).STEP"));
        assert_eq!(name, "USB-C-plug-v1-2--JAE-");
        assert!(insertion::task::checked_name(&name).is_ok());
    }
}
