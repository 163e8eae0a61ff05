//! `optimize task import`: a task from meshes of plug and socket.

use super::super::{Failure, print, print_json, say};
use super::check;
use crate::connector::mesh::import::{
    ALLOWED, Along, COARSEST, Imported, MOST_PARTS, Mesh, Request, import,
};
use crate::connector::mesh::{Surface, read};
use crate::connector::write::{self, Notes};
use crate::session::{DEFAULT_ROBOT, TaskCheck, TaskFile, read_task};
use crate::study::write_file;
use clap::{Args, ValueEnum};
use input::shipped::Source;
use input::units::MM;
use insertion::trial::engine::EngineKind;
use serde_json::json;
use std::path::{Path, PathBuf};

const FINEST: u32 = 1000;
/// Largest mesh file, bytes.
const LARGEST_FILE: u64 = 200 << 20;

/// Write a task from meshes of a plug and its socket (STL or OBJ)
///
/// Extruded outlines and all else that can be cut into convex pieces is taken over exactly, the rest
/// is approximated by convex hulls (VHACD), and how far these reach into the clearance is measured.
/// The plug's tip and the middle of the socket's largest opening are laid over one another. The jaws
/// close along y (x, if the plug goes in along y). Grip and moves are derived from the shapes, or
/// taken from another task with --like.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Mesh of the plug
    #[arg(long, value_name = "P.stl")]
    plug: PathBuf,
    /// Mesh of the socket
    #[arg(long, value_name = "S.stl")]
    socket: PathBuf,
    /// Unit of both files
    #[arg(long, value_enum)]
    unit: Unit,
    /// Direction, in the files, in which the plug goes in
    #[arg(long, value_name = "AXIS", value_enum, default_value = "-z", allow_hyphen_values = true)]
    insert_along: Along,
    /// A task of which all but the shapes is taken: grip, friction, strategy, success
    #[arg(long, value_name = "T")]
    like: Option<String>,
    /// Voxels along the longest side, where a mesh is approximated
    #[arg(long, value_name = "N", default_value_t = 64,
          value_parser = clap::value_parser!(u32).range(i64::from(COARSEST)..=i64::from(FINEST)))]
    resolution: u32,
    /// File to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Contact engine that tries the nominal start
    #[arg(long, value_enum, default_value_t)]
    engine: EngineKind,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Unit of length of a mesh file.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Unit {
    /// Millimetres
    Mm,
    /// Inches
    In,
    /// Metres
    M,
}

impl Unit {
    fn metres(self) -> f64 {
        match self {
            Unit::Mm => MM,
            Unit::In => 25.4 * MM,
            Unit::M => 1.0,
        }
    }
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let out = &arguments.out;
    if out.exists() {
        let file = out.display();
        return Err(Failure::usage(format!("{file} exists; name another file with --out")));
    }
    let like = arguments.like.as_deref().map(read_task).transpose()?;
    let [plug, socket] =
        [mesh(&arguments.plug, arguments.unit)?, mesh(&arguments.socket, arguments.unit)?];
    let inward = [&plug, &socket].map(|mesh| mesh.surface.was_inward);
    let name = out.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let request = Request {
        name: &name,
        along: arguments.insert_along,
        resolution: arguments.resolution,
        like: like.as_ref().map(|like| &like.task),
        say: &|what| say(what),
    };
    let imported = import(plug, socket, &request).map_err(Failure::input)?;
    let written = TaskFile::parse(Source {
        file: out.display().to_string(),
        text: write::task(&imported.task, &notes(arguments, &imported)),
    })?;
    write_file(out, &written.source.text)?;
    let checked = TaskCheck::of(written.source, DEFAULT_ROBOT, arguments.engine)?;
    report(arguments, &imported, inward, &checked)
}

fn mesh(path: &Path, unit: Unit) -> Result<Mesh, Failure> {
    let file = path.display().to_string();
    let unreadable =
        |error: std::io::Error| Failure::usage(format!("{file}: cannot read the mesh: {error}"));
    let opened = std::fs::File::open(path).map_err(unreadable)?;
    let bytes = input::files::read_up_to(opened, LARGEST_FILE).map_err(unreadable)?;
    let triangles = read(&bytes, &file).map_err(Failure::input)?;
    let surface = Surface::new(&triangles, unit.metres(), &file).map_err(Failure::input)?;
    Ok(Mesh { file, surface })
}

fn notes(arguments: &Arguments, imported: &Imported) -> Notes {
    let how = |exact: bool| if exact { "exact" } else { "approximated" };
    let [plug, socket] = imported.exact.map(how);
    let along = arguments.insert_along.to_possible_value();
    let mass = match &arguments.like {
        Some(like) => format!("As in {like}."),
        None => format!("Assumed: {} kg/m3. Weigh yours.", crate::connector::draft::DENSITY),
    };
    Notes {
        head: vec![
            format!(
                "Imported from {} ({plug}) and {} ({socket}), inserted along {}.",
                arguments.plug.display(),
                arguments.socket.display(),
                along.as_ref().map_or("", |value| value.get_name()),
            )
            .replace(['\n', '\r'], " "),
        ],
        mass,
    }
}

fn report(
    arguments: &Arguments,
    imported: &Imported,
    inward: [bool; 2],
    checked: &TaskCheck,
) -> Result<(), Failure> {
    let [plug, socket] = imported.parts();
    let (depth, at, of) = match imported.intrusion {
        Some((depth, at, of)) => (depth / MM, at.coords / MM, of),
        None => (0.0, nalgebra::Vector3::zeros(), "plug"),
    };
    let clearance_mm = imported.clearance / MM;
    let exact = imported.exact[usize::from(of == "socket")];
    let warning = (depth > ALLOWED * clearance_mm).then(|| {
        let remedy = if exact { String::new() } else { bridged() };
        format!(
            "parts reach {depth:.3} mm into the clearance of {clearance_mm:.3} mm, more than a tenth{remedy}"
        )
    });
    if arguments.json {
        return print_json(&json!({
            "parts": plug + socket,
            "plug_parts": plug,
            "socket_parts": socket,
            "plug_exact": imported.exact[0],
            "socket_exact": imported.exact[1],
            "largest_intrusion_mm": depth,
            "intrusion_of": of,
            "intrusion_at_mm": [at.x, at.y, at.z],
            "clearance_mm": clearance_mm,
            "resolution": arguments.resolution,
            // None is known to do: see `bridged`.
            "resolution_needed": null,
            "plug_was_inward": inward[0],
            "socket_was_inward": inward[1],
            "warning": warning,
            "out": arguments.out.display().to_string(),
            "check": check::json(checked),
        }));
    }
    let how = |exact: bool| if exact { "exact" } else { "approximated by hulls" };
    let mut text = format!(
        "written       {}\nplug          {plug} convex parts, {}\nsocket        {socket} convex parts, {}\n\
         clearance     {clearance_mm:.3} mm (opening less plug)\n\
         intrusion     {depth:.4} mm at most",
        arguments.out.display(),
        how(imported.exact[0]),
        how(imported.exact[1]),
    );
    if depth > 0.0 {
        text.push_str(&format!(", of the {of}, at [{:.2}, {:.2}, {:.2}] mm", at.x, at.y, at.z));
    }
    text.push('\n');
    for (name, inward) in ["plug", "socket"].into_iter().zip(inward) {
        if inward {
            text.push_str(&format!("normals       of the {name} pointed inward; turned\n"));
        }
    }
    text.extend(warning.map(|warning| format!("warning       {warning}\n")));
    print(&(text + &check::text(checked)))
}

/// Remedy where hulls reach into the clearance. Two voxels across a tenth of it would be more than
/// there is time for, and hulls bridge what is hollow by more than that (docs/guide/tasks.md).
fn bridged() -> String {
    format!(
        ": hulls bridge what is hollow, and no --resolution mends that; export the mesh with fewer flats \
         (what makes up to {MOST_PARTS} convex pieces is cut exactly), begin with `optimize task new --round`, \
         or write the parts about it by hand (docs/guide/tasks.md)"
    )
}
