//! Fewer faces for the same shape. An edge is collapsed onto one of its ends as long as the corner that
//! goes stays within a tolerance of the faces that are left (half-edge collapse; Kobbelt et al. 1998, A
//! general framework for mesh decimation).

use super::surface::Surface;
use input::units::MM;
use nalgebra::{Point3, Vector3};
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

/// Largest distance of the surface from the corners of the file, m.
pub const TOLERANCE: f64 = 0.01 * MM;
/// Faces from which on a mesh is reduced.
pub const MANY_FACES: usize = 2000;
/// Error of a collapse on a flat side, pm: that of files with 32-bit numbers.
const FLAT: u64 = 1_000_000;
/// Most faces about a corner that goes: the pole of a fine dome has hundreds.
const MOST_ABOUT: usize = 64;
/// Least cosine between the normals of a face before and after.
const LEAST_COSINE: f64 = 0.5;

struct Collapsing {
    points: Vec<Point3<f64>>,
    faces: Vec<[usize; 3]>,
    about: Vec<Vec<usize>>,
    /// How far the faces about a corner may be from the corners that have gone, m.
    error: Vec<f64>,
    /// Counts the changes about a corner: a queued collapse of an earlier count is out of date.
    version: Vec<u32>,
}

/// Returns the surface with as few faces as keep to the [`TOLERANCE`].
pub fn reduced(surface: Surface) -> Surface {
    let mut about = vec![Vec::new(); surface.points.len()];
    for (number, face) in surface.faces.iter().enumerate() {
        face.iter().for_each(|&corner| about[corner].push(number));
    }
    let count = surface.points.len();
    let Surface { points, faces, was_inward, mended } = surface;
    let mut mesh =
        Collapsing { points, faces, about, error: vec![0.0; count], version: vec![0; count] };
    let mut queue = BinaryHeap::new();
    (0..count).for_each(|corner| mesh.queue(corner, &mut queue));
    let mut left = mesh.faces.len();
    while let Some(Reverse((cost, [from, to], versions))) = queue.pop() {
        // What is flat costs nothing. More would bend faces that are few enough.
        if left <= MANY_FACES && cost > FLAT {
            break;
        }
        if versions != [from, to].map(|corner| mesh.version[corner]) {
            continue;
        }
        mesh.collapse(from, to);
        left -= 2;
        for corner in mesh.neighbours(to).into_iter().chain([to]) {
            mesh.version[corner] += 1;
        }
        for corner in mesh.neighbours(to).into_iter().chain([to]) {
            mesh.queue(corner, &mut queue);
        }
    }
    let (points, faces) = mesh.left();
    Surface { points, faces, was_inward, mended }
}

/// A collapse: its error, pm, the corner that goes and the one it goes to, and their versions.
type Queued = Reverse<(u64, [usize; 2], [u32; 2])>;

impl Collapsing {
    fn neighbours(&self, corner: usize) -> BTreeSet<usize> {
        let all = self.about[corner].iter().flat_map(|&face| self.faces[face]);
        all.filter(|&other| other != corner).collect()
    }

    fn queue(&self, from: usize, queue: &mut BinaryHeap<Queued>) {
        let faces = self.about[from].len();
        let near = if faces > MOST_ABOUT { BTreeSet::new() } else { self.neighbours(from) };
        // A closed fan has as many neighbours as faces; where surfaces touch nothing is changed.
        if near.len() != faces {
            return;
        }
        let best = near.iter().filter_map(|&to| Some((self.cost(from, to, &near)?, to)));
        if let Some((cost, to)) = best.min_by(|a, b| a.0.total_cmp(&b.0))
            && cost <= TOLERANCE
        {
            let versions = [from, to].map(|corner| self.version[corner]);
            queue.push(Reverse(((cost * 1e12) as u64, [from, to], versions)));
        }
    }

    fn meet(&self, a: usize, b: usize) -> bool {
        let [few, other] = if self.about[a].len() < self.about[b].len() { [a, b] } else { [b, a] };
        self.about[few].iter().any(|&face| self.faces[face].contains(&other))
    }

    /// Returns how far the corner that goes is then from the surface, and those that went before it;
    /// `None` if a face would turn over or the surface would touch itself.
    fn cost(&self, from: usize, to: usize, near: &BTreeSet<usize>) -> Option<f64> {
        if near.iter().filter(|&&other| other != to && self.meet(other, to)).count() != 2 {
            return None;
        }
        let mut distance = f64::INFINITY;
        for &face in &self.about[from] {
            let corners = self.faces[face];
            if corners.contains(&to) {
                continue;
            }
            let before = corners.map(|corner| self.points[corner]);
            let after = corners.map(|corner| self.points[if corner == from { to } else { corner }]);
            let [old, new] = [&before, &after].map(normal);
            if new.dot(&old) < LEAST_COSINE * new.norm() * old.norm() || new.norm() == 0.0 {
                return None;
            }
            distance = distance.min(away(&self.points[from], &after));
        }
        Some(self.error[from] + distance)
    }

    fn collapse(&mut self, from: usize, to: usize) {
        let near = self.neighbours(from);
        let error = self.cost(from, to, &near).unwrap_or(0.0);
        self.error[to] = self.error[to].max(error);
        for face in std::mem::take(&mut self.about[from]) {
            if self.faces[face].contains(&to) {
                for corner in self.faces[face] {
                    self.about[corner].retain(|&other| other != face);
                }
            } else {
                self.faces[face] =
                    self.faces[face].map(|corner| if corner == from { to } else { corner });
                self.about[to].push(face);
            }
        }
    }

    fn left(&self) -> (Vec<Point3<f64>>, Vec<[usize; 3]>) {
        let mut points = Vec::new();
        let mut number = vec![usize::MAX; self.points.len()];
        for (corner, about) in self.about.iter().enumerate() {
            if about.is_empty() {
                continue;
            }
            number[corner] = points.len();
            points.push(self.points[corner]);
        }
        let left: BTreeSet<usize> = self.about.iter().flatten().copied().collect();
        let faces = left.iter().map(|&face| self.faces[face].map(|corner| number[corner]));
        (points, faces.collect())
    }
}

fn normal([a, b, c]: &[Point3<f64>; 3]) -> Vector3<f64> {
    (b - a).cross(&(c - a))
}

/// Distance of a point from a triangle (Ericson 2005, Real-time collision detection, 5.1.5), m.
fn away(point: &Point3<f64>, [a, b, c]: &[Point3<f64>; 3]) -> f64 {
    let normal = (b - a).cross(&(c - a)).normalize();
    let beyond = |from: &Point3<f64>, to: &Point3<f64>| {
        (to - from).cross(&(point - from)).dot(&normal) < 0.0
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
    (point - a).dot(&normal).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

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
        let fine = Surface::new(&sphere(rings, radius), MM, "sphere.stl").unwrap();
        assert!(fine.faces.len() > 50_000);
        let volume = fine.volume();
        let coarse = reduced(fine);
        assert!(coarse.faces.len() < 7000, "{} faces", coarse.faces.len());
        // Closed as before, its corners on the sphere, its faces within the tolerance of it.
        let triangles = coarse.faces.iter().map(|face| face.map(|c| coarse.points[c] / MM));
        let again = Surface::new(&triangles.collect::<Vec<_>>(), MM, "coarse.stl").unwrap();
        assert_eq!(again.faces.len(), coarse.faces.len());
        let middles = coarse.faces.iter().map(|face| {
            let [a, b, c] = face.map(|corner| coarse.points[corner].coords);
            ((a + b + c) / 3.0).norm()
        });
        let least = middles.fold(f64::INFINITY, f64::min);
        assert!(radius * MM - least < 2.0 * TOLERANCE, "{} mm inside", (radius * MM - least) / MM);
        assert!((coarse.volume() / volume - 1.0).abs() < 0.01);
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
        let fine = Surface::new(&triangles, MM, "box.stl").unwrap();
        let coarse = reduced(fine);
        assert_eq!((coarse.points.len(), coarse.faces.len()), (8, 12));
        assert!((coarse.volume() / (1e3 * MM * MM * MM) - 1.0).abs() < 1e-9);
    }
}
