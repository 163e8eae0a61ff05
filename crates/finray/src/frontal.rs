//! Frontal matrix of the multifrontal method (`condense.rs`): dense symmetric stiffness matrix of some nodes, the first
//! of which are eliminated.

use super::mesh::MeshError;

/// Number of columns that are eliminated together.
const PANEL: usize = 4;
/// Smallest pivot, relative to its value before the elimination; a smaller one is a rounding error, and the node can
/// move without a force.
const MIN_PIVOT: f64 = 1e-11;

/// Stiffness matrix of some nodes of a part of a mesh.
#[derive(Debug, Clone)]
pub struct Frontal {
    /// Nodes of the mesh, those to eliminate first.
    pub nodes: Vec<u32>,
    /// Number of nodes to eliminate.
    eliminated: usize,
    /// Number of degrees of freedom of a node.
    dofs: usize,
    /// Square matrix, row by row; only the lower triangle is used.
    pub values: Vec<f64>,
}

impl Frontal {
    /// Creates a zero matrix of these nodes, of which the first `eliminated` are to be eliminated.
    pub fn new(nodes: Vec<u32>, eliminated: usize, dofs: usize) -> Self {
        let size = nodes.len() * dofs;
        Frontal { nodes, eliminated, dofs, values: vec![0.0; size * size] }
    }

    /// Returns the number of rows.
    pub fn size(&self) -> usize {
        self.nodes.len() * self.dofs
    }

    /// Returns an entry of the lower triangle.
    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.values[row * self.size() + column]
    }

    /// Adds the lower half of a square matrix; `places` are the indices of its nodes in [`Frontal::nodes`], `None` for
    /// a fixed node.
    pub fn add(&mut self, places: &[Option<usize>], lower: &[f64]) {
        let (size, f) = (self.size(), self.dofs);
        let width = places.len() * f;
        for (a, to_a) in places.iter().enumerate() {
            let Some(to_a) = to_a else { continue };
            for (b, to_b) in places[..=a].iter().enumerate() {
                let Some(to_b) = to_b else { continue };
                for i in 0..f {
                    let row = &lower[(a * f + i) * width + b * f..][..f];
                    for (j, value) in row.iter().enumerate().take(if a == b { i + 1 } else { f }) {
                        let (row, column) = (to_a * f + i, to_b * f + j);
                        self.values[row.max(column) * size + row.min(column)] += value;
                    }
                }
            }
        }
    }

    /// Eliminates the first nodes by a partial Cholesky factorization, which condenses the matrix onto the others.
    ///
    /// # Errors
    /// If one of the first nodes can move without a force.
    pub fn eliminate(&mut self) -> Result<(), MeshError> {
        let (size, end) = (self.size(), self.eliminated * self.dofs);
        let least: Vec<f64> = (0..end).map(|i| MIN_PIVOT * self.at(i, i)).collect();
        let mut panel = vec![0.0; PANEL * size];
        for start in (0..end).step_by(PANEL) {
            let width = PANEL.min(end - start);
            self.factor_panel(start, width, &least, &mut panel)?;
            self.update_rest(start + width, width, &panel);
        }
        Ok(())
    }

    /// Factors the columns `start .. start + width` and copies them to `panel`, column by column; `least` are the
    /// smallest pivots.
    fn factor_panel(
        &mut self,
        start: usize,
        width: usize,
        least: &[f64],
        panel: &mut [f64],
    ) -> Result<(), MeshError> {
        let size = self.size();
        for i in start..size {
            for q in 0..width {
                panel[q * size + i] = self.values[i * size + start + q];
            }
        }
        for q in 0..width {
            let (column, later) = panel[q * size..].split_at_mut(size);
            let pivot = column[start + q];
            if pivot.is_nan() || pivot <= least[start + q] {
                return Err(MeshError::Disconnected);
            }
            let scale = 1.0 / pivot.sqrt();
            column[start + q..].iter_mut().for_each(|value| *value *= scale);
            for (r, other) in later.chunks_exact_mut(size).take(width - q - 1).enumerate() {
                let from = start + q + 1 + r;
                let factor = column[from];
                for (to, by) in other[from..].iter_mut().zip(&column[from..]) {
                    *to -= factor * by;
                }
            }
        }
        for i in start..size {
            for q in 0..width.min(i - start + 1) {
                self.values[i * size + start + q] = panel[q * size + i];
            }
        }
        Ok(())
    }

    /// Subtracts the panel's outer product from the lower triangle of the rows from `start`.
    fn update_rest(&mut self, start: usize, width: usize, panel: &[f64]) {
        let size = self.size();
        for i in start..size {
            let row = &mut self.values[i * size + start..=i * size + i];
            let column = |q: usize| &panel[q * size + start..=q * size + i];
            if width == PANEL {
                let factor: [f64; PANEL] = std::array::from_fn(|q| panel[q * size + i]);
                let columns: [&[f64]; PANEL] = std::array::from_fn(|q| &column(q)[..row.len()]);
                for (k, to) in row.iter_mut().enumerate() {
                    let mut sum = 0.0;
                    for q in 0..PANEL {
                        sum += factor[q] * columns[q][k];
                    }
                    *to -= sum;
                }
            } else {
                for q in 0..width {
                    let factor = panel[q * size + i];
                    row.iter_mut().zip(column(q)).for_each(|(to, by)| *to -= factor * by);
                }
            }
        }
    }

    /// Returns the matrix condensed onto the remaining nodes (the Schur complement).
    pub fn rest(&self) -> Frontal {
        let mut rest = Frontal::new(self.nodes[self.eliminated..].to_vec(), 0, self.dofs);
        let (size, small) = (self.size(), rest.size());
        let skip = size - small;
        for i in 0..small {
            let from = (skip + i) * size + skip;
            rest.values[i * small..=i * small + i].copy_from_slice(&self.values[from..=from + i]);
        }
        rest
    }

    /// Computes the displacements of the eliminated nodes from those of the others, in place; the slice contains all
    /// nodes of the mesh, with `dofs` values each.
    pub fn substitute(&self, displacements: &mut [f64]) {
        let f = self.dofs;
        let place = |i: usize| self.nodes[i / f] as usize * f + i % f;
        let mut values: Vec<f64> = (0..self.size()).map(|i| displacements[place(i)]).collect();
        // Eliminated nodes carry no load: L^T u = 0, solved from the last row up.
        for i in (0..self.eliminated * f).rev() {
            let sum: f64 = (i + 1..self.size()).map(|k| self.at(k, i) * values[k]).sum();
            values[i] = -sum / self.at(i, i);
            displacements[place(i)] = values[i];
        }
    }
}
