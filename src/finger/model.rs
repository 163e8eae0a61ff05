//! What a task file may say of its fingers beyond their two measured springs.

use super::Finger;
use crate::units::MM;
use nalgebra::Matrix6;

/// The part of a finger that the task file decides; the default is the paper's finger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FingerModel {
    /// Where its remote centre of compliance is.
    pub rcc: Rcc,
    /// How its springs pull at one another, if they do.
    pub coupling: Option<Coupling>,
}

/// Distance of the remote centre of compliance from the contact plane towards the
/// plug's tip, by the infill direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rcc {
    /// At 0 degrees, m.
    pub at_zero: f64,
    /// Change with each degree, m.
    pub per_degree: f64,
}

/// Coefficients `c` that couple the six springs: `k_ij = c_ij sqrt(k_i k_j)`. They
/// do not depend on how stiff a design is, and any positive definite matrix with ones on
/// its diagonal makes a finger that springs back. Order: translations x, y, z,
/// rotations x, y, z about the remote centre, of the finger at -y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupling(Matrix6<f64>);

impl Default for FingerModel {
    fn default() -> Self {
        FingerModel { rcc: Rcc { at_zero: 21.0 * MM, per_degree: 0.0 }, coupling: None }
    }
}

impl FingerModel {
    /// A finger of such a stiffness with its infill in this direction, degrees.
    pub fn shape(&self, finger: Finger, direction_deg: f64) -> Finger {
        Finger { rcc: self.rcc.at(direction_deg), coupling: self.coupling, ..finger }
    }
}

impl Rcc {
    /// The distance for an infill direction in degrees, m.
    pub fn at(&self, direction_deg: f64) -> f64 {
        // 0 times an unknown direction is not unknown.
        if self.per_degree == 0.0 {
            return self.at_zero;
        }
        self.at_zero + self.per_degree * direction_deg
    }

    /// Whether the direction matters.
    pub fn varies(&self) -> bool {
        self.per_degree != 0.0
    }
}

impl Coupling {
    /// From the coefficients of pairs of axes; `None` unless positive definite.
    pub fn new(pairs: impl IntoIterator<Item = (usize, usize, f64)>) -> Option<Self> {
        let mut matrix = Matrix6::identity();
        for (i, j, coefficient) in pairs {
            matrix[(i, j)] = coefficient;
            matrix[(j, i)] = coefficient;
        }
        matrix.cholesky().map(|_| Coupling(matrix))
    }

    /// The stiffness matrix of springs that are coupled so. The finger at +y (`side` +1) is
    /// the same printed part turned by 180 degrees about z.
    pub fn stiffness(&self, springs: [f64; 6], side: f64) -> Matrix6<f64> {
        let flips = [side, side, -1.0, side, side, -1.0];
        Matrix6::from_fn(|i, j| {
            self.0[(i, j)] * (springs[i] * springs[j]).sqrt() * flips[i] * flips[j]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Spring, Springs};

    #[test]
    fn the_default_is_the_papers_finger() {
        let finger = FingerModel::default().shape(Finger::new(2e3, 4e4), f64::NAN);
        assert_eq!(finger, Finger::new(2e3, 4e4));
        assert!(matches!(finger.mounted(1.0), Springs::Axes(_)));
    }

    #[test]
    fn the_remote_centre_moves_with_the_infill_direction() {
        let rcc = Rcc { at_zero: 21.0 * MM, per_degree: -0.1 * MM };
        let model = FingerModel { rcc, ..FingerModel::default() };
        assert!((model.shape(Finger::new(2e3, 4e4), 30.0).rcc - 18.0 * MM).abs() < 1e-15);
    }

    /// Turned by 180 degrees about z, a push in y that turned about z turns the other way.
    #[test]
    fn the_opposite_finger_is_the_same_part_turned() {
        let coupling = Coupling::new([(1, 2, 0.3), (1, 5, 0.2), (0, 4, 0.1)]).unwrap();
        let springs = [1e5, 2e3, 4e4, 1.0, 10.0, 10.0];
        let [here, there] = [-1.0, 1.0].map(|side| coupling.stiffness(springs, side));
        assert_eq!(here[(1, 2)], 0.3 * (2e3_f64 * 4e4).sqrt());
        assert_eq!((there[(1, 2)], there[(1, 5)]), (-here[(1, 2)], -here[(1, 5)]));
        assert_eq!((there[(0, 4)], there[(1, 1)]), (here[(0, 4)], 2e3));
        assert_eq!(here, here.transpose());
    }

    #[test]
    fn coupling_that_would_push_a_finger_away_is_none() {
        assert_eq!(Coupling::new([(1, 2, 1.0)]), None);
        assert_eq!(Coupling::new([(0, 1, 0.8), (1, 2, 0.8), (0, 2, -0.8)]), None);
        assert!(Coupling::new([(0, 1, 0.8), (1, 2, 0.8), (0, 2, 0.8)]).is_some());
    }

    #[test]
    fn a_coupled_finger_keeps_the_damping_of_its_springs() {
        let coupling = Coupling::new([(1, 3, 0.5)]);
        let finger = Finger { coupling, ..Finger::new(2e3, 4e4) };
        let Springs::Coupled(coupled) = finger.mounted(-1.0) else { panic!("coupled") };
        let damping = finger.springs().map(|Spring { damping, .. }| damping);
        assert_eq!(coupled.damping, Matrix6::from_diagonal(&damping.into()));
        assert_eq!(coupled.stiffness[(1, 3)], 0.5 * (2e3 * finger.rotation[0]).sqrt());
    }
}
