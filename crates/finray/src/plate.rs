//! The profile as a plate under loads out of its plane, by Mindlin's theory.
//!
//! Each wall of the finger is then a deep beam that bends, shears and twists. In Mindlin's theory a narrow wall of
//! thickness t and depth d has the bending stiffness E t d^3 / 12, the shear stiffness 5/6 G t d and 5/6 of a thin
//! wall's torsional stiffness G d t^3 / 3. (Mindlin 1951, J. Appl. Mech. 18:31, shear factor 5/6 after Reissner 1945,
//! J. Appl. Mech. 12:A69.)

use super::condense::Element;
use super::elasticity::{Shape, Slab, area, shape};
use crate::outline::Outline;
use nalgebra::Point2;

/// Mindlin plate: a slab under loads out of its plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MindlinPlate(pub Slab);

/// Shear correction factor.
const SHEAR_FACTOR: f64 = 5.0 / 6.0;

/// First area coordinate and weight of two sets of three quadrature points, exact to degree 4 (Dunavant 1985, Int. J.
/// Numer. Meth. Eng. 21:1129).
const POINTS: [(f64, f64); 2] = [
    (0.108_103_018_168_070, 0.223_381_589_678_011),
    (0.816_847_572_980_459, 0.109_951_743_655_322),
];

/// Generalized strains of a plate: curvatures XX, YY and XY, 1/m, and shears XZ and YZ.
type Strains = [f64; 5];

impl Element for MindlinPlate {
    /// Deflection along Z = X x Y, m, and the rotations about X and Y, rad.
    const DOFS: usize = 3;

    fn stiffness(&self, corners: [Point2<f64>; 3]) -> Vec<f64> {
        let mut matrix = vec![0.0; 324];
        for (first, weight) in POINTS {
            let other = (1.0 - first) / 2.0;
            for i in 0..3 {
                let mut at = [other; 3];
                at[i] = first;
                self.add(&mut matrix, &shape(corners, at), weight * area(corners));
            }
        }
        matrix
    }

    /// Motions: translation along x, rotations about y and z. x = y x z points along -Z, so the deflection is `-u_x`.
    fn rigid_displacements(&self, outline: &Outline, [at_y, at_z]: [f64; 2]) -> Vec<[f64; 3]> {
        let (y, z) = (outline.out_of_pad(), outline.along_pad());
        // u_x = ry z - rz y
        vec![[-1.0, -at_z, at_y], [0.0, y.x, z.x], [0.0, y.y, z.y]]
    }
}

impl MindlinPlate {
    /// Adds the contribution of a quadrature point to the lower half of the stiffness matrix.
    fn add(&self, matrix: &mut [f64], shape: &Shape, weight: f64) {
        let strains: Vec<Strains> = (0..18).map(|i| strains(shape, i)).collect();
        for (i, of_i) in strains.iter().enumerate() {
            let stress = self.stress(of_i);
            for (j, of_j) in strains[..=i].iter().enumerate() {
                let work: f64 = stress.iter().zip(of_j).map(|(s, e)| s * e).sum();
                matrix[18 * i + j] += weight * work;
            }
        }
    }

    /// Returns the moments, N, and the shear forces, N/m, per unit length.
    fn stress(&self, [xx, yy, xy, x, y]: &Strains) -> Strains {
        let Slab { modulus, poisson: nu, thickness } = self.0;
        let bending = modulus * thickness.powi(3) / 12.0 / (1.0 - nu * nu);
        let shear = SHEAR_FACTOR * modulus / 2.0 / (1.0 + nu) * thickness;
        [
            bending * (xx + nu * yy),
            bending * (yy + nu * xx),
            bending * (1.0 - nu) / 2.0 * xy,
            shear * x,
            shear * y,
        ]
    }
}

/// Returns the strains at a point for a unit value of one of the 18 degrees of freedom.
fn strains(shape: &Shape, freedom: usize) -> Strains {
    let value = shape.values[freedom / 3];
    let [dx, dy] = shape.gradients[freedom / 3];
    match freedom % 3 {
        0 => [0.0, 0.0, 0.0, dx, dy],
        1 => [0.0, -dy, -dx, 0.0, -value],
        _ => [dx, 0.0, dy, value, 0.0],
    }
}
