//! Bodies of plug and socket in the files that a user names.

use super::assembly::split;
use super::step;
use crate::context::Context;
use crate::failure::Failure;
use connector::mesh::axes::{Unit, value};
use connector::mesh::{Body, Files, Triangle, is_step, pick, read};
use std::path::Path;

/// Largest mesh file, bytes.
const LARGEST_FILE: u64 = 200 << 20;

/// Requested files and bodies of a plug and its socket.
pub struct PartsRequest<'a> {
    /// File of the plug, or of both.
    pub plug: &'a Path,
    /// File of the socket.
    pub socket: &'a Path,
    /// Whether one file contains both in their mated pose.
    pub assembled: bool,
    /// Bodies of the plug.
    pub plug_body: &'a [String],
    /// Bodies of the socket.
    pub socket_body: &'a [String],
    /// Unit of the files.
    pub unit: Option<Unit>,
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
pub fn parts(
    files: Files,
    request: &PartsRequest,
    context: &Context<'_>,
) -> Result<Parts, Failure> {
    let (plug, plug_step) = bodies(request.plug, files[0], context)?;
    let both = request.socket == request.plug;
    let (socket, socket_step) =
        if both { (plug.clone(), plug_step) } else { bodies(request.socket, files[1], context)? };
    let unit = if plug_step || socket_step { Some(Unit::Mm) } else { request.unit };
    if let Some(other) = request.unit.filter(|given| Some(*given) != unit) {
        let problem =
            format!("--unit {}: STEP files contain their unit; leave it out", value(other));
        return Err(Failure::usage(problem));
    }
    let mut finding = None;
    let pick = |of: &[Body], names: &[String], file: &str| {
        let picked = (!names.is_empty()).then(|| pick(of, names, file));
        picked.transpose().map_err(Failure::input)
    };
    let plug_body = pick(&plug, request.plug_body, files[0])?;
    let socket_body = pick(&socket, request.socket_body, files[1])?;
    let all = |bodies: Vec<Body>| bodies.into_iter().flat_map(|body| body.triangles).collect();
    let triangles = match (plug_body, socket_body) {
        (Some([plug, _]), Some([socket, _])) => [plug, socket],
        (Some([plug, rest]), None) => [plug, if both { rest } else { all(socket) }],
        (None, Some([socket, rest])) => [if both { rest } else { all(plug) }, socket],
        (None, None) if request.assembled => {
            let (parts, names) = split(files[0], plug, unit)?;
            finding = Some(("plug's bodies", format!("{names}; --plug-body names others")));
            parts
        }
        (None, None) if both => {
            let names: Vec<_> = plug.iter().map(|body| format!("`{}`", body.name)).collect();
            return Err(Failure::usage(format!(
                "{} has the bodies {}: give --socket, or name those of the plug with --plug-body",
                files[0],
                names.join(", ")
            )));
        }
        (None, None) => [all(plug), all(socket)],
    };
    Ok(Parts { triangles, unit, finding })
}

/// Reads the bodies of a file; returns them, and whether the file is STEP, which is converted to mm.
fn bodies(path: &Path, file: &str, context: &Context<'_>) -> Result<(Vec<Body>, bool), Failure> {
    let unreadable =
        |error: std::io::Error| Failure::in_file(file, format!("cannot read the mesh: {error}"));
    let opened = std::fs::File::open(path).map_err(unreadable)?;
    let bytes = input::files::read_up_to(opened, LARGEST_FILE).map_err(unreadable)?;
    if is_step(&bytes, &path.display().to_string()) {
        return Ok((step::bodies(path, file, context)?, true));
    }
    Ok((read(&bytes, file).map_err(Failure::input)?, false))
}
