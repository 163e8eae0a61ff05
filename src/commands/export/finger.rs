//! `optimize export finger`: exports a finger for printing.

use crate::command;
use crate::context::Context;
use crate::failure::Failure;
use crate::setup::printed::PrintRequest;
use clap::ValueEnum;
use finray::export::prism::Prism;
use finray::export::sheet::AtPad;
use finray::export::{self, profile, sheet, slicer};
use finray::geometry::Geometry;
use finray::mechanics;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};
use study::write_file;

/// A finger for the printer: the best of a study, or of an infill
///
/// Both fingers of a gripper are this part. STL, 3MF, DXF and SVG have every rib of it; the
/// settings for slicers are for its outline, which is written beside them and which the slicer
/// fills with its own ribs.
#[derive(Debug, Clone, clap::Args)]
#[command(
    display_order = 2,
    after_help = "Example: optimize export finger results/rj45-gp-seed0 --format stl --out finger.stl"
)]
pub struct Request {
    /// Which finger.
    #[command(flatten)]
    pub finger: PrintRequest,
    /// Format of the file
    #[arg(long, value_enum)]
    pub format: Format,
    /// File to write
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

/// Output format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Closed surface, binary, mm
    Stl,
    /// Closed surface with its unit
    #[value(name = "3mf")]
    ThreeMf,
    /// Profile, true to size
    Svg,
    /// Profile as closed polylines, mm
    Dxf,
    /// One page to print by: drawing, dimensions, material; FILE ends in .svg or .html
    Sheet,
    /// Profile of settings to import in Cura (.curaprofile), with the outline beside it
    Cura,
    /// Configuration of PrusaSlicer (.ini), with the outline beside it
    Prusaslicer,
}

/// Files that were written.
#[derive(Serialize)]
pub struct Written {
    /// The requested file.
    out: PathBuf,
    /// Title of the finger.
    title: String,
    /// Outline and base, for slicer settings.
    beside: Vec<PathBuf>,
}

impl command::Request for Request {
    type Response = Written;

    fn run(&self, _context: &Context<'_>) -> Result<Written, Failure> {
        let geometry = self.finger.geometry()?;
        let (out, title) = (&self.out, export::title(&geometry));
        match self.format {
            Format::Stl => {
                write_file(out, &closed(Prism::finger(&geometry), &geometry)?.stl(&title))?
            }
            Format::ThreeMf => {
                let bytes = closed(Prism::finger(&geometry), &geometry)?
                    .three_mf(&title)
                    .map_err(|error| Failure::running(format!("{}: {error}", out.display())))?;
                write_file(out, &bytes)?;
            }
            Format::Svg => write_file(out, &profile::svg(&geometry, &title))?,
            Format::Dxf => write_file(out, &profile::dxf(&geometry, &title))?,
            Format::Sheet => write_file(out, &page(&self.finger, &geometry, out)?)?,
            Format::Cura | Format::Prusaslicer => {
                let cura = self.format == Format::Cura;
                let text = if cura { slicer::cura } else { slicer::prusaslicer };
                let beside = settings(out, &geometry, &text(&geometry))?;
                return Ok(Written { out: out.clone(), title, beside });
            }
        }
        Ok(Written { out: out.clone(), title, beside: Vec::new() })
    }
}

impl command::Response for Written {}

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Written { out, title, beside } = self;
        let out = out.display();
        let [outline, base] = &beside[..] else { return writeln!(f, "wrote {title}: {out}") };
        let (outline, base) = (outline.display(), base.display());
        writeln!(
            f,
            "wrote settings for {title}: {out}\n\
             to be sliced with them: {outline}\n\
             to be loaded as a modifier with 100 % infill: {base}"
        )
    }
}

fn closed(
    prism: Result<Prism, export::prism::PrismError>,
    geometry: &Geometry,
) -> Result<Prism, Failure> {
    prism.map_err(|error| Failure::usage(format!("{}: {error}", geometry.finger.file)))
}

fn page(request: &PrintRequest, geometry: &Geometry, out: &Path) -> Result<String, Failure> {
    let ending = out.extension().and_then(|ending| ending.to_str()).map(str::to_lowercase);
    let write = match ending.as_deref() {
        Some("svg") => sheet::svg,
        Some("html" | "htm") => sheet::html,
        _ => {
            let problem = format!("--out {}: a sheet's file ends in .svg or .html", out.display());
            return Err(Failure::usage(problem));
        }
    };
    let ribs = mechanics::compute(geometry).map_err(Failure::input)?;
    let measured = request.measured_model()?.map(|prediction| prediction.at_pad());
    Ok(write(geometry, &AtPad { ribs: &ribs, measured }))
}

/// Writes settings for a slicer, and next to them outline and base.
fn settings(out: &Path, geometry: &Geometry, text: &str) -> Result<Vec<PathBuf>, Failure> {
    let title = export::title(geometry);
    let stem = out.file_stem().unwrap_or_default().to_string_lossy();
    let beside = |part: &str| out.with_file_name(format!("{stem}-{part}.stl"));
    let [outline, base] = ["outline", "base"].map(beside);
    let parts = [
        (&outline, closed(Prism::outline(geometry), geometry)?.stl(&format!("{title}, outline"))),
        (&base, closed(Prism::base(geometry), geometry)?.stl(&format!("{title}, solid base"))),
    ];
    // The user did not name these files, so existing ones must not be overwritten.
    for (file, content) in &parts {
        if std::fs::read(file).is_ok_and(|found| found != *content) {
            let problem = "is there already, with other contents; remove it, or give another --out";
            return Err(Failure::usage(format!("{}: {problem}", file.display())));
        }
    }
    write_file(out, text)?;
    for (file, content) in &parts {
        write_file(file, content)?;
    }
    Ok(vec![outline, base])
}
