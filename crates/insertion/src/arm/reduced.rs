//! Reduced model: an arm near one pose as a single body at the TCP.

use super::{Angles, Arm, ArmError};
use contact::scene::{Pose, Springs, block_rotation};
use nalgebra::{Matrix3, Matrix6, SMatrix, UnitQuaternion, Vector3};

/// Smallest ratio of the least to the greatest singular value of the Jacobian (m and rad) at a nonsingular pose.
const MIN_SINGULAR_RATIO: f64 = 1e-3;

/// Spring, damper and mass at the TCP: `J^-T M J^-1` for each joint-space matrix `M`. Symmetric 6x6, translations
/// then rotations, TCP axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReducedArm {
    /// Stiffness; by block N/m, N/rad and N m/rad.
    pub stiffness: Matrix6<f64>,
    /// Damping; by block N s/m, N s/rad and N m s/rad.
    pub damping: Matrix6<f64>,
    /// Mass; by block kg, kg m and kg m2.
    pub mass: Matrix6<f64>,
    /// Tilt of the TCP about the task's x at the pose of the model, rad.
    pub tilt: f64,
    /// Whether the damper acts on the rate of the position error (velocity feed-forward) instead of the flange speed.
    pub feed_forward: bool,
    /// Slowest time constant of a servo, damping over stiffness, s.
    pub time_constant: f64,
    /// Force of the arm on an immovable part at the end of the assembly move, N.
    pub assembly_force: f64,
    /// Translational compliance at the TCP, task axes, m/N.
    pub compliance: Matrix3<f64>,
    /// Joint torques per unit force at the TCP, task axes, N m/N.
    pub torques: SMatrix<f64, 6, 3>,
    /// Torque limits of the joints, N m.
    pub limits: [f64; 6],
}

impl Arm {
    /// Returns the reduced model at the start of a task: the TCP at its home position, the task frame rotated about
    /// the base's z by `turn`, the TCP tilted about the task's x by `tilt`, rad.
    ///
    /// # Errors
    /// If the arm does not reach the start, or is singular there.
    pub fn at_start(&self, turn: f64, tilt: f64) -> Result<ReducedArm, ArmError> {
        let task = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
        let tilted = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), tilt);
        let position = self.posture(&self.home).tcp.translation;
        let angles = self.inverse_kinematics(&Pose::from_parts(position, task * tilted))?;
        Ok(ReducedArm { tilt, ..self.reduced(&angles, &task)? })
    }

    /// Returns the reduced model at the given joint angles, with `tilt` 0; `task` rotates task axes into base axes.
    ///
    /// # Errors
    /// If the Jacobian is singular.
    pub fn reduced(
        &self,
        angles: &Angles,
        task: &UnitQuaternion<f64>,
    ) -> Result<ReducedArm, ArmError> {
        let posture = self.posture(angles);
        let jacobian = posture.tcp_jacobian();
        let values = jacobian.singular_values();
        if values.min() < MIN_SINGULAR_RATIO * values.max() {
            return Err(ArmError::Singular);
        }
        let tcp_axes = block_rotation(&posture.tcp.rotation.inverse());
        let inverse = (tcp_axes * jacobian).try_inverse().ok_or(ArmError::Singular)?;
        // The mean removes the asymmetry of rounding errors, which would add energy to the simulation.
        let at_tcp = |joints: &Matrix6<f64>| {
            let matrix = inverse.tr_mul(&(joints * inverse));
            (matrix + matrix.transpose()) * 0.5
        };
        let diagonal = |value: fn(&super::Joint) -> f64| {
            Matrix6::from_diagonal(&Angles::from_iterator(self.joints.iter().map(value)))
        };
        let linear = (block_rotation(&task.inverse()) * jacobian).fixed_rows::<3>(0).into_owned();
        let time_constants = self.joints.iter().map(|joint| joint.damping / joint.stiffness);
        let compliance = diagonal(|joint| 1.0 / joint.stiffness);
        Ok(ReducedArm {
            stiffness: at_tcp(&diagonal(|joint| joint.stiffness)),
            damping: at_tcp(&diagonal(|joint| joint.damping)),
            mass: at_tcp(&self.mass_matrix(&posture)),
            tilt: 0.0,
            feed_forward: self.feed_forward,
            time_constant: time_constants.fold(0.0, f64::max),
            assembly_force: self.assembly_force,
            compliance: linear * compliance * linear.transpose(),
            torques: linear.transpose(),
            limits: std::array::from_fn(|i| self.joints[i].limit),
        })
    }
}

impl ReducedArm {
    /// Returns the spring and the damper between the commanded pose and the flange.
    pub fn servo(&self) -> Springs {
        let damping = if self.feed_forward { self.damping } else { Matrix6::zeros() };
        Springs::Coupled { stiffness: self.stiffness, damping }
    }

    /// Returns whether a force at the TCP (task axes, N) exceeds the torque limit of a joint.
    pub fn overloaded(&self, force: &Vector3<f64>) -> bool {
        let torques = self.torques * force;
        torques.iter().zip(self.limits).any(|(torque, limit)| torque.abs() > limit)
    }
}
