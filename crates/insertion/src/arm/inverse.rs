//! Inverse kinematics by damped least squares (Wampler 1986, IEEE Trans. Syst.
//! Man Cybern. 16:93): `dq = J^T (J J^T + l^2)^-1 e`, from the home angles.

use super::{Angles, Arm, ArmError};
use contact::scene::Pose;
use input::units::{DEG, MM};
use nalgebra::{Matrix6, Vector6};

/// Damping `l` far from the target, m: steps near a singular pose stay bounded.
const DAMPING: f64 = 0.02;
/// Steps at most; a start near home takes fewer than twenty.
const STEPS: usize = 200;
/// Error of a solution, m and rad.
const EXACT: f64 = 1e-10;

impl Arm {
    /// Angles near home that bring the TCP to a pose in the base frame.
    pub fn reach(&self, target: &Pose) -> Result<Angles, ArmError> {
        let mut angles = self.home;
        let mut error = Vector6::zeros();
        for _ in 0..STEPS {
            let posture = self.at(&angles);
            error = displacement(&posture.tcp, target);
            if error.amax() < EXACT {
                return Ok(angles);
            }
            let jacobian = posture.tcp_jacobian();
            // The damping goes with the error, so that the last steps are Newton's.
            let damping = (DAMPING * error.norm().min(1.0)).powi(2);
            let square = jacobian * jacobian.transpose() + Matrix6::from_diagonal_element(damping);
            let step = square.cholesky().ok_or(ArmError::Singular)?.solve(&error);
            angles += jacobian.tr_mul(&step);
        }
        Err(ArmError::Unreachable {
            miss_mm: error.fixed_rows::<3>(0).norm() / MM,
            miss_deg: error.fixed_rows::<3>(3).norm() / DEG,
        })
    }
}

/// Translation, and rotation vector, from one pose to another, base axes.
pub fn displacement(from: &Pose, to: &Pose) -> Vector6<f64> {
    let moved = to.translation.vector - from.translation.vector;
    let turned = (to.rotation * from.rotation.inverse()).scaled_axis();
    Vector6::new(moved.x, moved.y, moved.z, turned.x, turned.y, turned.z)
}
