//! A profile extruded along its depth: a closed surface of triangles.

use super::rings;
use crate::geometry::Geometry;
use crate::mesh::{Mesh, MeshError};
use crate::polygon::{self, Ring};
use input::units::MM;
use nalgebra::{Point2, Vector3};
use std::collections::{BTreeMap, BTreeSet};

/// A closed surface. Corners have the precision that files of triangles have, so what is
/// checked is what a slicer reads.
#[derive(Debug, Clone, PartialEq)]
pub struct Prism {
    /// Corners, mm.
    pub corners: Vec<[f32; 3]>,
    /// Corners of each triangle, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Why there is no closed surface.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PrismError {
    /// The profile cannot be divided.
    #[error("the profile cannot be divided into triangles: {0}")]
    Profile(#[from] MeshError),
    /// Triangles that do not close the surface.
    #[error("{0} edges do not belong to exactly two triangles")]
    Open(usize),
    /// Another volume than that of the profile.
    #[error("the volume is {found:.1} mm3; area times depth is {expected:.1} mm3")]
    Volume {
        /// Enclosed by the triangles, mm3.
        found: f64,
        /// Area of the profile times depth, mm3.
        expected: f64,
    },
}

/// Share by which a volume may differ from area times depth.
const VOLUME_TOLERANCE: f64 = 1e-3;

impl Prism {
    /// The finger with its ribs, checked.
    ///
    /// # Errors
    /// If the surface is not closed, or encloses another volume than area times depth.
    pub fn finger(geometry: &Geometry) -> Result<Self, PrismError> {
        let mm = |ring: Vec<[f64; 2]>| ring.into_iter().map(Point2::from).collect();
        let mut rings: Vec<Ring> = rings(geometry).into_iter().map(mm).collect();
        let voids = rings.split_off(1);
        let outer = rings.pop().unwrap_or_default();
        Prism::new(&outer, &voids, geometry.finger.outline.depth / MM)
    }

    /// The finger without openings: what a slicer fills with its own infill.
    ///
    /// # Errors
    /// As of [`Prism::finger`].
    pub fn outline(geometry: &Geometry) -> Result<Self, PrismError> {
        let outer: Ring = rings(geometry)
            .into_iter()
            .take(1)
            .flat_map(|ring| ring.into_iter().map(Point2::from))
            .collect();
        Prism::new(&outer, &[], geometry.finger.outline.depth / MM)
    }

    /// The solid base: where a slicer's infill has to be full.
    ///
    /// # Errors
    /// As of [`Prism::finger`].
    pub fn base(geometry: &Geometry) -> Result<Self, PrismError> {
        let outline = &geometry.finger.outline;
        let (start, end) = ((outline.length - outline.solid) / MM, outline.length / MM);
        let width = outline.width / MM;
        let block = [[start, 0.0], [end, 0.0], [end, width], [start, width]];
        Prism::new(&block.map(Point2::from).to_vec(), &[], outline.depth / MM)
    }

    /// A ring less holes (clockwise) from 0 to `depth`, mm.
    fn new(outer: &Ring, holes: &[Ring], depth: f64) -> Result<Self, PrismError> {
        let mesh = Mesh::coarsest(outer, holes)?;
        let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
        let mut corners = Vec::new();
        let mut number = |node: u32| {
            *numbers.entry(node).or_insert_with(|| {
                let place = mesh.nodes[node as usize];
                let [x, y] = [place.x, place.y].map(|value| value as f32);
                corners.extend([[x, y, 0.0], [x, y, depth as f32]]);
                corners.len() as u32 - 2
            })
        };
        let below: Vec<[u32; 3]> =
            mesh.triangles.iter().map(|&[a, b, c, ..]| [a, b, c].map(&mut number)).collect();
        let mut triangles: Vec<[u32; 3]> = below.iter().map(|&[a, b, c]| [a, c, b]).collect();
        triangles.extend(below.iter().map(|corners| corners.map(|corner| corner + 1)));
        let edges: BTreeSet<[u32; 2]> = below.iter().flat_map(sides).collect();
        let rim = edges.iter().filter(|[a, b]| !edges.contains(&[*b, *a]));
        triangles.extend(rim.flat_map(|&[a, b]| [[a, b, b + 1], [a, b + 1, a + 1]]));
        let prism = Prism { corners, triangles };
        let area = polygon::area(outer) + holes.iter().map(|hole| polygon::area(hole)).sum::<f64>();
        prism.check(area * depth)?;
        Ok(prism)
    }

    fn check(&self, expected: f64) -> Result<(), PrismError> {
        match self.open_edges() {
            0 => {}
            count => return Err(PrismError::Open(count)),
        }
        let found = self.volume();
        if (found - expected).abs() > VOLUME_TOLERANCE * expected {
            return Err(PrismError::Volume { found, expected });
        }
        Ok(())
    }

    /// Edges that are not met exactly twice, once each way; corners are told apart by their
    /// places alone, as in a file without numbers of corners.
    pub fn open_edges(&self) -> usize {
        let place = |corner: u32| self.corners[corner as usize].map(f32::to_bits);
        let mut met: BTreeMap<[[u32; 3]; 2], i32> = BTreeMap::new();
        for [a, b] in self.triangles.iter().flat_map(sides) {
            *met.entry([place(a), place(b)]).or_default() += 1;
        }
        let twice = |[a, b]: &[[u32; 3]; 2]| met[&[*a, *b]] == 1 && met.get(&[*b, *a]) == Some(&1);
        met.keys().filter(|edge| !twice(edge)).count()
    }

    /// The volume that the surface encloses, mm3.
    pub fn volume(&self) -> f64 {
        let sixth = |triangle: &[u32; 3]| {
            let [a, b, c] = self.places(triangle);
            a.dot(&b.cross(&c)) / 6.0
        };
        self.triangles.iter().map(sixth).sum()
    }

    /// Where the corners of a triangle are, mm.
    pub(super) fn places(&self, triangle: &[u32; 3]) -> [Vector3<f64>; 3] {
        triangle.map(|corner| self.corners[corner as usize].map(f64::from).into())
    }
}

/// The directed edges of a triangle.
fn sides(&[a, b, c]: &[u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}
