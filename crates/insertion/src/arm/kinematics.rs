//! Forward kinematics: where the links are, and how the joints move a point.

use super::{Angles, Arm, JOINTS};
use contact::scene::Pose;
use nalgebra::{Isometry3, Matrix6, Point3, Translation3, UnitQuaternion, Vector3};

/// The arm at some joint angles, base frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Posture {
    /// Frames of the links, turned with their joints.
    pub links: [Pose; JOINTS],
    /// Unit vectors along the joints.
    pub axes: [Vector3<f64>; JOINTS],
    /// The tool centre point.
    pub tcp: Pose,
}

impl Arm {
    /// Link frames, joint axes and TCP at these angles.
    pub fn at(&self, angles: &Angles) -> Posture {
        let mut links = [Pose::identity(); JOINTS];
        let mut axes = [Vector3::zeros(); JOINTS];
        let mut frame = Pose::identity();
        for (i, joint) in self.joints.iter().enumerate() {
            frame *= joint.frame;
            axes[i] = frame.rotation * joint.axis.into_inner();
            let turn = UnitQuaternion::from_axis_angle(&joint.axis, angles[i]);
            frame *= Isometry3::from_parts(Translation3::identity(), turn);
            links[i] = frame;
        }
        Posture { links, axes, tcp: frame * self.tool }
    }
}

impl Posture {
    /// Velocity (rows 0..3) and angular velocity (rows 3..6) in base axes of a point
    /// that is fixed to a link, by the joint rates: 6x6, m and 1.
    pub fn jacobian(&self, point: &Point3<f64>, link: usize) -> Matrix6<f64> {
        let mut jacobian = Matrix6::zeros();
        for i in 0..=link {
            let arm = point.coords - self.links[i].translation.vector;
            jacobian.fixed_view_mut::<3, 1>(0, i).copy_from(&self.axes[i].cross(&arm));
            jacobian.fixed_view_mut::<3, 1>(3, i).copy_from(&self.axes[i]);
        }
        jacobian
    }

    /// The Jacobian of the TCP, base axes.
    pub fn tcp_jacobian(&self) -> Matrix6<f64> {
        self.jacobian(&Point3::from(self.tcp.translation.vector), JOINTS - 1)
    }
}
