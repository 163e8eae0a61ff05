//! Owen-scrambled Sobol points.

use crate::stream::stream;
use rand::Rng;

/// Number of points in a sequence of `sobol_burley`.
const SEQUENCE_LENGTH: u32 = 1 << 16;
/// Axes that share one scramble; `sobol_burley` has 256 dimensions, further axes use another scramble.
const AXES_PER_SCRAMBLE: usize = 256;

/// An Owen-scrambled Sobol sequence (Burley 2020, JCGT 9(4)) of up to 65536 points.
#[derive(Debug, Clone)]
pub struct SobolSequence {
    scrambles: Vec<u32>,
    dimension: usize,
    next: u32,
}

impl SobolSequence {
    /// Creates the sequence of `dimension` axes named by `(seed, counter, purpose)`.
    pub fn new(dimension: usize, seed: u64, counter: u64, purpose: &str) -> Self {
        let mut random = stream(seed, counter, purpose);
        let scrambles =
            (0..dimension.div_ceil(AXES_PER_SCRAMBLE)).map(|_| random.next_u32()).collect();
        SobolSequence { scrambles, dimension, next: 0 }
    }
}

impl Iterator for SobolSequence {
    /// A point of the unit cube, each coordinate in [0, 1).
    type Item = Vec<f64>;

    fn next(&mut self) -> Option<Vec<f64>> {
        if self.next >= SEQUENCE_LENGTH {
            return None;
        }
        let index = self.next;
        self.next += 1;
        let coordinate = |axis: usize| {
            let scramble = self.scrambles[axis / AXES_PER_SCRAMBLE];
            f64::from(sobol_burley::sample(index, (axis % AXES_PER_SCRAMBLE) as u32, scramble))
        };
        Some((0..self.dimension).map(coordinate).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Grid, OptimizerKind, build};

    #[test]
    fn the_first_sixteen_points_fall_in_sixteen_cells() {
        for seed in 0..5 {
            let mut cells: Vec<_> = SobolSequence::new(2, seed, 0, "test")
                .take(16)
                .map(|u| ((u[0] * 4.0) as u32, (u[1] * 4.0) as u32))
                .collect();
            cells.sort_unstable();
            cells.dedup();
            assert_eq!(cells.len(), 16, "seed {seed}");
        }
    }

    #[test]
    fn more_axes_than_one_scramble_has() {
        let unit = SobolSequence::new(600, 1, 0, "test").next().unwrap();
        assert_eq!(unit.len(), 600);
        assert!(unit[0] != unit[256] && unit.iter().all(|u| (0.0..1.0).contains(u)));
    }

    #[test]
    fn the_sequence_ends_and_the_search_does_not() {
        assert_eq!(SobolSequence::new(1, 1, 0, "test").count(), 1 << 16);
        let mut search = build(OptimizerKind::Sobol, Grid::new(vec![70_000]), 1);
        assert_eq!(search.ask(70_000).len(), 70_000);
        assert_eq!(search.ask(1), vec![]);
    }
}
