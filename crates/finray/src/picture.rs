//! A picture of a finger that bends under a load on its pad.

use super::FingerError;
use super::condense::condense;
use super::elasticity::{PlaneStress, Slab};
use super::geometry::Geometry;
use super::mechanics::SIZE;
use super::mesh::MeshError;
use super::meshed::{Body, MeshedFinger};
use super::stiffness::PlanarStiffness;
use crate::outline::Outline;
use input::units::MM;
use nalgebra::{Point2, Vector2, Vector3};
use std::fmt::Write;

/// Pixels per millimetre.
const SCALE: f64 = 12.0;
/// Margins around the finger, mm: left, top, right, bottom.
const MARGIN: [f64; 4] = [9.0, 12.0, 4.0, 11.0];
/// Longest displacement in the picture, mm.
const LONGEST: f64 = 5.0;
/// Length of the scale bar, mm.
const BAR: f64 = 10.0;

/// Stand-alone SVG of the finger at rest (light) and under a force on its pad, y and z in N
/// (dark). The part touches the pad alone and does not hold it from turning.
///
/// # Errors
/// If the finger's stiffness cannot be computed.
pub fn svg(geometry: &Geometry, force: [f64; 2]) -> Result<String, FingerError> {
    let bent = Bent::new(geometry, force).map_err(|error| FingerError::mesh(geometry, error))?;
    let outline = &geometry.finger.outline;
    let [left, top, right, bottom] = MARGIN;
    let (wide, height) = (outline.length / MM + left + right, outline.width / MM + top + bottom);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0} {:.0}\" \
         font-family=\"sans-serif\" font-size=\"14\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        wide * SCALE,
        height * SCALE,
    );
    words(&mut out, geometry, force, bent.exaggeration, height);
    let boundary = bent.meshed.mesh.boundary();
    let rings = |at: &dyn Fn(usize) -> Point2<f64>| {
        boundary.iter().map(|ring| path(ring.iter().map(|&node| at(node)))).collect::<String>()
    };
    shape(&mut out, &rings(&|node| bent.meshed.mesh.nodes[node]), "#d9dde3");
    shape(&mut out, &rings(&|node| bent.moved(node)), "#33507a");
    let Outline { length, width, clamped, .. } = *outline;
    let (start, back) = (length - clamped, -width);
    let base = [[start, 0.0], [length, 0.0], [length, back], [start, back]];
    shape(&mut out, &path(base.into_iter().map(Point2::from)), "#8a8f98");
    let [tip, corner] = [outline.tip_point(), outline.corner()]
        .map(|p| pixels(p + bent.rigid(outline, &p) * bent.exaggeration));
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "<polyline points=\"{tip} {corner}\" fill=\"none\" stroke=\"#e8a33d\" \
         stroke-width=\"4\"/>\n</svg>"
    );
    Ok(out)
}

/// Finger under load.
struct Bent {
    meshed: MeshedFinger,
    /// Two numbers for each node, m.
    displacements: Vec<f64>,
    exaggeration: f64,
    /// Motion of the pad along y and z and about x, m and rad.
    motion: Vector3<f64>,
}

impl Bent {
    fn new(geometry: &Geometry, [y, z]: [f64; 2]) -> Result<Self, MeshError> {
        let meshed = MeshedFinger::new(geometry, SIZE)?;
        let element = PlaneStress(Slab::of(&geometry.finger));
        let condensed = condense(&meshed.mesh, &element, &meshed.roles, true)?;
        let held = meshed.hold(&condensed, &element, Body::Pad)?;
        let stiffness = PlanarStiffness::new(held.stiffness).ok_or(MeshError::Limp)?;
        let motion = stiffness.compliance * Vector3::new(y, z, 0.0);
        let displacements = condensed.expand(&(&held.follow * motion));
        let largest = displacements.iter().fold(0.0, |most: f64, d| most.max(d.abs()));
        let exaggeration = round(LONGEST * MM / largest);
        Ok(Bent { meshed, displacements, exaggeration, motion })
    }

    fn moved(&self, node: usize) -> Point2<f64> {
        let by = Vector2::new(self.displacements[2 * node], self.displacements[2 * node + 1]);
        self.meshed.mesh.nodes[node] + by * self.exaggeration
    }

    /// Displacement of a point of the pad, m.
    fn rigid(&self, outline: &Outline, point: &Point2<f64>) -> Vector2<f64> {
        let [y, z] = self.meshed.local(point);
        let turn = self.motion.z;
        outline.out_of_pad() * (self.motion.x - turn * z)
            + outline.along_pad() * (self.motion.y + turn * y)
    }
}

/// Largest of 1, 2, 5, 10, ... that is not above a number; 0 unless it is finite and above 0.
fn round(value: f64) -> f64 {
    if !(value.is_finite() && value > 0.0) {
        return 0.0;
    }
    let decade = libm::pow(10.0, libm::log10(value).floor());
    [5.0, 2.0, 1.0].map(|step| step * decade).into_iter().find(|&n| n <= value).unwrap_or(decade)
}

fn words(out: &mut String, geometry: &Geometry, [y, z]: [f64; 2], factor: f64, height: f64) {
    let (name, design) = (&geometry.finger.name, &geometry.design);
    let title = format!(
        "{name}: infill {} %, {}°; {y:.1} N in y and {z:.1} N in z on the pad",
        design.density_percent, design.direction_deg
    );
    let note = format!(
        "light: at rest; dark: under load, displacements × {factor}; orange: pad, rigid; \
         grey: clamped"
    );
    let [left, _, _, bottom] = MARGIN;
    let (x, bar) = (left * SCALE, (height - bottom + 6.0) * SCALE);
    let _ = write!(
        out,
        "<text x=\"{x:.0}\" y=\"28\" font-size=\"18\">{}</text>\n\
         <text x=\"{x:.0}\" y=\"50\" fill=\"#555\">{note}</text>\n\
         <path d=\"M{x:.0} {bar:.0} h{:.0}\" stroke=\"#000\" stroke-width=\"3\"/>\n\
         <text x=\"{x:.0}\" y=\"{:.0}\">{BAR} mm</text>\n",
        title.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;"),
        BAR * SCALE,
        bar + 20.0,
    );
}

fn shape(out: &mut String, path: &str, fill: &str) {
    let _ = writeln!(out, "<path d=\"{path}\" fill=\"{fill}\" fill-rule=\"evenodd\"/>");
}

fn path(points: impl Iterator<Item = Point2<f64>>) -> String {
    let points: Vec<String> = points.map(pixels).collect();
    format!("M{}Z", points.join("L"))
}

fn pixels(point: Point2<f64>) -> String {
    let [left, top, ..] = MARGIN;
    format!("{:.1},{:.1}", (point.x / MM + left) * SCALE, (top - point.y / MM) * SCALE)
}
