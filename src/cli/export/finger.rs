//! `optimize export finger`: a finger for the printer.

use crate::cli::setup::find;
use crate::cli::{Failure, print};
use crate::study::{StudyRecord, write_file};
use clap::{Args, ValueEnum};
use finray::export::prism::Prism;
use finray::export::{self, profile, sheet, slicer};
use finray::geometry::Geometry;
use finray::mechanics;
use input::shipped::FINGERS;
use insertion::finger::file::FingerFile;
use insertion::space::Design;
use std::path::{Path, PathBuf};

/// A finger for the printer: the best of a study, or of an infill
///
/// Both fingers of a gripper are this part. STL, 3MF, DXF and SVG have every rib of it; the
/// settings for slicers are for its outline, which is written beside them and which the slicer
/// fills with its own ribs.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder of a study: its best design
    #[arg(value_name = "DIR", conflicts_with_all = ["density", "direction"],
          required_unless_present = "density")]
    dir: Option<PathBuf>,
    /// Infill density, percent
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true, requires = "direction")]
    density: Option<f64>,
    /// Infill direction, degrees
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, requires = "density")]
    direction: Option<f64>,
    /// Finger: finray9, or the path of a finger file [default: the study's, or finray9]
    #[arg(long, value_name = "NAME")]
    finger: Option<String>,
    /// Where the first rib lies, mm [default: the finger file's]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    phase_mm: Option<f64>,
    /// What to write
    #[arg(long, value_enum)]
    format: Format,
    /// File to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// The finger of the paper.
const DEFAULT: &str = "finray9";

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
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

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let geometry = geometry(arguments)?;
    let (out, title) = (&arguments.out, export::title(&geometry));
    match arguments.format {
        Format::Stl => write_file(out, &finger(&geometry)?.stl(&title))?,
        Format::ThreeMf => {
            let bytes = finger(&geometry)?
                .three_mf(&title)
                .map_err(|error| Failure::running(format!("{}: {error}", out.display())))?;
            write_file(out, &bytes)?;
        }
        Format::Svg => write_file(out, &profile::svg(&geometry, &title))?,
        Format::Dxf => write_file(out, &profile::dxf(&geometry, &title))?,
        Format::Sheet => write_file(out, &page(&geometry, out)?)?,
        Format::Cura => return settings(out, &geometry, &slicer::cura(&geometry)),
        Format::Prusaslicer => return settings(out, &geometry, &slicer::prusaslicer(&geometry)),
    }
    print(&format!("wrote {title}: {}\n", out.display()))
}

/// The finger that is asked for.
fn geometry(arguments: &Arguments) -> Result<Geometry, Failure> {
    let (design, of_study) = match (&arguments.dir, arguments.density, arguments.direction) {
        (Some(dir), ..) => best(dir)?,
        (None, Some(density), Some(direction)) => (Design::infill(density, direction), None),
        _ => {
            return Err(Failure::usage("give the folder of a study, or --density and --direction"));
        }
    };
    let file = match (&arguments.finger, of_study) {
        (None, Some(file)) => file,
        (named, _) => {
            let source = find("finger", FINGERS, named.as_deref().unwrap_or(DEFAULT))?;
            FingerFile::parse(&source.text, &source.file).map_err(Failure::input)?
        }
    };
    let finger = file.with(&design).map_err(Failure::input)?;
    let infill = design.printed(arguments.phase_mm);
    Geometry::new(&finger, &infill).map_err(Failure::input)
}

/// The design that a study recommends, and the finger file of its fingers.
fn best(dir: &Path) -> Result<(Design, Option<FingerFile>), Failure> {
    let record = StudyRecord::load(dir)?;
    let Some(best) = record.to_print() else {
        return Err(Failure::usage(format!(
            "{}: the study recommends no design; give --density and --direction",
            dir.display()
        )));
    };
    Ok((best.clone(), record.finger.clone()))
}

fn finger(geometry: &Geometry) -> Result<Prism, Failure> {
    closed(Prism::finger(geometry), geometry)
}

fn closed(
    prism: Result<Prism, export::prism::PrismError>,
    geometry: &Geometry,
) -> Result<Prism, Failure> {
    prism.map_err(|error| Failure::usage(format!("{}: {error}", geometry.finger.file)))
}

fn page(geometry: &Geometry, out: &Path) -> Result<String, Failure> {
    let ending = out.extension().and_then(|ending| ending.to_str()).map(str::to_lowercase);
    let write = match ending.as_deref() {
        Some("svg") => sheet::svg,
        Some("html" | "htm") => sheet::html,
        _ => {
            let problem = format!("--out {}: a sheet's file ends in .svg or .html", out.display());
            return Err(Failure::usage(problem));
        }
    };
    let stiffness = mechanics::compute(geometry).map_err(Failure::input)?;
    Ok(write(geometry, &stiffness))
}

/// Writes settings for a slicer, and beside them what they are for.
fn settings(out: &Path, geometry: &Geometry, text: &str) -> Result<(), Failure> {
    let title = export::title(geometry);
    let stem = out.file_stem().unwrap_or_default().to_string_lossy();
    let beside = |part: &str| out.with_file_name(format!("{stem}-{part}.stl"));
    let [outline, base] = ["outline", "base"].map(beside);
    let [outline_part, base_part] = [Prism::outline(geometry), Prism::base(geometry)];
    write_file(out, text)?;
    write_file(&outline, &closed(outline_part, geometry)?.stl(&format!("{title}, outline")))?;
    write_file(&base, &closed(base_part, geometry)?.stl(&format!("{title}, solid base")))?;
    print(&format!(
        "wrote settings for {title}: {}\n\
         to be sliced with them: {}\n\
         to be loaded as a modifier with 100 % infill: {}\n",
        out.display(),
        outline.display(),
        base.display()
    ))
}
