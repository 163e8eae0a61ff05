//! A task from meshes of a plug and its socket.

use super::failure::not_stopped;
use super::{DEFAULT_ROBOT, Failure, TaskCheck, TaskFile, read_task};
use crate::connector::draft::DENSITY;
use crate::connector::mesh::import::{Along, COARSEST, Imported, Mesh, Request, Unit, import};
use crate::connector::mesh::{Surface, read};
use crate::connector::write::{self, Notes};
use crate::study::write_file;
use clap::ValueEnum;
use input::shipped::Source;
use insertion::trial::engine::EngineKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

const FINEST: u32 = 1000;
/// Largest mesh file, bytes.
const LARGEST_FILE: u64 = 200 << 20;

/// Which meshes to make a task of, and how.
#[derive(Debug, Clone, clap::Args)]
pub struct ImportRequest {
    /// Mesh of the plug
    #[arg(long, value_name = "P.stl")]
    pub plug: PathBuf,
    /// Mesh of the socket
    #[arg(long, value_name = "S.stl")]
    pub socket: PathBuf,
    /// Unit of both files
    #[arg(long, value_enum)]
    pub unit: Unit,
    /// Direction, in the files, in which the plug goes in
    #[arg(long, value_name = "AXIS", value_enum, default_value = "-z", allow_hyphen_values = true)]
    pub insert_along: Along,
    /// A task of which all but the shapes is taken: grip, friction, strategy, success
    #[arg(long, value_name = "T")]
    pub like: Option<String>,
    /// Voxels along the longest side, where a mesh is approximated
    #[arg(long, value_name = "N", default_value_t = 64,
          value_parser = clap::value_parser!(u32).range(i64::from(COARSEST)..=i64::from(FINEST)))]
    pub resolution: u32,
    /// File to write
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Contact engine that tries the nominal start
    #[arg(long, value_enum, default_value_t)]
    pub engine: EngineKind,
}

/// A task that was imported and written.
pub struct ImportedTask {
    /// The task, and how far it is from the meshes.
    pub imported: Imported,
    /// Whether the normals of plug and of socket pointed inward.
    pub inward: [bool; 2],
    /// What is wrong with the file that was written, and whether its nominal start inserts.
    pub checked: TaskCheck,
}

impl ImportRequest {
    /// Imports the meshes, writes the task's file and checks it; `say` gets progress messages.
    pub fn run(&self, say: &dyn Fn(&str), stop: &AtomicBool) -> Result<ImportedTask, Failure> {
        let out = &self.out;
        if out.exists() {
            let file = out.display();
            return Err(Failure::usage(format!("{file} exists; name another file with --out")));
        }
        let (imported, inward) = self.imported(say)?;
        not_stopped(stop)?;
        // All is known of the shapes here, and nothing is written.
        let written = TaskFile::parse(Source {
            file: out.display().to_string(),
            text: write::task(&imported.task, &self.notes(&imported)),
        })?;
        write_file(out, &written.source.text)?;
        let checked = TaskCheck::of(written.source, DEFAULT_ROBOT, self.engine)?;
        Ok(ImportedTask { imported, inward, checked })
    }

    fn imported(&self, say: &dyn Fn(&str)) -> Result<(Imported, [bool; 2]), Failure> {
        let like = self.like.as_deref().map(read_task).transpose()?;
        let [plug, socket] = [mesh(&self.plug, self.unit)?, mesh(&self.socket, self.unit)?];
        let inward = [&plug, &socket].map(|mesh| mesh.surface.was_inward);
        let stem = self.out.file_stem();
        let name = stem.map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let request = Request {
            name: &name,
            along: self.insert_along,
            resolution: self.resolution,
            like: like.as_ref().map(|like| &like.task),
            say,
        };
        Ok((import(plug, socket, &request).map_err(Failure::input)?, inward))
    }

    fn notes(&self, imported: &Imported) -> Notes {
        let how = |exact: bool| if exact { "exact" } else { "approximated" };
        let [plug, socket] = imported.exact.map(how);
        let along = self.insert_along.to_possible_value();
        let mass = match &self.like {
            Some(like) => format!("As in {like}."),
            None => format!("Assumed: {DENSITY} kg/m3. Weigh yours."),
        };
        let head = format!(
            "Imported from {} ({plug}) and {} ({socket}), inserted along {}.",
            self.plug.display(),
            self.socket.display(),
            along.as_ref().map_or("", |value| value.get_name()),
        );
        Notes { head: vec![head.replace(['\n', '\r'], " ")], mass }
    }
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
