//! Matern 5/2 correlation (Rasmussen and Williams 2006, equation 4.17).

/// Returns `(1 + s + s^2 / 3) exp(-s)` with `s = sqrt(5) r`, from the squared scaled distance `r^2`.
#[inline]
pub fn matern52(r2: f64) -> f64 {
    let s = (5.0 * r2).sqrt();
    (1.0 + s + s * s / 3.0) * exp_minus(s)
}

/// Returns `-d matern52 / d(r^2)`, which is `5/6 (1 + s) exp(-s)` and has no singularity at 0.
#[inline]
pub fn matern52_slope(r2: f64) -> f64 {
    let s = (5.0 * r2).sqrt();
    5.0 / 6.0 * (1.0 + s) * exp_minus(s)
}

/// Returns the squared distance between two scaled points.
#[inline]
pub fn distance2(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}

/// Returns `exp(-s)` for `s >= 0`, accurate to a few parts in 1e16. Branch-free, so that loops over it
/// vectorise, and made of additions and products only, so that results are identical on every
/// machine.
#[inline]
fn exp_minus(s: f64) -> f64 {
    /// Adding and then subtracting this constant rounds to the nearest integer.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    const LN2_HIGH: f64 = 6.931_471_803_691_238e-1;
    const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    let x = -s.min(700.0);
    let shifted = x * std::f64::consts::LOG2_E + ROUND;
    let k = shifted - ROUND;
    let r = (x - k * LN2_HIGH) - k * LN2_LOW;
    // Taylor series; the first omitted term is below 4e-18 for |r| <= ln(2) / 2.
    let mut sum = 1.0 / 6_227_020_800.0;
    for reciprocal in [
        1.0 / 479_001_600.0,
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ] {
        sum = sum * r + reciprocal;
    }
    // Multiplies by 2^k: the low bits of `shifted` are k, and the shift moves them into the exponent. A
    // float-to-integer conversion would prevent vectorisation.
    sum * f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_agrees_with_the_library() {
        for k in 0..70_000 {
            let s = f64::from(k) * 0.01;
            let (ours, theirs) = (exp_minus(s), libm::exp(-s));
            assert!((ours / theirs - 1.0).abs() < 1e-15, "{s}: {ours} {theirs}");
        }
        assert!(exp_minus(1e9) >= 0.0 && exp_minus(1e9) < 1e-300);
    }

    #[test]
    fn known_values_and_the_slope() {
        assert_eq!(matern52(0.0), 1.0);
        // r = 1: (1 + sqrt 5 + 5/3) exp(-sqrt 5) = 0.523994108831820...
        assert!((matern52(1.0) - 0.523_994_108_831_82).abs() < 1e-13, "{}", matern52(1.0));
        for r2 in [0.01, 0.5, 3.0, 20.0] {
            let h = 1e-6 * r2;
            let difference = (matern52(r2 - h) - matern52(r2 + h)) / (2.0 * h);
            assert!((matern52_slope(r2) / difference - 1.0).abs() < 1e-7);
        }
    }
}
