//! Chamfers and radii along the edges of a box: the solid that remains, and the lead-in edges of a task.

use super::geometry::{self, Solid};
use super::rounded::Rounded;
use super::{Part, Task};
use input::units::MM;
use nalgebra::{Matrix3, Point3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Distance below which two corners are the same, m.
pub const SAME: f64 = 1e-6 * MM;

/// A face of a box: its axis, and which end of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Face {
    pub(super) axis: usize,
    pub(super) high: bool,
}

/// Cut along an edge, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cut {
    /// Flat at 45 degrees with this leg along both faces.
    Chamfer(f64),
    /// Arc with this radius, tangent to both faces.
    Radius(f64),
}

impl Cut {
    /// Returns the size of the cut along either face, m.
    pub fn size(self) -> f64 {
        match self {
            Cut::Chamfer(size) | Cut::Radius(size) => size,
        }
    }
}

/// An edge by its two faces.
pub type Edge = [Face; 2];

/// Returns the edges with a name: the four edges of a face ("-z"), or the edge of two faces ("+x-z"); `None` if
/// invalid.
pub fn named(text: &str) -> Option<Vec<Edge>> {
    let face = |text: &str| faces().find(|face| face.name() == text);
    let first = face(text.get(..2)?)?;
    if text.len() > 2 {
        let second = face(text.get(2..)?)?;
        return (first.axis != second.axis).then_some(vec![[first, second]]);
    }
    let sides = faces().filter(|side| side.axis != first.axis);
    Some(sides.map(|side| [first, side]).collect())
}

/// Returns the six faces of a box.
fn faces() -> impl Iterator<Item = Face> {
    (0..3).flat_map(|axis| [false, true].map(|high| Face { axis, high }))
}

/// Returns whether two edges are the same, in either order of their faces.
fn same(a: &Edge, b: &Edge) -> bool {
    a == b || *a == [b[1], b[0]]
}

/// Returns the cut of an edge.
pub fn cut_at(edges: &[(Edge, Cut)], edge: Edge) -> Option<Cut> {
    edges.iter().find(|(other, _)| same(other, &edge)).map(|(_, cut)| *cut)
}

/// Half-space of the points `p` with `normal . p <= distance`: outward normal, and distance from the origin, m.
pub(super) type HalfSpace = (Vector3<f64>, f64);

/// Returns the half-space behind the plane through a point with an outward normal.
fn half_space(point: &Vector3<f64>, normal: Vector3<f64>) -> HalfSpace {
    (normal, normal.dot(point))
}

impl Face {
    pub(super) fn name(self) -> String {
        let sign = if self.high { '+' } else { '-' };
        format!("{sign}{}", ["x", "y", "z"][self.axis])
    }

    pub(super) fn outward(self) -> Vector3<f64> {
        Vector3::ith(self.axis, if self.high { 1.0 } else { -1.0 })
    }
}

/// Problem of cuts that overlap.
const TOO_LARGE: &str = "do not fit on the part; make them smaller";
/// Problem of a part whose hull would lose corners.
const TOO_THIN: &str = "do not fit: the part is too thin or too small; leave its edges sharp";

/// Returns the solid that remains of a box after the cuts.
///
/// # Errors
/// If the cuts overlap, or the box is too thin or too small.
pub fn cut([min, max]: [&Vector3<f64>; 2], edges: &[(Edge, Cut)]) -> Result<Solid, &'static str> {
    if !fit(&(max - min), edges) {
        return Err(TOO_LARGE);
    }
    if edges.iter().any(|(_, cut)| matches!(cut, Cut::Radius(_))) {
        return Rounded::new([min, max], edges).map(Solid::Rounded).ok_or(TOO_THIN);
    }
    let corners = corners(&half_spaces([min, max], edges, |_| 1));
    let hull = geometry::hull(&corners).filter(|(points, _)| points.len() == corners.len());
    hull.map(|(points, _)| Solid::Hull { points }).ok_or(TOO_THIN)
}

/// Returns the half-spaces of a box with cut edges. One plane replaces a chamfered edge, and one for each chord a round
/// edge; `chords` returns the number of chords.
pub(super) fn half_spaces(
    [min, max]: [&Vector3<f64>; 2],
    edges: &[(Edge, Cut)],
    chords: impl Fn(&Edge) -> usize,
) -> Vec<HalfSpace> {
    let corner = |face: Face| if face.high { max } else { min };
    let mut spaces: Vec<_> = faces().map(|face| half_space(corner(face), face.outward())).collect();
    for &(edge, cut) in edges {
        let [first, second] = edge;
        let mut at = *corner(first);
        at[second.axis] = corner(second)[second.axis];
        let [a, b] = edge.map(Face::outward);
        match cut {
            Cut::Chamfer(leg) => spaces.push(half_space(&(at - a * leg), (a + b).normalize())),
            Cut::Radius(radius) => {
                let (centre, chords) = (at - (a + b) * radius, chords(&edge));
                let step = FRAC_PI_2 / chords as f64;
                for i in 0..chords {
                    let turn = (i as f64 + 0.5) * step;
                    let normal = a * libm::cos(turn) + b * libm::sin(turn);
                    let point = centre + normal * (radius * libm::cos(step / 2.0));
                    spaces.push(half_space(&point, normal));
                }
            }
        }
    }
    spaces
}

impl Solid {
    /// Returns a box with a chamfer along the edges with a name; `None` if the chamfer does not fit.
    pub fn chamfered(min: &Vector3<f64>, max: &Vector3<f64>, at: &str, leg: f64) -> Option<Self> {
        let edges: Vec<_> = named(at)?.into_iter().map(|edge| (edge, Cut::Chamfer(leg))).collect();
        cut([min, max], &edges).ok()
    }
}

/// Returns whether the cuts at opposite edges of each face fit on it.
fn fit(size: &Vector3<f64>, edges: &[(Edge, Cut)]) -> bool {
    let reach = |edge: Edge| cut_at(edges, edge).map_or(0.0, Cut::size);
    let room = |face: Face, side: Face| {
        let across = Face { high: !side.high, ..side };
        reach([face, side]) + reach([face, across]) <= size[side.axis] + SAME
    };
    edges.iter().all(|([a, b], _)| room(*a, *b) && room(*b, *a))
}

/// Returns the corners of the intersection of all half-spaces.
pub(super) fn corners(spaces: &[HalfSpace]) -> Vec<Point3<f64>> {
    let mut points: Vec<Point3<f64>> = Vec::new();
    for (i, a) in spaces.iter().enumerate() {
        for (j, b) in spaces.iter().enumerate().skip(i + 1) {
            for c in &spaces[j + 1..] {
                let Some(point) = intersection([a, b, c]) else { continue };
                let inside = |(normal, distance): &HalfSpace| {
                    normal.dot(&point.coords) <= distance + SAME / 10.0
                };
                if spaces.iter().all(inside) && !points.iter().any(|p| (p - point).norm() < SAME) {
                    points.push(point);
                }
            }
        }
    }
    points
}

/// Returns the intersection of three planes; `None` unless it is one point.
fn intersection(planes: [&HalfSpace; 3]) -> Option<Point3<f64>> {
    let normals = Matrix3::from_rows(&planes.map(|(normal, _)| normal.transpose()));
    if normals.determinant().abs() < 1e-6 {
        return None;
    }
    let distances = Vector3::from(planes.map(|(_, distance)| *distance));
    normals.try_inverse().map(|inverse| Point3::from(inverse * distances))
}

/// Largest distance from the plug's tip to the lower face of a box whose edges lead in, m.
const LEAD_IN: f64 = 2.0 * MM;
/// Largest radius, as a share of a box's smallest side: sheet metal is round at its edge.
const MAX_SHARE: f64 = 0.49;
/// Largest distance from the opening at which a face counts as its wall, m.
const WALL_DISTANCE: f64 = 0.15 * MM;

impl Task {
    /// Returns the task with a radius, m, on the edges that lead in: those at the bottom of the plug's boxes
    /// at its tip, and those of the socket's boxes along the opening. The radius of a thin box is limited
    /// by its thickness. Parts that are not boxes do not change.
    pub fn rounded(&self, radius: f64) -> Task {
        let mut task = self.clone();
        let corners = self.plug.parts.iter().flat_map(|part| part.solid.corners());
        let tip = corners.map(|p| p.z).fold(f64::INFINITY, f64::min);
        for part in &mut task.plug.parts {
            let at_tip = |min: &Vector3<f64>| min.z < tip + LEAD_IN;
            cut_edges(part, radius, Cut::Radius, |min, _| named("-z").filter(|_| at_tip(min)));
        }
        task.cut_opening(radius, Cut::Radius);
        task
    }

    /// Returns the task with a chamfer, m along either face, on the edges of the socket's boxes along the
    /// opening. The chamfer of a thin box is limited by its thickness. Parts that are not boxes do not change.
    pub fn chamfered(&self, leg: f64) -> Task {
        let mut task = self.clone();
        task.cut_opening(leg, Cut::Chamfer);
        task
    }

    fn cut_opening(&mut self, size: f64, cut: fn(f64) -> Cut) {
        let [x, y] = self.opening;
        for part in &mut self.socket {
            cut_edges(part, size, cut, |min, max| {
                let walls = [
                    (max.x - x[0], "+x+z"),
                    (min.x - x[1], "-x+z"),
                    (max.y - y[0], "+y+z"),
                    (min.y - y[1], "-y+z"),
                ];
                let beside =
                    walls.iter().filter(|(off, _)| max.z.abs() < SAME && off.abs() < WALL_DISTANCE);
                Some(beside.filter_map(|(_, edge)| named(edge)).flatten().collect())
            });
        }
    }
}

/// Cuts the edges of a box that `which` returns for its smallest and largest corner.
fn cut_edges(
    part: &mut Part,
    size: f64,
    cut_by: fn(f64) -> Cut,
    which: impl Fn(&Vector3<f64>, &Vector3<f64>) -> Option<Vec<Edge>>,
) {
    let Solid::Box { min, max } = &part.solid else { return };
    let edges = which(min, max).unwrap_or_default();
    let size = size.min(MAX_SHARE * (max - min).min());
    let cuts: Vec<_> = edges.into_iter().map(|edge| (edge, cut_by(size))).collect();
    if !cuts.is_empty()
        && let Ok(solid) = cut([min, max], &cuts)
    {
        part.solid = solid;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::task::geometry::volume;
    use std::f64::consts::PI;

    const SIZE: [f64; 3] = [4.0, 6.0, 10.0];

    fn left(text: &str, cut: Cut) -> Result<Solid, &'static str> {
        let edges: Vec<_> = named(text).unwrap().into_iter().map(|edge| (edge, cut)).collect();
        super::cut([&Vector3::zeros(), &(Vector3::from(SIZE) * MM)], &edges)
    }

    fn missing(text: &str, cut: Cut) -> f64 {
        let [x, y, z] = SIZE;
        x * y * z - volume(&left(text, cut).unwrap()) / (MM * MM * MM)
    }

    #[test]
    fn a_chamfer_takes_half_a_square_off_each_millimetre_of_its_edge() {
        let chamfer = Cut::Chamfer(0.5 * MM);
        assert!((missing("-z+x", chamfer) - 0.125 * 6.0).abs() < 1e-9);
        assert!((missing("+y-x", chamfer) - 0.125 * 10.0).abs() < 1e-9);
        // Around a face: two corners of neighbours share a pyramid of leg^3 / 3.
        let face = 0.125 * 2.0 * (4.0 + 6.0) - 4.0 * 0.125 / 3.0;
        assert!((missing("-z", chamfer) - face).abs() < 1e-9);
    }

    #[test]
    fn a_radius_takes_off_what_a_quarter_circle_leaves_of_a_square() {
        let exact = (1.0 - PI / 4.0) * 0.8 * 0.8 * 10.0;
        let taken = missing("+x+y", Cut::Radius(0.8 * MM));
        // Chords lie at most 0.8 um below the arc.
        let more = 0.8e-3 * 0.8 * PI / 2.0 * 10.0;
        assert!((exact..exact + more).contains(&taken), "{taken} {exact}");
    }

    #[test]
    fn a_cut_may_take_a_face_away_but_not_the_other_side() {
        let Ok(Solid::Hull { points }) = left("-z+x", Cut::Chamfer(4.0 * MM)) else { panic!() };
        assert_eq!(points.len(), 8, "a wedge at the tip: {points:?}");
        assert_eq!(left("-z+x", Cut::Chamfer(4.1 * MM)), Err(TOO_LARGE));
        assert_eq!(left("-z", Cut::Radius(2.1 * MM)), Err(TOO_LARGE));
        assert!(left("-z", Cut::Radius(1.9 * MM)).is_ok());
    }

    /// Each plate that can be cut keeps its corners; plates that are too thin are rejected.
    #[test]
    fn no_plate_loses_corners() {
        let (mut whole, mut refused) = (0, 0);
        for thick in [0.05, 0.1, 0.3, 1.0] {
            for side in [5.0, 20.0, 100.0, 900.0] {
                let max = Vector3::new(thick, side, 2.0 * side) * MM;
                let named = |at| named(at).unwrap().into_iter();
                let radius = |edge| (edge, Cut::Radius(thick / 3.0 * MM));
                let chamfer = |edge| (edge, Cut::Chamfer(thick / 3.0 * MM));
                let edges: Vec<_> =
                    named("-z").map(radius).chain(named("+z").map(chamfer)).collect();
                match super::cut([&Vector3::zeros(), &max], &edges) {
                    Ok(solid) => {
                        whole += 1;
                        let share = volume(&solid) / max.product();
                        assert!(share > 0.95, "{thick} x {side} mm keeps {share}");
                    }
                    Err(why) => {
                        refused += 1;
                        assert_eq!(why, TOO_THIN);
                        assert!(thick / side < 0.003, "{thick} x {side} mm");
                    }
                }
            }
        }
        assert!(whole > 4 && refused > 0, "{whole} whole, {refused} refused");
    }

    #[test]
    fn edges_are_named_by_one_face_or_by_two() {
        assert_eq!(named("-z").unwrap().len(), 4);
        assert!(same(&named("+x-z").unwrap()[0], &named("-z+x").unwrap()[0]));
        for wrong in ["", "z", "-", "-q", "+x-x", "-z+", "-z+xy", "+x+y+z", "\u{e9}z"] {
            assert_eq!(named(wrong), None, "{wrong}");
        }
    }

    /// The key's four edges at the tip and the slot's four at its mouth are round, nothing else is.
    #[test]
    fn the_edges_that_lead_in_are_rounded() {
        let task = crate::tests::fixtures::task("ket8");
        let round = task.rounded(0.3 * MM);
        let missing = |before: &Part, after: &Part| volume(&before.solid) - volume(&after.solid);
        // Along the 30 mm about the tip, but for the corners, where two cuts meet.
        let along = 30.0 * (1.0 - PI / 4.0) * 0.09;
        let tip = missing(&task.plug.parts[0], &round.plug.parts[0]) / (MM * MM * MM);
        assert!((tip / along - 1.0).abs() < 0.05, "{tip} of {along} mm3");
        for (before, after) in task.socket.iter().zip(&round.socket) {
            let less = missing(before, after) > 0.0;
            assert_eq!(less, before.name != "floor", "{}", before.name);
            let inner =
                |part: &Part| part.solid.corners().iter().map(|p| p.y.abs()).fold(9.0, f64::min);
            assert!((inner(before) - inner(after)).abs() < SAME, "{}", before.name);
        }
        assert_eq!(task.opening, round.opening);
    }

    /// Only the mouth is cut, by half a square along each of its four sides.
    #[test]
    fn an_opening_is_chamfered_and_the_plug_is_not() {
        let task = crate::tests::fixtures::task("ket8");
        let cut = task.chamfered(0.5 * MM);
        assert_eq!(task.plug, cut.plug);
        let all = |task: &Task| task.socket.iter().map(|part| volume(&part.solid)).sum::<f64>();
        let missing = (all(&task) - all(&cut)) / (MM * MM * MM);
        // The walls at -y and +y are 80 mm long, those at -x and +x fill the slot's 8.15 mm.
        assert!((missing - 0.125 * 2.0 * (80.0 + 8.15)).abs() < 1e-6, "{missing} mm3");
    }
}
