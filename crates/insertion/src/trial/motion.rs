//! Commanded motion of the TCP: straight, minimum-jerk, in simulated time.

use crate::task::duration::MIN_MOVE_S;
use contact::scene::Pose;
use nalgebra::{Translation3, UnitQuaternion, Vector3};

/// A TCP target: position, m, and tilt about x, rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tcp {
    /// Position, m.
    pub position: Vector3<f64>,
    /// Tilt about x, rad.
    pub tilt: f64,
}

impl Tcp {
    /// Returns the pose of the TCP.
    pub(super) fn pose(&self) -> Pose {
        let rotation = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), self.tilt);
        Pose::from_parts(Translation3::from(self.position), rotation)
    }

    /// Returns the target at a share of the way to another.
    pub fn towards(&self, to: &Tcp, share: f64) -> Tcp {
        Tcp {
            position: self.position + share * (to.position - self.position),
            tilt: self.tilt + share * (to.tilt - self.tilt),
        }
    }

    /// Returns the target displaced by a vector, m.
    pub(super) fn moved(&self, by: Vector3<f64>) -> Tcp {
        Tcp { position: self.position + by, tilt: self.tilt }
    }
}

/// A minimum-jerk move (Flash and Hogan 1985, J. Neurosci. 5:1688); peak speed 15/8 of the mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    from: Tcp,
    to: Tcp,
    /// Duration, s.
    pub duration: f64,
}

impl Move {
    /// Returns a move at a mean speed, m/s.
    pub fn new(from: Tcp, to: Tcp, speed: f64) -> Self {
        Move::with_duration(from, to, (to.position - from.position).norm() / speed)
    }

    /// Returns a move with a duration, s.
    pub fn with_duration(from: Tcp, to: Tcp, duration: f64) -> Self {
        Move { from, to, duration: duration.max(MIN_MOVE_S) }
    }

    /// Returns the commanded TCP `time` seconds after the start; after the duration, the end of the move.
    pub fn at(&self, time: f64) -> Tcp {
        let t = (time / self.duration).clamp(0.0, 1.0);
        let s = t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
        self.from.towards(&self.to, s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_move_starts_and_ends_at_rest_and_peaks_at_15_eighths() {
        let at = |x| Tcp { position: Vector3::new(x, 0.0, 0.0), tilt: 0.0 };
        let motion = Move::new(at(0.0), at(0.01), 0.05);
        assert!((motion.duration - 0.2).abs() < 1e-12);
        let speed = |t: f64| (motion.at(t + 1e-6).position.x - motion.at(t).position.x) / 1e-6;
        assert!(speed(0.0) < 1e-6 && speed(0.2 - 1e-6) < 1e-6);
        assert!((speed(0.1) / 0.05 - 15.0 / 8.0).abs() < 1e-3);
        assert_eq!(motion.at(1.0), at(0.01));
    }
}
