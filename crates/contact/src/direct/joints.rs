//! Joints as implicit springs and dampers.
//!
//! The coordinates `q` are translation and rotation vector of the child's joint frame in the parent's. With their exact
//! Jacobian `J`, the force at the end of the step, `f = -k (q + h J v - target) - c J v`, adds `J^T (h c + h^2 k) J` to
//! the system and `-h J^T k (q - target)` to its right-hand side: stable for any stiffness, and exact at rest.
//! `k` and `c` are a number for each axis or, for coupled springs, a matrix. A locked axis is a
//! very stiff spring (0.1 um at 100 N). A servo at its limit exerts that limit; the step is solved
//! again until the servos found at their limits are those assumed for the solution.

use super::blocks::{Blocks, Vector6};
use super::body::MovingBody;
use crate::scene::{AxialFriction, Joint, Motion, Pose, Spring, Springs};
use nalgebra::{Matrix3, Matrix6, Vector3};

/// Axis of a joint along which [`AxialFriction`] acts.
const ALONG: usize = 2;

/// Stiffness of a locked translation, N/m.
const LOCKED: f64 = 1e9;
/// Stiffness of a locked rotation, N m/rad: as stiff at an arm of 30 mm.
const LOCKED_TURN: f64 = 1e6;

/// Matrix `h c + h^2 k` that maps the rates of a joint at the end of the step to the impulse that opposes them;
/// diagonal unless the springs are coupled.
#[expect(clippy::large_enum_variant, reason = "lives on the stack of one call")]
enum ImplicitDamping {
    Diagonal(Vector6),
    Full(Matrix6<f64>),
}

impl ImplicitDamping {
    /// Returns the impulse for the rates.
    fn impulse(&self, rates: &Vector6) -> Vector6 {
        match self {
            ImplicitDamping::Diagonal(diagonal) => diagonal.component_mul(rates),
            ImplicitDamping::Full(matrix) => matrix * rates,
        }
    }

    /// Returns the product with a Jacobian, which maps the velocity of a body to the impulse.
    fn times(&self, jacobian: &Matrix6<f64>) -> Matrix6<f64> {
        match self {
            ImplicitDamping::Diagonal(diagonal) => {
                jacobian.map_with_location(|row, _, entry| entry * diagonal[row])
            }
            ImplicitDamping::Full(matrix) => matrix * jacobian,
        }
    }
}

/// Joint of springs and dampers, with its coordinates at the start of the step.
#[derive(Debug, Clone)]
pub(super) struct SpringJoint {
    /// Joint of the scene, with very stiff springs on its locked axes.
    joint: Joint,
    /// Sign of the force of each servo at its limit, else 0.
    saturated: [f64; 6],
    /// Coordinates, m, rad.
    position: Vector6,
    /// Jacobians of the rates of the coordinates with respect to the velocities of child and parent.
    by_child: Matrix6<f64>,
    by_parent: Matrix6<f64>,
}

impl SpringJoint {
    pub fn new(joint: &Joint) -> Self {
        let mut joint = joint.clone();
        if let Springs::Axes(axes) = &mut joint.springs {
            for (i, axis) in axes.iter_mut().enumerate() {
                axis.get_or_insert(Spring::new(if i < 3 { LOCKED } else { LOCKED_TURN }, 0.0));
            }
        }
        SpringJoint {
            joint,
            saturated: [0.0; 6],
            position: Vector6::zeros(),
            by_child: Matrix6::zeros(),
            by_parent: Matrix6::zeros(),
        }
    }

    /// Creates a joint that leaves all axes free, for a friction along z.
    pub fn free(friction: &AxialFriction) -> Self {
        SpringJoint::new(&Joint {
            name: String::new(),
            parent: friction.parent,
            child: friction.child,
            in_parent: Pose::identity(),
            in_child: Pose::identity(),
            springs: Springs::Axes([Some(Spring::new(0.0, 0.0)); 6]),
        })
    }

    /// Sets the largest friction along z, N, and the damping of sticking, N s/m.
    pub fn set_friction(&mut self, limit: f64, damping: f64) {
        let damper = Spring { limit, ..Spring::new(0.0, damping) };
        self.set(ALONG, if limit > 0.0 { damper } else { Spring::new(0.0, 0.0) });
    }

    /// Returns the friction along z on the child at the bodies' velocities, world axes, N.
    pub fn friction(&self, bodies: &[MovingBody]) -> Vector3<f64> {
        let Springs::Axes(axes) = &self.joint.springs else { return Vector3::zeros() };
        let Some(Spring { damping, limit, .. }) = axes[ALONG] else { return Vector3::zeros() };
        let sign = self.saturated[ALONG];
        let force = if sign == 0.0 { -damping * self.rate(bodies)[ALONG] } else { sign * limit };
        bodies[self.joint.parent.0].pose.rotation * Vector3::z() * force
    }

    /// Replaces the spring of an axis unless the springs are coupled; a servo remains at its limit until the next step.
    pub fn set(&mut self, axis: usize, spring: Spring) {
        let Springs::Axes(axes) = &mut self.joint.springs else { return };
        axes[axis] = Some(spring);
        if spring.limit.is_infinite() {
            self.saturated[axis] = 0.0;
        }
    }

    /// Computes the coordinates and their Jacobians at the bodies' poses.
    pub fn locate(&mut self, bodies: &[MovingBody]) {
        let (parent, child) = (&bodies[self.joint.parent.0], &bodies[self.joint.child.0]);
        let (p, c) = (parent.pose * self.joint.in_parent, child.pose * self.joint.in_child);
        let relative = p.inv_mul(&c);
        let turn = relative.rotation.scaled_axis();
        self.position.fixed_rows_mut::<3>(0).copy_from(&relative.translation.vector);
        self.position.fixed_rows_mut::<3>(3).copy_from(&turn);
        let axes = p.rotation.inverse().to_rotation_matrix().into_inner();
        let angular = inverse_left_jacobian(&turn) * axes;
        // Both Jacobians refer to the body points at the origin of the child's joint frame.
        let place = c.translation.vector;
        self.by_child = jacobian(&axes, &angular, &(place - child.centre.coords));
        self.by_parent = -jacobian(&axes, &angular, &(place - parent.centre.coords));
    }

    /// Returns the matrix from rates to the impulse, and the impulse at zero rates.
    fn linear_impulse(&self, step: f64) -> (ImplicitDamping, Vector6) {
        let axes = match &self.joint.springs {
            Springs::Axes(axes) => axes.iter().flatten(),
            Springs::Coupled { stiffness, damping } => {
                let matrix = (damping + stiffness * step) * step;
                return (ImplicitDamping::Full(matrix), stiffness * self.position * -step);
            }
        };
        let mut diagonal = Vector6::zeros();
        let mut push = Vector6::zeros();
        for (i, spring) in axes.enumerate() {
            if self.saturated[i] == 0.0 {
                diagonal[i] = step * (spring.damping + step * spring.stiffness);
                push[i] = -step * spring.stiffness * (self.position[i] - spring.target);
            } else {
                push[i] = step * self.saturated[i] * spring.limit;
            }
        }
        (ImplicitDamping::Diagonal(diagonal), push)
    }

    /// Adds the springs to the system and its right-hand side.
    pub fn assemble(
        &self,
        bodies: &[MovingBody],
        step: f64,
        system: &mut Blocks,
        rhs: &mut [Vector6],
    ) {
        let (damping, mut push) = self.linear_impulse(step);
        // The impulse due to the known velocity of a driven end belongs on the right-hand side.
        let [parent, child] = [self.joint.parent, self.joint.child].map(|end| &bodies[end.0]);
        for (end, jacobian) in [(parent, &self.by_parent), (child, &self.by_child)] {
            if end.motion == Motion::Driven {
                push -= damping.impulse(&(jacobian * end.velocity));
            }
        }
        let (parent, child) = (parent.place, child.place);
        for (place, jacobian) in [(parent, &self.by_parent), (child, &self.by_child)] {
            let Some(place) = place else { continue };
            system.add(place, place, &jacobian.tr_mul(&damping.times(jacobian)));
            rhs[place] += jacobian.tr_mul(&push);
        }
        if let (Some(p), Some(c)) = (parent, child) {
            if p > c {
                system.add(p, c, &self.by_parent.tr_mul(&damping.times(&self.by_child)));
            } else {
                system.add(c, p, &self.by_child.tr_mul(&damping.times(&self.by_parent)));
            }
        }
    }

    /// Returns the rates of the coordinates.
    fn rate(&self, bodies: &[MovingBody]) -> Vector6 {
        self.by_child * bodies[self.joint.child.0].velocity
            + self.by_parent * bodies[self.joint.parent.0].velocity
    }

    /// Determines the servos at their limits; returns whether the last solution assumed the same ones.
    pub fn update_limits(&mut self, bodies: &[MovingBody], step: f64) -> bool {
        let Springs::Axes(axes) = &self.joint.springs else { return true };
        if axes.iter().flatten().all(|spring| spring.limit.is_infinite()) {
            return true;
        }
        let rate = self.rate(bodies);
        let before = self.saturated;
        for (i, spring) in axes.iter().flatten().enumerate() {
            let &Spring { stiffness, damping, target, limit } = spring;
            let end = self.position[i] + step * rate[i];
            let force = -stiffness * (end - target) - damping * rate[i];
            // With a margin, so that rounding errors do not make the solutions alternate.
            let beyond = force.abs() > limit * (1.0 + 1e-9);
            let sign = if beyond { force.signum() } else { 0.0 };
            // Before friction changes its sign, sticking is tried; otherwise the signs could alternate for ever.
            let reverses = stiffness == 0.0 && sign == -before[i];
            self.saturated[i] = if reverses { 0.0 } else { sign };
        }
        self.saturated == before
    }
}

/// Returns the Jacobian of `axes (v + w x arm)` and `angular w` with respect to `v` and `w`.
fn jacobian(axes: &Matrix3<f64>, angular: &Matrix3<f64>, arm: &Vector3<f64>) -> Matrix6<f64> {
    let mut made = Matrix6::zeros();
    made.fixed_view_mut::<3, 3>(0, 0).copy_from(axes);
    made.fixed_view_mut::<3, 3>(0, 3).copy_from(&-(axes * arm.cross_matrix()));
    made.fixed_view_mut::<3, 3>(3, 3).copy_from(angular);
    made
}

/// Returns the matrix that maps the angular velocity to the rate of the rotation vector `t`, both in the parent's axes:
/// `1 - [t]/2 + (1/|t|^2 - cot(|t|/2)/(2 |t|)) [t]^2` (Bullo and Murray 1995, "Proportional derivative control on the
/// Euclidean group").
fn inverse_left_jacobian(turn: &Vector3<f64>) -> Matrix3<f64> {
    let angle = turn.norm();
    let cross = turn.cross_matrix();
    let second = if angle < 1e-3 {
        // Series: 1/12 + angle^2/720.
        1.0 / 12.0 + angle * angle / 720.0
    } else {
        let half = 0.5 * angle;
        (1.0 - half / libm::tan(half)) / (angle * angle)
    };
    Matrix3::identity() - cross * 0.5 + cross * cross * second
}
