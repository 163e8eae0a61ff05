//! Static condensation of a finite-element mesh onto a few of its nodes.
//!
//! The mesh is halved repeatedly; each half is condensed onto the nodes it shares with
//! the rest, and the results of two halves are added and condensed in turn. A printed finger
//! is a net of thin walls: its halves share few nodes, so that all intermediate matrices are
//! small and dense. (Nested dissection: George 1973, SIAM J. Numer. Anal. 10:345; the
//! multifrontal method: Duff and Reid 1983, ACM Trans. Math. Softw. 9:302.)
//! The order of all sums depends on the mesh alone.

use super::frontal::Frontal;
use super::halving::{LEAF, halve};
use super::mesh::{Mesh, MeshError};
use crate::outline::Outline;
use nalgebra::{DMatrix, DVector, Point2};
use std::ops::Range;

/// Finite element with six nodes: elasticity of the triangles of a mesh.
pub trait Element {
    /// Number of degrees of freedom of a node.
    const DOFS: usize;
    /// Returns the stiffness matrix of a triangle, square, row by row, by the degrees of freedom of its six nodes; only
    /// the lower half is used.
    fn stiffness(&self, corners: [Point2<f64>; 3]) -> Vec<f64>;
    /// Returns the displacements of a node per unit of the three motions of a rigid pad about its middle (y, z, rx in
    /// the plane; x, ry, rz out of it), a row for each degree of freedom; `place` is the node's position along y and z
    /// from the middle of the pad, m.
    fn rigid_displacements(&self, outline: &Outline, place: [f64; 2]) -> Vec<[f64; 3]>;
}

/// Treatment of a node in the condensation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Eliminated: it carries no load.
    Free,
    /// Clamped: it does not move.
    Fixed,
    /// Kept (a master node): the mesh is condensed onto it.
    Kept,
}

/// Stiffness of a mesh condensed onto its kept nodes.
#[derive(Debug, Clone)]
pub struct Condensed {
    /// Kept nodes, in the order of the matrix.
    pub nodes: Vec<u32>,
    /// Symmetric, square, SI units: `DOFS` rows for each kept node.
    pub stiffness: DMatrix<f64>,
    dofs: usize,
    /// Number of nodes of the mesh.
    count: usize,
    /// Eliminated frontal matrices, in their order; empty unless `remember` was set.
    steps: Vec<Frontal>,
}

/// Condenses a mesh onto the nodes of role [`Role::Kept`]. With `remember`,
/// [`Condensed::expand`] also returns the displacements of the free nodes.
///
/// # Errors
/// If a part of the mesh is not connected to a clamped or kept node.
pub fn condense<E: Element>(
    mesh: &Mesh,
    element: &E,
    roles: &[Role],
    remember: bool,
) -> Result<Condensed, MeshError> {
    let (order, cuts) = halve(mesh);
    let mut work = Condensation {
        mesh,
        element,
        spans: spans(mesh, &order),
        order,
        cuts: cuts.into_iter(),
        roles,
        places: vec![0; mesh.nodes.len()],
        steps: remember.then(Vec::new),
    };
    let root = work.condense(0..mesh.triangles.len())?;
    let stiffness = DMatrix::from_fn(root.size(), root.size(), |i, j| root.at(i.max(j), i.min(j)));
    Ok(Condensed {
        nodes: root.nodes,
        stiffness,
        dofs: E::DOFS,
        count: mesh.nodes.len(),
        steps: work.steps.unwrap_or_default(),
    })
}

impl Condensed {
    /// Returns the displacement of every node (`DOFS` numbers each, m or rad) from those of the kept
    /// nodes, in the order of the matrix. Those of free nodes are 0 unless `remember` was set.
    pub fn expand(&self, kept: &DVector<f64>) -> Vec<f64> {
        let mut all = vec![0.0; self.count * self.dofs];
        for (&node, from) in self.nodes.iter().zip(kept.as_slice().chunks(self.dofs)) {
            all[node as usize * self.dofs..][..self.dofs].copy_from_slice(from);
        }
        for step in self.steps.iter().rev() {
            step.substitute(&mut all);
        }
        all
    }
}

struct Condensation<'a, E> {
    mesh: &'a Mesh,
    element: &'a E,
    /// Order and cuts of [`halve`].
    order: Vec<u32>,
    cuts: std::vec::IntoIter<usize>,
    /// First and last index in `order` of the triangles of each node.
    spans: Vec<[u32; 2]>,
    roles: &'a [Role],
    /// Scratch: index of each node in the current frontal matrix.
    places: Vec<u32>,
    steps: Option<Vec<Frontal>>,
}

impl<E: Element> Condensation<'_, E> {
    /// Returns the stiffness of the triangles in this range of `order`, condensed onto their kept nodes and those they
    /// share with other triangles.
    fn condense(&mut self, range: Range<usize>) -> Result<Frontal, MeshError> {
        let cut = if range.len() > LEAF { self.cuts.next() } else { None };
        let parts: Vec<(Vec<u32>, Vec<f64>)> = match cut.map(|cut| range.start + cut) {
            None => {
                let triangle = |&t: &u32| {
                    let matrix = self.element.stiffness(self.mesh.corners(t as usize));
                    (self.mesh.triangles[t as usize].to_vec(), matrix)
                };
                self.order[range.clone()].iter().map(triangle).collect()
            }
            Some(cut) => [self.condense(range.start..cut)?, self.condense(cut..range.end)?]
                .map(|half| (half.nodes, half.values))
                .into(),
        };
        let roles = self.roles;
        let moves = |node: &u32| roles[*node as usize] != Role::Fixed;
        let nodes = parts.iter().flat_map(|(nodes, _)| nodes).copied();
        let mut frontal = self.frontal(nodes.filter(moves).collect(), &range);
        for (nodes, matrix) in parts {
            let place = |node: u32| moves(&node).then(|| self.places[node as usize] as usize);
            frontal.add(&nodes.into_iter().map(place).collect::<Vec<_>>(), &matrix);
        }
        frontal.eliminate()?;
        let rest = frontal.rest();
        if let Some(steps) = &mut self.steps {
            steps.push(frontal);
        }
        Ok(rest)
    }

    /// Creates a frontal matrix of zeros; nodes that belong to no triangle outside the range come first.
    fn frontal(&mut self, mut nodes: Vec<u32>, range: &Range<usize>) -> Frontal {
        nodes.sort_unstable();
        nodes.dedup();
        let ends_here = |node: &u32| {
            let [first, last] = self.spans[*node as usize].map(|place| place as usize);
            self.roles[*node as usize] == Role::Free && first >= range.start && last < range.end
        };
        let (mut inner, outer): (Vec<u32>, Vec<u32>) = nodes.into_iter().partition(ends_here);
        let eliminated = inner.len();
        inner.extend(outer);
        for (place, &node) in inner.iter().enumerate() {
            self.places[node as usize] = place as u32;
        }
        Frontal::new(inner, eliminated, E::DOFS)
    }
}

/// Returns the first and last index in the order of the triangles of each node.
fn spans(mesh: &Mesh, order: &[u32]) -> Vec<[u32; 2]> {
    let mut spans = vec![[u32::MAX, 0]; mesh.nodes.len()];
    for (place, &t) in order.iter().enumerate() {
        for node in mesh.triangles[t as usize] {
            let [first, last] = &mut spans[node as usize];
            *first = (*first).min(place as u32);
            *last = (*last).max(place as u32);
        }
    }
    spans
}
