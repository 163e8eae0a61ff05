//! The arm's mass matrix in joint coordinates.

use super::{Arm, JOINTS, Posture};
use nalgebra::{Matrix3, Matrix6};

impl Arm {
    /// `M(q)` of the kinetic energy `q' M q' / 2`, kg m2: the sum over the links of
    /// `m Jv^T Jv + Jw^T I Jw`, each about the link's centre of mass.
    pub fn mass(&self, posture: &Posture) -> Matrix6<f64> {
        (0..JOINTS)
            .map(|i| {
                let (link, frame) = (&self.joints[i].link, posture.links[i]);
                let jacobian = posture.jacobian(&(frame * link.centre), i);
                let axes = frame.rotation.to_rotation_matrix().into_inner();
                let tensor = axes * Matrix3::from_diagonal(&link.moments) * axes.transpose();
                let (linear, angular) = (jacobian.fixed_rows::<3>(0), jacobian.fixed_rows::<3>(3));
                linear.tr_mul(&linear) * link.mass + angular.tr_mul(&(tensor * angular))
            })
            .sum()
    }
}
