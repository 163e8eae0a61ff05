//! Values in units of their own scatter.

/// Shift and scale that bring values to mean 0 and standard deviation 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Standard {
    /// Mean of the values.
    pub mean: f64,
    /// Their standard deviation; 1 of values that are all alike.
    pub sd: f64,
}

impl Standard {
    /// Of these values, their variance the sum of squares over as many less `lost`.
    pub fn of(values: &[f64], lost: usize) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        let variance = squares / (n - lost as f64);
        Standard { mean, sd: if variance > 0.0 { variance.sqrt() } else { 1.0 } }
    }

    /// A value in standard deviations about the mean.
    pub fn apply(self, value: f64) -> f64 {
        (value - self.mean) / self.sd
    }
}
