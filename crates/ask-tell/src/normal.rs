//! Normal and chi-squared random numbers with the same bits on every system.
//!
//! `rand_distr` takes logarithm and exponential from the system, whose last bits differ. Rounding to a
//! grid much coarser than those bits removes the differences, except with the probability derived here.
//!
//! - 98.8 % of normal numbers are products of a table and random bits: no function is involved.
//! - In the wedges of the ziggurat the exponential decides between acceptance and rejection. An error in its
//!   last bit changes the decision with a probability of at most 2^-53 over the height of a layer, below 1e-13.
//! - A number beyond 3.654 is 3.654 plus a logarithm, whose last bit moves the sum by at most one unit in
//!   the last place: 2^-51 up to 4 and 2^-50 beyond. The rounded number changes if one of the rounding
//!   boundaries, which are 2^-32 apart, lies between the two sums: with a probability of 2^-19 and 2^-18. Of
//!   all numbers, 2.58e-4 lie beyond 3.654, and 6.3e-5 beyond 4. Together: 1.95e-4 * 2^-19 + 6.3e-5 * 2^-18 = 6.1e-10.
//!
//! So systems whose functions always differ in the last bit would differ in one of 1.6e9 normal numbers.

use rand::Rng;
use rand::distr::Distribution;

/// Grid steps per unit for normal numbers.
const NORMAL_GRID: f64 = (1u64 << 32) as f64;
/// Grid steps per unit for chi-squared numbers, which multiply the error of the underlying normal number.
const CHI_SQUARED_GRID: f64 = (1u32 << 24) as f64;

/// Standard normal distribution, rounded to multiples of 2^-32.
#[derive(Debug, Clone, Copy)]
pub struct StandardNormal;

impl Distribution<f64> for StandardNormal {
    fn sample<R: Rng + ?Sized>(&self, random: &mut R) -> f64 {
        let x: f64 = rand_distr::StandardNormal.sample(random);
        (x * NORMAL_GRID).round() / NORMAL_GRID
    }
}

/// Draws a number from the chi-squared distribution, rounded to a multiple of 2^-24; NaN unless `freedom`
/// is above 0.
pub fn chi_squared<R: Rng + ?Sized>(freedom: f64, random: &mut R) -> f64 {
    let draw = |distribution: rand_distr::ChiSquared<f64>| distribution.sample(random);
    let x = rand_distr::ChiSquared::new(freedom).map_or(f64::NAN, draw);
    (x * CHI_SQUARED_GRID).round() / CHI_SQUARED_GRID
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::Moments;
    use crate::stream::stream;
    use rand::RngExt;

    #[test]
    fn numbers_are_on_the_grid_and_have_the_moments_of_their_distributions() {
        let mut random = stream(0, 0, "normal");
        let mut draws: Vec<f64> = (0..1_000_000).map(|_| random.sample(StandardNormal)).collect();
        assert!(draws.iter().all(|x| (x * NORMAL_GRID).fract() == 0.0));
        let moments = Moments::of(&draws);
        assert!(moments.mean.abs() < 4e-3 && (moments.variance() - 1.0).abs() < 6e-3);
        // Beyond 3.654 lie 258 of a million.
        let tail = draws.iter().filter(|x| x.abs() > 3.654_152_885_361_009).count();
        assert!((190..330).contains(&tail), "{tail}");
        draws = (0..100_000).map(|_| chi_squared(5.0, &mut random)).collect();
        assert!(draws.iter().all(|x| (x * CHI_SQUARED_GRID).fract() == 0.0));
        let moments = Moments::of(&draws);
        assert!((moments.mean - 5.0).abs() < 0.04 && (moments.variance() - 10.0).abs() < 0.3);
    }

    #[test]
    fn the_first_numbers_are_the_same_on_every_system() {
        let mut random = stream(0, 0, "normal");
        let first: [f64; 3] = std::array::from_fn(|_| random.sample(StandardNormal));
        assert_eq!(
            first.map(|x| (x * NORMAL_GRID) as i64),
            [-262_496_455, 9_802_235_450, -4_882_312_205]
        );
    }
}
