//! `optimize task import`: creates a task from meshes of plug and socket.

use crate::command;
use crate::context::{Context, not_stopped};
use crate::failure::Failure;
use crate::layout::wrapped;
use crate::setup::assembly::split;
use crate::setup::mated::{Given, LeftOut, MatedTask, NoTask, mated};
use crate::setup::request::DEFAULT_ROBOT;
use crate::setup::step;
use crate::setup::task::{TaskCheck, TaskFile, read_task};
use crate::setup::tune::{Tried, begun, brief, chosen};
use connector::draft::{DENSITY, Size};
use connector::mesh::import::{ALLOWED, Along, Imported, Jaws, Request as Meshes, Unit, import};
use connector::mesh::mated::Interference;
use connector::mesh::place::{Placed, placed, value};
use connector::mesh::{Body, Triangle, is_step, pick, read};
use connector::tune::Tuned;
use connector::write::{self, Notes};
use input::shipped::Source;
use input::units::MM;
use insertion::task::Task;
use insertion::task::parts_file::{PartsFile, joined, sha256};
use insertion::trial::engine::EngineKind;
use serde::{Serialize, Serializer};
use std::fmt;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use study::write_file;

const RESOLUTIONS: [u32; 2] = [8, 1000];
/// Voxels unless said otherwise.
const RESOLUTION: u32 = 64;
/// Most parts that are written into the task file.
const MOST_INLINE: usize = 30;
/// Depths to be reached in a through hole, mm.
const DEPTHS_MM: RangeInclusive<f64> = 0.4..=300.0;
/// Largest mesh file, bytes.
const LARGEST_FILE: u64 = 200 << 20;

/// Create a task from meshes of a plug and its socket (STL, OBJ or STEP)
///
/// Give one file that holds both in their mated pose, or one of each with --plug and --socket, in any pose. STEP needs the
/// Python package with its extra `step`. Shapes about one opening that can be cut into convex pieces, such as extruded outlines, are cut; the plug's tip is
/// aligned with the middle of the opening. Of others the mated pose is found, whatever the frames of the files,
/// and the faces that the two can touch become thin convex parts in a file beside the task; faces that overlap in the
/// mated pose, such as unloaded contact springs, are listed and left out.
/// Unit, direction and axis of the jaws are derived from the shapes and printed, unless they are given. Grip and
/// strategy are derived from the shapes, or, about one opening, taken from another task with --like.
#[derive(Debug, Clone, clap::Args)]
#[command(
    display_order = 4,
    after_help = "Example: optimize task import --plug plug.stl --socket socket.stl --out mine.toml"
)]
pub struct Request {
    /// Mesh of plug and socket in their mated pose; the plug is what can be withdrawn
    #[arg(conflicts_with_all = ["plug", "socket"])]
    pub assembly: Option<PathBuf>,
    /// Mesh of the plug, or of both
    #[arg(long, value_name = "P.stl", required_unless_present = "assembly")]
    pub plug: Option<PathBuf>,
    /// Mesh of the socket [default: the rest of the plug's file without --plug-body]
    #[arg(long, value_name = "S.stl")]
    pub socket: Option<PathBuf>,
    /// Body of the file that belongs to the plug: `o` or `g` of an OBJ, `solid` of a text STL, or the number of
    /// a shell, from 1; may be repeated [default: all, or the rest without --socket-body]
    #[arg(long, value_name = "NAME")]
    pub plug_body: Vec<String>,
    /// Body of its file that belongs to the socket; may be repeated
    #[arg(long, value_name = "NAME")]
    pub socket_body: Vec<String>,
    /// Unit of both files [default: the one with a plausible plug and clearance]
    #[arg(long, value_enum)]
    pub unit: Option<Unit>,
    /// Direction of insertion in the files [default: the one with a hole for the plug's end]
    #[arg(long, value_name = "AXIS", value_enum, allow_hyphen_values = true)]
    pub insert_along: Option<Along>,
    /// Axis of the files along which the jaws close [default: y, or the one across which the plug has two
    /// parallel faces for the pads]
    #[arg(long, value_name = "AXIS", value_enum)]
    pub jaws: Option<Jaws>,
    /// Task for all but the shapes: grip, friction, strategy, success
    #[arg(long, value_name = "T")]
    pub like: Option<String>,
    /// Voxels along the longest side of an approximated mesh; without effect, since meshes are exact within 0.02 mm
    #[arg(long, value_name = "N", default_value_t = RESOLUTION,
          value_parser = clap::value_parser!(u32).range(i64::from(RESOLUTIONS[0])..=i64::from(RESOLUTIONS[1])))]
    pub resolution: u32,
    /// Handle on a plug that has no place to hold, width between the jaws x height x length in mm
    /// [default: 10x12x20 where one is needed]
    #[arg(long, value_name = "WxHxL")]
    pub body: Option<Size>,
    /// Depth to be reached in a through hole, mm [default: that over which plug and socket engage]
    #[arg(long, value_name = "MM")]
    pub depth_mm: Option<f64>,
    /// File to write [default: the plug's name with .toml]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Contact engine for the nominal start
    #[arg(long, value_enum, default_value_t)]
    pub engine: EngineKind,
    /// Names of plug and socket in messages and in the task file [default: their paths]
    #[arg(long, hide = true, num_args = 2, allow_hyphen_values = true)]
    pub names: Vec<String>,
}

/// A task that was imported and written.
pub struct ImportedTask {
    found: Found,
    /// The strategies that were tried; none if the file has problems.
    tuned: Option<Tuned>,
    /// Check of the written file, with its nominal start.
    checked: TaskCheck,
    out: PathBuf,
    resolution: u32,
}

/// Plug and socket as they were read.
struct Read {
    triangles: [Vec<Triangle>; 2],
    /// Unit, if it is known.
    unit: Option<Unit>,
    /// Finding about the bodies of an assembly.
    said: Option<(&'static str, String)>,
}

/// Task before it is written.
struct Found {
    /// The task, and how far it is from the meshes.
    imported: Imported,
    /// Unit of the files.
    unit: Unit,
    /// Direction of insertion in the files.
    along: Along,
    /// Findings and repairs: the subject and a sentence.
    said: Vec<(&'static str, String)>,
    /// Whether the normals of plug and of socket pointed inward.
    inward: [bool; 2],
    /// What was left out of the shapes, because the mated pair overlaps there.
    left_out: Vec<Interference>,
}

impl command::Request for Request {
    type Response = ImportedTask;

    fn run(&self, context: &Context<'_>) -> Result<ImportedTask, Failure> {
        let stop = context.stop;
        let out = &self.out();
        if let Some(depth) = self.depth_mm.filter(|depth| !DEPTHS_MM.contains(depth)) {
            let [low, high] = [DEPTHS_MM.start(), DEPTHS_MM.end()];
            let problem =
                format!("--depth-mm: is {depth} mm; it must be within {low} .. {high} mm");
            return Err(Failure::usage(problem));
        }
        if out.exists() {
            let file = out.display();
            return Err(Failure::usage(format!("{file} exists; name another file with --out")));
        }
        let mut found = self.found(context)?;
        not_stopped(stop)?;
        let (task, tuned) = begun(found.imported.task, self.engine, stop)?;
        found.imported.task = task;
        let written = self.write(out, &found)?;
        let checked = TaskCheck::of(written.source, DEFAULT_ROBOT, self.engine, stop)?;
        let (out, resolution) = (out.clone(), self.resolution);
        Ok(ImportedTask { found, tuned, checked, out, resolution })
    }
}

impl Request {
    /// Returns the names of plug and socket in messages.
    fn called(&self) -> [String; 2] {
        let paths = || [self.plug(), self.socket()].map(|path| path.display().to_string());
        <[String; 2]>::try_from(self.names.clone()).unwrap_or_else(|_| paths())
    }

    /// Returns the file to write.
    fn out(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| {
            let stem = self.plug().file_stem().unwrap_or_default();
            PathBuf::from(stem).with_extension("toml")
        })
    }

    /// Writes the task; many parts lie in a file of their own beside it.
    fn write(&self, out: &Path, found: &Found) -> Result<TaskFile, Failure> {
        let (task, mut notes) = (&found.imported.task, self.notes(found));
        let file = out.display().to_string();
        if task.plug.parts.len() + task.socket.len() <= MOST_INLINE {
            let written = TaskFile::parse(Source { file, text: write::task(task, &notes) })?;
            write_file(out, &written.source.text)?;
            return Ok(written);
        }
        let (beside, parts) = (out.with_extension("parts.toml"), write::parts_file(task));
        let name = beside.file_name().unwrap_or_default().to_string_lossy().into_owned();
        notes.parts = Some(PartsFile { file: name, sha256: sha256(&parts) });
        let text = write::task(task, &notes);
        let written = TaskFile::parse(Source { file, text: joined(&text, &parts) })?;
        write_file(&beside, &parts)?;
        let whole = write_file(out, &text);
        if whole.is_err() {
            // Parts without their task are of no use.
            let _ = std::fs::remove_file(&beside);
        }
        whole?;
        Ok(written)
    }

    /// Returns the task of shapes that are cut exactly about one opening; of others that of their skins in the mated
    /// pose.
    fn found(&self, context: &Context<'_>) -> Result<Found, Failure> {
        let like = self.like.as_deref().map(read_task).transpose()?;
        let files = self.called();
        let Read { triangles: bodies, unit, said } = self.bodies([&files[0], &files[1]])?;
        let bodies = &bodies;
        let about_opening =
            self.assembly.is_none() && self.body.is_none() && self.depth_mm.is_none();
        let exact = match about_opening {
            true => self.exact(bodies, unit, like.as_ref(), &|what| context.note(what)).map(Some),
            false => Ok(None),
        };
        match exact {
            Ok(Some(found)) if found.imported.exact == [true; 2] => Ok(found),
            Err(error) if error.exit_code() != 2 => Err(error),
            other => {
                not_stopped(context.stop)?;
                match self.mated(bodies, unit, like.as_ref(), context) {
                    Ok(mut found) => {
                        found.said.extend(said);
                        Ok(found)
                    }
                    // What fits nowhere is told as by the drawing.
                    Err(NoTask::NoMate(error)) => other.and(Err(error)),
                    Err(NoTask::Other(error)) => Err(error),
                }
            }
        }
    }

    fn name(&self) -> String {
        self.out().file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
    }

    fn mated(
        &self,
        [plug, socket]: &[Vec<Triangle>; 2],
        unit: Option<Unit>,
        like: Option<&TaskFile>,
        context: &Context<'_>,
    ) -> Result<Found, NoTask> {
        let files = self.called();
        let name = self.name();
        let given = Given {
            name: &name,
            unit,
            assembled: self.assembly.is_some(),
            along: self.insert_along,
            jaws: self.jaws,
            like: like.map(|like| &like.task),
            handle: self.body.map(|size| [size.height, size.width, size.length]),
            depth: self.depth_mm.map(|depth| depth * MM),
            closeup: &self.out().with_extension("place.svg"),
        };
        let found = mated([&files[0], &files[1]], [plug, socket], &given, context)?;
        let MatedTask { made, unit, along, jaws, inward, play, said } = found;
        let grip = made.task.grip;
        let body = [grip.faces_y[1] - grip.faces_y[0], made.held, grip.shoulder_z + made.mated_z()];
        let imported = Imported {
            task: Task { description: described(&files), ..made.task },
            exact: [true; 2],
            jaws,
            play,
            chamfer: [0.0; 3],
            body,
            intrusion: None,
        };
        Ok(Found { imported, unit, along, said, inward, left_out: made.interference })
    }

    fn exact(
        &self,
        [plug, socket]: &[Vec<Triangle>; 2],
        unit: Option<Unit>,
        like: Option<&TaskFile>,
        say: &dyn Fn(&str),
    ) -> Result<Found, Failure> {
        let files = self.called();
        let named = [&*files[0], &*files[1]];
        let placed = placed([plug, socket], named, unit, self.insert_along, say);
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
        let name = self.name();
        let request =
            Meshes { name: &name, along, jaws: self.jaws, like: like.map(|like| &like.task), say };
        let imported = import(plug, socket, &request).map_err(Failure::input)?;
        if self.jaws.is_none() {
            let why = format!(
                "{}: across it the plug has two faces {:.2} mm apart",
                value(imported.jaws),
                imported.body[0] / MM
            );
            said.push(("jaws along", why));
        }
        Ok(Found { imported, unit, along, said, inward, left_out: Vec::new() })
    }

    /// Returns the file of the plug.
    fn plug(&self) -> &Path {
        // One of the two is required.
        let given = self.assembly.as_ref().or(self.plug.as_ref());
        given.map_or(Path::new(""), PathBuf::as_path)
    }

    fn socket(&self) -> &Path {
        self.socket.as_ref().map_or(self.plug(), PathBuf::as_path)
    }

    /// Triangles of plug and socket, and their unit if it is known; of a file that has both, what one of them leaves is the
    /// other.
    fn bodies(&self, files: [&str; 2]) -> Result<Read, Failure> {
        let (plug, plug_step) = bodies(self.plug(), files[0])?;
        let both = self.socket() == self.plug();
        let (socket, socket_step) =
            if both { (plug.clone(), plug_step) } else { bodies(self.socket(), files[1])? };
        let unit = if plug_step || socket_step { Some(Unit::Mm) } else { self.unit };
        if let Some(other) = self.unit.filter(|given| Some(*given) != unit) {
            let problem =
                format!("--unit {}: STEP names its unit, and is read in mm", value(other));
            return Err(Failure::usage(problem));
        }
        let mut said = None;
        let pick = |of: &[Body], names: &[String], file: &str| {
            let picked = (!names.is_empty()).then(|| pick(of, names, file));
            picked.transpose().map_err(Failure::input)
        };
        let plug_body = pick(&plug, &self.plug_body, files[0])?;
        let socket_body = pick(&socket, &self.socket_body, files[1])?;
        let all = |bodies: Vec<Body>| bodies.into_iter().flat_map(|body| body.triangles).collect();
        let triangles = match (plug_body, socket_body) {
            (Some([plug, _]), Some([socket, _])) => [plug, socket],
            (Some([plug, rest]), None) => [plug, if both { rest } else { all(socket) }],
            (None, Some([socket, rest])) => [if both { rest } else { all(plug) }, socket],
            (None, None) if self.assembly.is_some() => {
                let (parts, names) = split(files[0], plug, unit)?;
                said = Some(("plug's bodies", format!("{names}; --plug-body names others")));
                parts
            }
            (None, None) if both => {
                let names: Vec<_> = plug.iter().map(|body| format!("`{}`", body.name)).collect();
                return Err(Failure::usage(format!(
                    "{} has the bodies {}: give --socket, or say which is the plug with --plug-body",
                    files[0],
                    names.join(", ")
                )));
            }
            (None, None) => [all(plug), all(socket)],
        };
        Ok(Read { triangles, unit, said })
    }

    fn notes(&self, Found { imported, unit, along, left_out, .. }: &Found) -> Notes {
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
        let (head, left_out) = (vec![head.replace(['\n', '\r'], " ")], !left_out.is_empty());
        Notes { head, mass, parts: None, left_out }
    }
}

/// One-line description of a task from these files.
fn described(files: &[String; 2]) -> String {
    let name = |file: &String| {
        let name = Path::new(file).file_name();
        name.map_or(file.clone(), |name| name.to_string_lossy().into_owned())
    };
    match files[0] == files[1] {
        true => format!("from {}", name(&files[0])),
        false => format!("from {} and {}", name(&files[0]), name(&files[1])),
    }
}

/// Bodies of a file, and whether it is STEP, which names its unit and is read in mm.
fn bodies(path: &Path, file: &str) -> Result<(Vec<Body>, bool), Failure> {
    let unreadable =
        |error: std::io::Error| Failure::in_file(file, format!("cannot read the mesh: {error}"));
    let opened = std::fs::File::open(path).map_err(unreadable)?;
    let bytes = input::files::read_up_to(opened, LARGEST_FILE).map_err(unreadable)?;
    if is_step(&bytes, &path.display().to_string()) {
        return Ok((step::bodies(path, file)?, true));
    }
    Ok((read(&bytes, file).map_err(Failure::input)?, false))
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
    left_out: Vec<LeftOut>,
    warning: Option<String>,
    out: String,
    tuned: Option<Tried<'a>>,
    check: &'a TaskCheck,
}

impl ImportedTask {
    /// Returns the keys of `--json`, and the text.
    fn told(&self) -> (Fields<'_>, String) {
        let ImportedTask { found, tuned, checked, out, resolution } = self;
        let Found { imported, unit, along, said, inward, left_out } = found;
        let [plug, socket] = imported.parts();
        let (depth, at, of) = match imported.intrusion {
            Some((depth, at, of)) => (depth / MM, at.coords / MM, of),
            None => (0.0, nalgebra::Vector3::zeros(), "plug"),
        };
        let clearance_mm = imported.clearance() / MM;
        let [play, chamfer, body] = [&imported.play[..], &imported.chamfer, &imported.body]
            .map(|lengths| lengths.iter().map(|v| v / MM).collect::<Vec<_>>());
        let warning = (depth > ALLOWED * clearance_mm).then(|| {
            format!(
                "parts reach {depth:.3} mm into the clearance of {clearance_mm:.3} mm, more than a tenth"
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
            left_out: left_out.iter().map(LeftOut::from).collect(),
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
