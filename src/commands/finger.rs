//! `optimize finger`: computes the stiffness of a finger from its ribs.

use crate::layout::wrapped;
use crate::setup::files::DEFAULT_FINGER;
use crate::setup::finger::{InfillRequest, setting};
use crate::setup::printed::{finger_file, predicted_stiffness};
use crate::{Context, Failure, Output, command};
use finray::geometry::Geometry;
use finray::mechanics::{self, FingerStiffness};
use finray::picture;
use finray::stiffness::PlanarStiffness;
use input::units::{GRAM, MM, N_PER_MM};
use insertion::finger::file::{infill, is_shape};
use insertion::{Design, Prediction};
use nalgebra::Matrix3;
use report::answer::lines;
use report::text_table;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Compute the stiffness of a printed finger from its ribs.
///
/// Plane stress on the exact profile, with the modulus of the finger file and without measured corrections:
/// stiffness at the middle of the pad. Trials and studies use it with --finger-model computed.
#[derive(Debug, Clone, clap::Args)]
#[command(
    mut_arg("density", |density| density.required(true)),
    mut_arg("direction", |direction| direction.required(true)),
    after_help = "Example: optimize finger --density 20 --direction 20 --svg finger.svg"
)]
pub struct Request {
    /// Infill of the finger.
    #[command(flatten)]
    pub infill: InfillRequest,
    /// Finger: finray9, or the path of a finger file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_FINGER)]
    pub finger: String,
    /// Position of the first rib, mm [default: that of the finger file]
    #[arg(long, value_name = "MM")]
    pub phase_mm: Option<f64>,
    /// A number of the finger file, for example finger.skin.thickness_mm=0.8; may be given several times
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    pub set: Vec<(String, f64)>,
    /// Draw the finger at rest and under the force of a grasp on its pad
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
}

impl command::Request for Request {
    fn run(&self, _context: &Context<'_>) -> Result<Output, Failure> {
        if let Some((key, _)) = self.set.iter().find(|(key, _)| !is_shape(key)) {
            return Err(Failure::usage(format!(
                "--set {key}: must be a number of the finger file, for example finger.skin.thickness_mm"
            )));
        }
        let set = Design(self.set.iter().cloned().collect());
        let file = finger_file(&self.finger)?;
        let finger = file.with(&set)?;
        let [density, direction] = self.infill.required("")?;
        let mut design = Design::infill(density, direction);
        let geometry = Geometry::new(&finger, &infill(&design, self.phase_mm))?;
        let computed = mechanics::compute(&geometry)?;
        design.0.extend(set.0);
        let model = predicted_stiffness(&file.finger, &design)?;
        let svg = picture::svg(&geometry)?;
        let value = json(&geometry, &computed, model.as_ref());
        let text = wrapped(&text(&geometry, &computed, model.as_ref()));
        Output::new(text, value).drawn(svg, self.svg.as_ref())
    }
}

/// Returns the numbers of an in-plane stiffness: key of `--json`, value, and decimals in the text.
fn planar(found: &PlanarStiffness) -> [(&'static str, f64, usize); 6] {
    [
        ("compliance_n_per_mm", found.in_compliance() / N_PER_MM, 2),
        ("assembly_n_per_mm", found.in_assembly() / N_PER_MM, 1),
        ("tilting_nm_per_rad", found.tilting(), 2),
        ("centre_below_pad_mm", found.centre_below_pad() / MM, 1),
        ("centre_from_pad_mm", found.centre_in_front() / MM, 1),
        ("coupling_yz", found.coupling_yz(), 2),
    ]
}

/// Returns an in-plane stiffness as JSON; its matrix is for y, z and rx at the middle of the pad, see [`in_mm`].
fn planar_json(found: &PlanarStiffness) -> Value {
    let mut json: Value = planar(found).into_iter().map(|(key, value, _)| (key, value)).collect();
    json["stiffness_matrix"] = json!(in_mm(found.matrix()));
    json
}

/// Returns the stiffness of a finger as JSON; `model` is `None` if the stiffness model does not cover this infill, or
/// if `--set` changes the shape.
fn json(geometry: &Geometry, computed: &FingerStiffness, model: Option<&Prediction>) -> Value {
    json!({
        "finger": geometry.finger.name,
        "infill_density_percent": geometry.design.density_percent,
        "infill_direction_deg": geometry.design.direction_deg,
        "phase_mm": first_rib_mm(geometry),
        "area_mm2": geometry.area() / (MM * MM),
        "mass_g": geometry.mass() / GRAM,
        "measured_model": model,
        "pad": planar_json(&computed.pad),
        "pad_and_roof": planar_json(&computed.pad_and_roof),
        "across": {
            "depth_n_per_mm": computed.cross.in_depth / N_PER_MM,
            "about_y_nm_per_rad": computed.cross.about_y,
            "about_z_nm_per_rad": computed.cross.about_z,
        },
    })
}

fn text(geometry: &Geometry, computed: &FingerStiffness, model: Option<&Prediction>) -> String {
    let (design, finger, first_mm) = (&geometry.design, &geometry.finger, first_rib_mm(geometry));
    let [density, direction] = [design.density_percent, design.direction_deg];
    let (material, modulus) = (&finger.material, finger.material.modulus / 1e9);
    let (area, mass) = (geometry.area() / (MM * MM), geometry.mass() / GRAM);
    let model = model.map(|prediction| lines::stiffness(prediction)[0].1.clone());
    let model = model.unwrap_or_else(|| "not covered by the measured model".to_owned());
    let rows = [row("pad", &computed.pad), row("pad and roof", &computed.pad_and_roof)];
    let (ribs, cross) = (text_table(1, PLANAR, rows), &computed.cross);
    let in_x = cross.in_depth / N_PER_MM;
    format!(
        "finger        {}, {density} %, {direction}°, first rib at {first_mm} mm\n\
         material      {}, {modulus} GPa ({})\n\
         area, mass    {area:.1} mm2, {mass:.2} g\n\
         stiffness     {model}\n\n\
         from the ribs\n{ribs}\n\
         across        {in_x:.1} N/mm in x, {:.2} Nm/rad about y, \
         {:.2} about z\n",
        finger.name, material.name, material.source, cross.about_y, cross.about_z
    )
}

/// Returns the position of the first rib, mm.
fn first_rib_mm(geometry: &Geometry) -> f64 {
    geometry.design.phase_mm.unwrap_or(geometry.finger.ribs.phase / MM)
}

/// Column headings for [`row`].
const PLANAR: [&str; 7] = [
    "contact\nat",
    "compliance\nN/mm",
    "assembly\nN/mm",
    "tilting\nNm/rad",
    "centre\nbelow, mm",
    "centre\nfront, mm",
    "coupling\ny-z",
];

/// Returns the row of an in-plane stiffness; `name` is its first cell.
fn row(name: &str, found: &PlanarStiffness) -> [String; 7] {
    let [a, b, c, d, e, f] = planar(found).map(|(_, value, places)| format!("{value:.places$}"));
    [name.to_owned(), a, b, c, d, e, f]
}

/// Converts a stiffness matrix for y, z and rx from N/m, N/rad and N m/rad to N/mm, N/rad and N mm/rad.
fn in_mm(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    let unit = |i: usize, j: usize| match (i == 2, j == 2) {
        (false, false) => 1.0 / N_PER_MM,
        (true, true) => 1.0 / MM,
        _ => 1.0,
    };
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[(i, j)] * unit(i, j)))
}
