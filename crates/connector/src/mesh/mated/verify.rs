//! Comparison of convex parts with the drawn body (the mesh of the file) that they approximate: its faces must lie near
//! a part, and no corner of a part may lie outside the drawn body.

use crate::body::ConvexBody;
use crate::mesh::Triangle;
use crate::mesh::skin::snapped_hull;
use input::units::MM;
use insertion::task::geometry;
use insertion::{Part, Solid};
use nalgebra::{Point3, Vector3};
use parry::math::Vector;
use parry::query::PointQuery;
use parry::shape::TriMesh;
use rapier3d_f64::parry;
use rayon::prelude::*;

/// Largest accepted distance between parts and drawing, m.
pub const TOLERANCE: f64 = 0.02 * MM;
/// Three times the distance of the outermost samples of a triangle from an edge, as a share of the height above that
/// edge.
const MARGIN: f64 = 0.1;
/// Largest spacing of samples along a side, m, up to [`MAX_SAMPLES`].
const SPACING: f64 = 0.5 * MM;
/// Largest number of intervals between samples along the side of a triangle.
const MAX_SAMPLES: usize = 12;

/// Place where parts and drawing differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// Place, m.
    pub place: Point3<f64>,
    /// Distance by which a part protrudes from the drawn body, m; `None` where no part covers a drawn face.
    pub out: Option<f64>,
}

/// Returns the deviation of the part that protrudes most from the drawing of its body (0 plug, 1 socket) or, if none
/// does, a face without a part; of equal ones, that of the plug.
pub(super) fn worst([plug, socket]: [Vec<Deviation>; 2]) -> Option<(usize, Deviation)> {
    let far = |(_, off): &(usize, Deviation)| off.out.unwrap_or(0.0);
    let plug = plug.into_iter().map(|off| (0, off));
    let all = socket.into_iter().map(|off| (1, off)).chain(plug);
    all.max_by(|a, b| far(a).total_cmp(&far(b)))
}

/// Drawn body with which parts are compared.
pub struct Drawn<'a> {
    /// Triangles with outward normals, m.
    triangles: &'a [Triangle],
    /// The same triangles, mm; `None` if parry rejects them: then every part counts as protruding.
    mesh: Option<TriMesh>,
}

impl<'a> Drawn<'a> {
    /// Creates the body enclosed by triangles with outward normals, m.
    pub fn new(triangles: &'a [Triangle]) -> Self {
        let points = triangles.iter().flatten().map(|p| (p.coords / MM).into()).collect();
        let faces = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Drawn { triangles, mesh: TriMesh::new(points, faces).ok() }
    }

    /// Returns the nearest point of the surface and its distance, m, for a place outside the body by more than the
    /// tolerance, and `None` for any other place.
    fn outside(&self, place: &Point3<f64>) -> Option<(Point3<f64>, f64)> {
        let Some(mesh) = &self.mesh else { return Some((*place, f64::INFINITY)) };
        let point: Vector = (place.coords / MM).into();
        let near = mesh.project_local_point(point, false).point;
        let distance = (near - point).length() * MM;
        (distance > TOLERANCE && winding(self.triangles, place) < 0.5)
            .then(|| (Point3::from(Vector3::from(near) * MM), distance))
    }

    /// Moves the corners of a convex solid that are outside the body to its surface; `None` if the result still
    /// protrudes, for example behind a sharp edge.
    pub fn trimmed(&self, solid: Solid) -> Option<Solid> {
        let corners = solid.corners();
        let moved =
            |place: &Point3<f64>| self.outside(place).map_or(*place, |(nearest, _)| nearest);
        let moved: Vec<_> = corners.iter().map(moved).collect();
        let solid = if moved == corners { solid } else { snapped_hull(&moved)? };
        self.protrusion(&solid).is_none().then_some(solid)
    }

    /// Returns the first corner or centre of a hull triangle of a convex solid that is outside the body.
    fn protrusion(&self, solid: &Solid) -> Option<Deviation> {
        let (corners, faces) = geometry::hull(&solid.corners())?;
        let middles = faces.iter().map(|face| {
            let [a, b, c] = face.map(|corner| corners[corner].coords);
            Point3::from((a + b + c) / 3.0)
        });
        let off = |place: Point3<f64>| {
            self.outside(&place).map(|(_, out)| Deviation { place, out: Some(out) })
        };
        corners.iter().copied().chain(middles).find_map(off)
    }

    /// Returns the samples of the faces `kept` (those that the other body can touch) without a part nearby, and one
    /// place of each part that protrudes.
    pub fn deviations(&self, kept: &[Triangle], parts: &[Part]) -> Vec<Deviation> {
        let body = ConvexBody::new(parts);
        let uncovered = |triangle: &Triangle| -> Vec<Deviation> {
            let samples = samples(triangle, SPACING, MAX_SAMPLES, MARGIN);
            let bare = samples.filter(|p| body.near(p, TOLERANCE).next().is_none());
            bare.map(|place| Deviation { place, out: None }).collect()
        };
        let mut found: Vec<Deviation> = kept.par_iter().flat_map_iter(uncovered).collect();
        let out = |part: &Part| self.protrusion(&part.solid);
        found.par_extend(parts.par_iter().filter_map(out));
        found
    }
}

/// Returns evenly spaced points of a triangle, at most `spacing` apart, m, unless that needs more than `most` steps
/// along a side. `margin` is three times the distance of the outermost points from an edge, as a share of the height
/// above that edge.
pub(super) fn samples(
    &[a, b, c]: &Triangle,
    spacing: f64,
    most: usize,
    margin: f64,
) -> impl Iterator<Item = Point3<f64>> {
    let longest = (b - a).norm().max((c - a).norm()).max((c - b).norm());
    let steps = ((longest / spacing).ceil() as usize).clamp(1, most);
    let inside = move |k: usize| margin / 3.0 + (1.0 - margin) * k as f64 / steps as f64;
    let place = move |i, j| a + (b - a) * inside(i) + (c - a) * inside(j);
    (0..=steps).flat_map(move |i| (0..=steps - i).map(move |j| place(i, j)))
}

/// Returns the generalized winding number of oriented triangles about a point (Jacobson et al. 2013): 1 inside, 0
/// outside.
fn winding(triangles: &[Triangle], place: &Point3<f64>) -> f64 {
    let angle = |triangle: &Triangle| {
        let [a, b, c] = triangle.map(|p| p - place);
        let [la, lb, lc] = [a.norm(), b.norm(), c.norm()];
        let volume = a.dot(&b.cross(&c));
        let sum = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
        libm::atan2(volume, sum)
    };
    triangles.iter().map(angle).sum::<f64>() / std::f64::consts::TAU
}

#[cfg(test)]
mod tests {
    use super::super::overlap::tests::{faces, part};
    use super::*;

    #[test]
    fn a_protruding_part_and_a_bare_face_are_found() {
        let drawn = faces([0.0; 3], [4.0; 3]);
        let whole = part([0.0; 3], [4.0; 3]);
        assert_eq!(Drawn::new(&drawn).deviations(&drawn, &[whole]), []);
        let long = part([0.0; 3], [4.0, 4.0, 4.05]);
        let out = Drawn::new(&drawn).deviations(&drawn, &[long]);
        let sticks_out = |far: f64| (far - 0.05 * MM).abs() < 1e-9;
        assert!(out.iter().any(|d| d.out.is_some_and(sticks_out)), "{out:?}");
        let short = part([0.0; 3], [4.0, 4.0, 3.95]);
        let bare = Drawn::new(&drawn).deviations(&drawn, &[short]);
        assert!(!bare.is_empty() && bare.iter().all(|d| d.out.is_none() && d.place.z > 3.9 * MM));
    }

    #[test]
    fn the_larger_deviation_of_two_bodies_is_the_worst() {
        let off = |x: f64, out: Option<f64>| Deviation { place: Point3::new(x, 0.0, 0.0), out };
        let (bare, near, far) = (off(1.0, None), off(2.0, Some(0.03)), off(3.0, Some(0.05)));
        assert_eq!(worst([vec![near, bare], vec![far]]), Some((1, far)));
        assert_eq!(worst([vec![bare], vec![near]]), Some((1, near)));
        assert_eq!(worst([vec![far], vec![near, far]]), Some((0, far)));
        assert_eq!(worst([vec![], vec![bare]]), Some((1, bare)));
        assert_eq!(worst([vec![], vec![]]), None);
    }

    #[test]
    fn parts_without_a_drawing_protrude() {
        let whole = part([0.0; 3], [4.0; 3]);
        assert_eq!(Drawn::new(&[]).trimmed(whole.solid.clone()), None);
        assert!(Drawn::new(&[]).deviations(&[], &[whole])[0].out.is_some());
    }

    /// Off the grid, the rounding in files could change the solid or make it invalid.
    #[test]
    fn trimmed_corners_are_on_the_grid_of_files() {
        let solid = part([1.0, 1.0, 3.0], [2.0, 2.0, 4.1]).solid;
        let trimmed = Drawn::new(&faces([0.0; 3], [4.000_03; 3])).trimmed(solid).unwrap();
        for corner in trimmed.corners() {
            let grid = corner / (1e-4 * MM);
            assert!((grid - grid.map(f64::round)).amax() < 1e-6, "{corner}");
        }
        assert_eq!(crate::body::extent(trimmed.corners(), 2)[1], 4.0 * MM);
    }
}
