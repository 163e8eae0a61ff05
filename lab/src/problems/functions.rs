//! Functions with known optima.

use clap::ValueEnum;
use std::f64::consts::PI;

/// Test function, to be minimised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Function {
    /// Sum of squares
    Sphere,
    /// Bent valley
    Rosenbrock,
    /// Squares with weights from 1 to 1e6
    Ellipsoid,
    /// Bowl with a lattice of local minima
    Rastrigin,
    /// Branin on the unit square: three equal minima
    Branin,
    /// Hartmann in six dimensions on the unit cube: one minimum and a second, nearly as deep
    Hartmann6,
}

impl Function {
    pub fn name(self) -> String {
        self.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned())
    }

    /// Value at `x`; the last two are functions on the unit cube of their own dimension.
    pub fn value(self, x: &[f64]) -> f64 {
        match self {
            Self::Sphere => x.iter().map(|v| v * v).sum(),
            Self::Rosenbrock => rosenbrock(x),
            Self::Ellipsoid => ellipsoid(x),
            Self::Rastrigin => {
                x.iter().map(|v| v * v + 10.0 - 10.0 * libm::cos(2.0 * PI * v)).sum()
            }
            Self::Branin => branin(x),
            Self::Hartmann6 => hartmann6(x),
        }
    }
}

fn rosenbrock(x: &[f64]) -> f64 {
    x.windows(2).map(|w| 100.0 * (w[1] - w[0] * w[0]).powi(2) + (1.0 - w[0]).powi(2)).sum()
}

fn ellipsoid(x: &[f64]) -> f64 {
    let last = (x.len() - 1) as f64;
    x.iter().enumerate().map(|(i, v)| libm::pow(1e6, i as f64 / last) * v * v).sum()
}

/// Minimum 0.397887.
fn branin(u: &[f64]) -> f64 {
    let (x, y) = (15.0 * u[0] - 5.0, 15.0 * u[1]);
    let a = y - 5.1 / (4.0 * PI * PI) * x * x + 5.0 / PI * x - 6.0;
    a * a + 10.0 * (1.0 - 1.0 / (8.0 * PI)) * libm::cos(x) + 10.0
}

/// Minimum -3.32237.
fn hartmann6(u: &[f64]) -> f64 {
    const ALPHA: [f64; 4] = [1.0, 1.2, 3.0, 3.2];
    const A: [[f64; 6]; 4] = [
        [10.0, 3.0, 17.0, 3.5, 1.7, 8.0],
        [0.05, 10.0, 17.0, 0.1, 8.0, 14.0],
        [3.0, 3.5, 1.7, 10.0, 17.0, 8.0],
        [17.0, 8.0, 0.05, 10.0, 0.1, 14.0],
    ];
    const P: [[f64; 6]; 4] = [
        [0.1312, 0.1696, 0.5569, 0.0124, 0.8283, 0.5886],
        [0.2329, 0.4135, 0.8307, 0.3736, 0.1004, 0.9991],
        [0.2348, 0.1451, 0.3522, 0.2883, 0.3047, 0.6650],
        [0.4047, 0.8828, 0.8732, 0.5743, 0.1091, 0.0381],
    ];
    let term = |i: usize| -> f64 {
        let e: f64 = (0..6).map(|j| A[i][j] * (u[j] - P[i][j]).powi(2)).sum();
        ALPHA[i] * libm::exp(-e)
    };
    -(0..4).map(term).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_known_minima_are_met_and_are_minima() {
        let minima: [(Function, &[f64], f64); 6] = [
            (Function::Sphere, &[0.0, 0.0], 0.0),
            (Function::Rosenbrock, &[1.0, 1.0, 1.0], 0.0),
            (Function::Ellipsoid, &[0.0, 0.0], 0.0),
            (Function::Rastrigin, &[0.0; 5], 0.0),
            (Function::Branin, &[(PI + 5.0) / 15.0, 2.275 / 15.0], 0.397_887),
            (
                Function::Hartmann6,
                &[0.20169, 0.150011, 0.476874, 0.275332, 0.311652, 0.6573],
                -3.322_37,
            ),
        ];
        for (function, at, minimum) in minima {
            let value = function.value(at);
            assert!((value - minimum).abs() < 1e-5, "{}: {value}", function.name());
            for axis in 0..at.len() {
                for step in [-0.01, 0.01] {
                    let mut beside = at.to_vec();
                    beside[axis] += step;
                    assert!(function.value(&beside) > value, "{}", function.name());
                }
            }
        }
    }
}
