//! The contact law of one point: unilateral contact with Coulomb friction, as a
//! projection onto the friction cone.
//!
//! With the relative velocity `u` (of the second body against the first), the
//! bias `b` and the compliances `e_n`, `e_t` the impulse is the point of the
//! cone `|l_t| <= mu l_n` nearest to `-(u + b)/e` in the metric of `e`: the
//! gradient of a convex potential of `u` (MuJoCo, Todorov 2014, ICRA,
//! "Convex and analytically-invertible dynamics with contacts").

use nalgebra::{Matrix3, Vector3};

/// Compliances of a contact, 1/kg: relative velocity per impulse.
#[derive(Debug, Clone, Copy)]
pub(super) struct Compliance {
    /// Along the normal.
    pub normal: f64,
    /// In the tangent plane.
    pub tangent: f64,
}

/// What a contact is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum State {
    Apart,
    Stick,
    Slide,
}

/// Velocity of a contact, split: what the law wants to know of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pull {
    /// `-(u + b)` along the normal, m/s.
    normal: f64,
    /// `-u` in the tangent plane, m/s.
    tangent: Vector3<f64>,
    /// Its length.
    speed: f64,
}

impl Pull {
    /// From the relative velocity, the unit normal and the normal's bias.
    #[inline]
    pub fn new(velocity: &Vector3<f64>, normal: &Vector3<f64>, bias: f64) -> Self {
        let along = velocity.dot(normal);
        let tangent = normal * along - velocity;
        Pull { normal: -(along + bias), tangent, speed: tangent.norm() }
    }
}

/// A cone with its compliances.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cone {
    pub mu: f64,
    pub compliance: Compliance,
}

impl Cone {
    #[inline]
    fn ratio(&self) -> f64 {
        self.compliance.tangent / self.compliance.normal
    }

    /// Which part of the cone the impulse lies on.
    #[inline]
    pub fn state(&self, pull: &Pull) -> State {
        let Compliance { normal, tangent } = self.compliance;
        if pull.speed * normal <= self.mu * pull.normal * tangent {
            State::Stick
        } else if self.mu * pull.speed <= -pull.normal {
            State::Apart
        } else {
            State::Slide
        }
    }

    /// Normal impulse of a sliding contact, N s.
    #[inline]
    fn sliding(&self, pull: &Pull) -> f64 {
        (pull.normal + self.mu * pull.speed)
            / (self.compliance.normal * (1.0 + self.mu * self.mu * self.ratio()))
    }

    /// Impulse on the second body, N s.
    #[inline]
    pub fn impulse(&self, pull: &Pull, normal: &Vector3<f64>) -> Vector3<f64> {
        match self.state(pull) {
            State::Apart => Vector3::zeros(),
            State::Stick => {
                normal * (pull.normal / self.compliance.normal)
                    + pull.tangent / self.compliance.tangent
            }
            State::Slide => {
                let pressed = self.sliding(pull);
                normal * pressed + pull.tangent * (self.mu * pressed / pull.speed)
            }
        }
    }

    /// Minus the derivative of the impulse by the velocity, kg: symmetric and
    /// positive semidefinite.
    #[inline]
    pub fn stiffness(&self, pull: &Pull, normal: &Vector3<f64>) -> Matrix3<f64> {
        match self.state(pull) {
            State::Apart => Matrix3::zeros(),
            State::Stick => {
                let tangent = 1.0 / self.compliance.tangent;
                let extra = 1.0 / self.compliance.normal - tangent;
                Matrix3::from_diagonal_element(tangent) + (normal * extra) * normal.transpose()
            }
            State::Slide => {
                let along = pull.tangent / pull.speed;
                let across = normal.cross(&along);
                let edge = normal + along * self.mu;
                let weight =
                    1.0 / (self.compliance.normal * (1.0 + self.mu * self.mu * self.ratio()));
                let turning = self.mu * self.sliding(pull) / pull.speed;
                (edge * weight) * edge.transpose() + (across * turning) * across.transpose()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONE: Cone = Cone { mu: 0.3, compliance: Compliance { normal: 0.02, tangent: 0.001 } };

    fn impulse(u: Vector3<f64>) -> Vector3<f64> {
        CONE.impulse(&Pull::new(&u, &Vector3::z(), 0.0), &Vector3::z())
    }

    #[test]
    fn the_impulse_is_continuous_and_stays_in_the_cone() {
        for i in 0..2000 {
            let angle = f64::from(i) * 0.01;
            let u = Vector3::new(0.02 * angle.sin(), 0.01, 0.05 * (1.7 * angle).cos());
            let l = impulse(u);
            assert!(l.z >= 0.0 && l.x.hypot(l.y) <= CONE.mu * l.z * (1.0 + 1e-12));
            let step = impulse(u + Vector3::new(1e-9, 1e-9, 1e-9)) - l;
            assert!(step.norm() < 4e-9 / CONE.compliance.tangent);
        }
    }

    #[test]
    fn the_stiffness_is_the_derivative_of_the_impulse() {
        for u in [[1e-4, 2e-4, -0.05], [0.02, -0.01, -0.02], [0.02, 0.0, 0.001], [0.0, 0.0, 0.1]] {
            let u = Vector3::from(u);
            let k = CONE.stiffness(&Pull::new(&u, &Vector3::z(), 0.0), &Vector3::z());
            for axis in 0..3 {
                let mut d = Vector3::zeros();
                d[axis] = 1e-7;
                let slope = (impulse(u - d) - impulse(u + d)) / 2e-7;
                assert!((slope - k.column(axis)).norm() < 1e-4 * (1.0 + k.norm()), "{u} {axis}");
            }
        }
    }
}
