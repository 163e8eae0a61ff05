//! Loads out of the plane: the plate against elasticity in three dimensions.
//!
//! The solid is the profile's mesh, extruded; through the depth its displacements are
//! polynomials in the distance z from the middle plane: odd in X and Y, even in Z. Mindlin's
//! plate is the first of each, with the stress along z left out.

use super::infill;
use crate::condense::Element;
use crate::elasticity::{Shape, Slab, area, shape};
use crate::mechanics::{CROSS_SIZE, cross};
use crate::meshed::{RigidFace, rigid_stiffness};
use crate::outline::Outline;
use crate::plate::MindlinPlate;
use crate::stiffness::CrossStiffness;
use nalgebra::{Matrix6, Point2, Vector6};

/// Polynomials of each displacement.
const TERMS: usize = 3;

/// Gauss's six points through the depth: the work is even in z, so three count twice.
const GAUSS: [(f64, f64); 3] = [
    (0.238_619_186_083_197, 0.467_913_934_572_691),
    (0.661_209_386_466_265, 0.360_761_573_048_139),
    (0.932_469_514_203_152, 0.171_324_492_379_170),
];

struct Solid(Slab);

/// A polynomial's value and slope at a distance from the middle plane, by half the depth.
fn term(axis: usize, term: usize, z: f64, half: f64) -> (f64, f64) {
    let power = 2 * term as i32 + i32::from(axis < 2);
    let slope = if power == 0 { 0.0 } else { f64::from(power) * (z / half).powi(power - 1) };
    ((z / half).powi(power) * half, slope)
}

impl Solid {
    /// Strains XX, YY, ZZ, YZ, ZX, XY of a degree of freedom.
    fn strain(&self, shape: &Shape, freedom: usize, z: f64) -> Vector6<f64> {
        let (node, axis) = (freedom / Self::DOFS, freedom % Self::DOFS / TERMS);
        let (value, slope) = term(axis, freedom % TERMS, z, self.0.thickness / 2.0);
        let (n, [dx, dy]) = (shape.values[node], shape.gradients[node]);
        let (x, y, z) = (dx * value, dy * value, n * slope);
        match axis {
            0 => Vector6::new(x, 0.0, 0.0, 0.0, z, y),
            1 => Vector6::new(0.0, y, 0.0, z, 0.0, x),
            _ => Vector6::new(0.0, 0.0, z, y, x, 0.0),
        }
    }

    fn elasticity(&self) -> Matrix6<f64> {
        let Slab { modulus, poisson, .. } = self.0;
        let shear = modulus / 2.0 / (1.0 + poisson);
        let lame = modulus * poisson / (1.0 + poisson) / (1.0 - 2.0 * poisson);
        Matrix6::from_fn(|i, j| match (i < 3 && j < 3, i == j) {
            (true, same) => lame + if same { 2.0 * shear } else { 0.0 },
            (false, true) => shear,
            (false, false) => 0.0,
        })
    }
}

impl Element for Solid {
    const DOFS: usize = 3 * TERMS;

    fn stiffness(&self, corners: [Point2<f64>; 3]) -> Vec<f64> {
        let size = 6 * Self::DOFS;
        let mut matrix = vec![0.0; size * size];
        let elasticity = self.elasticity();
        let half = self.0.thickness / 2.0;
        for i in 0..3 {
            let mut at = [1.0 / 6.0; 3];
            at[i] = 2.0 / 3.0;
            let shape = shape(corners, at);
            for (z, weight) in GAUSS {
                let weight = 2.0 * weight * half * area(corners) / 3.0;
                let strains: Vec<Vector6<f64>> =
                    (0..size).map(|freedom| self.strain(&shape, freedom, z * half)).collect();
                for (r, row) in strains.iter().enumerate() {
                    let stress = elasticity * row * weight;
                    for (c, column) in strains[..=r].iter().enumerate() {
                        matrix[r * size + c] += stress.dot(column);
                    }
                }
            }
        }
        matrix
    }

    /// A turn moves X and Y in proportion to z (term 0, scaled by the half depth).
    fn rigid_displacements(&self, outline: &Outline, place: [f64; 2]) -> Vec<[f64; 3]> {
        let [deflection, about_x, about_y] =
            <[_; 3]>::try_from(MindlinPlate(self.0).rigid_displacements(outline, place)).unwrap();
        let mut rows = vec![[0.0; 3]; Self::DOFS];
        rows[0] = about_y;
        rows[TERMS] = about_x.map(|turn| -turn);
        rows[2 * TERMS] = deflection.map(|way| way / (self.0.thickness / 2.0));
        rows
    }
}

/// The plate is as stiff as the solid. Pushed out of the plane, a finger bends about its base, which lies above the
/// pad: the pad turns so that its lower end is displaced farther.
#[test]
fn the_plate_is_as_stiff_as_the_solid_and_turns_like_a_cantilever() {
    for (density, direction) in [(10.0, 0.0), (20.0, 20.0), (25.0, 40.0)] {
        let geometry = infill(density, direction);
        let solid = Solid(Slab::of(&geometry.finger));
        let [solid] = rigid_stiffness(&geometry, &solid, CROSS_SIZE, [RigidFace::Pad]).unwrap();
        let solid = CrossStiffness::new(solid).unwrap();
        let plate = cross(&geometry).unwrap();
        for (plate, solid) in [
            (plate.in_depth, solid.in_depth),
            (plate.about_y, solid.about_y),
            (plate.about_z, solid.about_z),
        ] {
            assert!((plate / solid - 1.0).abs() < 0.1, "{density} %, {direction}: {plate} {solid}");
        }
        let compliance = plate.matrix.try_inverse().unwrap();
        // u_x = x + ry z: at the lower end z is negative.
        let turn = compliance[(1, 0)] / compliance[(0, 0)];
        // A cantilever of length L under an end load turns by 3 / 2L.
        let length = -1.5 / turn;
        assert!((0.02..0.06).contains(&length), "{density} %, {direction}: {length} m");
    }
}
