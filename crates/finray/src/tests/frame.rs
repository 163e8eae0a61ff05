//! A space frame of straight beams (Przemieniecki 1968, Theory of Matrix Structural
//! Analysis, ch. 5): an independent model of a finger, for tests.

use nalgebra::{DMatrix, Matrix3, Matrix6, Point2, SMatrix, Vector3};

/// A beam in the plane X, Y, of rectangular section.
pub struct Beam {
    /// Numbers of the joints at its ends.
    pub ends: [usize; 2],
    /// Width in the plane, m.
    pub width: f64,
}

/// Beams of one depth and material.
pub struct Frame {
    /// Places of the joints, m.
    pub joints: Vec<Point2<f64>>,
    /// Beams between the joints.
    pub beams: Vec<Beam>,
    /// Out of the plane, m.
    pub depth: f64,
    /// Young's modulus, N/m2.
    pub modulus: f64,
    /// Poisson's ratio.
    pub poisson: f64,
}

impl Frame {
    /// Stiffness (X, Y, Z; turns about them) of a rigid body at a point that holds some joints.
    pub fn condensed(
        &self,
        at: Point2<f64>,
        held: impl Fn(usize) -> bool,
        fixed: impl Fn(usize) -> bool,
    ) -> Matrix6<f64> {
        let mut place = vec![None; self.joints.len()];
        let mut count = 6;
        for (joint, place) in place.iter_mut().enumerate() {
            if !held(joint) && !fixed(joint) {
                *place = Some(count);
                count += 6;
            }
        }
        let mut all = DMatrix::zeros(count, count);
        for beam in &self.beams {
            let stiffness = self.stiffness(beam);
            // Displacements of the two ends by those of what is solved for.
            let parts = beam.ends.map(|joint| match place[joint] {
                Some(place) => Some((place, Matrix6::identity())),
                None if held(joint) => Some((0, rigid(self.joints[joint] - at))),
                None => None,
            });
            for (i, row) in parts.iter().enumerate() {
                for (j, column) in parts.iter().enumerate() {
                    let (Some((r, left)), Some((c, right))) = (row, column) else { continue };
                    let block = stiffness.fixed_view::<6, 6>(6 * i, 6 * j);
                    let mut target = all.fixed_view_mut::<6, 6>(*r, *c);
                    target += left.transpose() * block * right;
                }
            }
        }
        let free = count - 6;
        let own = all.view((0, 0), (6, 6)).into_owned();
        let mixed = all.view((6, 0), (free, 6)).into_owned();
        let among = all.view((6, 6), (free, free)).into_owned().cholesky().unwrap();
        let condensed = own - mixed.transpose() * among.solve(&mixed);
        condensed.fixed_view::<6, 6>(0, 0).into_owned()
    }

    /// Bending and shear both ways (Timoshenko), stretching, and torsion of a thin rectangle.
    fn stiffness(&self, beam: &Beam) -> SMatrix<f64, 12, 12> {
        let [a, b] = beam.ends.map(|joint| self.joints[joint]);
        let along = b - a;
        let length = along.norm();
        let (e, g) = (self.modulus, self.modulus / 2.0 / (1.0 + self.poisson));
        let area = beam.width * self.depth;
        let slender = beam.width.min(self.depth) / beam.width.max(self.depth);
        let thin = beam.width.min(self.depth);
        let torsion = beam.width.max(self.depth) * thin.powi(3) / 3.0 * (1.0 - 0.63 * slender);
        let mut local = SMatrix::<f64, 12, 12>::zeros();
        let mut spring = |i: usize, j: usize, k: f64| {
            for (r, c, sign) in [(i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)] {
                local[(r, c)] += sign * k;
            }
        };
        spring(0, 6, e * area / length);
        spring(3, 9, g * torsion / length);
        // In the plane: deflection y, turn z. Across it: deflection z, turn -y.
        for (deflection, turn, sign, inertia) in [
            (1, 5, 1.0, self.depth * beam.width.powi(3) / 12.0),
            (2, 4, -1.0, beam.width * self.depth.powi(3) / 12.0),
        ] {
            let stiff = e * inertia;
            let phi = 12.0 * stiff / (g * area * 5.0 / 6.0 * length * length);
            let k = stiff / (1.0 + phi) / length.powi(3);
            let places = [deflection, turn, deflection + 6, turn + 6];
            let l = length * sign;
            let own = (4.0 + phi) * length * length;
            let other = (2.0 - phi) * length * length;
            let rows = [
                [12.0, 6.0 * l, -12.0, 6.0 * l],
                [6.0 * l, own, -6.0 * l, other],
                [-12.0, -6.0 * l, 12.0, -6.0 * l],
                [6.0 * l, other, -6.0 * l, own],
            ];
            for (r, row) in places.iter().zip(rows) {
                for (c, value) in places.iter().zip(row) {
                    local[(*r, *c)] += k * value;
                }
            }
        }
        let (c, s) = (along.x / length, along.y / length);
        let turn = Matrix3::new(c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0);
        let mut turned = SMatrix::<f64, 12, 12>::zeros();
        for i in 0..4 {
            turned.fixed_view_mut::<3, 3>(3 * i, 3 * i).copy_from(&turn);
        }
        turned.transpose() * local * turned
    }
}

/// Displacement of a point of a rigid body by the body's six motions.
fn rigid(arm: nalgebra::Vector2<f64>) -> Matrix6<f64> {
    let mut matrix = Matrix6::identity();
    let arm = Vector3::new(arm.x, arm.y, 0.0);
    matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&-arm.cross_matrix());
    matrix
}
