//! What a task file may say of its fingers beyond their two measured springs.

use input::units::MM;
use nalgebra::Matrix6;

/// The part of a finger that the task file decides; the default leaves it as it is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FingerModel {
    /// Remote centre of compliance, if the file gives it.
    pub rcc: Option<Rcc>,
    /// Coupling of its springs, if the file gives it.
    pub coupling: Option<Coupling>,
}

/// Distance of the remote centre from the contact plane towards the tip, by infill direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rcc {
    /// At 0 degrees, m.
    pub at_zero: f64,
    /// Change with each degree, m.
    pub per_degree: f64,
}

/// Coefficients `c` that couple the six springs: `k_ij = c_ij sqrt(k_i k_j)`. For any design, a
/// positive definite matrix with ones on its diagonal makes a finger that springs back. Order:
/// translations x, y, z, rotations x, y, z about the remote centre, of the finger at -y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupling(Matrix6<f64>);

impl Rcc {
    /// The paper's, for all directions.
    pub const PAPER: Rcc = Rcc { at_zero: 21.0 * MM, per_degree: 0.0 };

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

    /// The coefficients of a stiffness matrix; `None` unless it is positive definite.
    pub fn of(stiffness: &Matrix6<f64>) -> Option<Self> {
        stiffness.cholesky()?;
        let scale = |i: usize, j: usize| (stiffness[(i, i)] * stiffness[(j, j)]).sqrt();
        Some(Coupling(Matrix6::from_fn(|i, j| match i == j {
            true => 1.0,
            false => stiffness[(i, j)] / scale(i, j),
        })))
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
