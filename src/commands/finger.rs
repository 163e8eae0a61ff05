//! `optimize finger`: computes the stiffness of a finger from its ribs.

use crate::command::{self, Output};
use crate::context::Context;
use crate::failure::Failure;
use crate::setup::files::DEFAULT_FINGER;
use crate::setup::finger::{InfillRequest, setting};
use crate::setup::printed::{finger_file, predicted_stiffness};
use finray::geometry::Geometry;
use finray::mechanics::{self, FingerStiffness};
use finray::picture;
use finray::stiffness::PlanarStiffness;
use input::units::{GRAM, MM, N_PER_MM};
use insertion::finger::file::{infill, is_shape};
use insertion::space::Design;
use insertion::surrogate::Prediction;
use nalgebra::Matrix3;
use report::answer::lines;
use report::text_table;
use serde::Serialize;
use std::path::PathBuf;

/// Largest drawn force on the pad, N, since displacements are linear.
const LARGEST_LOAD_N: f64 = 1000.0;

/// Compute the stiffness of a printed finger from its ribs.
///
/// Plane stress on the exact profile, with the modulus of the finger file and without measured corrections:
/// stiffness at the middle of the pad. Trials and studies use it with --finger-model computed.
#[derive(Debug, Clone, clap::Args)]
#[command(
    display_order = 14,
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
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub phase_mm: Option<f64>,
    /// A number of the finger file, for example finger.skin.thickness_mm=0.8; may be given several times
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    pub set: Vec<(String, f64)>,
    /// Draw the finger at rest and under a force on its pad
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
    /// Force on the pad for --svg, N: y towards the part, z up; -5,0 is a grasp, 0,10 a part that pulls up
    #[arg(long, value_name = "Y,Z", default_value = "-5,0", value_parser = force,
        allow_hyphen_values = true)]
    pub load_n: [f64; 2],
}

fn force(text: &str) -> Result<[f64; 2], String> {
    let number = |part: &str| part.trim().parse::<f64>().ok();
    let parts = text.split_once(',').and_then(|(y, z)| Some([number(y)?, number(z)?]));
    let [y, z] = parts.unwrap_or_default();
    match (1e-3..=LARGEST_LOAD_N).contains(&libm::hypot(y, z)) {
        true => Ok([y, z]),
        false => {
            Err(format!("must be a force Y,Z of 0.001 to {LARGEST_LOAD_N} N, for example -5,0"))
        }
    }
}

/// Finger with its computed stiffness, and the prediction of the stiffness model.
#[derive(Serialize)]
pub struct ComputedFinger {
    finger: String,
    infill_density_percent: f64,
    infill_direction_deg: f64,
    phase_mm: f64,
    area_mm2: f64,
    mass_g: f64,
    /// `None` if the stiffness model does not cover this infill, or if `set` changes the shape.
    measured_model: Option<Prediction>,
    pad: Planar,
    pad_and_roof: Planar,
    across: Across,
}

/// Stiffness out of the plane.
#[derive(Serialize)]
struct Across {
    depth_n_per_mm: f64,
    about_y_nm_per_rad: f64,
    about_z_nm_per_rad: f64,
}

impl command::Request for Request {
    type Response = ComputedFinger;

    fn run(&self, _context: &Context<'_>) -> Result<Output<ComputedFinger>, Failure> {
        if let Some((key, _)) = self.set.iter().find(|(key, _)| !is_shape(key)) {
            return Err(Failure::usage(format!(
                "--set {key}: must be a number of the finger file, for example finger.skin.thickness_mm"
            )));
        }
        let set = Design(self.set.iter().cloned().collect());
        let file = finger_file(&self.finger)?;
        let finger = file.with(&set).map_err(Failure::input)?;
        let [density, direction] = self.infill.required()?;
        let infill = infill(&Design::infill(density, direction), self.phase_mm);
        let geometry = Geometry::new(&finger, &infill).map_err(Failure::input)?;
        let computed = mechanics::compute(&geometry).map_err(Failure::input)?;
        let mut design = Design::infill(density, direction);
        design.0.extend(set.0);
        let value =
            ComputedFinger::new(&geometry, &computed, predicted_stiffness(&file.finger, &design)?);
        let svg = picture::svg(&geometry, self.load_n).map_err(Failure::input)?;
        Output::new(value.text(&geometry), value).drawn(svg, self.svg.as_ref())
    }
}

/// In-plane stiffness of a finger.
#[derive(Serialize)]
struct Planar {
    compliance_n_per_mm: f64,
    assembly_n_per_mm: f64,
    tilting_nm_per_rad: f64,
    centre_below_pad_mm: f64,
    centre_from_pad_mm: f64,
    coupling_yz: f64,
    /// For y, z and rx at the middle of the pad: N/mm, N, N mm.
    stiffness_matrix: [[f64; 3]; 3],
}

impl From<&PlanarStiffness> for Planar {
    fn from(found: &PlanarStiffness) -> Self {
        Planar {
            compliance_n_per_mm: found.in_compliance() / N_PER_MM,
            assembly_n_per_mm: found.in_assembly() / N_PER_MM,
            tilting_nm_per_rad: found.tilting(),
            centre_below_pad_mm: found.centre_below_pad() / MM,
            centre_from_pad_mm: found.centre_in_front() / MM,
            coupling_yz: found.coupling_yz(),
            stiffness_matrix: in_mm(found.matrix()),
        }
    }
}

impl ComputedFinger {
    fn new(geometry: &Geometry, computed: &FingerStiffness, model: Option<Prediction>) -> Self {
        let (design, cross) = (&geometry.design, &computed.cross);
        ComputedFinger {
            finger: geometry.finger.name.clone(),
            infill_density_percent: design.density_percent,
            infill_direction_deg: design.direction_deg,
            phase_mm: design.phase_mm.unwrap_or(geometry.finger.ribs.phase / MM),
            area_mm2: geometry.area() / (MM * MM),
            mass_g: geometry.mass() / GRAM,
            measured_model: model,
            pad: (&computed.pad).into(),
            pad_and_roof: (&computed.pad_and_roof).into(),
            across: Across {
                depth_n_per_mm: cross.in_depth / N_PER_MM,
                about_y_nm_per_rad: cross.about_y,
                about_z_nm_per_rad: cross.about_z,
            },
        }
    }

    fn text(&self, geometry: &Geometry) -> String {
        let ComputedFinger {
            finger, infill_density_percent, infill_direction_deg, phase_mm, ..
        } = self;
        let material = &geometry.finger.material;
        let model = self.measured_model.as_ref();
        let model = model.map(|prediction| lines::stiffness(prediction)[0].1.clone());
        let model = model.unwrap_or_else(|| "not covered by the measured model".to_owned());
        let rows = [self.pad.row("pad"), self.pad_and_roof.row("pad and roof")];
        let Across { depth_n_per_mm, about_y_nm_per_rad, about_z_nm_per_rad } = self.across;
        format!(
            "finger        {finger}, {infill_density_percent} %, {infill_direction_deg}°, first rib at {phase_mm} mm\n\
             material      {}, {} GPa ({})\n\
             area, mass    {:.1} mm2, {:.2} g\n\
             stiffness     {model}\n\n\
             from the ribs\n{}\n\
             across        {depth_n_per_mm:.1} N/mm in x, {about_y_nm_per_rad:.2} Nm/rad about y, \
             {about_z_nm_per_rad:.2} about z\n",
            material.name,
            material.modulus / 1e9,
            material.source,
            self.area_mm2,
            self.mass_g,
            text_table(1, PLANAR, rows),
        )
    }
}

/// Column headings for [`Planar::row`].
const PLANAR: [&str; 7] = [
    "contact\nat",
    "compliance\nN/mm",
    "assembly\nN/mm",
    "tilting\nNm/rad",
    "centre\nbelow, mm",
    "centre\nfront, mm",
    "coupling\ny-z",
];

impl Planar {
    fn row(&self, name: &str) -> [String; 7] {
        [
            name.to_owned(),
            format!("{:.2}", self.compliance_n_per_mm),
            format!("{:.1}", self.assembly_n_per_mm),
            format!("{:.2}", self.tilting_nm_per_rad),
            format!("{:.1}", self.centre_below_pad_mm),
            format!("{:.1}", self.centre_from_pad_mm),
            format!("{:.2}", self.coupling_yz),
        ]
    }
}

/// Converts N/m, N/rad and N m/rad to N/mm, N and N mm.
fn in_mm(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    let unit = |i: usize, j: usize| match (i == 2, j == 2) {
        (false, false) => 1.0 / N_PER_MM,
        (true, true) => 1.0 / MM,
        _ => 1.0,
    };
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[(i, j)] * unit(i, j)))
}
