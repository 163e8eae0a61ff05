//! Box with round edges, decomposed into convex shapes that join without steps: a core (capsule) along each round
//! edge, one hull with sharp edges that spans all flat faces, and, at each corner that is not part of a ball,
//! a hull that approximates the arcs within 1 um.
//!
//! Arcs that meet at a corner are mitred like intersecting cylinders; three arcs of equal radius form part
//! of a ball.

use super::edges::{Cut, Edge, Face, SAME, corners, cut_at, half_spaces};
use super::geometry;
use contact::scene::Shape;
use nalgebra::{Point3, Vector3};
use std::f64::consts::{FRAC_PI_2, SQRT_2};

/// Height of an arc above its chords at corners, m.
const SAG: f64 = 0.8e-6;

/// Box with round edges.
#[derive(Debug, Clone, PartialEq)]
pub struct Rounded {
    /// Smallest corner, m.
    pub min: Vector3<f64>,
    /// Size, m.
    size: Vector3<f64>,
    edges: Vec<(Edge, Cut)>,
    /// Shapes with their centres relative to the smallest corner, m.
    pieces: Vec<(Shape, Vector3<f64>)>,
    /// Corners of a hull inside the box, at most 1 um below the arcs (at a ball at most 4 % of its radius),
    /// relative to the smallest corner, m.
    inside: Vec<Point3<f64>>,
}

impl Rounded {
    /// Creates the box; `None` if the cuts are too fine for a hull.
    pub(super) fn new([min, max]: [&Vector3<f64>; 2], edges: &[(Edge, Cut)]) -> Option<Self> {
        let size = max - min;
        let (pieces, inside) = (Vec::new(), Vec::new());
        let mut made = Rounded { min: *min, size, edges: edges.to_vec(), pieces, inside };
        made.pieces =
            made.single_core().map_or_else(|| made.decompose(), |core| Some(vec![core]))?;
        let balls: Vec<_> = made.rounded_corners().filter_map(|end| made.ball(&end)).collect();
        let hulls = made.pieces.iter().filter(|(shape, _)| matches!(shape, Shape::Hull { .. }));
        let points = hulls
            .chain(&balls)
            .flat_map(|(shape, at)| shape.corners().into_iter().map(move |point| point + at));
        made.inside = geometry::hull(&points.collect::<Vec<_>>())?.0;
        Some(made)
    }

    /// Returns the shapes and their centres.
    pub fn pieces(&self) -> impl Iterator<Item = (Shape, Vector3<f64>)> {
        self.pieces.iter().map(|(shape, at)| (shape.clone(), at + self.min))
    }

    /// Returns the corners of a hull inside the box, at most 1 um below its arcs.
    pub fn corners(&self) -> impl Iterator<Item = Point3<f64>> {
        self.inside.iter().map(|point| point + self.min)
    }

    /// Returns the largest corner, m.
    pub fn max(&self) -> Vector3<f64> {
        self.min + self.size
    }

    /// Returns the cuts: name of the edge, key and size, m, of the cut.
    pub fn cuts(&self) -> impl Iterator<Item = (String, &'static str, f64)> {
        self.edges.iter().map(|([first, second], cut)| {
            let key = if matches!(cut, Cut::Chamfer(_)) { "chamfer_mm" } else { "radius_mm" };
            (format!("{}{}", first.name(), second.name()), key, cut.size())
        })
    }

    /// Returns the whole box as one rounded box if its edges all have the same radius.
    fn single_core(&self) -> Option<(Shape, Vector3<f64>)> {
        let (_, Cut::Radius(radius)) = *self.edges.first()? else { return None };
        let all =
            self.edges.len() == 12 && self.edges.iter().all(|(_, cut)| *cut == Cut::Radius(radius));
        let core = self.size / 2.0 - Vector3::repeat(radius);
        // A radius of half the thickness leaves rounding errors only.
        let core = core.map(|half| if half < SAME { 0.0 } else { half });
        all.then_some((Shape::RoundBox { core, radius }, self.size / 2.0))
    }

    /// Returns the cores along the round edges, the hull of the flat faces and the hulls of the corners.
    fn decompose(&self) -> Option<Vec<(Shape, Vector3<f64>)>> {
        let mut pieces: Vec<_> =
            self.edges.iter().filter_map(|(edge, cut)| self.core(edge, *cut)).collect();
        let flats = corners(&half_spaces([&Vector3::zeros(), &self.size], &self.edges, |_| 1));
        let (points, _) = geometry::hull(&flats).filter(|(hull, _)| hull.len() == flats.len())?;
        pieces.push(geometry::centred(&points));
        let unequal = self.rounded_corners().filter(|end| self.ball(end).is_none());
        pieces.extend(unequal.filter_map(|end| self.corner_hull(&end)));
        Some(pieces)
    }

    /// Returns the core along a round edge, shortened so that its ends do not protrude.
    fn core(&self, edge: &Edge, cut: Cut) -> Option<(Shape, Vector3<f64>)> {
        let Cut::Radius(radius) = cut else { return None };
        let axis = 3 - edge[0].axis - edge[1].axis;
        let mut centre = Vector3::zeros();
        for face in edge {
            centre[face.axis] = if face.high { self.size[face.axis] - radius } else { radius };
        }
        let [low, high] = [false, true].map(|high| self.trim(edge, radius, Face { axis, high }));
        let half = (self.size[axis] - low - high) / 2.0;
        if half < -SAME {
            return None;
        }
        centre[axis] = (low + self.size[axis] - high) / 2.0;
        let core = Vector3::ith(axis, if half < SAME { 0.0 } else { half });
        Some((Shape::RoundBox { core, radius }, centre))
    }

    /// Returns the smallest distance from a face at which a ball with the radius of a round edge fits, m.
    fn trim(&self, edge: &Edge, radius: f64, end: Face) -> f64 {
        let beside = |side: &Face| match cut_at(&self.edges, [end, *side]) {
            Some(Cut::Chamfer(leg)) => leg + (SQRT_2 - 1.0) * radius,
            Some(Cut::Radius(other)) => other,
            None => 0.0,
        };
        edge.iter().map(beside).fold(radius, f64::max)
    }

    /// Returns the corners of the box at which a round edge ends, each as its three faces.
    fn rounded_corners(&self) -> impl Iterator<Item = [Face; 3]> {
        let corner = |i: usize| [0, 1, 2].map(|axis| Face { axis, high: i >> axis & 1 == 1 });
        let round = |[a, b, c]: &[Face; 3]| {
            let cuts = [[*a, *b], [*b, *c], [*c, *a]].map(|edge| cut_at(&self.edges, edge));
            cuts.iter().any(|cut| matches!(cut, Some(Cut::Radius(_))))
        };
        (0..8).map(corner).filter(round)
    }

    /// Returns the ball of a corner at which three edges of equal radius meet.
    fn ball(&self, [a, b, c]: &[Face; 3]) -> Option<(Shape, Vector3<f64>)> {
        let first = cut_at(&self.edges, [*a, *b]);
        let Some(Cut::Radius(radius)) = first else { return None };
        let all = [[*b, *c], [*c, *a]].iter().all(|&edge| cut_at(&self.edges, edge) == first);
        let at = |face: &Face| if face.high { self.size[face.axis] - radius } else { radius };
        let shape = Shape::RoundBox { core: Vector3::zeros(), radius };
        all.then(|| (shape, Vector3::new(at(a), at(b), at(c))))
    }

    /// Returns the hull of a corner, which the cores of its edges do not reach.
    fn corner_hull(&self, faces: &[Face; 3]) -> Option<(Shape, Vector3<f64>)> {
        let near = |edge: &Edge| edge.iter().all(|face| faces.contains(face));
        let chords = |edge: &Edge| match cut_at(&self.edges, *edge) {
            Some(Cut::Radius(radius)) if near(edge) => {
                let step = 2.0 * libm::acos(1.0 - (SAG / radius).min(0.25));
                (FRAC_PI_2 / step).ceil() as usize
            }
            _ => 1,
        };
        let mut bounds = half_spaces([&Vector3::zeros(), &self.size], &self.edges, chords);
        for (i, end) in faces.iter().enumerate() {
            let [one, other] = [faces[(i + 1) % 3], faces[(i + 2) % 3]];
            let width = |edge: Edge| cut_at(&self.edges, edge).map_or(0.0, Cut::size);
            let own = match cut_at(&self.edges, [one, other]) {
                Some(Cut::Radius(radius)) => self.trim(&[one, other], radius, *end),
                _ => 0.0,
            };
            let reach = own.max(width([*end, one])).max(width([*end, other]));
            let from_low = if end.high { self.size[end.axis] - reach } else { reach };
            // The side of the face `end`.
            let inward = -end.outward();
            bounds.push((inward, inward[end.axis] * from_low));
        }
        Some(geometry::centred(&corners(&bounds))).filter(|(shape, _)| shape.corners().len() > 3)
    }
}

#[cfg(test)]
mod tests {
    use super::super::edges::{cut, named};
    use super::super::geometry::Solid;
    use super::*;
    use contact::shapes;
    use input::units::MM;
    use rapier3d_f64::parry::shape::SharedShape;
    use std::f64::consts::PI;

    const SIZE: [f64; 3] = [4.0 * MM, 6.0 * MM, 10.0 * MM];

    fn made(cuts: &[(&str, Cut)]) -> Rounded {
        let edges: Vec<_> = cuts
            .iter()
            .flat_map(|(at, cut)| named(at).unwrap().into_iter().map(|edge| (edge, *cut)))
            .collect();
        let min = Vector3::new(1.0, -2.0, 3.0) * MM;
        match cut([&min, &(min + Vector3::from(SIZE))], &edges) {
            Ok(Solid::Rounded(rounded)) => rounded,
            other => panic!("{other:?}"),
        }
    }

    /// Pseudorandom number from 0 to 1.
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 33) as f64 / (1u64 << 31) as f64
    }

    /// Distance of a point, from the smallest corner, to the drawn solid; negative inside.
    fn outside(of: &Rounded, p: &Vector3<f64>) -> f64 {
        let depth =
            |face: &Face| if face.high { of.size[face.axis] - p[face.axis] } else { p[face.axis] };
        let sides = (0..3).flat_map(|axis| [false, true].map(|high| Face { axis, high }));
        let flat = sides.map(|face| -depth(&face)).fold(f64::MIN, f64::max);
        let at_edge = |([a, b], cut): &(Edge, Cut)| match cut {
            Cut::Chamfer(leg) => (leg - depth(a) - depth(b)) / SQRT_2,
            Cut::Radius(r) if depth(a) < *r && depth(b) < *r => {
                libm::hypot(r - depth(a), r - depth(b)) - r
            }
            Cut::Radius(_) => f64::MIN,
        };
        let at_ball = |(shape, at): (Shape, Vector3<f64>)| {
            let Shape::RoundBox { radius, .. } = shape else { panic!() };
            let way = p - at;
            let beyond =
                (0..3).all(|i| way[i] * (at[i] - of.size[i] / 2.0) >= 0.0 && way[i] != 0.0);
            if beyond { way.norm() - radius } else { f64::MIN }
        };
        let balls = of.rounded_corners().filter_map(|end| of.ball(&end)).map(at_ball);
        of.edges.iter().map(at_edge).chain(balls).fold(flat, f64::max)
    }

    /// Last point within a solid on the way from a point inside to one outside.
    fn last(
        from: &Vector3<f64>,
        to: &Vector3<f64>,
        within: impl Fn(&Vector3<f64>) -> bool,
    ) -> Vector3<f64> {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            let end = if within(&from.lerp(to, middle)) { &mut low } else { &mut high };
            *end = middle;
        }
        from.lerp(to, low)
    }

    /// Largest distance of the pieces' surface from the drawn one, m, both ways, and of `corners`.
    fn deviation(of: &Rounded, state: &mut u64) -> [f64; 3] {
        let made = |(shape, at): &(Shape, Vector3<f64>)| (shapes::shared(shape, 1e3).0, *at);
        let shapes: Vec<_> = of.pieces.iter().map(made).collect();
        let hull =
            (shapes::shared(&Shape::Hull { points: of.inside.clone() }, 1e3).0, Vector3::zeros());
        let apart = |(shape, at): &(SharedShape, Vector3<f64>), p: &Vector3<f64>| {
            shape.distance_to_local_point(((p - at) * 1e3).into(), true) / 1e3
        };
        let mut found = [0.0f64; 3];
        for i in 0..10_000 {
            // Towards the neighbourhood of an edge.
            let mut to = Vector3::from_fn(|axis, _| random(state) * of.size[axis]);
            for axis in [i % 3, (i + 1) % 3] {
                let beside = 0.3 * of.size[axis] * random(state).powi(2);
                to[axis] = if random(state) < 0.5 { beside } else { of.size[axis] - beside };
            }
            let to = to + (to - of.size / 2.0) * 3.0;
            let point = last(&(of.size / 2.0), &to, |p| outside(of, p) <= 0.0);
            let nearest = shapes.iter().map(|piece| apart(piece, &point)).fold(f64::MAX, f64::min);
            let piece = &shapes[i % shapes.len()];
            let rim = last(&piece.1, &(piece.1 + to - of.size / 2.0), |p| apart(piece, p) <= 0.0);
            let beyond = outside(of, &rim);
            for (most, value) in found.iter_mut().zip([nearest, beyond, apart(&hull, &point)]) {
                *most = most.max(value);
            }
        }
        found
    }

    #[test]
    fn the_pieces_have_the_drawn_surface() {
        let (r, c) = (|mm: f64| Cut::Radius(mm * MM), |mm: f64| Cut::Chamfer(mm * MM));
        let all = ["+x+y", "+x-y", "-x+y", "-x-y", "-z", "+z"];
        let mut state = 7;
        for cuts in [
            vec![("-z", r(0.3))],
            vec![("+x+z", r(0.07))],
            vec![("-z", r(0.02)), ("+x+y", r(0.5))],
            vec![("-z", r(2.0))],
            vec![("-z+x", r(2.0)), ("-z-x", r(2.0)), ("+z", c(1.0))],
            vec![("-z", r(0.6)), ("+x+y", r(0.6)), ("-x+y", c(0.4)), ("+z", c(0.5))],
            vec![("+x+y", r(1.0)), ("+y+z", c(1.5)), ("+x+z", r(0.4)), ("-z", c(0.2))],
            all.map(|at| (at, r(0.5))).to_vec(),
            all.map(|at| (at, r(2.0))).to_vec(),
        ] {
            let made = made(&cuts);
            let found = deviation(&made, &mut state);
            assert!(found[..2].iter().all(|&most| most < 1e-6), "{cuts:?}: {found:?}");
            // The points of a ball are 22.5 degrees apart.
            let ball = made.rounded_corners().filter_map(|end| made.ball(&end)).next();
            let radius = ball.map_or(0.0, |(shape, _)| shape.corners()[0].coords.norm());
            assert!(found[2] < 1e-6 + 0.04 * radius, "{cuts:?}: {found:?}");
        }
    }

    #[test]
    fn a_box_with_all_edges_round_is_one_core_and_has_its_volume() {
        let all =
            ["+x+y", "+x-y", "-x+y", "-x-y", "-z", "+z"].map(|at| (at, Cut::Radius(0.5 * MM)));
        let made = made(&all);
        let core = Vector3::new(1.5, 2.5, 4.5) * MM;
        let [(Shape::RoundBox { core: found, radius }, at)] = &made.pieces[..] else { panic!() };
        assert!((found - core).norm() < 1e-12 && (at - Vector3::from(SIZE) / 2.0).norm() < 1e-12);
        assert!((radius / MM - 0.5).abs() < 1e-12);
        // Steiner's formula.
        let [a, b, c] = [3.0, 5.0, 9.0];
        let exact = a * b * c + (a * b + b * c + c * a) + PI / 4.0 * (a + b + c) + PI / 6.0;
        let volume = geometry::volume(&Solid::Rounded(made)) / MM.powi(3);
        assert!((volume / exact - 1.0).abs() < 2e-3, "{volume} {exact}");
    }
}
