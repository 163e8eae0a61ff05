//! `optimize finger`: what a finger's ribs say of its stiffness.

use super::{Failure, print, print_json};
use crate::session::{Ribs, RibsRequest};
use clap::Args;
use finray::picture;
use finray::stiffness::PlanarStiffness;
use input::units::{GRAM, MM, N_PER_MM};
use nalgebra::Matrix3;
use report::answer::lines;
use serde_json::{Value, json};
use std::path::PathBuf;
use study::write_file;

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
    fitting(force.unwrap_or_default())
}

fn fitting([y, z]: [f64; 2]) -> Result<[f64; 2], String> {
    match (1e-3..=LARGEST_LOAD_N).contains(&libm::hypot(y, z)) {
        true => Ok([y, z]),
        false => Err(format!("is no force y,z of 0.001 to {LARGEST_LOAD_N} N; as -5,0")),
    }
}

/// Output of `--json`, and the drawing under this force on the pad, N.
pub fn drawn(request: &RibsRequest, load_n: [f64; 2]) -> Result<(Value, String), Failure> {
    let load_n =
        fitting(load_n).map_err(|problem| Failure::usage(format!("--load-n {problem}")))?;
    let found = request.run()?;
    let drawing = picture::svg(&found.0, load_n).map_err(Failure::input)?;
    Ok((found_json(&found), drawing))
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let found = arguments.request.run()?;
    let (geometry, computed, measured) = &found;
    if let Some(file) = &arguments.svg {
        write_file(file, &picture::svg(geometry, arguments.load_n).map_err(Failure::input)?)?;
    }
    let (finger, design) = (&geometry.finger, &geometry.design);
    let phase_mm = design.phase_mm.unwrap_or(finger.ribs.phase / MM);
    let (area_mm2, mass_g) = (geometry.area() / (MM * MM), geometry.mass() / GRAM);
    let (depth, cross) = (computed.cross.in_depth / N_PER_MM, &computed.cross);
    if arguments.json {
        return print_json(&found_json(&found));
    }
    let model = measured.as_ref().map(|prediction| lines::stiffness(prediction)[0].1.clone());
    let model = model.unwrap_or_else(|| "no measured model of it".to_owned());
    print(&format!(
        "finger        {}, {} %, {}°, first rib at {phase_mm} mm\n\
         material      {}, {} GPa ({})\n\
         area, mass    {area_mm2:.1} mm2, {mass_g:.2} g\n\
         stiffness     {model}\n\n\
         from the ribs\n\
         the part      compliance assembly   tilting    centre    centre  coupling\n\
         touches           N/mm      N/mm    Nm/rad  below, mm front, mm       y-z\n{}{}\n\
         across        {depth:.1} N/mm in x, {:.2} Nm/rad about y, {:.2} about z\n",
        finger.name,
        design.density_percent,
        design.direction_deg,
        finger.material.name,
        finger.material.modulus / 1e9,
        finger.material.source,
        planar_text("pad", &computed.pad),
        planar_text("pad and roof", &computed.pad_and_roof),
        cross.about_y,
        cross.about_z,
    ))
}

fn found_json((geometry, computed, measured): &Ribs) -> Value {
    let (finger, design, cross) = (&geometry.finger, &geometry.design, &computed.cross);
    json!({
        "finger": finger.name,
        "infill_density_percent": design.density_percent,
        "infill_direction_deg": design.direction_deg,
        "phase_mm": design.phase_mm.unwrap_or(finger.ribs.phase / MM),
        "area_mm2": geometry.area() / (MM * MM),
        "mass_g": geometry.mass() / GRAM,
        "measured_model": measured,
        "pad": planar_json(&computed.pad),
        "pad_and_roof": planar_json(&computed.pad_and_roof),
        "across": {
            "depth_n_per_mm": cross.in_depth / N_PER_MM,
            "about_y_nm_per_rad": cross.about_y,
            "about_z_nm_per_rad": cross.about_z,
        },
    })
}

fn planar_json(found: &PlanarStiffness) -> Value {
    json!({
        "compliance_n_per_mm": found.in_compliance() / N_PER_MM,
        "assembly_n_per_mm": found.in_assembly() / N_PER_MM,
        "tilting_nm_per_rad": found.tilting(),
        "centre_below_pad_mm": found.centre_below_pad() / MM,
        "centre_from_pad_mm": found.centre_in_front() / MM,
        "coupling_yz": found.coupling_yz(),
        // y, z, rx at the pad's middle: N/mm, N, N mm.
        "stiffness_matrix": in_mm(found.matrix()),
    })
}

fn planar_text(name: &str, found: &PlanarStiffness) -> String {
    format!(
        "{name:<13} {:>9.2} {:>9.1} {:>9.2} {:>9.1} {:>9.1} {:>9.2}\n",
        found.in_compliance() / N_PER_MM,
        found.in_assembly() / N_PER_MM,
        found.tilting(),
        found.centre_below_pad() / MM,
        found.centre_in_front() / MM,
        found.coupling_yz(),
    )
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
