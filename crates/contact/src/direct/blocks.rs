//! Elimination of bodies from the system matrix, six rows at a time.
//!
//! The matrix couples bodies that share a joint. Bodies that touch nothing (flange, jaws) are
//! eliminated first by a block Cholesky factorisation, down to a small dense system of the others.

use super::dense::Six;
use nalgebra::{Cholesky, Const, Matrix6, SVector};

/// Velocity (linear of the centre of mass, angular) or impulse, world axes.
pub(super) type Vector6 = SVector<f64, 6>;

/// Index of a block that is always zero.
const NONE: usize = usize::MAX;

/// Symmetric matrix of 6x6 blocks with a fixed pattern, as its lower half.
#[derive(Clone)]
pub(super) struct Blocks {
    /// Number of bodies.
    size: usize,
    /// Number of eliminated bodies, which come first.
    pub eliminated: usize,
    /// Index in `blocks` of each block (row >= column).
    index: Vec<usize>,
    blocks: Vec<Matrix6<f64>>,
    factors: Vec<Cholesky<f64, Const<6>>>,
}

impl Blocks {
    /// Creates a zero matrix with the blocks of the pairs and the fill-in of the elimination.
    pub fn new(size: usize, eliminated: usize, pairs: &[(usize, usize)]) -> Self {
        let mut present = vec![false; size * size];
        for (a, b) in (0..size).map(|i| (i, i)).chain(pairs.iter().copied()) {
            present[a.max(b) * size + a.min(b)] = true;
        }
        for k in 0..eliminated {
            for i in k + 1..size {
                for j in k + 1..=i {
                    if present[i * size + k] && present[j * size + k] {
                        present[i * size + j] = true;
                    }
                }
            }
        }
        let mut places = 0..;
        let mut place = |there: bool| if there { places.next() } else { None };
        let index: Vec<_> = present.into_iter().map(|there| place(there).unwrap_or(NONE)).collect();
        let blocks = vec![Matrix6::zeros(); places.start];
        Blocks { size, eliminated, index, blocks, factors: Vec::with_capacity(eliminated) }
    }

    /// Sets every block to zero.
    pub fn clear(&mut self) {
        self.blocks.fill(Matrix6::zeros());
    }

    /// Adds to the block of a row and a column, `row >= column`.
    pub fn add(&mut self, row: usize, column: usize, block: &Matrix6<f64>) {
        let at = self.index[row * self.size + column];
        self.blocks[at] += block;
    }

    fn get(&self, row: usize, column: usize) -> Option<&Matrix6<f64>> {
        self.blocks.get(self.index[row * self.size + column])
    }

    /// Eliminates the first bodies; returns `None` if the matrix is not positive definite (or not finite).
    pub fn eliminate(&mut self) -> Option<()> {
        self.factors.clear();
        for k in 0..self.eliminated {
            let factor = Cholesky::new(*self.get(k, k)?)?;
            let lower = factor.l();
            self.factors.push(factor);
            for i in k + 1..self.size {
                let at = self.index[i * self.size + k];
                if at == NONE {
                    continue;
                }
                // L_ik = A_ik L_kk^-T
                let mut side = self.blocks[at].transpose();
                lower.solve_lower_triangular_mut(&mut side);
                self.blocks[at] = side.transpose();
                for j in k + 1..=i {
                    let other = self.index[j * self.size + k];
                    if other == NONE {
                        continue;
                    }
                    let product = self.blocks[at] * self.blocks[other].transpose();
                    let to = self.index[i * self.size + j];
                    self.blocks[to] -= product;
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
