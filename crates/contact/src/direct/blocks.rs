//! Elimination of bodies from the system matrix, six rows at a time.
//!
//! The matrix couples bodies that share a joint. Bodies that touch nothing (flange, jaws) are
//! eliminated first by a block Cholesky factorization, down to a small dense system of the others.

use super::dense::Six;
use nalgebra::{Cholesky, Const, Matrix6, SVector};

/// Velocity (linear of the centre of mass, angular) or impulse, world axes.
pub(super) type Vector6 = SVector<f64, 6>;

/// Symmetric matrix of 6x6 blocks, as its lower half.
#[derive(Clone)]
pub(super) struct Blocks {
    /// Number of bodies.
    size: usize,
    /// Number of eliminated bodies, which come first.
    pub eliminated: usize,
    /// Blocks, row by row (row >= column); `None` if zero.
    blocks: Vec<Option<Matrix6<f64>>>,
    /// Factors of the diagonal blocks of the eliminated bodies.
    factors: Vec<Cholesky<f64, Const<6>>>,
}

impl Blocks {
    /// Creates a zero matrix.
    pub fn new(size: usize, eliminated: usize) -> Self {
        let factors = Vec::with_capacity(eliminated);
        Blocks { size, eliminated, blocks: vec![None; size * size], factors }
    }

    /// Sets every block to zero.
    pub fn clear(&mut self) {
        self.blocks.fill(None);
    }

    /// Adds to the block of a row and a column, `row >= column`.
    pub fn add(&mut self, row: usize, column: usize, block: &Matrix6<f64>) {
        *self.blocks[row * self.size + column].get_or_insert_with(Matrix6::zeros) += block;
    }

    fn get(&self, row: usize, column: usize) -> Option<&Matrix6<f64>> {
        self.blocks[row * self.size + column].as_ref()
    }

    /// Eliminates the first bodies; returns `None` if the matrix is not positive definite (or not finite).
    pub fn eliminate(&mut self) -> Option<()> {
        self.factors.clear();
        for k in 0..self.eliminated {
            let factor = Cholesky::new(*self.get(k, k)?)?;
            let lower = factor.l();
            self.factors.push(factor);
            for i in k + 1..self.size {
                let Some(block) = self.get(i, k) else { continue };
                // L_ik = A_ik L_kk^-T
                let mut side = block.transpose();
                lower.solve_lower_triangular_mut(&mut side);
                let block = side.transpose();
                self.blocks[i * self.size + k] = Some(block);
                for j in k + 1..=i {
                    let Some(other) = self.get(j, k) else { continue };
                    let product = block * other.transpose();
                    *self.blocks[i * self.size + j].get_or_insert_with(Matrix6::zeros) -= product;
                }
            }
        }
        Some(())
    }

    /// Eliminates the first bodies from the right-hand side.
    pub fn reduce(&self, rhs: &mut [Vector6]) {
        for (k, factor) in self.factors.iter().enumerate() {
            factor.l_dirty().solve_lower_triangular_mut(&mut rhs[k]);
            for i in k + 1..self.size {
                if let Some(side) = self.get(i, k) {
                    let carried = side * rhs[k];
                    rhs[i] -= carried;
                }
            }
        }
    }

    /// Solves for the eliminated bodies; `rhs` holds the solution of the others.
    pub fn expand(&self, rhs: &mut [Vector6]) {
        for (k, factor) in self.factors.iter().enumerate().rev() {
            for i in k + 1..self.size {
                if let Some(side) = self.get(i, k) {
                    let carried = side.tr_mul(&rhs[i]);
                    rhs[k] -= carried;
                }
            }
            factor.l_dirty().tr_solve_lower_triangular_mut(&mut rhs[k]);
        }
    }

    /// Copies the remaining matrix into a dense one, row by row, with both halves.
    pub fn remainder(&self, dense: &mut [Six]) {
        let remaining = self.size - self.eliminated;
        dense.fill([0.0; 6]);
        for i in 0..remaining {
            for j in 0..=i {
                let (row, column) = (i + self.eliminated, j + self.eliminated);
                let Some(block) = self.get(row, column) else { continue };
                for r in 0..6 {
                    for c in 0..6 {
                        dense[(6 * i + r) * remaining + j][c] = block[(r, c)];
                        dense[(6 * j + c) * remaining + i][r] = block[(r, c)];
                    }
                }
            }
        }
    }
}
