//! Triangles with their neighbours, and the flat faces that they form.

use crate::mesh::surface::weld;
use crate::mesh::{Triangle, edges};
use input::units::MM;
use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;

/// Largest distance of the corners of a flat face from its plane, m.
const FLAT: f64 = 4e-3 * MM;
/// Smallest cosine between the normals of a flat face and of one of its triangles.
const MIN_COSINE: f64 = 0.97;
/// Height below which a triangle counts as degenerate, m.
pub const NARROW: f64 = 5e-4 * MM;

/// Welded triangles, counter-clockwise from outside.
pub struct Facets {
    /// Corners, m.
    pub points: Vec<Point3<f64>>,
    /// Corner indices of the triangles.
    pub faces: Vec<[usize; 3]>,
    /// Unit normals; zero for a degenerate triangle.
    pub normals: Vec<Vector3<f64>>,
    /// Triangle across each edge (from corner i to i + 1), if there is exactly one of the same orientation.
    pub across: Vec<[Option<usize>; 3]>,
}

impl Facets {
    /// Welds triangles, m, and finds the neighbours of each.
    pub fn new(triangles: &[Triangle]) -> Self {
        let (points, faces) = weld(triangles, 1.0);
        let normal = |face: &[usize; 3]| {
            let [a, b, c] = face.map(|corner| points[corner]);
            let normal = (b - a).cross(&(c - a));
            let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
            let degenerate = normal.norm() < NARROW * longest;
            if degenerate { Vector3::zeros() } else { normal.normalize() }
        };
        let normals = faces.iter().map(normal).collect();
        let mut sides: BTreeMap<[usize; 2], Option<usize>> = BTreeMap::new();
        for (number, face) in faces.iter().enumerate() {
            for side in edges(*face) {
                sides.entry(side).and_modify(|face| *face = None).or_insert(Some(number));
            }
        }
        let other = |[from, to]: [usize; 2]| sides.get(&[to, from]).copied().flatten();
        let across = faces.iter().map(|face| edges(*face).map(other)).collect();
        Facets { points, faces, normals, across }
    }

    /// Returns the corners of a triangle.
    pub fn corners(&self, face: usize) -> Triangle {
        self.faces[face].map(|corner| self.points[corner])
    }

    /// Returns the edges that a triangle shares, each with the triangle across it.
    pub fn neighbours(&self, face: usize) -> impl Iterator<Item = ([usize; 2], usize)> {
        let sides = edges(self.faces[face]).into_iter().zip(self.across[face]);
        sides.filter_map(|(side, other)| Some((side, other?)))
    }

    fn double_area(&self, face: usize) -> f64 {
        let [a, b, c] = self.corners(face);
        (b - a).cross(&(c - a)).norm()
    }

    /// Groups the triangles into flat faces: returns the triangles of each face, with the one that defines its plane
    /// first, and the index of each triangle's face.
    pub fn flats(&self) -> (Vec<Vec<usize>>, Vec<usize>) {
        let mut order: Vec<usize> = (0..self.faces.len()).collect();
        order.sort_by(|a, b| self.double_area(*b).total_cmp(&self.double_area(*a)));
        let mut flat_of = vec![usize::MAX; self.faces.len()];
        let mut flats: Vec<Vec<usize>> = Vec::new();
        for first in order {
            if flat_of[first] != usize::MAX {
                continue;
            }
            let (normal, origin) = (self.normals[first], self.corners(first)[0]);
            let belongs = |face: usize| {
                let near = |p: Point3<f64>| (p - origin).dot(&normal).abs() < FLAT;
                let own = self.normals[face];
                (own == Vector3::zeros() || own.dot(&normal) > MIN_COSINE)
                    && self.corners(face).into_iter().all(near)
            };
            flat_of[first] = flats.len();
            let (mut flat, mut done) = (vec![first], 0);
            while done < flat.len() {
                for next in self.across[flat[done]].into_iter().flatten() {
                    if flat_of[next] == usize::MAX && belongs(next) {
                        flat_of[next] = flats.len();
                        flat.push(next);
                    }
                }
                done += 1;
            }
            flats.push(flat);
        }
        (flats, flat_of)
    }

    /// Returns the sets of triangles that are connected across edges (a common corner is not enough).
    pub fn shells(&self) -> Vec<Vec<usize>> {
        let mut seen = vec![false; self.faces.len()];
        let mut shells = Vec::new();
        for first in 0..self.faces.len() {
            let (mut shell, mut todo) = (Vec::new(), vec![first]);
            while let Some(face) = todo.pop() {
                if !std::mem::replace(&mut seen[face], true) {
                    shell.push(face);
                    todo.extend(self.across[face].into_iter().flatten());
                }
            }
            if !shell.is_empty() {
                shells.push(shell);
            }
        }
        shells
    }
}
