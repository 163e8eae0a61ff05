//! Normal and chi-squared numbers with the same bits on every system: those of `rand_distr` 0.6, which takes
//! logarithm and exponential from the system.

use libm::{exp, log, sqrt};
use rand::distr::{Distribution, Open01};
use rand::{Rng, RngExt};
use std::sync::LazyLock;

/// Where the tail begins.
const TAIL: f64 = 3.654_152_885_361_009;
/// Area of a layer under the density without its factor.
const AREA: f64 = 0.004_928_673_233_99;
/// Where the edge of a layer in the table of `rand_distr` differs from what follows from the one before, and by
/// how many last places: drawn numbers stay what they were.
#[rustfmt::skip]
const LAST_PLACES: [(usize, i8); 19] = [
    (54, 1), (81, 1), (85, 1), (86, -1), (87, -1), (102, 1), (127, 1), (137, -1), (145, 1),
    (146, 1), (149, 1), (175, -1), (186, -1), (204, 1), (206, -1), (224, -2), (225, 1), (226, 1), (234, 1),
];

/// Edges of the layers from the lowest up; the lowest, which holds the tail, is as wide as its area asks.
static EDGES: LazyLock<[f64; 257]> = LazyLock::new(|| {
    let mut edges = [0.0; 257];
    edges[0] = AREA / density(TAIL);
    edges[1] = TAIL;
    for i in 2..256 {
        let edge = sqrt(-2.0 * log(AREA / edges[i - 1] + density(edges[i - 1])));
        let places = LAST_PLACES.iter().find(|(at, _)| *at == i).map_or(0, |(_, places)| *places);
        edges[i] = f64::from_bits(edge.to_bits().wrapping_add_signed(places.into()));
    }
    edges
});

fn density(x: f64) -> f64 {
    exp(-x * x / 2.0)
}

/// The standard normal distribution: the ziggurat of Doornik (2005).
#[derive(Debug, Clone, Copy)]
pub struct StandardNormal;

impl Distribution<f64> for StandardNormal {
    fn sample<R: Rng + ?Sized>(&self, random: &mut R) -> f64 {
        loop {
            let bits = random.next_u64();
            let layer = (bits & 0xff) as usize;
            // From -1 to 1, by the 52 bits of a fraction with the exponent of 2 to 4.
            let share = f64::from_bits(bits >> 12 | 2f64.to_bits()) - 3.0;
            let [outer, inner] = [EDGES[layer], EDGES[layer + 1]];
            let x = share * outer;
            if x.abs() < inner {
                return x;
            }
            if layer == 0 {
                return tail(random).copysign(share);
            }
            let [low, high] = [density(outer), density(inner)];
            if high + (low - high) * random.random::<f64>() < density(x) {
                return x;
            }
        }
    }
}

/// A number beyond [`TAIL`] (Marsaglia 1964).
fn tail<R: Rng + ?Sized>(random: &mut R) -> f64 {
    loop {
        let [beyond, bound] = std::array::from_fn(|_| -log(random.sample(Open01)));
        let beyond: f64 = beyond / TAIL;
        if 2.0 * bound >= beyond * beyond {
            return TAIL + beyond;
        }
    }
}

/// A number of the chi-squared distribution of so many degrees of freedom, above 2 (Marsaglia and Tsang 2000); fewer
/// count as 2.
pub fn chi_squared<R: Rng + ?Sized>(freedom: f64, random: &mut R) -> f64 {
    let shape = (0.5 * freedom).max(1.0) - 1.0 / 3.0;
    loop {
        let x: f64 = random.sample(StandardNormal);
        let root = 1.0 + 1.0 / sqrt(9.0 * shape) * x;
        if root <= 0.0 {
            continue;
        }
        let cube = root * root * root;
        let share: f64 = random.sample(Open01);
        let square = x * x;
        if share < 1.0 - 0.0331 * square * square
            || log(share) < 0.5 * square + shape * (1.0 - cube + log(cube))
        {
            return cube * shape * 2.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::stream;

    #[test]
    fn drawn_numbers_are_those_of_rand_distr() {
        let [mut ours, mut theirs] = [0, 1].map(|_| stream(0, 0, "normal"));
        for _ in 0..1_000_000 {
            let [x, y]: [f64; 2] =
                [ours.sample(StandardNormal), theirs.sample(rand_distr::StandardNormal)];
            let close = x.abs() > TAIL && (x / y - 1.0).abs() < 1e-15;
            assert!(x.to_bits() == y.to_bits() || close, "{x} for {y}");
        }
        let chi = rand_distr::ChiSquared::new(5.0).unwrap();
        for _ in 0..100_000 {
            let [x, y]: [f64; 2] = [chi_squared(5.0, &mut ours), theirs.sample(chi)];
            assert!((x / y - 1.0).abs() < 1e-15, "{x} for {y}");
        }
    }
}
