//! Contact law of a point: unilateral contact with Coulomb friction, as a projection onto the
//! friction cone.
//!
//! With the relative velocity `u` (of the second body against the first), the bias `b` and the
//! compliances `e_n`, `e_t` the impulse is the point of the cone `|l_t| <= mu l_n` nearest to
//! `-(u + b)/e` in the metric of `e`: the gradient of a convex potential of `u` (MuJoCo,
//! Todorov 2014, ICRA, "Convex and analytically-invertible dynamics with contacts").
//!
//! `u` and `l` have four components: along the world's axes, and about the normal, scaled by the
//! patch radius `rho`: `u_4 = rho w_n`, `l_4 = m_n/rho`. So `|l_t| <= mu l_n` is the ellipsoid of
//! a soft finger's friction, `(f/mu N)^2 + (m/mu N rho)^2 <= 1` (Howe and Cutkosky 1996, Int. J.
//! Robot. Res. 15:557).

use nalgebra::{Matrix4, Vector4};

/// State of a contact point: separated, sticking or sliding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum State {
    Apart,
    Stick,
    Slide,
}

/// Relative velocity of a contact with reversed sign, split into its components along and across the normal.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SplitVelocity {
    /// `-(u + b)` along the normal, m/s.
    normal: f64,
    /// `-u` without its component along the normal, m/s.
    tangent: Vector4<f64>,
    /// Magnitude of `tangent`, m/s.
    speed: f64,
}

impl SplitVelocity {
    /// Splits a relative velocity by the unit normal, with the bias along it.
    #[inline]
    pub fn new(velocity: &Vector4<f64>, normal: &Vector4<f64>, bias: f64) -> Self {
        let along = velocity.dot(normal);
        let tangent = normal * along - velocity;
        SplitVelocity { normal: -(along + bias), tangent, speed: tangent.norm() }
    }
}

/// Friction cone with its compliances, 1/kg: relative velocity per impulse.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Cone {
    /// Coefficient of friction.
    pub mu: f64,
    /// Compliance along the normal.
    pub normal: f64,
    /// Compliance in the tangent plane, and about the normal at the patch radius.
    pub tangent: f64,
}

impl Cone {
    /// Returns the compliance along the edge of the cone, 1/kg.
    #[inline]
    fn edge(&self) -> f64 {
        self.normal * (1.0 + self.mu * self.mu * (self.tangent / self.normal))
    }

    /// Returns the part of the cone on which the impulse lies.
    #[inline]
    pub fn state(&self, split: &SplitVelocity) -> State {
        if split.speed * self.normal <= self.mu * split.normal * self.tangent {
            State::Stick
        } else if self.mu * split.speed <= -split.normal {
            State::Apart
        } else {
            State::Slide
        }
    }

    /// Returns the normal impulse of a sliding contact, N s.
    #[inline]
    fn sliding(&self, split: &SplitVelocity) -> f64 {
        (split.normal + self.mu * split.speed) / self.edge()
    }

    /// Returns the impulse on the second body, N s; its fourth component is the moment divided by the patch radius.
    #[inline]
    pub fn impulse(&self, split: &SplitVelocity, normal: &Vector4<f64>) -> Vector4<f64> {
        match self.state(split) {
            State::Apart => Vector4::zeros(),
            State::Stick => normal * (split.normal / self.normal) + split.tangent / self.tangent,
            State::Slide => {
                let pressed = self.sliding(split);
                normal * pressed + split.tangent * (self.mu * pressed / split.speed)
            }
        }
    }

    /// Returns minus the derivative of the impulse with respect to the velocity, kg: symmetric, positive semidefinite.
    #[inline]
    pub fn stiffness(&self, split: &SplitVelocity, normal: &Vector4<f64>) -> Matrix4<f64> {
        match self.state(split) {
            State::Apart => Matrix4::zeros(),
            State::Stick => {
                let tangent = 1.0 / self.tangent;
                let extra = 1.0 / self.normal - tangent;
                Matrix4::from_diagonal_element(tangent) + (normal * extra) * normal.transpose()
            }
            State::Slide => {
                let along = split.tangent / split.speed;
                let edge = normal + along * self.mu;
                let weight = 1.0 / self.edge();
                let turning = self.mu * self.sliding(split) / split.speed;
                let across =
                    Matrix4::identity() - normal * normal.transpose() - along * along.transpose();
                (edge * weight) * edge.transpose() + across * turning
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    const CONE: Cone = Cone { mu: 0.3, normal: 0.02, tangent: 0.001 };

    fn impulse(u: Vector4<f64>) -> Vector4<f64> {
        CONE.impulse(&SplitVelocity::new(&u, &Vector4::z(), 0.0), &Vector4::z())
    }

    #[test]
    fn the_impulse_is_continuous_and_stays_in_the_cone() {
        for i in 0..2000 {
            let angle = f64::from(i) * 0.01;
            let spin = 0.02 * libm::sin(0.3 * angle);
            let u =
                Vector4::new(0.02 * libm::sin(angle), 0.01, 0.05 * libm::cos(1.7 * angle), spin);
            let l = impulse(u);
            let friction = Vector3::new(l.x, l.y, l.w).norm();
            assert!(l.z >= 0.0 && friction <= CONE.mu * l.z * (1.0 + 1e-12));
            let step = impulse(u + Vector4::repeat(1e-9)) - l;
            assert!(step.norm() < 4e-9 / CONE.tangent);
        }
    }

    #[test]
    fn the_stiffness_is_the_derivative_of_the_impulse() {
        let moves = [
            [1e-4, 2e-4, -0.05, -1e-4],
            [0.02, -0.01, -0.02, 0.015],
            [0.02, 0.0, 0.001, 0.0],
            [0.0, 0.0, 0.1, 0.01],
        ];
        for u in moves {
            let u = Vector4::from(u);
            let k = CONE.stiffness(&SplitVelocity::new(&u, &Vector4::z(), 0.0), &Vector4::z());
            for axis in 0..4 {
                let mut d = Vector4::zeros();
                d[axis] = 1e-7;
                let slope = (impulse(u - d) - impulse(u + d)) / 2e-7;
                assert!((slope - k.column(axis)).norm() < 1e-4 * (1.0 + k.norm()), "{u} {axis}");
            }
        }
    }
}
