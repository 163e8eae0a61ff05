//! The hyperparameters of the Matern 5/2 kernel with a length scale per axis.

/// Hyperparameters, as natural logarithms; outputs are standardised, inputs in the unit cube.
#[derive(Debug, Clone, PartialEq)]
pub struct Hyperparameters {
    /// Length scale of each axis, in cube edges.
    pub log_length: Vec<f64>,
    /// Signal variance.
    pub log_signal: f64,
    /// Noise variance above the floor.
    pub log_noise: f64,
}

impl Hyperparameters {
    /// Returns all as one vector: length scales, signal, noise.
    pub(super) fn to_vec(&self) -> Vec<f64> {
        let mut theta = self.log_length.clone();
        theta.extend([self.log_signal, self.log_noise]);
        theta
    }

    /// Converts such a vector back; it has at least two numbers.
    pub(super) fn from_slice(theta: &[f64]) -> Self {
        let d = theta.len() - 2;
        let log_length = theta[..d].to_vec();
        Hyperparameters { log_length, log_signal: theta[d], log_noise: theta[d + 1] }
    }

    /// Returns `x` in units of the length scales.
    pub(super) fn scale(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.log_length).map(|(x, l)| x * libm::exp(-l)).collect()
    }
}
