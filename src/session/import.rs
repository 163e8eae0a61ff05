//! A task from meshes of a plug and its socket.

use super::failure::{not_stopped, within};
use super::{DEFAULT_ROBOT, Failure, TaskCheck, TaskFile, begun, read_task};
use connector::draft::DENSITY;
use connector::mesh::import::{Along, COARSEST, Imported, Jaws, Request, Unit, import};
use connector::mesh::place::{Placed, placed, value};
use connector::mesh::{Body, Triangle, pick, read};
use connector::tune::Tuned;
use connector::write::{self, Notes};
use input::shipped::Source;
use input::units::MM;
use insertion::trial::engine::EngineKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use study::write_file;

const FINEST: u32 = 1000;
/// Voxels unless said otherwise.
const RESOLUTION: u32 = 64;
/// Largest mesh file, bytes.
const LARGEST_FILE: u64 = 200 << 20;

/// Which meshes to make a task of, and how.
#[derive(Debug, Clone, clap::Args)]
pub struct ImportRequest {
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
    /// What to call plug and socket in messages and in the task's file, if not by their paths
    #[arg(skip)]
    pub names: Option<[String; 2]>,
}

/// A task that was imported and written.
pub struct ImportedTask {
    /// The task, and how far it is from the meshes.
    pub imported: Imported,
    /// Unit of the files.
    pub unit: Unit,
    /// Direction of insertion in the files.
    pub along: Along,
    /// What was found out or mended, and why: what of, and a sentence.
    pub said: Vec<(&'static str, String)>,
    /// Whether the normals of plug and of socket pointed inward.
    pub inward: [bool; 2],
    /// The strategies that were tried; none if the file has problems.
    pub tuned: Option<Tuned>,
    /// What is wrong with the file that was written, and whether its nominal start inserts.
    pub checked: TaskCheck,
}

/// What is known of a task before it is written.
struct Found {
    imported: Imported,
    unit: Unit,
    along: Along,
    said: Vec<(&'static str, String)>,
    inward: [bool; 2],
}

impl ImportRequest {
    /// Import into a file, all else as usual.
    pub fn new(plug: PathBuf, socket: Option<PathBuf>, out: PathBuf) -> Self {
        ImportRequest {
            plug,
            socket,
            plug_body: None,
            socket_body: None,
            unit: None,
            insert_along: None,
            jaws: None,
            like: None,
            resolution: RESOLUTION,
            out,
            engine: EngineKind::default(),
            names: None,
        }
    }

    /// What messages call plug and socket.
    fn called(&self) -> [String; 2] {
        let paths = || [&self.plug, self.socket()].map(|path| path.display().to_string());
        self.names.clone().unwrap_or_else(paths)
    }

    /// Imports the meshes, writes the task's file and checks it; `say` gets progress messages.
    pub fn run(&self, say: &dyn Fn(&str), stop: &AtomicBool) -> Result<ImportedTask, Failure> {
        within("--resolution", self.resolution, &(COARSEST..=FINEST))?;
        let out = &self.out;
        if out.exists() {
            let file = out.display();
            return Err(Failure::usage(format!("{file} exists; name another file with --out")));
        }
        let mut found = self.found(say)?;
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
        Ok(ImportedTask { imported, unit, along, said, inward, tuned, checked })
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
        let request = Request {
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
