//! Elementary effects: what one input alone changes, at random places of the cube.
//!
//! Morris, Technometrics 33 (1991) 161, doi:10.1080/00401706.1991.10484804; the mean of the sizes, mu*, by
//! Campolongo, Cariboni and Saltelli, Environ. Model. Softw. 22 (2007) 1509,
//! doi:10.1016/j.envsoft.2006.10.004.

use super::{Interval, bootstrap};
use crate::stream::stream;
use rand::RngExt;
use rand::seq::SliceRandom;

/// Levels of the grid, Morris' p.
const LEVELS: u32 = 4;
/// Step of an effect, p / (2 (p - 1)): every level is then reached equally often.
const STEP: f64 = LEVELS as f64 / (2.0 * (LEVELS as f64 - 1.0));

/// The effect of one input over its whole range, in the unit of the values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effect {
    /// Mean of the effects, mu: its sign says which way.
    pub mean: f64,
    /// Mean of their sizes, mu*: how much the input matters.
    pub size: Interval,
    /// Their standard deviation, sigma: large beside mu*, the effect depends on the other inputs
    /// or is curved.
    pub sd: f64,
}

/// Walks through the cube on each of which every input is moved once.
#[derive(Debug, Clone)]
pub struct Screening {
    dimension: usize,
    seed: u64,
    walks: Vec<Walk>,
}

/// Where a walk begins, and its moves: which input, and up or down.
#[derive(Debug, Clone)]
struct Walk {
    start: Vec<f64>,
    moves: Vec<(usize, f64)>,
}

impl Screening {
    /// `walks` walks in a cube of `dimension` inputs, as the seed draws them.
    pub fn new(dimension: usize, walks: usize, seed: u64) -> Self {
        let walk = |number: usize| {
            let mut random = stream(seed, number as u64, "morris walk");
            let mut order: Vec<usize> = (0..dimension).collect();
            order.shuffle(&mut random);
            let mut start = Vec::with_capacity(dimension);
            let mut step = Vec::with_capacity(dimension);
            for _ in 0..dimension {
                let low = f64::from(random.random_range(0..LEVELS / 2)) / f64::from(LEVELS - 1);
                let up = random.random::<bool>();
                start.push(if up { low } else { low + STEP });
                step.push(if up { STEP } else { -STEP });
            }
            let moves = order.into_iter().map(|input| (input, step[input])).collect();
            Walk { start, moves }
        };
        Screening { dimension, seed, walks: (0..walks).map(walk).collect() }
    }

    /// The points to evaluate: `walks * (dimension + 1)`, coordinates in 0 .. 1.
    pub fn points(&self) -> Vec<Vec<f64>> {
        let mut points = Vec::with_capacity(self.walks.len() * (self.dimension + 1));
        for walk in &self.walks {
            let mut at = walk.start.clone();
            points.push(at.clone());
            for &(input, step) in &walk.moves {
                at[input] += step;
                points.push(at.clone());
            }
        }
        points
    }

    /// The effect of each input, from the values at [`Screening::points`], in their order.
    pub fn effects(&self, values: &[f64]) -> Vec<Effect> {
        let mut found = vec![Vec::with_capacity(self.walks.len()); self.dimension];
        for (walk, values) in self.walks.iter().zip(values.chunks(self.dimension + 1)) {
            for (&(input, step), pair) in walk.moves.iter().zip(values.windows(2)) {
                found[input].push((pair[1] - pair[0]) / step);
            }
        }
        found.iter().enumerate().map(|(input, found)| self.effect(input, found)).collect()
    }

    fn effect(&self, input: usize, found: &[f64]) -> Effect {
        let count = found.len() as f64;
        let mean = found.iter().sum::<f64>() / count;
        let squares: f64 = found.iter().map(|effect| (effect - mean).powi(2)).sum();
        let size = |rows: &[usize]| rows.iter().map(|&row| found[row].abs()).sum::<f64>() / count;
        let seed = self.seed.wrapping_add(input as u64);
        let sd = (squares / (count - 1.0).max(1.0)).sqrt();
        Effect { mean, size: bootstrap(found.len(), seed, size), sd }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn screen(dimension: usize, walks: usize, f: impl Fn(&[f64]) -> f64) -> Vec<Effect> {
        let screening = Screening::new(dimension, walks, 3);
        let values: Vec<f64> = screening.points().iter().map(|at| f(at)).collect();
        screening.effects(&values)
    }

    #[test]
    fn points_stay_in_the_cube_and_one_input_moves_at_a_time() {
        let points = Screening::new(5, 20, 1).points();
        assert_eq!(points.len(), 120);
        assert!(points.iter().flatten().all(|u| (-1e-12..=1.0 + 1e-12).contains(u)));
        for walk in points.chunks(6) {
            for pair in walk.windows(2) {
                let moved = pair[0].iter().zip(&pair[1]).filter(|(a, b)| a != b).count();
                assert_eq!(moved, 1);
            }
        }
    }

    #[test]
    fn a_plane_has_its_slopes_and_no_spread() {
        let effects = screen(3, 10, |u| 2.0 * u[0] - 5.0 * u[1] + 1.0);
        for (effect, slope) in effects.iter().zip([2.0, -5.0, 0.0]) {
            assert!((effect.mean - slope).abs() < 1e-12 && effect.sd < 1e-12);
            assert!((effect.size.high - slope.abs()).abs() < 1e-12);
        }
    }

    #[test]
    fn inputs_that_act_together_show_by_their_spread() {
        let effects = screen(3, 200, |u| u[0] * u[1] + u[2]);
        // d/du0 = u1 on the levels 0, 1/3, 2/3, 1: mean 1/2, standard deviation sqrt(5)/6.
        assert!((effects[0].mean - 0.5).abs() < 0.06, "{effects:?}");
        assert!((effects[0].sd - 5_f64.sqrt() / 6.0).abs() < 0.03, "{effects:?}");
        assert!(effects[2].sd < 1e-12);
        assert!(effects[0].size.low < 0.5 && 0.5 < effects[0].size.high);
    }
}
