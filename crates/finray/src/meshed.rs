//! Finite-element model of a finger: mesh, clamped nodes, and the pad, or pad and roof, as a rigid face.

use super::condense::{Condensed, Element, Role, condense};
use super::geometry::Geometry;
use super::mesh::{Mesh, MeshError};
use super::polygon::{Ring, edges};
use crate::outline::{Outline, ring};
use input::units::MM;
use nalgebra::{DMatrix, Matrix3, Point2};

/// Distance from a line within which a node counts as on it, m.
const ON_LINE: f64 = 1e-6 * MM;
/// Size of the triangles at the ends of a rigid face, where stress is singular, relative to the usual size.
const MIN_SIZE_RATIO: f64 = 0.3;

/// Mesh of a finger without its clamped part, which does not deform.
pub struct MeshedFinger {
    /// Triangles and their nodes.
    pub mesh: Mesh,
    /// Roles of the nodes in the condensation; those of pad and roof are [`Role::Kept`].
    pub roles: Vec<Role>,
    outline: Outline,
}

/// Face that moves as one rigid body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RigidFace {
    /// The pad alone.
    Pad,
    /// The pad and the section of the roof that rests on the gripped part.
    PadAndRoof,
}

impl MeshedFinger {
    /// Creates a mesh with triangles of sides of about `size`, m.
    ///
    /// # Errors
    /// If the profile cannot be meshed.
    pub fn new(geometry: &Geometry, size: f64) -> Result<Self, MeshError> {
        let outline = geometry.finger.outline;
        let roof_end = outline.corner() + outline.out_of_pad() * outline.roof;
        let ends = [outline.tip_point(), outline.corner(), roof_end];
        let clamp = outline.length - outline.clamped;
        let ring = graded(&ring(&outline, 0.0, clamp), &ends, size);
        let mesh = Mesh::new(&ring, &geometry.voids, size)?;
        let mut meshed = MeshedFinger { mesh, outline, roles: Vec::new() };
        let role = |p: &Point2<f64>| match () {
            () if p.x > clamp - ON_LINE => Role::Fixed,
            () if meshed.is_on(RigidFace::PadAndRoof, p) => Role::Kept,
            () => Role::Free,
        };
        meshed.roles = meshed.mesh.nodes.iter().map(role).collect();
        Ok(meshed)
    }

    /// Returns the coordinates y (out of the pad) and z (along it) of a point, from the middle of the pad, m.
    pub fn local(&self, point: &Point2<f64>) -> [f64; 2] {
        let from_middle = point - self.outline.pad_middle();
        [self.outline.out_of_pad(), self.outline.along_pad()].map(|axis| axis.dot(&from_middle))
    }

    fn is_on(&self, face: RigidFace, point: &Point2<f64>) -> bool {
        let [y, z] = self.local(point);
        let half = self.outline.pad / 2.0;
        let on_pad = y.abs() < ON_LINE && z.abs() < half + ON_LINE;
        let on_roof = (z - half).abs() < ON_LINE && y > -ON_LINE && y < self.outline.roof + ON_LINE;
        on_pad || (face == RigidFace::PadAndRoof && on_roof)
    }

    /// Returns the stiffness of a rigid face and the displacements due to its motions, with the other kept nodes free.
    ///
    /// # Errors
    /// If a part of the finger is not connected to its base.
    pub fn rigid_motion<E: Element>(
        &self,
        condensed: &Condensed,
        element: &E,
        face: RigidFace,
    ) -> Result<RigidMotion, MeshError> {
        let places: Vec<_> =
            condensed.nodes.iter().map(|&node| self.mesh.nodes[node as usize]).collect();
        let dofs = E::DOFS;
        let (held, free): (Vec<usize>, Vec<usize>) =
            (0..places.len()).partition(|&i| self.is_on(face, &places[i]));
        // Columns: the face's three motions, then the free nodes' degrees of freedom.
        let rows = places.len() * dofs;
        let mut displacements = DMatrix::zeros(rows, 3 + free.len() * dofs);
        for i in held {
            let rows = element.rigid_displacements(&self.outline, self.local(&places[i]));
            for (d, row) in rows.iter().enumerate() {
                displacements.fixed_view_mut::<1, 3>(i * dofs + d, 0).copy_from_slice(row);
            }
        }
        for (k, i) in free.into_iter().enumerate() {
            for d in 0..dofs {
                displacements[(i * dofs + d, 3 + k * dofs + d)] = 1.0;
            }
        }
        let stiffness = displacements.transpose() * &condensed.stiffness * &displacements;
        let free = stiffness.nrows() - 3;
        let own: Matrix3<f64> = stiffness.fixed_view::<3, 3>(0, 0).into_owned();
        if free == 0 {
            return Ok(RigidMotion { stiffness: own, displacements });
        }
        let mixed = stiffness.view((3, 0), (free, 3)).into_owned();
        let among = stiffness.view((3, 3), (free, free)).into_owned();
        let response = -among.cholesky().ok_or(MeshError::Disconnected)?.solve(&mixed);
        let stiffness = own + mixed.transpose() * &response;
        let stiffness = stiffness.fixed_view::<3, 3>(0, 0).into_owned();
        let displacements = displacements.columns(0, 3).into_owned()
            + displacements.columns(3, free).into_owned() * response;
        Ok(RigidMotion { stiffness, displacements })
    }
}

/// Returns the stiffness matrix ([`RigidMotion::stiffness`]) of each face if it is rigid, on a mesh of triangles with
/// sides of about `size`, m.
///
/// # Errors
/// If the profile cannot be meshed, or a part of it is not connected to its base.
pub fn rigid_stiffness<E: Element, const N: usize>(
    geometry: &Geometry,
    element: &E,
    size: f64,
    faces: [RigidFace; N],
) -> Result<[Matrix3<f64>; N], MeshError> {
    let meshed = MeshedFinger::new(geometry, size)?;
    let condensed = condense(&meshed.mesh, element, &meshed.roles, false)?;
    let mut matrices = [Matrix3::zeros(); N];
    for (matrix, face) in matrices.iter_mut().zip(faces) {
        *matrix = meshed.rigid_motion(&condensed, element, face)?.stiffness;
    }
    Ok(matrices)
}

/// Stiffness of a rigid face, and displacements due to its motions.
pub struct RigidMotion {
    /// Forces and moments on the face per unit of its motions ([`Element::rigid_displacements`]): N/m, N/rad, N m/rad.
    pub stiffness: Matrix3<f64>,
    /// Displacements of the kept nodes per unit of the face's motions.
    pub displacements: DMatrix<f64>,
}

/// Divides the edges of a ring finely near the given corners.
fn graded(ring: &Ring, corners: &[Point2<f64>], size: f64) -> Ring {
    let near = |p: Point2<f64>| corners.iter().any(|corner| (p - corner).norm() < ON_LINE);
    let steps = |length: f64| -> Vec<f64> {
        let reach = size.min(length / 2.0);
        let steps = std::iter::successors(Some(MIN_SIZE_RATIO * size), |step| Some(2.0 * step));
        steps.take_while(|step| *step < reach).collect()
    };
    let mut finer = Ring::new();
    for (from, to) in edges(ring) {
        let length = (to - from).norm();
        let along = (to - from) / length;
        finer.push(from);
        if near(from) {
            finer.extend(steps(length).iter().map(|step| from + along * *step));
        }
        if near(to) {
            finer.extend(steps(length).iter().rev().map(|step| to - along * *step));
        }
    }
    finer
}
