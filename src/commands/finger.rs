//! `optimize finger`: computes the stiffness of a finger from its ribs.

use crate::command;
use crate::context::Context;
use crate::failure::Failure;
use crate::setup::files::DEFAULT_FINGER;
use crate::setup::finger::{InfillRequest, setting};
use crate::setup::printed::{finger_file, measured_model};
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
use serde::{Serialize, Serializer};
use std::fmt;
use std::path::PathBuf;
use study::write_file;

/// Largest force on the pad for the drawing, N; the deflection is linear (small displacements).
const LARGEST_LOAD_N: f64 = 1000.0;

/// Compute the stiffness of a printed finger from its ribs.
///
/// Plane stress on the exact profile: free stiffnesses at the pad's middle at the modulus of the
/// finger file, before any measured correction. Nothing is fitted. Trials and studies use
/// it with --finger-model computed.
#[derive(Debug, Clone, clap::Args)]
#[command(
    display_order = 14,
    mut_arg("density", |density| density.required(true)),
    mut_arg("direction", |direction| direction.required(true)),
    after_help = "Example: optimize finger --density 20 --direction 20 --svg finger.svg"
)]
pub struct Request {
    /// Its infill.
    #[command(flatten)]
    pub infill: InfillRequest,
    /// Finger: finray9, or the path of a finger file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_FINGER)]
    pub finger: String,
    /// Where the first rib lies, mm [default: the finger file's]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub phase_mm: Option<f64>,
    /// A number of the finger file, as finger.skin.thickness_mm=0.8; may be given several times
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    pub set: Vec<(String, f64)>,
    /// Draw the finger, at rest and under a force on its pad
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
    /// Force on the pad, N: y towards the part, z up; -5,0 is a grasp, 0,10 a part that pulls up
    #[arg(long, value_name = "Y,Z", default_value = "-5,0", value_parser = load,
        allow_hyphen_values = true)]
    pub load_n: [f64; 2],
}

fn load(text: &str) -> Result<[f64; 2], String> {
    let number = |part: &str| part.trim().parse::<f64>().ok();
    let force = text.split_once(',').and_then(|(y, z)| Some([number(y)?, number(z)?]));
    let [y, z] = force.unwrap_or_default();
    match (1e-3..=LARGEST_LOAD_N).contains(&libm::hypot(y, z)) {
        true => Ok([y, z]),
        false => Err(format!("is no force y,z of 0.001 to {LARGEST_LOAD_N} N; as -5,0")),
    }
}

/// Geometry of a finger, its computed stiffness, and the prediction of the stiffness model.
pub struct Ribs {
    geometry: Geometry,
    computed: FingerStiffness,
    /// `None` if the stiffness model does not cover this infill, or if `set` changes the shape.
    measured: Option<Prediction>,
    load_n: [f64; 2],
}

impl command::Request for Request {
    type Response = Ribs;

    fn run(&self, _context: &Context<'_>) -> Result<Ribs, Failure> {
        if let Some((key, _)) = self.set.iter().find(|(key, _)| !is_shape(key)) {
            return Err(Failure::usage(format!(
                "--set {key}: sets no number of a finger file, as finger.skin.thickness_mm does"
            )));
        }
        let set = Design(self.set.iter().cloned().collect());
        let file = finger_file(&self.finger)?;
        let finger = file.with(&set).map_err(Failure::input)?;
        let [density, direction] = self.infill.both()?;
        let infill = infill(&Design::infill(density, direction), self.phase_mm);
        let geometry = Geometry::new(&finger, &infill).map_err(Failure::input)?;
        let computed = mechanics::compute(&geometry).map_err(Failure::input)?;
        let mut design = Design::infill(density, direction);
        design.0.extend(set.0);
        let measured = measured_model(&file.finger, &design)?;
        let ribs = Ribs { geometry, computed, measured, load_n: self.load_n };
        if let Some(file) = &self.svg {
            write_file(file, &ribs.svg()?)?;
        }
        Ok(ribs)
    }
}

impl Ribs {
    fn svg(&self) -> Result<String, Failure> {
        picture::svg(&self.geometry, self.load_n).map_err(Failure::input)
    }

    /// Position of the first rib, mm.
    fn phase_mm(&self) -> f64 {
        self.geometry.design.phase_mm.unwrap_or(self.geometry.finger.ribs.phase / MM)
    }
}

impl command::Response for Ribs {
    fn picture(&self) -> Result<Option<String>, Failure> {
        self.svg().map(Some)
    }
}

impl Serialize for Ribs {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Across {
            depth_n_per_mm: f64,
            about_y_nm_per_rad: f64,
            about_z_nm_per_rad: f64,
        }
        #[derive(Serialize)]
        struct Fields<'a> {
            finger: &'a str,
            infill_density_percent: f64,
            infill_direction_deg: f64,
            phase_mm: f64,
            area_mm2: f64,
            mass_g: f64,
            measured_model: &'a Option<Prediction>,
            pad: Planar,
            pad_and_roof: Planar,
            across: Across,
        }
        let Ribs { geometry, computed, measured, .. } = self;
        let (design, cross) = (&geometry.design, &computed.cross);
        let fields = Fields {
            finger: &geometry.finger.name,
            infill_density_percent: design.density_percent,
            infill_direction_deg: design.direction_deg,
            phase_mm: self.phase_mm(),
            area_mm2: geometry.area() / (MM * MM),
            mass_g: geometry.mass() / GRAM,
            measured_model: measured,
            pad: (&computed.pad).into(),
            pad_and_roof: (&computed.pad_and_roof).into(),
            across: Across {
                depth_n_per_mm: cross.in_depth / N_PER_MM,
                about_y_nm_per_rad: cross.about_y,
                about_z_nm_per_rad: cross.about_z,
            },
        };
        fields.serialize(serializer)
    }
}

/// In-plane stiffness of a finger, as in the output of `--json`.
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

impl fmt::Display for Ribs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Ribs { geometry, computed, measured, .. } = self;
        let (finger, design) = (&geometry.finger, &geometry.design);
        let phase_mm = self.phase_mm();
        let (area_mm2, mass_g) = (geometry.area() / (MM * MM), geometry.mass() / GRAM);
        let (depth, cross) = (computed.cross.in_depth / N_PER_MM, &computed.cross);
        let model = measured.as_ref().map(|prediction| lines::stiffness(prediction)[0].1.clone());
        let model = model.unwrap_or_else(|| "no measured model of it".to_owned());
        let rows = [("pad", &computed.pad), ("pad and roof", &computed.pad_and_roof)]
            .map(|(name, found)| planar_row(name, found));
        write!(
            f,
            "finger        {}, {} %, {}°, first rib at {phase_mm} mm\n\
             material      {}, {} GPa ({})\n\
             area, mass    {area_mm2:.1} mm2, {mass_g:.2} g\n\
             stiffness     {model}\n\n\
             from the ribs\n{}\n\
             across        {depth:.1} N/mm in x, {:.2} Nm/rad about y, {:.2} about z\n",
            finger.name,
            design.density_percent,
            design.direction_deg,
            finger.material.name,
            finger.material.modulus / 1e9,
            finger.material.source,
            text_table(1, PLANAR, rows),
            cross.about_y,
            cross.about_z,
        )
    }
}

/// Column headings for [`planar_row`].
const PLANAR: [&str; 7] = [
    "the part\ntouches",
    "compliance\nN/mm",
    "assembly\nN/mm",
    "tilting\nNm/rad",
    "centre\nbelow, mm",
    "centre\nfront, mm",
    "coupling\ny-z",
];

fn planar_row(name: &str, found: &PlanarStiffness) -> [String; 7] {
    [
        name.to_owned(),
        format!("{:.2}", found.in_compliance() / N_PER_MM),
        format!("{:.1}", found.in_assembly() / N_PER_MM),
        format!("{:.2}", found.tilting()),
        format!("{:.1}", found.centre_below_pad() / MM),
        format!("{:.1}", found.centre_in_front() / MM),
        format!("{:.2}", found.coupling_yz()),
    ]
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
