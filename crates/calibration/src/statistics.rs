//! Means and rank correlations.

/// Mean; `None` without values.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Spearman's rank correlation of pairs: Pearson's, of ranks of which equals
/// share the mean. `None` below 3 pairs or if one side does not vary.
pub fn spearman(pairs: &[(f64, f64)]) -> Option<f64> {
    let first = ranks(&pairs.iter().map(|p| p.0).collect::<Vec<_>>());
    let second = ranks(&pairs.iter().map(|p| p.1).collect::<Vec<_>>());
    let middle = (pairs.len() as f64 - 1.0) / 2.0;
    let sum = |a: &[f64], b: &[f64]| -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - middle) * (b - middle)).sum()
    };
    let scale = (sum(&first, &first) * sum(&second, &second)).sqrt();
    (pairs.len() >= 3 && scale > 0.0).then(|| sum(&first, &second) / scale)
}

/// Ranks from 0; equals share the mean of their ranks.
fn ranks(values: &[f64]) -> Vec<f64> {
    let rank = |v: &f64| {
        let below = values.iter().filter(|other| *other < v).count() as f64;
        let equal = values.iter().filter(|other| *other == v).count() as f64;
        below + (equal - 1.0) / 2.0
    };
    values.iter().map(rank).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rank_correlations_by_hand() {
        // Ranks 0 1 2 3 against 1 0 3 2: 1 - 6 * 4 / (4 * 15) = 0.6.
        let close = |found: Option<f64>, r: f64| (found.unwrap() - r).abs() < 1e-12;
        assert!(close(spearman(&[(1.0, 20.0), (2.0, 10.0), (3.0, 40.0), (9.0, 30.0)]), 0.6));
        // Centred ranks -1 0 1 against 0.5 0.5 -1: -1.5 / sqrt(2 * 1.5).
        assert!(close(spearman(&[(1.0, 5.0), (2.0, 5.0), (3.0, 4.0)]), -0.75f64.sqrt()));
        assert_eq!(spearman(&[(1.0, 1.0), (2.0, 1.0), (3.0, 1.0)]), None);
        assert_eq!(spearman(&[(1.0, 1.0), (2.0, 2.0)]), None);
    }
}
