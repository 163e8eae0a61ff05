//! Springs, remote centre and coupling of a finger from its stiffness matrix.

use nalgebra::{Matrix3, Vector3};

/// Stiffness of a finger in its plane at the pad's middle: z along the pad towards the roof, y along its normal towards
/// the part, rx about x = y x z (right-handed).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarStiffness {
    stiffness: Matrix3<f64>,
    /// Compliance matrix: displacements (m, m, rad) per force and moment (N, N, N m).
    pub(super) compliance: Matrix3<f64>,
}

impl PlanarStiffness {
    /// Creates the stiffness from a matrix in N, N, N m per m, m, rad; `None` unless the matrix is positive definite.
    pub fn new(stiffness: Matrix3<f64>) -> Option<Self> {
        let stiffness = (stiffness + stiffness.transpose()) / 2.0;
        let compliance = stiffness.cholesky()?.inverse();
        Some(PlanarStiffness { stiffness, compliance })
    }

    /// Returns the stiffness with other values of [`in_compliance`](Self::in_compliance) and
    /// [`in_assembly`](Self::in_assembly), N/m, and the same tilting stiffness. The correlations of the compliances are
    /// unchanged, so the result is positive definite; the distances of the remote centre scale with the square roots of
    /// new over old compliance.
    pub fn corrected(&self, compliance: f64, assembly: f64) -> Option<Self> {
        let free = [self.in_compliance() / compliance, self.in_assembly() / assembly, 1.0];
        let roots = Matrix3::from_diagonal(&Vector3::from(free.map(f64::sqrt)));
        PlanarStiffness::new((roots * self.compliance * roots).try_inverse()?)
    }

    /// Returns the stiffness matrix: N/m, N/rad, N m/rad; order y, z, rx.
    pub fn matrix(&self) -> &Matrix3<f64> {
        &self.stiffness
    }

    /// Returns the compliance stiffness: that in y (the compliance direction), with z and rx free, N/m.
    pub fn in_compliance(&self) -> f64 {
        1.0 / self.compliance[(0, 0)]
    }

    /// Returns the assembly stiffness: that in z (the assembly direction), with y and rx free, N/m.
    pub fn in_assembly(&self) -> f64 {
        1.0 / self.compliance[(1, 1)]
    }

    /// Returns the stiffness against rotation about the remote centre, y and z free, N m/rad.
    pub fn tilting(&self) -> f64 {
        1.0 / self.compliance[(2, 2)]
    }

    /// Returns the distance of the remote centre, the point that a moment does not move, below the pad's middle
    /// (towards the tip and beyond), m.
    pub fn centre_below_pad(&self) -> f64 {
        -self.compliance[(0, 2)] / self.compliance[(2, 2)]
    }

    /// Returns the distance of the remote centre in front of the pad's face, towards the part, m.
    pub fn centre_in_front(&self) -> f64 {
        -self.compliance[(1, 2)] / self.compliance[(2, 2)]
    }

    /// Returns the correlation of the compliances in y and z, -1 .. 1; if positive, a pad that is pushed up
    /// approaches the part.
    pub fn coupling_yz(&self) -> f64 {
        let c = &self.compliance;
        c[(0, 1)] / (c[(0, 0)] * c[(1, 1)]).sqrt()
    }
}

/// Stiffness of a finger out of its plane, at the pad's middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossStiffness {
    /// Stiffness matrix: N/m, N/rad, N m/rad; order x, ry, rz.
    pub matrix: Matrix3<f64>,
    /// Stiffness in x, with ry and rz free, N/m.
    pub in_depth: f64,
    /// Stiffness against rotation about y, with x and rz free, N m/rad.
    pub about_y: f64,
    /// Stiffness against rotation about z, with x and ry free, N m/rad.
    pub about_z: f64,
}

impl CrossStiffness {
    /// Creates the stiffness from a matrix in N, N m, N m per m, rad, rad; `None` unless the matrix is positive
    /// definite.
    pub fn new(stiffness: Matrix3<f64>) -> Option<Self> {
        let PlanarStiffness { stiffness: matrix, compliance } = PlanarStiffness::new(stiffness)?;
        let [in_depth, about_y, about_z] = [0, 1, 2].map(|i| 1.0 / compliance[(i, i)]);
        Some(CrossStiffness { matrix, in_depth, about_y, about_z })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Springs at a remote centre, expressed at the pad's middle.
    #[test]
    fn springs_at_a_remote_centre_are_found_again() {
        let (ky, kz, kt, below, ahead) = (2e3, 4e4, 5.0, 0.02, 0.004);
        // Displacement of the centre (y = ahead, z = -below) by that of the pad.
        let to_centre = Matrix3::new(1.0, 0.0, below, 0.0, 1.0, ahead, 0.0, 0.0, 1.0);
        let springs = Matrix3::from_diagonal(&Vector3::new(ky, kz, kt));
        let pad = PlanarStiffness::new(to_centre.transpose() * springs * to_centre).unwrap();
        assert!((pad.tilting() - kt).abs() < 1e-9 * kt);
        assert!((pad.centre_below_pad() - below).abs() < 1e-12);
        assert!((pad.centre_in_front() - ahead).abs() < 1e-12);
        let softer = 1.0 / (1.0 / ky + below * below / kt);
        assert!((pad.in_compliance() - softer).abs() < 1e-9 * softer);
        let softer = 1.0 / (1.0 / kz + ahead * ahead / kt);
        assert!((pad.in_assembly() - softer).abs() < 1e-9 * softer);
        assert!(pad.coupling_yz() > 0.0);
    }

    #[test]
    fn a_corrected_finger_keeps_its_tilting_and_its_correlations() {
        let matrix = Matrix3::new(9e3, 2e4, -90.0, 2e4, 9e4, -60.0, -90.0, -60.0, 3.0);
        let pad = PlanarStiffness::new(matrix).unwrap();
        let (ky, kz) = (1.6 * pad.in_compliance(), 2.2 * pad.in_assembly());
        let found = pad.corrected(ky, kz).unwrap();
        let close = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-9;
        assert!(close(found.in_compliance(), ky) && close(found.in_assembly(), kz));
        assert!(close(found.tilting(), pad.tilting()));
        assert!(close(found.coupling_yz(), pad.coupling_yz()));
        assert!(close(found.centre_below_pad(), pad.centre_below_pad() / 1.6f64.sqrt()));
        // The remaining compliance of the spring at the centre is positive.
        let left = 1.0 / ky - found.centre_below_pad().powi(2) / found.tilting();
        assert!(left > 0.0, "{left}");
    }

    #[test]
    fn an_indefinite_stiffness_is_rejected() {
        let matrix = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0));
        assert_eq!(PlanarStiffness::new(matrix), None);
        assert_eq!(CrossStiffness::new(matrix * f64::NAN), None);
    }
}
