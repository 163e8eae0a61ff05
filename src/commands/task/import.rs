//! `optimize task import`: a task from meshes of plug and socket.

use crate::command;
use crate::context::{Context, not_stopped};
use crate::failure::Failure;
use crate::layout::wrapped;
use crate::setup::request::DEFAULT_ROBOT;
use crate::setup::task::{TaskCheck, TaskFile, read_task};
use crate::setup::tune::{Tried, begun, brief, chosen};
use connector::draft::DENSITY;
use connector::mesh::import::{
    ALLOWED, Along, COARSEST, Imported, Jaws, MOST_PARTS, Request as Meshes, Unit, import,
};
use connector::mesh::place::{Placed, placed, value};
use connector::mesh::{Body, Triangle, pick, read};
use connector::tune::Tuned;
use connector::write::{self, Notes};
use input::shipped::Source;
use input::units::MM;
use insertion::trial::engine::EngineKind;
use serde::{Serialize, Serializer};
use std::fmt;
use std::path::{Path, PathBuf};
use study::write_file;

const FINEST: u32 = 1000;
/// Voxels unless said otherwise.
const RESOLUTION: u32 = 64;
/// Largest mesh file, bytes.
const LARGEST_FILE: u64 = 200 << 20;

/// Write a task from meshes of a plug and its socket (STL or OBJ)
///
/// Extruded outlines and all else that can be cut into convex pieces is taken over exactly, the rest
/// is approximated by convex hulls (VHACD), and how far these reach into the clearance is measured.
/// The plug's tip and the middle of the socket's largest opening are laid over one another. Unit,
/// direction and the jaws' axis are found from the shapes and said, unless they are given. Grip and moves are derived from the shapes, or
/// taken from another task with --like.
#[derive(Debug, Clone, clap::Args)]
#[command(
    display_order = 4,
    after_help = "Example: optimize task import --plug plug.stl --socket socket.stl --out mine.toml"
)]
pub struct Request {
    /// Mesh of the plug, or of both
    #[arg(long, value_name = "P.stl")]
    pub plug: PathBuf,
    /// Mesh of the socket [default: what --plug-body leaves of the plug's file]
    #[arg(long, value_name = "S.stl")]
    pub socket: Option<PathBuf>,
    /// Body of the file that is the plug: `o` or `g` of an OBJ, `solid` of a text STL, or the number of
    /// a shell, from 1 [default: all, or what --socket-body leaves]
    #[arg(long, value_name = "NAME")]
    pub plug_body: Option<String>,
    /// Body of its file that is the socket
    #[arg(long, value_name = "NAME")]
    pub socket_body: Option<String>,
    /// Unit of both files [default: the one in which jaws hold the plug and the clearance is a connector's]
    #[arg(long, value_enum)]
    pub unit: Option<Unit>,
    /// Direction, in the files, in which the plug goes in [default: the one with a hole that takes the
    /// plug's end]
    #[arg(long, value_name = "AXIS", value_enum, allow_hyphen_values = true)]
    pub insert_along: Option<Along>,
    /// Axis of the files along which the jaws close [default: y, or the one across which the plug has two
    /// faces that pads hold]
    #[arg(long, value_name = "AXIS", value_enum)]
    pub jaws: Option<Jaws>,
    /// A task of which all but the shapes is taken: grip, friction, strategy, success
    #[arg(long, value_name = "T")]
    pub like: Option<String>,
    /// Voxels along the longest side, where a mesh is approximated
    #[arg(long, value_name = "N", default_value_t = RESOLUTION,
          value_parser = clap::value_parser!(u32).range(i64::from(COARSEST)..=i64::from(FINEST)))]
    pub resolution: u32,
    /// File to write
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Contact engine that tries the nominal start
    #[arg(long, value_enum, default_value_t)]
    pub engine: EngineKind,
    /// Names of plug and socket in messages and in the task file, in place of their paths
    #[arg(long, hide = true, num_args = 2, allow_hyphen_values = true)]
    pub names: Vec<String>,
}

/// A task that was imported and written.
pub struct ImportedTask {
    /// The task, and how far it is from the meshes.
    pub imported: Imported,
    /// Unit of the files.
    pub unit: Unit,
    /// Direction of insertion in the files.
    pub along: Along,
    /// Findings and repairs: the subject and a sentence.
    pub said: Vec<(&'static str, String)>,
    /// Whether the normals of plug and of socket pointed inward.
    pub inward: [bool; 2],
    /// The strategies that were tried; none if the file has problems.
    pub tuned: Option<Tuned>,
    /// Check of the written file, with its nominal start.
    pub checked: TaskCheck,
    out: PathBuf,
    resolution: u32,
}

/// Task before it is written.
struct Found {
    imported: Imported,
    unit: Unit,
    along: Along,
    said: Vec<(&'static str, String)>,
    inward: [bool; 2],
}

impl command::Request for Request {
    type Response = ImportedTask;

    fn run(&self, context: &Context<'_>) -> Result<ImportedTask, Failure> {
        let stop = context.stop;
        let out = &self.out;
        if out.exists() {
            let file = out.display();
            return Err(Failure::usage(format!("{file} exists; name another file with --out")));
        }
        let mut found = self.found(&|what| context.note(what))?;
        not_stopped(stop)?;
        let (task, tuned) = begun(found.imported.task, self.engine, stop)?;
        found.imported.task = task;
        let written = TaskFile::parse(Source {
            file: out.display().to_string(),
            text: write::task(&found.imported.task, &self.notes(&found)),
        })?;
        write_file(out, &written.source.text)?;
        let checked = TaskCheck::of(written.source, DEFAULT_ROBOT, self.engine, stop)?;
        let Found { imported, unit, along, said, inward } = found;
        let (out, resolution) = (out.clone(), self.resolution);
        Ok(ImportedTask { imported, unit, along, said, inward, tuned, checked, out, resolution })
    }
}

impl Request {
    /// Returns the names of plug and socket in messages.
    fn called(&self) -> [String; 2] {
        let paths = || [&self.plug, self.socket()].map(|path| path.display().to_string());
        <[String; 2]>::try_from(self.names.clone()).unwrap_or_else(|_| paths())
    }

    fn found(&self, say: &dyn Fn(&str)) -> Result<Found, Failure> {
        let like = self.like.as_deref().map(read_task).transpose()?;
        let files = self.called();
        let [plug, socket] = self.bodies([&files[0], &files[1]])?;
        let named = [&*files[0], &*files[1]];
        let placed = placed([&plug, &socket], named, self.unit, self.insert_along, say);
        let Placed { meshes: [plug, socket], unit, along, why_unit, why_along } =
            placed.map_err(Failure::input)?;
        if let Some(jaws) = self.jaws.filter(|jaws| !along.across().contains(jaws)) {
            let [a, b] = along.across().map(value);
            return Err(Failure::usage(format!(
                "--jaws {}: the plug goes in along {}; give {a} or {b}",
                value(jaws),
                value(along)
            )));
        }
        let mut said: Vec<(&str, String)> = Vec::new();
        said.extend(why_unit.map(|why| ("unit", format!("{}: {why}", value(unit)))));
        said.extend(why_along.map(|why| ("direction", format!("{}: {why}", value(along)))));
        for (what, mesh) in [("plug mended", &plug), ("socket mended", &socket)] {
            let (corners, far) = mesh.surface.mended;
            let why =
                format!("{corners} corners moved by up to {:.4} mm, to meet others", far / MM);
            said.extend((corners > 0).then_some((what, why)));
        }
        let inward = [&plug, &socket].map(|mesh| mesh.surface.was_inward);
        let stem = self.out.file_stem();
        let name = stem.map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let request = Meshes {
            name: &name,
            along,
            jaws: self.jaws,
            resolution: self.resolution,
            like: like.as_ref().map(|like| &like.task),
            say,
        };
        let imported = import(plug, socket, &request).map_err(Failure::input)?;
        if self.jaws.is_none() {
            let why = format!(
                "{}: across it the plug has two faces {:.2} mm apart",
                value(imported.jaws),
                imported.body[0] / MM
            );
            said.push(("jaws along", why));
        }
        Ok(Found { imported, unit, along, said, inward })
    }

    fn socket(&self) -> &PathBuf {
        self.socket.as_ref().unwrap_or(&self.plug)
    }

    /// Triangles of plug and socket; of a file that has both, what one of them leaves is the other.
    fn bodies(&self, files: [&str; 2]) -> Result<[Vec<Triangle>; 2], Failure> {
        let plug = bodies(&self.plug, files[0])?;
        let both = self.socket.as_ref().is_none_or(|socket| *socket == self.plug);
        let socket = if both { plug.clone() } else { bodies(self.socket(), files[1])? };
        let pick = |of: &[Body], name: &Option<String>, file: &str| {
            let picked = name.as_ref().map(|name| pick(of, name, file));
            picked.transpose().map_err(Failure::input)
        };
        let plug_body = pick(&plug, &self.plug_body, files[0])?;
        let socket_body = pick(&socket, &self.socket_body, files[1])?;
        let all = |bodies: Vec<Body>| bodies.into_iter().flat_map(|body| body.triangles).collect();
        Ok(match (plug_body, socket_body) {
            (Some([plug, _]), Some([socket, _])) => [plug, socket],
            (Some([plug, rest]), None) => [plug, if both { rest } else { all(socket) }],
            (None, Some([socket, rest])) => [if both { rest } else { all(plug) }, socket],
            (None, None) if both => {
                let names: Vec<_> = plug.iter().map(|body| format!("`{}`", body.name)).collect();
                return Err(Failure::usage(format!(
                    "{} has the bodies {}: give --socket, or say which is the plug with --plug-body",
                    files[0],
                    names.join(", ")
                )));
            }
            (None, None) => [all(plug), all(socket)],
        })
    }

    fn notes(&self, Found { imported, unit, along, .. }: &Found) -> Notes {
        let files = self.called();
        let how = |exact: bool| if exact { "exact" } else { "approximated" };
        let [plug, socket] = imported.exact.map(how);
        let mass = match &self.like {
            Some(like) => format!("As in {like}."),
            None => format!("Assumed: {DENSITY} kg/m3. Weigh yours."),
        };
        let head = format!(
            "Imported from {} ({plug}) and {} ({socket}), in {}, inserted along {}, jaws along {}.",
            files[0],
            files[1],
            value(*unit),
            value(*along),
            value(imported.jaws),
        );
        Notes { head: vec![head.replace(['\n', '\r'], " ")], mass }
    }
}

fn bodies(path: &Path, file: &str) -> Result<Vec<Body>, Failure> {
    let unreadable =
        |error: std::io::Error| Failure::in_file(file, format!("cannot read the mesh: {error}"));
    let opened = std::fs::File::open(path).map_err(unreadable)?;
    let bytes = input::files::read_up_to(opened, LARGEST_FILE).map_err(unreadable)?;
    read(&bytes, file).map_err(Failure::input)
}

#[derive(Serialize)]
struct Fields<'a> {
    parts: usize,
    plug_parts: usize,
    socket_parts: usize,
    plug_exact: bool,
    socket_exact: bool,
    largest_intrusion_mm: f64,
    intrusion_of: &'a str,
    intrusion_at_mm: [f64; 3],
    unit: String,
    insert_along: String,
    jaws: String,
    found: Vec<String>,
    clearance_mm: f64,
    clearance_x_mm: f64,
    clearance_y_mm: f64,
    chamfer_x_mm: f64,
    chamfer_y_mm: f64,
    chamfer_depth_mm: f64,
    body_mm: Vec<f64>,
    resolution: u32,
    resolution_needed: Option<u32>,
    plug_was_inward: bool,
    socket_was_inward: bool,
    warning: Option<String>,
    out: String,
    tuned: Option<Tried<'a>>,
    check: &'a TaskCheck,
}

impl ImportedTask {
    /// Returns the keys of `--json`, and the text.
    fn told(&self) -> (Fields<'_>, String) {
        let ImportedTask { imported, unit, along, said, inward, tuned, checked, out, resolution } =
            self;
        let [plug, socket] = imported.parts();
        let (depth, at, of) = match imported.intrusion {
            Some((depth, at, of)) => (depth / MM, at.coords / MM, of),
            None => (0.0, nalgebra::Vector3::zeros(), "plug"),
        };
        let clearance_mm = imported.clearance() / MM;
        let [play, chamfer, body] = [&imported.play[..], &imported.chamfer, &imported.body]
            .map(|lengths| lengths.iter().map(|v| v / MM).collect::<Vec<_>>());
        let exact = imported.exact[usize::from(of == "socket")];
        let warning = (depth > ALLOWED * clearance_mm).then(|| {
            let remedy = if exact { String::new() } else { bridged() };
            format!(
                "parts reach {depth:.3} mm into the clearance of {clearance_mm:.3} mm, more than a tenth{remedy}"
            )
        });
        let fields = Fields {
            parts: plug + socket,
            plug_parts: plug,
            socket_parts: socket,
            plug_exact: imported.exact[0],
            socket_exact: imported.exact[1],
            largest_intrusion_mm: depth,
            intrusion_of: of,
            intrusion_at_mm: [at.x, at.y, at.z],
            unit: value(*unit),
            insert_along: value(*along),
            jaws: value(imported.jaws),
            found: said.iter().map(|(what, why)| format!("{what} {why}")).collect::<Vec<_>>(),
            clearance_mm,
            clearance_x_mm: play[0],
            clearance_y_mm: play[1],
            chamfer_x_mm: chamfer[0],
            chamfer_y_mm: chamfer[1],
            chamfer_depth_mm: chamfer[2],
            body_mm: body.clone(),
            resolution: *resolution,
            resolution_needed: None,
            plug_was_inward: inward[0],
            socket_was_inward: inward[1],
            warning: warning.clone(),
            out: out.display().to_string(),
            tuned: tuned.as_ref().and_then(chosen),
            check: checked,
        };
        let how = |exact: bool| if exact { "exact" } else { "approximated by hulls" };
        let mut text = format!(
            "written       {}\nplug          {plug} convex parts, {}\nsocket        {socket} convex parts, {}\n\
             clearance     {:.2} mm in y, {:.2} in x; {}; body {:.1} x {:.1} x {:.1} mm\n\
             intrusion     {depth:.4} mm at most",
            out.display(),
            how(imported.exact[0]),
            how(imported.exact[1]),
            play[1],
            play[0],
            chamfered(&chamfer),
            body[0],
            body[1],
            body[2],
        );
        if depth > 0.0 {
            text.push_str(&format!(", of the {of}, at [{:.2}, {:.2}, {:.2}] mm", at.x, at.y, at.z));
        }
        text.push('\n');
        for (what, why) in said {
            text.push_str(&format!("{what:<14}{why}\n"));
        }
        for (name, inward) in ["plug", "socket"].into_iter().zip(inward) {
            if *inward {
                text.push_str(&format!("normals       of the {name} pointed inward; turned\n"));
            }
        }
        text.extend(warning.map(|warning| format!("warning       {warning}\n")));
        text.extend(tuned.iter().map(|tuned| brief("strategy", tuned)));
        (fields, wrapped(&(text + &checked.text())))
    }
}

impl Serialize for ImportedTask {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.told().0.serialize(serializer)
    }
}

impl command::Response for ImportedTask {
    fn verdict(&self) -> Result<(), Failure> {
        self.checked.ended(self.tuned.as_ref())
    }
}

impl fmt::Display for ImportedTask {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.told().1)
    }
}

/// Chamfer of the opening: its widths in x and in y and its depth, mm.
fn chamfered(chamfer: &[f64]) -> String {
    match chamfer {
        [x, y, depth] if *depth > 0.0 => {
            let width = if (x - y).abs() < 0.01 {
                format!("{y:.2} mm")
            } else {
                format!("{y:.2} mm in y, {x:.2} in x")
            };
            format!("chamfer {width} at the opening, {depth:.2} deep")
        }
        _ => "no chamfer at the opening".to_owned(),
    }
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
