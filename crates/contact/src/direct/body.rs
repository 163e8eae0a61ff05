//! Bodies in motion: pose, velocity and mass.

use super::blocks::Vector6;
use crate::scene::{Body, Inertia, Motion, Pose, block_rotation, displacement};
use nalgebra::{Matrix3, Matrix6, Point3, Translation3, UnitQuaternion, Vector3};

/// Body in motion.
#[derive(Debug, Clone)]
pub(super) struct MovingBody {
    pub motion: Motion,
    /// Block row of the body in the system matrix, if the solver determines its velocity.
    pub place: Option<usize>,
    /// Pose of the body frame in the world.
    pub pose: Pose,
    /// Pose at the end of the step if the body is driven.
    pub target: Pose,
    /// Mass properties; zero for fixed and driven bodies and for a mechanism, whose mass is in `motion`.
    inertia: Inertia,
    /// Reference point of velocity and momentum in the world, m: the centre of mass, or the origin of the body frame if
    /// `inertia` is zero.
    pub centre: Point3<f64>,
    /// Velocity of `centre`, m/s, and angular velocity, rad/s, world axes.
    pub velocity: Vector6,
    /// Momentum and angular momentum about `centre` at the start of the step, N s, N m s, world axes. To conserve them
    /// from step to step, instead of the velocities, includes the gyroscopic term to first order in the step
    /// (negligible in an insertion).
    pub momentum: Vector6,
    /// Inertia about the centre of mass, world axes, kg m2.
    tensor: Matrix3<f64>,
}

impl MovingBody {
    /// Creates a body at rest; `place` is its block row in the system matrix, if the solver determines its velocity.
    pub fn new(body: &Body, place: Option<usize>) -> Self {
        let inertia = match body.motion {
            Motion::Free(inertia) | Motion::Carried(inertia) => inertia,
            Motion::Fixed | Motion::Driven | Motion::Mechanism(_) => Inertia::default(),
        };
        let mut made = MovingBody {
            motion: body.motion,
            place,
            pose: body.pose,
            target: body.pose,
            inertia,
            centre: Point3::origin(),
            velocity: Vector6::zeros(),
            momentum: Vector6::zeros(),
            tensor: Matrix3::zeros(),
        };
        made.refresh();
        made
    }

    /// Moves a fixed body to a pose.
    pub fn put(&mut self, pose: Pose) {
        self.pose = pose;
        self.refresh();
    }

    /// Returns the mass matrix about `centre`, world axes. That of a mechanism rotates with its end; its dependence on
    /// the configuration of the mechanism is neglected.
    pub fn mass(&self) -> Matrix6<f64> {
        if let Motion::Mechanism(mass) = &self.motion {
            let both = block_rotation(&self.pose.rotation);
            return both * mass * both.transpose();
        }
        let mut mass = Matrix6::from_diagonal_element(self.inertia.mass);
        mass.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.tensor);
        mass
    }

    /// Returns the momentum at the end of a step in which only gravity acts.
    pub fn momentum_after(&self, gravity: &Vector3<f64>, step: f64) -> Vector6 {
        let mut momentum = self.momentum;
        if let Motion::Free(_) = self.motion {
            let mut linear = momentum.fixed_rows_mut::<3>(0);
            linear += gravity * (step * self.inertia.mass);
        }
        momentum
    }

    /// Sets the velocity of a driven body so that it reaches its target.
    pub fn steer(&mut self, step: f64) {
        let Motion::Driven = self.motion else { return };
        self.velocity = displacement(&self.pose, &self.target) / step;
    }

    /// Moves the body over a step: a driven body to its target, others with constant velocity and angular velocity.
    pub fn advance(&mut self, step: f64) {
        match self.motion {
            Motion::Fixed => return,
            Motion::Driven => self.pose = self.target,
            Motion::Free(_) | Motion::Carried(_) | Motion::Mechanism(_) => {
                let angular = self.velocity.fixed_rows::<3>(3).into_owned();
                self.momentum = self.mass() * self.velocity;
                let centre = self.centre + self.velocity.fixed_rows::<3>(0) * step;
                let turn = UnitQuaternion::from_scaled_axis(angular * step);
                let rotation = (turn * self.pose.rotation).into_inner();
                let rotation = UnitQuaternion::new_normalize(rotation);
                let origin = centre - rotation * self.inertia.centre.coords;
                self.pose = Pose::from_parts(Translation3::from(origin), rotation);
            }
        }
        self.refresh();
    }

    /// Returns whether pose and velocity are finite numbers.
    pub fn is_finite(&self) -> bool {
        let pose = self.pose.translation.vector.iter().chain(self.pose.rotation.coords.iter());
        pose.chain(self.velocity.iter()).all(|x| x.is_finite())
    }

    /// Updates `centre` and the inertia in world axes.
    fn refresh(&mut self) {
        self.centre = self.pose * self.inertia.centre;
        let axes = self.pose.rotation.to_rotation_matrix().into_inner();
        self.tensor = axes * Matrix3::from_diagonal(&self.inertia.moments) * axes.transpose();
    }
}
