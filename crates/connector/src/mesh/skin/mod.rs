//! Convex slabs from the skin of a body: each flat face is cut into convex polygons, which are extruded into the
//! material. Cavities and slits stay open, and the surface need not be closed; its normals must point outward.

mod facets;
mod polygons;

use super::Triangle;
use super::solid::solid_of;
use super::surface::snap;
use crate::body::{extent, width};
use facets::Facets;
use input::units::MM;
use insertion::Solid;
use insertion::task::geometry::{MIN_VOLUME, hull, volume};
use nalgebra::{Point3, Vector3};
use parry::bounding_volume::{Aabb, BoundingVolume};
use parry::partitioning::{Bvh, BvhBuildStrategy};
use rapier3d_f64::parry;
use std::collections::BTreeSet;

/// Largest thickness of a slab, m: more than the gap at which contacts are predicted, so that a body that slides along
/// a face past its edge meets the side of the slab, not its edge.
const THICK: f64 = 0.25 * MM;
/// Smallest thickness of a slab, m.
const THIN: f64 = 10e-3 * MM;
/// Smallest length of a side at which a polygon is cut into pieces, m.
const MIN_PIECE: f64 = 0.2 * MM;
/// Smallest size of a solid along an axis, m.
const MIN_SIZE: f64 = 2e-3 * MM;
/// Smallest volume of a solid, m3, with a margin for the rounding in files.
const MIN_SOLID_VOLUME: f64 = 10.0 * MIN_VOLUME;
/// Width of the border of a polygon behind which faces do not limit the thickness, m.
const BESIDE: f64 = 5e-3 * MM;
/// Smallest depth of a face that limits the thickness, m; shallower ones are the polygon's own.
const BEHIND: f64 = 5e-3 * MM;
/// Largest height of a corner above a plane that still counts as below it, m.
const CONVEX: f64 = 2e-3 * MM;
/// Largest number of corners of a convex body that becomes one part.
const MAX_CORNERS: usize = 400;
/// Largest cosine between opposite faces that are cut at their common edge; above it, they are the two sides of a film.
const FILM: f64 = 0.9999;
/// Margin of the bounding boxes in which faces are searched for, mm.
const AROUND_MM: f64 = 1e-3;
/// Number of corners of a cut hull at and above which those inside it are dropped.
const MANY: usize = 32;

/// Plane of a face that meets a polygon at less than a right angle: index of the flat face, a point, and the normal.
type SharpFace = (usize, Point3<f64>, Vector3<f64>);

/// Returns convex solids whose outer surface is that of the triangles, m, for which `reached` is true, and these
/// triangles, welded; a slab that `fitted` rejects is made thinner.
pub fn skin(
    triangles: &[Triangle],
    reached: impl Fn(&Triangle, &Vector3<f64>) -> bool,
    fitted: impl Fn(Solid) -> Option<Solid>,
) -> (Vec<Solid>, Vec<Triangle>) {
    let facets = Facets::new(triangles);
    let reached = |face: usize| reached(&facets.corners(face), &facets.normals[face]);
    let reached: Vec<bool> = (0..facets.faces.len()).map(reached).collect();
    let mut whole = vec![false; facets.faces.len()];
    let mut solids = Vec::new();
    for shell in facets.shells() {
        if let Some(solid) = convex_body(&facets, &shell) {
            shell.iter().for_each(|&face| whole[face] = true);
            solids.extend(shell.iter().any(|&face| reached[face]).then_some(solid));
        }
    }
    let (flats, flat_of) = facets.flats();
    let faces = FaceIndex::new(&facets, &flat_of);
    for flat in &flats {
        let normal = facets.normals[flat[0]];
        let kept: Vec<usize> =
            flat.iter().copied().filter(|&face| reached[face] && !whole[face]).collect();
        if normal == Vector3::zeros() || kept.is_empty() {
            continue;
        }
        for polygon in polygons::polygons(&facets, &kept, &normal) {
            solids.extend(faces.slabs(flat, &polygon, &normal, &fitted));
        }
    }
    let kept = (0..reached.len())
        .filter(|&face| reached[face] && facets.normals[face] != Vector3::zeros())
        .map(|face| facets.corners(face));
    (solids, kept.collect())
}

/// Returns a closed shell as one solid if it is convex.
fn convex_body(facets: &Facets, shell: &[usize]) -> Option<Solid> {
    if shell.iter().any(|&face| facets.across[face].contains(&None)) {
        return None;
    }
    let corners: BTreeSet<usize> = shell.iter().flat_map(|&face| facets.faces[face]).collect();
    let flat = |&face: &usize| {
        let (normal, origin) = (facets.normals[face], facets.corners(face)[0]);
        corners.iter().all(|&corner| (facets.points[corner] - origin).dot(&normal) < CONVEX)
    };
    if corners.len() > MAX_CORNERS || !shell.iter().all(flat) {
        return None;
    }
    solid_of(&corners.iter().map(|&corner| facets.points[corner]).collect::<Vec<_>>())
}

/// Spatial index of the triangles.
struct FaceIndex<'a> {
    facets: &'a Facets,
    /// Index of the flat face of each triangle.
    flat_of: &'a [usize],
    tree: Bvh,
}

impl<'a> FaceIndex<'a> {
    fn new(facets: &'a Facets, flat_of: &'a [usize]) -> Self {
        let boxed = |face: usize| bounding_box(&facets.corners(face), AROUND_MM);
        let boxes: Vec<_> = (0..facets.faces.len()).map(boxed).collect();
        FaceIndex { facets, flat_of, tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes) }
    }

    /// Extrudes a polygon of a flat face into the material, in pieces if the whole does not fit: along a sharp edge the
    /// material can be too thin for a slab that fits elsewhere.
    fn slabs(
        &self,
        flat: &[usize],
        polygon: &[usize],
        normal: &Vector3<f64>,
        fitted: impl Fn(Solid) -> Option<Solid>,
    ) -> Vec<Solid> {
        let sharp = self.sharp(flat, polygon, normal);
        let mut open = vec![polygon.iter().map(|&i| self.facets.points[i]).collect::<Vec<_>>()];
        let mut found = Vec::new();
        while let Some(corners) = open.pop() {
            let slab = [&sharp[..], &[]].iter().find_map(|sharp| {
                let half = |thick: &f64| (*thick > THIN).then(|| (thick / 2.0).max(THIN));
                let thick = self.thickness(&corners, normal, sharp);
                std::iter::successors(Some(thick), half)
                    .filter_map(|thick| extruded(&corners, &(normal * thick), sharp))
                    .find_map(&fitted)
            });
            match slab {
                Some(slab) => found.push(slab),
                None => open.extend(halves(&corners).into_iter().flatten()),
            }
        }
        found
    }

    /// Returns the planes of the faces that meet a polygon at less than a right angle.
    fn sharp(&self, flat: &[usize], polygon: &[usize], normal: &Vector3<f64>) -> Vec<SharpFace> {
        let mut found: Vec<SharpFace> = Vec::new();
        let shared = flat.iter().flat_map(|&face| self.facets.neighbours(face));
        for (ends, other) in shared.filter(|(ends, _)| ends.iter().all(|i| polygon.contains(i))) {
            let side = self.facets.normals[other];
            let (flat, origin) = (self.flat_of[other], self.facets.points[ends[0]]);
            let convex = |p: Point3<f64>| (p - origin).dot(normal) < CONVEX;
            // The plane at a short edge of an outline that bends slightly inward would cut off too much.
            let below = |&i: &usize| (self.facets.points[i] - origin).dot(&side) < CONVEX;
            if (-FILM..-1e-6).contains(&side.dot(normal))
                && self.facets.corners(other).into_iter().all(convex)
                && polygon.iter().all(below)
                && found.iter().all(|(known, ..)| *known != flat)
            {
                found.push((flat, origin, side));
            }
        }
        found
    }

    /// Returns half of the wall thickness behind a polygon, m, at most [`THICK`].
    fn thickness(
        &self,
        corners: &[Point3<f64>],
        normal: &Vector3<f64>,
        sharp: &[SharpFace],
    ) -> f64 {
        let count = corners.len();
        let side = |i: usize| {
            let along = corners[(i + 1) % count] - corners[i];
            let outward = along.cross(normal).normalize();
            (corners[i] - outward * BESIDE, outward)
        };
        let mut planes: Vec<_> = (0..count)
            .filter(|&i| (corners[(i + 1) % count] - corners[i]).norm() > BESIDE)
            .map(side)
            .collect();
        planes.push((corners[0] - normal * BEHIND, *normal));
        planes.push((corners[0] - normal * (2.0 * THICK), -normal));
        let back: Vec<_> = corners.iter().map(|p| p - normal * (2.0 * THICK)).collect();
        let boxed = bounding_box(&[corners, &back].concat(), AROUND_MM);
        let mut least = 2.0 * THICK;
        for face in self.tree.intersect_aabb(&boxed) {
            let face = face as usize;
            if self.facets.normals[face].dot(normal) > -0.02
                || sharp.iter().any(|(flat, ..)| *flat == self.flat_of[face])
            {
                continue;
            }
            let mut piece = self.facets.corners(face).to_vec();
            for (origin, outward) in &planes {
                piece = cut(piece, origin, outward);
            }
            let depth = piece.iter().map(|p| (corners[0] - p).dot(normal));
            least = depth.fold(least, f64::min);
        }
        (least / 2.0).max(THIN)
    }
}

/// Cuts a polygon in half across its longest side; `None` if it is small.
fn halves(corners: &[Point3<f64>]) -> Option<[Vec<Point3<f64>>; 2]> {
    let ends = |i: usize| [corners[i], corners[(i + 1) % corners.len()]];
    let [a, b] = (0..corners.len())
        .map(ends)
        .max_by(|[a, b], [c, d]| (b - a).norm().total_cmp(&(d - c).norm()))
        .filter(|[a, b]| (b - a).norm() > MIN_PIECE)?;
    let middle = nalgebra::center(&a, &b);
    Some([b - a, a - b].map(|normal| cut(corners.to_vec(), &middle, &normal)))
}

/// Extrudes a polygon into the material, below the planes of faces at sharp edges.
fn extruded(corners: &[Point3<f64>], deeper: &Vector3<f64>, sharp: &[SharpFace]) -> Option<Solid> {
    let mut points = corners.to_vec();
    points.extend(corners.iter().map(|p| p - deeper));
    for (_, origin, side) in sharp {
        points = below(points, origin, side);
    }
    snapped_hull(&points)
}

/// Returns the part of a solid below a plane, rounded to the grid of files; `None` if it is too thin.
pub fn cut_below(solid: &Solid, origin: &Point3<f64>, normal: &Vector3<f64>) -> Option<Solid> {
    snapped_hull(&below(solid.corners(), origin, normal))
}

/// Returns the hull of points rounded to the grid of files; `None` if it is too thin.
pub fn snapped_hull(points: &[Point3<f64>]) -> Option<Solid> {
    let points: Vec<_> = points.iter().map(|p| Point3::from(p.coords.map(snap))).collect();
    // The size along each axis and the volume must be large enough for files.
    let is_thick = |solid: &Solid| {
        (0..3).all(|axis| width(extent(solid.corners(), axis)) >= MIN_SIZE)
            && volume(solid) >= MIN_SOLID_VOLUME
    };
    solid_of(&points).filter(is_thick)
}

/// Returns the bounding box of points, with a margin, in millimetres, the magnitude that parry's tolerances are made
/// for.
pub fn bounding_box(points: &[Point3<f64>], margin_mm: f64) -> Aabb {
    let points = points.iter().map(|p| (p.coords / MM).into());
    Aabb::from_points(points).loosened(margin_mm)
}

/// Returns the polygon below a plane.
pub fn cut(
    polygon: Vec<Point3<f64>>,
    origin: &Point3<f64>,
    normal: &Vector3<f64>,
) -> Vec<Point3<f64>> {
    let above = |p: &Point3<f64>| (p - origin).dot(normal);
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for i in 0..polygon.len() {
        let (p, q) = (polygon[i], polygon[(i + 1) % polygon.len()]);
        let (a, b) = (above(&p), above(&q));
        kept.extend((a <= 0.0).then_some(p));
        kept.extend(((a > 0.0) != (b > 0.0)).then(|| p + (q - p) * (a / (a - b))));
    }
    kept
}

/// Returns corners of the part of a hull below a plane.
fn below(
    points: Vec<Point3<f64>>,
    origin: &Point3<f64>,
    normal: &Vector3<f64>,
) -> Vec<Point3<f64>> {
    let above = |p: &Point3<f64>| (p - origin).dot(normal);
    let (beyond, mut kept): (Vec<_>, Vec<_>) = points.into_iter().partition(|p| above(p) > 0.0);
    let crossing = |p: &Point3<f64>, q: &Point3<f64>| {
        let (a, b) = (above(p), above(q));
        p + (q - p) * (a / (a - b))
    };
    let crossings: Vec<_> =
        kept.iter().flat_map(|p| beyond.iter().map(move |q| crossing(p, q))).collect();
    kept.extend(crossings);
    // Corners inside the hull are dropped, so that repeated cuts do not multiply them.
    if kept.len() < MANY { kept } else { hull(&kept).map_or(kept, |(corners, _)| corners) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::{ConvexBody, longest_side};
    use crate::mesh::mated::verify::Drawn;
    use insertion::task::{Part, geometry};

    /// Triangles of an outline, mm, from z = 0 to 5, whose caps are these quadrangles of its corners.
    fn extruded(outline: &[[f64; 2]], quads: &[[usize; 4]]) -> Vec<Triangle> {
        let at = |i: usize, z: f64| {
            let [x, y] = outline[i % outline.len()];
            Point3::new(x, y, z) * MM
        };
        let quad = |[a, b, c, d]: [Point3<f64>; 4]| [[a, b, c], [a, c, d]];
        let side = |i: usize| quad([at(i, 0.0), at(i + 1, 0.0), at(i + 1, 5.0), at(i, 5.0)]);
        let caps = quads.iter().flat_map(|q| {
            let [low, high] = [0.0, 5.0].map(|z| q.map(|i| at(i, z)));
            [quad([low[3], low[2], low[1], low[0]]), quad(high)].concat()
        });
        (0..outline.len()).flat_map(side).chain(caps).collect()
    }

    fn parts(triangles: &[Triangle]) -> Vec<Part> {
        let part = |solid| Part { name: String::new(), solid, friction: None };
        skin(triangles, |_, _| true, Some).0.into_iter().map(part).collect()
    }

    #[test]
    fn a_convex_body_is_one_part() {
        let outline = [[0.0, 0.0], [4.0, 0.0], [5.0, 2.0], [0.0, 3.0]];
        let found = parts(&extruded(&outline, &[[0, 1, 2, 3]]));
        assert_eq!(found.len(), 1);
        assert!((geometry::volume(&found[0].solid) / (11.5 * 5.0 * MM.powi(3)) - 1.0).abs() < 1e-6);
    }

    /// A channel of 0.2 mm sheet with a sharp lip stays open, and half of the sheet lies behind each face.
    #[test]
    fn a_channel_of_sheet_stays_open() {
        let outline = [
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 3.2],
            [3.8, 3.0],
            [3.8, 0.2],
            [0.2, 0.2],
            [0.2, 3.0],
            [0.0, 3.0],
        ];
        let drawn = extruded(&outline, &[[0, 1, 4, 5], [1, 2, 3, 4], [0, 5, 6, 7]]);
        let whole = parts(&drawn);
        assert!((10..40).contains(&whole.len()), "{}", whole.len());
        assert_eq!(Drawn::new(&drawn).deviations(&drawn, &whole), []);
        let body = ConvexBody::new(&whole);
        assert!(body.part_at(&(Point3::new(2.0, 0.25, 2.5) * MM)).is_none());
        assert!(body.part_at(&(Point3::new(2.0, 0.15, 2.5) * MM)).is_some());
        // Without a lid, normals alone tell where the material is.
        let open: Vec<Triangle> =
            drawn.iter().filter(|t| t.iter().any(|p| p.z < 4.9 * MM)).copied().collect();
        let open = parts(&open);
        let open = ConvexBody::new(&open).part_at(&(Point3::new(2.0, 0.25, 2.5) * MM));
        assert!(open.is_none());
    }

    /// Pieces cover a face that no single slab does.
    #[test]
    fn faces_are_cut_until_their_slabs_fit() {
        let outline = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 2.0], [0.0, 4.0]];
        let drawn = extruded(&outline, &[[0, 1, 2, 3], [0, 3, 4, 4]]);
        let short = |solid: Solid| (longest_side(&solid.corners()) < 1.5 * MM).then_some(solid);
        let part = |solid| Part { name: String::new(), solid, friction: None };
        let pieces: Vec<Part> = skin(&drawn, |_, _| true, short).0.into_iter().map(part).collect();
        assert!(pieces.len() > 50, "{}", pieces.len());
        assert_eq!(Drawn::new(&drawn).deviations(&drawn, &pieces), []);
    }
}
