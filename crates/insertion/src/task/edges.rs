//! Chamfers and radii along the edges of a box: the hull that they leave.

use super::geometry::{self, Solid};
use input::units::MM;
use nalgebra::{Matrix3, Point3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Flats of a rounded edge, tangent to the arc: their corners stand out by 1.2 % of the radius.
const FLATS: usize = 4;
/// Corners nearer to one another are one, m.
pub const SAME: f64 = 1e-6 * MM;

/// A face of a box: its axis, and which end of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Face {
    axis: usize,
    high: bool,
}

/// Cut along an edge, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cut {
    /// A flat at 45 degrees, so far along either face.
    Chamfer(f64),
    /// An arc that is tangent to both faces.
    Radius(f64),
}

/// An edge by its two faces.
pub type Edge = [Face; 2];

/// Edges of that name: the four of a face ("-z"), or the one between two ("+x-z"); `None` if bad.
pub fn named(text: &str) -> Option<Vec<Edge>> {
    let face = |text: &str| {
        let axis = ["x", "y", "z"].iter().position(|name| text.get(1..) == Some(name))?;
        let high = ['-', '+'].iter().position(|&sign| text.starts_with(sign))? == 1;
        Some(Face { axis, high })
    };
    let first = face(text.get(..2)?)?;
    if text.len() > 2 {
        let second = face(text.get(2..)?)?;
        return (first.axis != second.axis).then_some(vec![[first, second]]);
    }
    let others = (0..3).filter(|&axis| axis != first.axis);
    let sides = others.flat_map(|axis| [false, true].map(|high| Face { axis, high }));
    Some(sides.map(|side| [first, side]).collect())
}

/// Whether two edges are the same.
pub fn same(a: &Edge, b: &Edge) -> bool {
    a == b || *a == [b[1], b[0]]
}

/// All points with `normal . p <= distance`.
struct HalfSpace {
    normal: Vector3<f64>,
    distance: f64,
}

impl HalfSpace {
    fn through(point: &Vector3<f64>, normal: Vector3<f64>) -> Self {
        HalfSpace { normal, distance: normal.dot(point) }
    }
}

impl Face {
    fn outward(self) -> Vector3<f64> {
        let mut normal = Vector3::zeros();
        normal[self.axis] = if self.high { 1.0 } else { -1.0 };
        normal
    }
}

/// Problem of cuts that take more than a face has.
const ROOM: &str = "take off more than the part has; make them smaller";
/// Problem of so thin, or so small, a part that corners of the hull would be lost.
const THIN: &str = "need a part that is not so thin or so small; leave its edges sharp";

/// The solid that the cuts leave of a box.
///
/// # Errors
/// The problem of the cuts.
pub fn cut(
    min: &Vector3<f64>,
    max: &Vector3<f64>,
    edges: &[(Edge, Cut)],
) -> Result<Solid, &'static str> {
    if !fit(&(max - min), edges) {
        return Err(ROOM);
    }
    let faces = (0..3).flat_map(|axis| [false, true].map(|high| Face { axis, high }));
    let corner = |face: Face| if face.high { max } else { min };
    let mut spaces: Vec<_> =
        faces.map(|face| HalfSpace::through(corner(face), face.outward())).collect();
    for ([first, second], cut) in edges {
        let mut at = *corner(*first);
        at[second.axis] = corner(*second)[second.axis];
        flats(&mut spaces, [first.outward(), second.outward()], &at, *cut);
    }
    let corners = corners(&spaces);
    match geometry::hull(&corners) {
        Some((points, _)) if points.len() == corners.len() => Ok(Solid::Hull { points }),
        _ => Err(THIN),
    }
}

impl Solid {
    /// A box with a chamfer along the edges of that name; `None` where there is none to be made.
    pub fn chamfered(min: &Vector3<f64>, max: &Vector3<f64>, at: &str, leg: f64) -> Option<Self> {
        let edges: Vec<_> = named(at)?.into_iter().map(|edge| (edge, Cut::Chamfer(leg))).collect();
        cut(min, max, &edges).ok()
    }
}

/// Whether the cuts of each face leave one another room on it.
fn fit(size: &Vector3<f64>, edges: &[(Edge, Cut)]) -> bool {
    let reach = |edge: Edge| {
        let cut = edges.iter().find(|(other, _)| same(other, &edge));
        cut.map_or(0.0, |(_, Cut::Chamfer(reach) | Cut::Radius(reach))| *reach)
    };
    let room = |face: Face, side: Face| {
        let across = Face { high: !side.high, ..side };
        reach([face, side]) + reach([face, across]) <= size[side.axis] + SAME
    };
    edges.iter().all(|([a, b], _)| room(*a, *b) && room(*b, *a))
}

/// The planes that a cut puts in place of the edge between the faces with these outward normals.
fn flats(spaces: &mut Vec<HalfSpace>, [a, b]: [Vector3<f64>; 2], edge: &Vector3<f64>, cut: Cut) {
    match cut {
        Cut::Chamfer(leg) => {
            spaces.push(HalfSpace::through(&(edge - a * leg), (a + b).normalize()));
        }
        Cut::Radius(radius) => {
            let centre = edge - (a + b) * radius;
            for i in 1..=FLATS {
                let turn = FRAC_PI_2 * i as f64 / (FLATS + 1) as f64;
                let normal = a * libm::cos(turn) + b * libm::sin(turn);
                spaces.push(HalfSpace::through(&(centre + normal * radius), normal));
            }
        }
    }
}

/// The points that three of the planes share and that lie in all the half-spaces.
fn corners(spaces: &[HalfSpace]) -> Vec<Point3<f64>> {
    let mut found: Vec<Point3<f64>> = Vec::new();
    for (i, a) in spaces.iter().enumerate() {
        for (j, b) in spaces.iter().enumerate().skip(i + 1) {
            for c in &spaces[j + 1..] {
                let Some(point) = meeting([a, b, c]) else { continue };
                let inside = |space: &HalfSpace| {
                    space.normal.dot(&point.coords) <= space.distance + SAME / 10.0
                };
                if spaces.iter().all(inside) && !found.iter().any(|p| (p - point).norm() < SAME) {
                    found.push(point);
                }
            }
        }
    }
    found
}

/// The point that three planes share, unless they meet in a line or nowhere.
fn meeting(planes: [&HalfSpace; 3]) -> Option<Point3<f64>> {
    let normals = Matrix3::from_rows(&planes.map(|plane| plane.normal.transpose()));
    if normals.determinant().abs() < 1e-6 {
        return None;
    }
    let distances = Vector3::from(planes.map(|plane| plane.distance));
    normals.try_inverse().map(|inverse| Point3::from(inverse * distances))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::task::geometry::volume;
    use std::f64::consts::PI;

    const SIZE: [f64; 3] = [4.0, 6.0, 10.0];

    fn left(text: &str, cut: Cut) -> Result<Solid, &'static str> {
        let edges: Vec<_> = named(text).unwrap().into_iter().map(|edge| (edge, cut)).collect();
        super::cut(&Vector3::zeros(), &(Vector3::from(SIZE) * MM), &edges)
    }

    /// Volume that is missing, mm3.
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
        // Tangents leave a little more than the arc: tan t / t of it, t half the angle between two.
        let half = PI / 4.0 / (FLATS + 1) as f64;
        let more = (half.tan() / half - 1.0) * PI / 4.0 * 0.8 * 0.8 * 10.0;
        assert!((taken - (exact - more)).abs() < 1e-9, "{taken}");
        assert!(more < 0.04 * exact);
    }

    #[test]
    fn a_cut_may_take_a_face_away_but_not_the_other_side() {
        let Ok(Solid::Hull { points }) = left("-z+x", Cut::Chamfer(4.0 * MM)) else { panic!() };
        assert_eq!(points.len(), 8, "a wedge at the tip: {points:?}");
        assert_eq!(left("-z+x", Cut::Chamfer(4.1 * MM)), Err(ROOM));
        assert_eq!(left("-z", Cut::Radius(2.1 * MM)), Err(ROOM));
        assert!(left("-z", Cut::Radius(1.9 * MM)).is_ok());
    }

    /// Of every plate that is cut, what is left is whole; the others are refused.
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
                match super::cut(&Vector3::zeros(), &max, &edges) {
                    Ok(solid) => {
                        whole += 1;
                        let share = volume(&solid) / max.product();
                        assert!(share > 0.95, "{thick} x {side} mm keeps {share}");
                    }
                    Err(why) => {
                        refused += 1;
                        assert_eq!(why, THIN);
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
}
