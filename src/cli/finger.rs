//! `optimize finger`: what a finger's ribs say of its stiffness.

use super::{Failure, print, print_json};
use crate::session::RibsRequest;
use crate::study::write_file;
use clap::Args;
use finray::geometry::Geometry;
use finray::mechanics::FingerStiffness;
use finray::picture;
use finray::printed::PrintedFinger;
use finray::stiffness::PlanarStiffness;
use input::units::{GRAM, MM, N_PER_MM};
use nalgebra::Matrix3;
use serde::Serialize;
use std::path::PathBuf;

/// Largest force on the pad that is drawn, N: bends are those of small displacements.
const LARGEST_LOAD_N: f64 = 1000.0;

/// Compute the stiffness of a printed finger from its ribs.
///
/// Plane stress on the exact profile: free stiffnesses at the pad's middle at the modulus of the
/// finger file, before any measured correction. Nothing is fitted. Trials and studies use
/// it with --finger-model computed.
#[derive(Debug, Clone, Args)]
pub struct Arguments {
    #[command(flatten)]
    request: RibsRequest,
    /// Draw the finger, at rest and under a force on its pad
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// That force, N: y towards the part, z up; as -5,0 is a grasp, 0,10 a part that pulls up
    #[arg(long, value_name = "Y,Z", default_value = "-5,0", value_parser = load,
        allow_hyphen_values = true)]
    load_n: [f64; 2],
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

fn load(text: &str) -> Result<[f64; 2], String> {
    let number = |part: &str| part.trim().parse::<f64>().ok();
    let force = text.split_once(',').and_then(|(y, z)| Some([number(y)?, number(z)?]));
    let fits = |[y, z]: &[f64; 2]| (1e-3..=LARGEST_LOAD_N).contains(&y.hypot(*z));
    force
        .filter(fits)
        .ok_or_else(|| format!("is no force y,z of 0.001 to {LARGEST_LOAD_N} N; as -5,0"))
}

/// The result as it is printed.
#[derive(Serialize)]
struct FingerRow {
    finger: String,
    infill_density_percent: f64,
    infill_direction_deg: f64,
    phase_mm: f64,
    area_mm2: f64,
    mass_g: f64,
    pad: PlanarRow,
    pad_and_roof: PlanarRow,
    across: AcrossRow,
}

#[derive(Serialize)]
struct PlanarRow {
    compliance_n_per_mm: f64,
    assembly_n_per_mm: f64,
    tilting_nm_per_rad: f64,
    centre_below_pad_mm: f64,
    centre_from_pad_mm: f64,
    coupling_yz: f64,
    /// y, z, rx at the pad's middle: N/mm, N, N mm.
    stiffness_matrix: [[f64; 3]; 3],
}

#[derive(Serialize)]
struct AcrossRow {
    depth_n_per_mm: f64,
    about_y_nm_per_rad: f64,
    about_z_nm_per_rad: f64,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (geometry, computed) = arguments.request.run()?;
    if let Some(file) = &arguments.svg {
        write_file(file, &picture::svg(&geometry, arguments.load_n).map_err(Failure::input)?)?;
    }
    let row = FingerRow::new(&geometry, &computed);
    if arguments.json {
        let value = serde_json::to_value(&row)
            .map_err(|error| Failure::running(format!("cannot write the result: {error}")))?;
        return print_json(&value);
    }
    print(&text(&row, &geometry.finger))
}

impl FingerRow {
    fn new(geometry: &Geometry, computed: &FingerStiffness) -> Self {
        let (design, cross) = (&geometry.design, &computed.cross);
        FingerRow {
            finger: geometry.finger.name.clone(),
            infill_density_percent: design.density_percent,
            infill_direction_deg: design.direction_deg,
            phase_mm: design.phase_mm.unwrap_or(geometry.finger.ribs.phase / MM),
            area_mm2: computed.area / (MM * MM),
            mass_g: computed.mass / GRAM,
            pad: PlanarRow::from(&computed.pad),
            pad_and_roof: PlanarRow::from(&computed.pad_and_roof),
            across: AcrossRow {
                depth_n_per_mm: cross.in_depth / N_PER_MM,
                about_y_nm_per_rad: cross.about_y,
                about_z_nm_per_rad: cross.about_z,
            },
        }
    }
}

impl From<&PlanarStiffness> for PlanarRow {
    fn from(stiffness: &PlanarStiffness) -> Self {
        PlanarRow {
            compliance_n_per_mm: stiffness.in_compliance() / N_PER_MM,
            assembly_n_per_mm: stiffness.in_assembly() / N_PER_MM,
            tilting_nm_per_rad: stiffness.tilting(),
            centre_below_pad_mm: stiffness.centre_below_pad() / MM,
            centre_from_pad_mm: stiffness.centre_in_front() / MM,
            coupling_yz: stiffness.coupling_yz(),
            stiffness_matrix: in_mm(stiffness.matrix()),
        }
    }
}

/// N/m, N/rad and N m/rad as N/mm, N and N mm.
fn in_mm(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    let unit = |i: usize, j: usize| match (i == 2, j == 2) {
        (false, false) => 1.0 / N_PER_MM,
        (true, true) => 1.0 / MM,
        _ => 1.0,
    };
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[(i, j)] * unit(i, j)))
}

fn text(row: &FingerRow, finger: &PrintedFinger) -> String {
    let modulus = finger.material.modulus / 1e9;
    let planar = |name: &str, planar: &PlanarRow| {
        format!(
            "{name:<13} {:>9.2} {:>9.1} {:>9.2} {:>9.1} {:>9.1} {:>9.2}\n",
            planar.compliance_n_per_mm,
            planar.assembly_n_per_mm,
            planar.tilting_nm_per_rad,
            planar.centre_below_pad_mm,
            planar.centre_from_pad_mm,
            planar.coupling_yz,
        )
    };
    format!(
        "finger        {}, {} %, {}°, first rib at {} mm\n\
         material      {}, {modulus} GPa ({})\n\
         area, mass    {:.1} mm2, {:.2} g\n\n\
         the part      compliance assembly   tilting    centre    centre  coupling\n\
         touches           N/mm      N/mm    Nm/rad  below, mm front, mm       y-z\n{}{}\n\
         across        {:.1} N/mm in x, {:.2} Nm/rad about y, {:.2} about z\n",
        row.finger,
        row.infill_density_percent,
        row.infill_direction_deg,
        row.phase_mm,
        finger.material.name,
        finger.material.source,
        row.area_mm2,
        row.mass_g,
        planar("pad", &row.pad),
        planar("pad and roof", &row.pad_and_roof),
        row.across.depth_n_per_mm,
        row.across.about_y_nm_per_rad,
        row.across.about_z_nm_per_rad,
    )
}
