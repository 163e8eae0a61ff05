//! Meshes of a polygon with holes: triangles with six nodes.

use super::polygon::{Ring, cycles};
use nalgebra::Point2;
use spade::{
    AngleLimit, ConstrainedDelaunayTriangulation, Point2 as Site, RefinementParameters,
    Triangulation,
};
use std::collections::BTreeSet;

/// Smallest angle of a triangle, degrees; above 30 the refinement may not terminate.
const MIN_ANGLE_DEG: f64 = 25.0;
/// Largest number of vertices that the refinement adds; a printable profile needs fewer.
const MAX_VERTICES: usize = 100_000;
/// Fraction of the requested area below which a triangle is not divided to improve its angles.
const MIN_AREA_RATIO: f64 = 1e-3;

/// Straight-sided triangles with nodes at their corners and mid-sides.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Positions of the nodes, m.
    pub nodes: Vec<Point2<f64>>,
    /// Nodes of each triangle, counter-clockwise: corners, then the middles of the sides 01, 12 and 20.
    pub triangles: Vec<[u32; 6]>,
}

/// Reason why a profile has no mesh, or its mesh no stiffness matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum MeshError {
    /// Rings that cross or touch.
    #[error("the profile cannot be meshed: its edges cross or touch one another")]
    Crossing,
    /// Walls or gaps that need too many triangles.
    #[error("the profile cannot be meshed: a wall or gap needs more than {MAX_VERTICES} vertices")]
    TooFine,
    /// Nodes that are not connected to the base.
    #[error("a part of the finger is not connected to its base")]
    Disconnected,
    /// A stiffness matrix that is not positive definite.
    #[error("the stiffness matrix of the finger is not positive definite")]
    NotPositiveDefinite,
}

impl Mesh {
    /// Meshes an outer ring minus its holes, with triangle sides of about `size`, m.
    ///
    /// # Errors
    /// If rings cross, or walls or gaps are so thin that the mesh would be too large.
    pub fn new(outer: &Ring, holes: &[Ring], size: f64) -> Result<Mesh, MeshError> {
        // Equilateral triangle.
        let area = 0.433 * size * size;
        let parameters = RefinementParameters::new()
            .with_angle_limit(AngleLimit::from_deg(MIN_ANGLE_DEG))
            .with_max_allowed_area(area)
            .with_min_required_area(area * MIN_AREA_RATIO)
            .with_max_additional_vertices(MAX_VERTICES);
        Mesh::fill(outer, holes, parameters)
    }

    /// Meshes an outer ring minus its holes without additional vertices.
    ///
    /// # Errors
    /// If rings cross.
    pub fn coarsest(outer: &Ring, holes: &[Ring]) -> Result<Mesh, MeshError> {
        let parameters = RefinementParameters::new()
            .keep_constraint_edges()
            .with_angle_limit(AngleLimit::from_deg(0.0));
        Mesh::fill(outer, holes, parameters)
    }

    fn fill(
        outer: &Ring,
        holes: &[Ring],
        parameters: RefinementParameters<f64>,
    ) -> Result<Mesh, MeshError> {
        let mut sites = Vec::new();
        let mut edges = Vec::new();
        for ring in std::iter::once(outer).chain(holes) {
            let first = sites.len();
            sites.extend(ring.iter().map(|p| Site::new(p.x, p.y)));
            edges.extend((0..ring.len()).map(|i| [first + i, first + (i + 1) % ring.len()]));
        }
        let count = sites.len();
        let mut crossing = false;
        let cdt =
            ConstrainedDelaunayTriangulation::<Site<f64>>::try_bulk_load_cdt(sites, edges, |_| {
                crossing = true
            });
        let whole = cdt.ok().filter(|cdt| !crossing && cdt.num_vertices() == count);
        let mut cdt = whole.ok_or(MeshError::Crossing)?;
        let refined = cdt.refine(parameters.exclude_outer_faces(true));
        if !refined.refinement_complete {
            return Err(MeshError::TooFine);
        }
        let outside: BTreeSet<_> = refined.excluded_faces.iter().map(|face| face.index()).collect();
        let faces = cdt.inner_faces().filter(|face| !outside.contains(&face.fix().index()));
        Ok(Mesh::quadratic(faces.map(|face| {
            face.adjacent_edges().map(|edge| {
                let at = edge.from().position();
                let side = cdt.num_vertices() + edge.as_undirected().fix().index();
                (edge.from().fix().index(), side, Point2::new(at.x, at.y))
            })
        })))
    }

    /// Creates a mesh from triangles. Each corner is given by its number, the number of the side to the next corner
    /// (sides are numbered after all corners), and its position.
    fn quadratic(faces: impl Iterator<Item = [(usize, usize, Point2<f64>); 3]>) -> Mesh {
        let mut mesh = Mesh { nodes: Vec::new(), triangles: Vec::new() };
        let mut known: Vec<Option<u32>> = Vec::new();
        for face in faces {
            let mut node = |number: usize, place: Point2<f64>| {
                if known.len() <= number {
                    known.resize(number + 1, None);
                }
                *known[number].get_or_insert_with(|| {
                    mesh.nodes.push(place);
                    mesh.nodes.len() as u32 - 1
                })
            };
            let [a, b, c] = face.map(|(corner, _, place)| node(corner, place));
            let [ab, bc, ca] = [0, 1, 2].map(|i| {
                let (next, after) = (face[i], face[(i + 1) % 3]);
                node(next.1, nalgebra::center(&next.2, &after.2))
            });
            mesh.triangles.push([a, b, c, ab, bc, ca]);
        }
        mesh
    }

    /// Returns the corners of a triangle, m, counter-clockwise.
    pub fn corners(&self, triangle: usize) -> [Point2<f64>; 3] {
        let [a, b, c, ..] = self.triangles[triangle];
        [a, b, c].map(|node| self.nodes[node as usize])
    }

    /// Returns the nodes along the boundary, as one ring for the outline and one for each opening.
    pub fn boundary(&self) -> Vec<Vec<usize>> {
        let sides = || {
            let of = |&[a, b, c, ab, bc, ca]: &[u32; 6]| [(a, ab, b), (b, bc, c), (c, ca, a)];
            self.triangles.iter().flat_map(of)
        };
        let inside: BTreeSet<_> = sides().map(|(from, _, to)| (to, from)).collect();
        let mut next = vec![None; self.nodes.len()];
        for (from, middle, to) in sides().filter(|(from, _, to)| !inside.contains(&(*from, *to))) {
            next[from as usize] = Some(middle as usize);
            next[middle as usize] = Some(to as usize);
        }
        cycles(next)
    }
}
