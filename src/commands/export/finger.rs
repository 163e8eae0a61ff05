//! `optimize export finger`: exports a finger for printing.

use crate::setup::film::extension;
use crate::setup::printed::{PrintChoice, PrintRequest};
use crate::studies::study_name;
use crate::{Context, Failure, Output, command};
use clap::ValueEnum;
use connector::mesh::axes::value;
use finray::export::prism::{Prism, PrismError};
use finray::export::sheet::SheetData;
use finray::export::{self, profile, sheet, slicer};
use finray::geometry::Geometry;
use finray::mechanics;
use serde::Serialize;
use std::collections::BTreeSet;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use study::write_file;

/// Export a finger for the printer: the best of a study, or one with a given infill
///
/// The two fingers of a gripper are identical. STL, 3MF and DXF contain every rib; in the
/// projects for slicers, the slicer fills the outline with its own ribs.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: optimize export finger results/rj45-gp-seed0 --out finger.stl")]
pub struct Request {
    /// The finger.
    #[command(flatten)]
    pub finger: PrintRequest,
    /// File format [default: by the extension of FILE]
    #[arg(long, value_enum)]
    pub format: Option<Format>,
    /// File to write
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

/// File format of a finger.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Closed surface, binary, mm
    Stl,
    /// Closed surface with its unit
    #[value(name = "3mf")]
    ThreeMf,
    /// Profile as closed polylines, mm
    Dxf,
    /// One page with drawing, dimensions and material
    Sheet,
    /// Outline and solid base with the settings of PrusaSlicer, in one 3MF; do not rotate it on the bed
    #[value(name = "prusaslicer-3mf")]
    PrusaslicerProject,
    /// The same for OrcaSlicer and Bambu Studio: open as a project
    #[value(name = "orcaslicer-3mf")]
    OrcaslicerProject,
}

/// Files that were written.
#[derive(Serialize)]
pub struct Written {
    /// The requested file.
    out: PathBuf,
    /// Title of the finger.
    title: String,
}

impl command::Request for Request {
    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let chosen = self.finger.chosen()?;
        chosen.notes.iter().for_each(|note| context.note(note));
        let geometry = &chosen.geometry;
        let (out, title) = (&self.out, export::title(geometry));
        match self.format()? {
            Format::Stl => {
                write_file(out, &closed(Prism::finger(geometry), geometry)?.stl(&title))?
            }
            Format::ThreeMf => {
                save(out, closed(Prism::finger(geometry), geometry)?.three_mf(&title))?;
            }
            Format::PrusaslicerProject => save(out, slicer::prusaslicer_project(geometry))?,
            Format::OrcaslicerProject => save(out, slicer::orcaslicer_project(geometry))?,
            Format::Dxf => write_file(out, &profile::dxf(geometry, &title))?,
            Format::Sheet => write_file(out, &draw_sheet(self.finger.dir.as_deref(), &chosen)?)?,
        }
        let text = format!("wrote {title}: {}\n", out.display());
        Ok(Output::new(text, Written { out: out.clone(), title }))
    }
}

impl Request {
    /// Returns the given format, or else that of the file's extension.
    fn format(&self) -> Result<Format, Failure> {
        let extension = extension(&self.out);
        let fits = |format: &&Format| format.extensions().contains(&&*extension);
        let of_extension = Format::value_variants().iter().find(fits);
        // A device has no extension.
        match (self.format, of_extension) {
            (Some(format), _) if !extension.is_empty() && !fits(&&format) => {
                let accepted = format.extensions().iter().map(|name| format!(".{name}"));
                let accepted = accepted.collect::<Vec<_>>().join(" or ");
                let (name, out) = (value(format), self.out.display());
                Err(Failure::usage(format!(
                    "--format {name} and --out {out} contradict each other: the file must end in {accepted}"
                )))
            }
            (Some(format), _) | (None, Some(&format)) => Ok(format),
            (None, None) => {
                let known = Format::value_variants().iter().flat_map(|format| format.extensions());
                let known: BTreeSet<_> = known.map(|name| format!(".{name}")).collect();
                let known = known.into_iter().collect::<Vec<_>>().join(", ");
                let out = self.out.display();
                Err(Failure::usage(format!("--out {out}: the file must end in one of {known}")))
            }
        }
    }
}

impl Format {
    /// Returns the accepted extensions, in lower case.
    fn extensions(self) -> &'static [&'static str] {
        match self {
            Format::Stl => &["stl"],
            Format::ThreeMf | Format::PrusaslicerProject | Format::OrcaslicerProject => &["3mf"],
            Format::Dxf => &["dxf"],
            Format::Sheet => &["html", "htm"],
        }
    }
}

/// Writes the bytes of a file.
fn save(out: &Path, bytes: Result<Vec<u8>, impl Display>) -> Result<(), Failure> {
    let bytes = bytes.map_err(|error| Failure::running(format!("{}: {error}", out.display())))?;
    Ok(write_file(out, &bytes)?)
}

/// Adds the finger file to the error of a surface that cannot be closed.
fn closed(prism: Result<Prism, PrismError>, geometry: &Geometry) -> Result<Prism, Failure> {
    prism.map_err(|error| Failure::usage(format!("{}: {error}", geometry.finger.file)))
}

/// Draws the sheet of a finger.
fn draw_sheet(study: Option<&Path>, chosen: &PrintChoice) -> Result<String, Failure> {
    let ribs = mechanics::compute(&chosen.geometry)?;
    let measured = chosen.predicted_stiffness()?.map(|prediction| prediction.at_pad());
    let origin = &study.map_or(String::new(), study_name);
    Ok(sheet::html(&chosen.geometry, &SheetData { origin, ribs: &ribs, measured }))
}
