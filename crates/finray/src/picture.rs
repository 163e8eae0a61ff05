//! A picture of a finger that bends under a load on its pad.

use super::condense::condense;
use super::elasticity::{PlaneStress, Slab};
use super::geometry::Geometry;
use super::mechanics::SIZE;
use super::mesh::MeshError;
use super::meshed::{MeshedFinger, RigidFace};
use super::stiffness::PlanarStiffness;
use crate::outline::Outline;
use drawing::{Drawing, Font, Style, View};
use input::InputError;
use input::units::MM;
use nalgebra::{Point2, Vector2, Vector3};

/// Pixels per millimetre.
const SCALE: f64 = 12.0;
/// Margins around the finger, mm: left, top, right, bottom.
const MARGIN: [f64; 4] = [9.0, 12.0, 4.0, 11.0];
/// Largest displacement in the picture, mm.
const MAX_DISPLACEMENT: f64 = 5.0;
/// Force of a grasp on the pad, along y (towards the part) and z (up), N.
const GRASP: [f64; 2] = [-5.0, 0.0];
/// Length of the scale bar, mm.
const BAR: f64 = 10.0;

/// Draws the finger at rest (light) and under the force of a grasp on its pad (dark) as a stand-alone SVG. The gripped
/// part touches only the pad and does not prevent its rotation.
///
/// # Errors
/// If the finger's stiffness cannot be computed.
pub fn svg(geometry: &Geometry) -> Result<String, InputError> {
    let bent = BentFinger::new(geometry).map_err(|error| geometry.finger.fault(error))?;
    let [left, top, right, bottom] = MARGIN.map(|mm| mm * SCALE);
    let view = View { origin: Point2::new(left, top), scale: SCALE / MM };
    let Outline { length, width, clamped, .. } = geometry.finger.outline;
    let [long, wide] = [length, width].map(|size| size * view.scale);
    let mut drawing = Drawing::default();
    drawing.white_background();
    caption(&mut drawing, geometry, bent.exaggeration);
    let boundary = bent.meshed.mesh.boundary();
    let mut shape = |at: &dyn Fn(usize) -> Point2<f64>, colour| {
        let ring = |ring: &Vec<usize>| ring.iter().map(|&node| view.place(at(node))).collect();
        let rings: Vec<Vec<_>> = boundary.iter().map(ring).collect();
        drawing.rings(rings, Style::fill(colour));
    };
    shape(&|node| bent.meshed.mesh.nodes[node], "#d9dde3");
    shape(&|node| bent.moved(node), "#33507a");
    let base = [[length - clamped, 0.0], [length, -width]].map(|p| view.place(p.into()));
    drawing.rectangle(base, 0.0, Style::fill("#8a8f98"));
    let outline = &geometry.finger.outline;
    let pad = [outline.tip_point(), outline.corner()]
        .map(|p| view.place(p + bent.rigid(outline, &p) * bent.exaggeration));
    drawing.line(pad, Style::line("#e8a33d", 4.0));
    let bar = Point2::new(left, top + wide + bottom / 2.0);
    drawing.scale_bar(bar, BAR * SCALE, &format!("{BAR} mm"), 14.0);
    Ok(drawing.svg([left + long + right, top + wide + bottom], ""))
}

/// Finger under load.
struct BentFinger {
    meshed: MeshedFinger,
    /// Displacements along X and Y, m, two for each node.
    displacements: Vec<f64>,
    /// Factor of the displacements in the picture.
    exaggeration: f64,
    /// Motion of the pad along y and z and about x, m and rad.
    motion: Vector3<f64>,
}

impl BentFinger {
    fn new(geometry: &Geometry) -> Result<Self, MeshError> {
        let meshed = MeshedFinger::new(geometry, SIZE)?;
        let element = PlaneStress(Slab::of(&geometry.finger));
        let condensed = condense(&meshed.mesh, &element, &meshed.roles, true)?;
        let held = meshed.rigid_motion(&condensed, &element, RigidFace::Pad)?;
        let stiffness =
            PlanarStiffness::new(held.stiffness).ok_or(MeshError::NotPositiveDefinite)?;
        let [y, z] = GRASP;
        let motion = stiffness.compliance * Vector3::new(y, z, 0.0);
        let displacements = condensed.expand(&(&held.displacements * motion));
        let largest = displacements.iter().fold(0.0, |most: f64, d| most.max(d.abs()));
        let exaggeration = round_down(MAX_DISPLACEMENT * MM / largest);
        Ok(BentFinger { meshed, displacements, exaggeration, motion })
    }

    fn moved(&self, node: usize) -> Point2<f64> {
        let by = Vector2::new(self.displacements[2 * node], self.displacements[2 * node + 1]);
        self.meshed.mesh.nodes[node] + by * self.exaggeration
    }

    /// Returns the displacement of a point of the pad, m.
    fn rigid(&self, outline: &Outline, point: &Point2<f64>) -> Vector2<f64> {
        let [y, z] = self.meshed.local(point);
        let turn = self.motion.z;
        outline.out_of_pad() * (self.motion.x - turn * z)
            + outline.along_pad() * (self.motion.y + turn * y)
    }
}

/// Returns the largest of 1, 2, 5, 10, ... that is not above a positive number.
fn round_down(value: f64) -> f64 {
    let decade = libm::pow(10.0, libm::log10(value).floor());
    [5.0, 2.0, 1.0].map(|step| step * decade).into_iter().find(|&n| n <= value).unwrap_or(decade)
}

fn caption(drawing: &mut Drawing, geometry: &Geometry, factor: f64) {
    let (name, design, [y, z]) = (&geometry.finger.name, &geometry.design, GRASP);
    let title = format!(
        "{name}: infill {} %, {}°; {y:.1} N in y and {z:.1} N in z on the pad",
        design.density_percent, design.direction_deg
    );
    let note = format!(
        "light: at rest; dark: under load, displacements × {factor}; orange: pad, rigid; \
         grey: clamped"
    );
    let x = MARGIN[0] * SCALE;
    drawing.text(Point2::new(x, 28.0), &title, Font::new(18.0));
    drawing.text(Point2::new(x, 50.0), &note, Font::new(14.0).colour("#555"));
}
