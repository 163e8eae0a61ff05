//! Reduced model of an arm at its TCP at one pose.

use super::{Angles, Arm, ArmError};
use contact::scene::{Pose, Springs};
use nalgebra::{Matrix3, Matrix6, SMatrix, UnitQuaternion, Vector3};

/// Ratio of the Jacobian's singular values (m and rad alike) that counts as singular.
const SINGULAR: f64 = 1e-3;

/// Spring, damper and mass at the TCP: `J^-T (.) J^-1` of the joints' own, which is
/// `(J K^-1 J^T)^-1` and so on. Symmetric 6x6, translations then rotations, TCP axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reduced {
    /// N/m, N/rad, N m/rad.
    pub stiffness: Matrix6<f64>,
    /// N s/m, N s/rad, N m s/rad.
    pub damping: Matrix6<f64>,
    /// kg, kg m, kg m2.
    pub mass: Matrix6<f64>,
    /// Tilt of the TCP about the task's x where this holds, rad.
    pub tilt: f64,
    /// Whether the damper acts on the rate of the error, not on the flange's speed.
    pub feed_forward: bool,
    /// Slowest time constant of a servo, damping over stiffness, s.
    pub time_constant: f64,
    /// Force with which the assembly move ends on a part that does not give way, N.
    pub assembly_force: f64,
    /// Displacement of the TCP by a force at it, task axes: 3x3, m/N.
    pub compliance: Matrix3<f64>,
    /// Joint torques by a force at the TCP, task axes: N m/N.
    pub torques: SMatrix<f64, 6, 3>,
    /// Largest joint torques, N m.
    pub limits: [f64; 6],
}

impl Arm {
    /// Returns the arm at a task's start: the TCP where it is at the home angles, the task frame turned
    /// about the base's z by `turn`, the TCP tilted about the task's x by `tilt`, rad.
    ///
    /// # Errors
    /// If the arm does not reach the start, or is singular there.
    pub fn at_start(&self, turn: f64, tilt: f64) -> Result<Reduced, ArmError> {
        let task = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
        let tilted = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), tilt);
        let place = self.at(&self.home).tcp.translation;
        let angles = self.reach(&Pose::from_parts(place, task * tilted))?;
        Ok(Reduced { tilt, ..self.reduced(&angles, &task)? })
    }

    /// Returns the arm at some joint angles, its TCP upright; `task` turns task axes into base axes.
    ///
    /// # Errors
    /// If there is a direction in which no joint moves the TCP.
    pub fn reduced(
        &self,
        angles: &Angles,
        task: &UnitQuaternion<f64>,
    ) -> Result<Reduced, ArmError> {
        let posture = self.at(angles);
        let jacobian = posture.tcp_jacobian();
        let sizes = jacobian.singular_values();
        if sizes.min() < SINGULAR * sizes.max() {
            return Err(ArmError::Singular);
        }
        let tcp_axes = both(&posture.tcp.rotation.inverse());
        let inverse = (tcp_axes * jacobian).try_inverse().ok_or(ArmError::Singular)?;
        // Rounding errors would make it asymmetric, and add energy to the simulation.
        let at_tcp = |joints: &Matrix6<f64>| {
            let matrix = inverse.tr_mul(&(joints * inverse));
            (matrix + matrix.transpose()) * 0.5
        };
        let diagonal = |of: fn(&super::Joint) -> f64| {
            Matrix6::from_diagonal(&Angles::from_iterator(self.joints.iter().map(of)))
        };
        let linear = (both(&task.inverse()) * jacobian).fixed_rows::<3>(0).into_owned();
        let time_constants = self.joints.iter().map(|joint| joint.damping / joint.stiffness);
        let soft = diagonal(|joint| 1.0 / joint.stiffness);
        Ok(Reduced {
            stiffness: at_tcp(&diagonal(|joint| joint.stiffness)),
            damping: at_tcp(&diagonal(|joint| joint.damping)),
            mass: at_tcp(&self.mass(&posture)),
            tilt: 0.0,
            feed_forward: self.feed_forward,
            time_constant: time_constants.fold(0.0, f64::max),
            assembly_force: self.assembly_force,
            compliance: linear * soft * linear.transpose(),
            torques: linear.transpose(),
            limits: std::array::from_fn(|i| self.joints[i].limit),
        })
    }
}

impl Reduced {
    /// Returns spring and damper between the command and the flange.
    pub fn servo(&self) -> Springs {
        let damping = if self.feed_forward { self.damping } else { Matrix6::zeros() };
        Springs::Coupled { stiffness: self.stiffness, damping }
    }

    /// Returns the damper between the flange and the world, if the flange's own speed is damped.
    pub fn brake(&self) -> Option<Springs> {
        let brake = Springs::Coupled { stiffness: Matrix6::zeros(), damping: self.damping };
        (!self.feed_forward).then_some(brake)
    }

    /// Returns whether a force at the TCP (task axes, N) exceeds the torque limit of a joint.
    pub fn overloaded(&self, force: &Vector3<f64>) -> bool {
        let torques = self.torques * force;
        torques.iter().zip(self.limits).any(|(torque, limit)| torque.abs() > limit)
    }
}

/// Returns a rotation of linear and of angular velocities.
fn both(rotation: &UnitQuaternion<f64>) -> Matrix6<f64> {
    let axes: Matrix3<f64> = rotation.to_rotation_matrix().into_inner();
    let mut both = Matrix6::zeros();
    both.fixed_view_mut::<3, 3>(0, 0).copy_from(&axes);
    both.fixed_view_mut::<3, 3>(3, 3).copy_from(&axes);
    both
}
