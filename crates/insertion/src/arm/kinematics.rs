//! Forward kinematics, mass matrix, and inverse kinematics by damped least squares (Wampler 1986,
//! IEEE Trans. Syst. Man Cybern. 16:93): `dq = J^T (J J^T + l^2)^-1 e`, from the home angles.

use super::{Angles, Arm, ArmError, JOINTS};
use contact::scene::{Pose, displacement};
use input::units::{DEG, MM};
use nalgebra::{Matrix3, Matrix6, Point3, Translation3, UnitQuaternion, Vector3, Vector6};

/// Damping `l` far from the target, m; it bounds the steps near singular poses.
const DAMPING: f64 = 0.02;
/// Largest number of steps; a start near home takes fewer than twenty.
const MAX_STEPS: usize = 200;
/// Largest error of a solution, m and rad.
const TOLERANCE: f64 = 1e-10;

/// Result of the forward kinematics: frames of an arm at given joint angles, base frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Posture {
    /// Frames of the links after the rotation of their joints.
    pub links: [Pose; JOINTS],
    /// Unit vectors along the joints.
    pub axes: [Vector3<f64>; JOINTS],
    /// Pose of the tool centre point.
    pub tcp: Pose,
}

impl Arm {
    /// Returns link frames, joint axes and TCP at the given joint angles (forward kinematics).
    pub fn posture(&self, angles: &Angles) -> Posture {
        let mut links = [Pose::identity(); JOINTS];
        let mut axes = [Vector3::zeros(); JOINTS];
        let mut frame = Pose::identity();
        for (i, joint) in self.joints.iter().enumerate() {
            frame *= joint.frame;
            axes[i] = frame.rotation * joint.axis.into_inner();
            let rotation = UnitQuaternion::from_axis_angle(&joint.axis, angles[i]);
            frame *= Pose::from_parts(Translation3::identity(), rotation);
            links[i] = frame;
        }
        Posture { links, axes, tcp: frame * self.tool }
    }

    /// Returns the mass matrix `M(q)` of the kinetic energy `q' M q' / 2`, kg m2: the sum of
    /// `m Jv^T Jv + Jw^T I Jw` over the links.
    pub fn mass_matrix(&self, posture: &Posture) -> Matrix6<f64> {
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

    /// Returns the joint angles near home that bring the TCP to a pose in the base frame.
    ///
    /// # Errors
    /// If the pose is out of reach or singular.
    pub fn inverse_kinematics(&self, target: &Pose) -> Result<Angles, ArmError> {
        let mut angles = self.home;
        let mut error = Vector6::zeros();
        for _ in 0..MAX_STEPS {
            let posture = self.posture(&angles);
            error = displacement(&posture.tcp, target);
            if error.amax() < TOLERANCE {
                return Ok(angles);
            }
            let jacobian = posture.tcp_jacobian();
            // The damping is proportional to the error, so that the last steps are Newton steps.
            let damping = (DAMPING * error.norm().min(1.0)).powi(2);
            let square = jacobian * jacobian.transpose() + Matrix6::from_diagonal_element(damping);
            let step = square.cholesky().ok_or(ArmError::Singular)?.solve(&error);
            angles += jacobian.tr_mul(&step);
        }
        let [distance, angle] = [0, 3].map(|row| error.fixed_rows::<3>(row).norm());
        Err(ArmError::Unreachable(distance / MM, angle / DEG))
    }
}

impl Posture {
    /// Returns the Jacobian of a point fixed to a link, from joint rates to linear velocity (rows 0..3, m) and
    /// angular velocity (rows 3..6) in base axes.
    pub fn jacobian(&self, point: &Point3<f64>, link: usize) -> Matrix6<f64> {
        let mut jacobian = Matrix6::zeros();
        for i in 0..=link {
            let lever = point.coords - self.links[i].translation.vector;
            jacobian.fixed_view_mut::<3, 1>(0, i).copy_from(&self.axes[i].cross(&lever));
            jacobian.fixed_view_mut::<3, 1>(3, i).copy_from(&self.axes[i]);
        }
        jacobian
    }

    /// Returns the Jacobian of the TCP, base axes.
    pub fn tcp_jacobian(&self) -> Matrix6<f64> {
        self.jacobian(&Point3::from(self.tcp.translation.vector), JOINTS - 1)
    }
}
