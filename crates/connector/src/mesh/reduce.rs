//! Mesh decimation: an edge is collapsed onto one of its ends as long as the removed corner stays within a tolerance of
//! the remaining faces (half-edge collapse; Kobbelt et al. 1998, A general framework for mesh decimation).

use super::surface::Surface;
use input::units::MM;
use nalgebra::{Point3, Vector3};
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

/// Largest distance of the surface from the corners of the file, m.
pub const TOLERANCE: f64 = 0.01 * MM;
/// Number of faces above which a mesh is reduced, and at which only collapses on flat sides go on.
const MANY_FACES: usize = 2000;
/// Largest error of a collapse on a flat side, pm (1 um): the rounding of files with 32-bit numbers.
const FLAT: u64 = 1_000_000;
/// Largest number of faces about a corner that is removed; limits the cost at the pole of a finely meshed dome, which
/// has hundreds.
const MAX_ABOUT: usize = 64;
/// Smallest cosine between the normals of a face before and after a collapse.
const MIN_COSINE: f64 = 0.5;

/// Mesh during its decimation.
struct Decimation {
    points: Vec<Point3<f64>>,
    faces: Vec<[usize; 3]>,
    /// Indices of the faces about each corner; none for a removed corner.
    about: Vec<Vec<usize>>,
    /// Bound on the distance between the faces about a corner and the removed corners, m.
    error: Vec<f64>,
    /// Counts the changes about a corner: a queued collapse of an earlier count is out of date.
    version: Vec<u32>,
}

/// Returns the surface with fewer faces, within the [`TOLERANCE`]; a surface of few faces is returned unchanged.
pub fn reduced(surface: Surface) -> Surface {
    if surface.faces.len() <= MANY_FACES {
        return surface;
    }
    let mut about = vec![Vec::new(); surface.points.len()];
    for (number, face) in surface.faces.iter().enumerate() {
        face.iter().for_each(|&corner| about[corner].push(number));
    }
    let count = surface.points.len();
    let Surface { points, faces, was_inward } = surface;
    let mut mesh =
        Decimation { points, faces, about, error: vec![0.0; count], version: vec![0; count] };
    let mut queue = BinaryHeap::new();
    (0..count).for_each(|corner| mesh.queue(corner, &mut queue));
    let mut left = mesh.faces.len();
    while let Some(Reverse((cost, [from, to], versions))) = queue.pop() {
        // Collapses on flat sides cause no error; others are made only as long as there are too many faces.
        if left <= MANY_FACES && cost > FLAT {
            break;
        }
        if versions != [from, to].map(|corner| mesh.version[corner]) {
            continue;
        }
        mesh.error[to] = mesh.error[to].max(cost as f64 * 1e-12);
        for face in std::mem::take(&mut mesh.about[from]) {
            if mesh.faces[face].contains(&to) {
                for corner in mesh.faces[face] {
                    mesh.about[corner].retain(|&other| other != face);
                }
            } else {
                mesh.faces[face] =
                    mesh.faces[face].map(|corner| if corner == from { to } else { corner });
                mesh.about[to].push(face);
            }
        }
        left -= 2;
        let changed: Vec<_> = mesh.neighbours(to).into_iter().chain([to]).collect();
        changed.iter().for_each(|&corner| mesh.version[corner] += 1);
        changed.iter().for_each(|&corner| mesh.queue(corner, &mut queue));
    }
    let mut points = Vec::new();
    let mut number = vec![usize::MAX; mesh.points.len()];
    for corner in (0..mesh.points.len()).filter(|&corner| !mesh.about[corner].is_empty()) {
        number[corner] = points.len();
        points.push(mesh.points[corner]);
    }
    let left: BTreeSet<usize> = mesh.about.iter().flatten().copied().collect();
    let faces = left.iter().map(|&face| mesh.faces[face].map(|corner| number[corner]));
    Surface { points, faces: faces.collect(), was_inward }
}

/// Collapse: its error, pm, the removed corner and the one that replaces it, and their versions.
type Queued = Reverse<(u64, [usize; 2], [u32; 2])>;

impl Decimation {
    fn neighbours(&self, corner: usize) -> BTreeSet<usize> {
        let all = self.about[corner].iter().flat_map(|&face| self.faces[face]);
        all.filter(|&other| other != corner).collect()
    }

    /// Queues the cheapest collapse that removes a corner, if one is allowed.
    fn queue(&self, from: usize, queue: &mut BinaryHeap<Queued>) {
        let faces = self.about[from].len();
        let near = if faces > MAX_ABOUT { BTreeSet::new() } else { self.neighbours(from) };
        // Corners at which surfaces touch have fewer or more neighbours than faces; they are kept.
        if near.len() != faces {
            return;
        }
        let place = self.points[from];
        let change = |&to: &usize| {
            let change = self.change(from, to, &near)?;
            let distance = Facet::distance(&change[1], &place);
            (self.error[from] + distance <= TOLERANCE).then_some((distance, to, change))
        };
        let mut changes: Vec<_> = near.iter().filter_map(change).collect();
        changes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut costs =
            changes.into_iter().filter_map(|(_, to, of)| Some((self.cost(from, to, of)?, to)));
        if let Some((cost, to)) = costs.next() {
            let versions = [from, to].map(|corner| self.version[corner]);
            queue.push(Reverse(((cost * 1e12) as u64, [from, to], versions)));
        }
    }

    fn share_edge(&self, a: usize, b: usize) -> bool {
        let [few, other] = if self.about[a].len() < self.about[b].len() { [a, b] } else { [b, a] };
        self.about[few].iter().any(|&face| self.faces[face].contains(&other))
    }

    /// Returns the faces about a corner before and after its removal; `None` if a face would turn over or the surface
    /// would touch itself.
    fn change(&self, from: usize, to: usize, near: &BTreeSet<usize>) -> Option<Change> {
        if near.iter().filter(|&&other| other != to && self.share_edge(other, to)).count() != 2 {
            return None;
        }
        let [mut before, mut after]: Change = Default::default();
        for &face in &self.about[from] {
            let corners = self.faces[face];
            let old = Facet::new(corners.map(|corner| self.points[corner]), self.points[from]);
            if !corners.contains(&to) {
                let moved = corners.map(|corner| if corner == from { to } else { corner });
                let new = Facet::new(moved.map(|corner| self.points[corner]), self.points[to]);
                if new.normal.dot(&old.normal) < MIN_COSINE {
                    return None;
                }
                after.push(new);
            }
            before.push(old);
        }
        Some([before, after])
    }

    /// Returns the error of a collapse: the largest distance between the old and the new faces, m; `None` beyond the
    /// [`TOLERANCE`].
    fn cost(&self, from: usize, to: usize, [mut before, after]: Change) -> Option<f64> {
        let within = |distance: f64| (self.error[from] + distance <= TOLERANCE).then_some(distance);
        // The distance of the removed corner alone is not enough: a new face can pass near it while another one fills a
        // concavity.
        let gone = within(Facet::farthest(&before, &after))?;
        let about = self.about[to].iter().map(|&face| self.faces[face]);
        let facet =
            |face: [usize; 3]| Facet::new(face.map(|corner| self.points[corner]), self.points[to]);
        before.extend(about.map(facet));
        let come = within(Facet::farthest(&after, &before))?;
        Some(self.error[from] + gone.max(come))
    }
}

/// Faces about a corner before and after its removal.
type Change = [Vec<Facet>; 2];

/// Triangle with its unit normal and two samples, at the middle of one edge and at the centroid.
struct Facet {
    corners: [Point3<f64>; 3],
    normal: Vector3<f64>,
    samples: [Point3<f64>; 2],
}

impl Facet {
    /// Creates the facet with a sample on the edge that starts at `at`; the normal is zero if it has no area.
    fn new(corners: [Point3<f64>; 3], at: Point3<f64>) -> Self {
        let [a, b, c] = &corners;
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
        let first = corners.iter().position(|corner| *corner == at).unwrap_or(0);
        let half = nalgebra::center(&at, &corners[(first + 1) % 3]);
        let middle = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        Facet { corners, normal, samples: [half, middle] }
    }

    /// Returns the largest distance of the samples of facets from other facets, m.
    fn farthest(of: &[Facet], from: &[Facet]) -> f64 {
        let samples = of.iter().flat_map(|facet| &facet.samples);
        samples.map(|place| Facet::distance(from, place)).fold(0.0, f64::max)
    }

    /// Returns the distance of a point from the nearest of some facets, m.
    fn distance(facets: &[Facet], point: &Point3<f64>) -> f64 {
        facets.iter().map(|facet| facet.distance_to(point)).fold(f64::INFINITY, f64::min)
    }

    /// Returns the distance to a point (Ericson 2005, Real-time collision detection, 5.1.5), m.
    fn distance_to(&self, point: &Point3<f64>) -> f64 {
        let [a, b, c] = &self.corners;
        let beyond = |from: &Point3<f64>, to: &Point3<f64>| {
            (to - from).cross(&(point - from)).dot(&self.normal) < 0.0
        };
        let edge = |from: &Point3<f64>, to: &Point3<f64>| {
            let along = to - from;
            let share = ((point - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (point - (from + along * share)).norm()
        };
        let edges = [(a, b), (b, c), (c, a)];
        if edges.iter().any(|(from, to)| beyond(from, to)) {
            return edges.iter().map(|(from, to)| edge(from, to)).fold(f64::INFINITY, f64::min);
        }
        (point - a).dot(&self.normal).abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use insertion::task::geometry::surface_moments;
    use std::f64::consts::{PI, TAU};

    fn enclosed(surface: &Surface) -> f64 {
        surface_moments(&surface.points, &surface.faces).0
    }

    /// Returns a sphere of `rings` rings of 2 `rings` corners.
    fn sphere(rings: usize, radius: f64) -> Vec<[Point3<f64>; 3]> {
        let around = 2 * rings;
        let at = |ring: usize, k: usize| {
            let (t, p) =
                (PI * ring as f64 / rings as f64, TAU * (k % around) as f64 / around as f64);
            let r = if ring.is_multiple_of(rings) { 0.0 } else { libm::sin(t) };
            Point3::new(r * libm::cos(p), r * libm::sin(p), -libm::cos(t)) * radius
        };
        let quad = |ring: usize, k: usize| {
            let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k)];
            let (lower, upper) = ((ring > 0).then_some([a, b, c]), [a, c, d]);
            let upper = (ring + 1 < rings).then_some(upper);
            lower.into_iter().chain(upper)
        };
        (0..rings).flat_map(|ring| (0..around).flat_map(move |k| quad(ring, k))).collect()
    }

    #[test]
    fn a_fine_sphere_keeps_its_size_with_few_faces() {
        let (radius, rings) = (5.0, 120);
        let fine = Surface::new(&sphere(rings, radius), MM).unwrap();
        assert!(fine.faces.len() > 50_000);
        let volume = enclosed(&fine);
        let coarse = reduced(fine);
        assert!(coarse.faces.len() < 7000, "{} faces", coarse.faces.len());
        // Closed as before, its corners on the sphere, its faces within the tolerance of it.
        let triangles = coarse.faces.iter().map(|face| face.map(|c| coarse.points[c] / MM));
        let again = Surface::new(&triangles.collect::<Vec<_>>(), MM).unwrap();
        assert_eq!(again.faces.len(), coarse.faces.len());
        let middles = coarse.faces.iter().map(|face| {
            let [a, b, c] = face.map(|corner| coarse.points[corner].coords);
            ((a + b + c) / 3.0).norm()
        });
        let least = middles.fold(f64::INFINITY, f64::min);
        assert!(radius * MM - least < 2.0 * TOLERANCE, "{} mm inside", (radius * MM - least) / MM);
        assert!((enclosed(&coarse) / volume - 1.0).abs() < 0.01);
    }

    #[test]
    fn sharp_edges_and_flat_sides_stay() {
        // A box whose sides are cut into many triangles.
        let n = 20;
        let mut triangles = Vec::new();
        for axis in 0..3 {
            for (end, flip) in [(0.0, true), (10.0, false)] {
                for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                    let at = |i: usize, j: usize| {
                        let mut p = [end; 3];
                        p[(axis + 1) % 3] = 10.0 * i as f64 / n as f64;
                        p[(axis + 2) % 3] = 10.0 * j as f64 / n as f64;
                        Point3::from(p)
                    };
                    let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    for [p, q, r] in [[a, b, c], [a, c, d]] {
                        triangles.push(if flip { [p, r, q] } else { [p, q, r] });
                    }
                }
            }
        }
        let fine = Surface::new(&triangles, MM).unwrap();
        let coarse = reduced(fine);
        assert_eq!((coarse.points.len(), coarse.faces.len()), (8, 12));
        assert!((enclosed(&coarse) / (1e3 * MM * MM * MM) - 1.0).abs() < 1e-9);
    }
}
