//! Quadratic triangles in plane stress (Zienkiewicz and Taylor, The Finite Element Method, vol. 1).

use super::condense::Element;
use crate::outline::Outline;
use crate::printed::PrintedFinger;
use nalgebra::Point2;

/// Elastic slab: extruded profile with its material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slab {
    /// Young's modulus, N/m2.
    pub modulus: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Thickness perpendicular to the profile's plane, m.
    pub thickness: f64,
}

impl Slab {
    /// Returns the slab of a printed finger.
    pub fn of(finger: &PrintedFinger) -> Self {
        let (material, thickness) = (&finger.material, finger.outline.depth);
        Slab { modulus: material.modulus, poisson: material.poisson, thickness }
    }
}

/// Plane stress of a slab that is loaded in its plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneStress(pub Slab);

/// Shape functions of a six-node triangle at a point.
#[derive(Debug, Clone, Copy)]
pub struct Shape {
    /// Value of each node's function.
    pub values: [f64; 6],
    /// Gradient of each node's function, 1/m.
    pub gradients: [[f64; 2]; 6],
}

/// Area coordinates of three quadrature points of equal weight, exact for quadratic functions.
const POINTS: [[f64; 3]; 3] = {
    const A: f64 = 2.0 / 3.0;
    const B: f64 = 1.0 / 6.0;
    [[A, B, B], [B, A, B], [B, B, A]]
};

/// Returns the area of a triangle, m2.
pub fn area([a, b, c]: [Point2<f64>; 3]) -> f64 {
    (b - a).perp(&(c - a)) / 2.0
}

/// Returns the shape functions at a point given by its area coordinates.
pub fn shape([a, b, c]: [Point2<f64>; 3], [l, m, n]: [f64; 3]) -> Shape {
    let double = 2.0 * area([a, b, c]);
    // Gradient of an area coordinate: the opposite side, rotated by a right angle, over twice the area.
    let gradient =
        |from: Point2<f64>, to: Point2<f64>| [(from.y - to.y) / double, (to.x - from.x) / double];
    let [gl, gm, gn] = [gradient(b, c), gradient(c, a), gradient(a, b)];
    let corner = |l: f64, g: [f64; 2]| g.map(|g| (4.0 * l - 1.0) * g);
    let side = |l: f64, gl: [f64; 2], m: f64, gm: [f64; 2]| {
        [4.0 * (l * gm[0] + m * gl[0]), 4.0 * (l * gm[1] + m * gl[1])]
    };
    Shape {
        values: [
            l * (2.0 * l - 1.0),
            m * (2.0 * m - 1.0),
            n * (2.0 * n - 1.0),
            4.0 * l * m,
            4.0 * m * n,
            4.0 * n * l,
        ],
        gradients: [
            corner(l, gl),
            corner(m, gm),
            corner(n, gn),
            side(l, gl, m, gm),
            side(m, gm, n, gn),
            side(n, gn, l, gl),
        ],
    }
}

impl Element for PlaneStress {
    /// Displacements along X and Y, m.
    const DOFS: usize = 2;

    fn stiffness(&self, corners: [Point2<f64>; 3]) -> Vec<f64> {
        let Slab { modulus, poisson, thickness } = self.0;
        let plane = modulus * thickness / (1.0 - poisson * poisson);
        let shear = plane * (1.0 - poisson) / 2.0;
        let mixed = plane * poisson;
        let mut matrix = vec![0.0; 144];
        let weight = area(corners) / 3.0;
        for Shape { gradients, .. } in POINTS.map(|point| shape(corners, point)) {
            for (a, [ax, ay]) in gradients.into_iter().enumerate() {
                for (b, [bx, by]) in gradients.into_iter().enumerate() {
                    let at = 24 * a + 2 * b;
                    matrix[at] += weight * (plane * ax * bx + shear * ay * by);
                    matrix[at + 1] += weight * (mixed * ax * by + shear * ay * bx);
                    matrix[at + 12] += weight * (mixed * ay * bx + shear * ax * by);
                    matrix[at + 13] += weight * (plane * ay * by + shear * ax * bx);
                }
            }
        }
        matrix
    }

    /// Motions: translations along y and z, rotation about x = y x z.
    fn rigid_displacements(&self, outline: &Outline, [at_y, at_z]: [f64; 2]) -> Vec<[f64; 3]> {
        let (y, z) = (outline.out_of_pad(), outline.along_pad());
        let turn = z * at_y - y * at_z;
        (0..2).map(|d| [y[d], z[d], turn[d]]).collect()
    }
}
