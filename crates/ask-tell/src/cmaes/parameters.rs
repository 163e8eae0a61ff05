//! Strategy parameters: table 1 and equations (49) to (58) of Hansen's tutorial (see `cmaes`).

use libm::{log, sqrt};

/// Strategy parameters of a run, in the tutorial's notation.
#[derive(Debug)]
pub(super) struct Parameters {
    /// Number of parents: the candidates with positive weight.
    pub mu: usize,
    /// `w_1 .. w_lambda`; the positive ones sum to one.
    pub weights: Vec<f64>,
    pub mu_eff: f64,
    pub c_sigma: f64,
    pub d_sigma: f64,
    pub c_c: f64,
    pub c_1: f64,
    pub c_mu: f64,
    /// Expected length of a standard normal vector, E||N(0, I)||.
    pub chi_n: f64,
}

/// Returns the default population size, `4 + floor(3 ln n)` (48).
pub(super) fn default_lambda(n: usize) -> usize {
    4 + (3.0 * log(n.max(1) as f64)) as usize
}

impl Parameters {
    /// Returns the defaults for dimension `n` and population size `lambda` (at least 2); the worse
    /// half of the candidates has negative weights (53).
    pub fn new(n: usize, lambda: usize) -> Self {
        let (lambda, dim) = (lambda.max(2), n.max(1) as f64);
        let raw: Vec<f64> =
            (1..=lambda).map(|i| log((lambda as f64 + 1.0) / 2.0) - log(i as f64)).collect();
        let mu = lambda / 2;
        let (positive, negative) = (&raw[..mu], &raw[mu..]);
        let (mu_eff, mu_eff_minus) = (effective_mass(positive), effective_mass(negative));

        let c_sigma = (mu_eff + 2.0) / (dim + mu_eff + 5.0);
        let d_sigma = 1.0 + 2.0 * (sqrt((mu_eff - 1.0) / (dim + 1.0)) - 1.0).max(0.0) + c_sigma;
        let c_c = (4.0 + mu_eff / dim) / (dim + 4.0 + 2.0 * mu_eff / dim);
        let c_1 = 2.0 / ((dim + 1.3) * (dim + 1.3) + mu_eff);
        let c_mu = (2.0 * (0.25 + mu_eff + 1.0 / mu_eff - 2.0)
            / ((dim + 2.0) * (dim + 2.0) + mu_eff))
            .clamp(0.0, 1.0 - c_1);

        let sum_positive: f64 = positive.iter().sum();
        let sum_negative: f64 = -negative.iter().sum::<f64>();
        let scale = if c_mu > 0.0 && sum_negative > 0.0 {
            let alpha_mu = 1.0 + c_1 / c_mu;
            let alpha_mu_eff = 1.0 + 2.0 * mu_eff_minus / (mu_eff + 2.0);
            let alpha_pos_def = (1.0 - c_1 - c_mu) / (dim * c_mu);
            alpha_mu.min(alpha_mu_eff).min(alpha_pos_def) / sum_negative
        } else {
            0.0
        };
        let weights = raw
            .iter()
            .enumerate()
            .map(|(i, w)| if i < mu { w / sum_positive } else { w * scale })
            .collect();
        let chi_n = sqrt(dim) * (1.0 - 1.0 / (4.0 * dim) + 1.0 / (21.0 * dim * dim));
        Parameters { mu, weights, mu_eff, c_sigma, d_sigma, c_c, c_1, c_mu, chi_n }
    }
}

/// Returns the variance-effective selection mass `(sum w)^2 / sum w^2`; zero without weights.
fn effective_mass(weights: &[f64]) -> f64 {
    let (sum, squares) = weights.iter().fold((0.0, 0.0), |(s, q), w| (s + w, q + w * w));
    if squares > 0.0 { sum * sum / squares } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12 * b.abs().max(1.0)
    }

    #[test]
    fn constants_for_ten_dimensions_worked_by_hand() {
        // lambda = 10, mu = 5: w' = ln 5.5 - ln i.
        let p = Parameters::new(10, default_lambda(10));
        assert_eq!((p.weights.len(), p.mu), (10, 5));
        let raw: Vec<f64> = (1..=5).map(|i| libm::log(5.5) - libm::log(f64::from(i))).collect();
        let sum: f64 = raw.iter().sum();
        let mu_eff = sum * sum / raw.iter().map(|w| w * w).sum::<f64>();
        assert!(close(p.mu_eff, mu_eff) && (mu_eff - 3.167_299).abs() < 1e-5, "{mu_eff}");
        assert!(close(p.weights[..5].iter().sum::<f64>(), 1.0));
        assert!(close(p.c_sigma, (mu_eff + 2.0) / (15.0 + mu_eff)));
        assert!(close(p.d_sigma, 1.0 + p.c_sigma));
        assert!(close(p.c_c, (4.0 + mu_eff / 10.0) / (14.0 + mu_eff / 5.0)));
        assert!(close(p.c_1, 2.0 / (11.3 * 11.3 + mu_eff)));
        assert!(close(p.c_mu, 2.0 * (mu_eff - 1.75 + 1.0 / mu_eff) / (144.0 + mu_eff)));
        assert!((p.chi_n - 3.084_727).abs() < 1e-3, "{}", p.chi_n);
    }

    #[test]
    fn negative_weights_obey_the_three_bounds() {
        for n in [1, 2, 5, 20] {
            for lambda in [4, 6, 8, 30, 200] {
                let p = Parameters::new(n, lambda);
                let sum: f64 = -p.weights.iter().filter(|w| **w < 0.0).sum::<f64>();
                assert!(sum <= 1.0 + p.c_1 / p.c_mu + 1e-12);
                assert!(sum * n as f64 * p.c_mu <= 1.0 - p.c_1 - p.c_mu + 1e-12);
            }
        }
    }

    #[test]
    fn tiny_populations_have_usable_constants() {
        for lambda in 0..5 {
            let p = Parameters::new(1, lambda);
            assert!(p.weights.len() >= 2 && p.weights.iter().all(|w| w.is_finite()));
            assert!(p.c_mu >= 0.0 && p.c_1 + p.c_mu <= 1.0);
        }
    }
}
