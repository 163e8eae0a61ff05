//! Optimizers by name.

use super::cmaes::CmaEsOptimizer;
use super::gp::{DEFAULT_NOISE_FLOOR, GpOptimizer};
use super::lattice::lattice;
use super::sequence::Sequence;
use super::{Grid, Optimizer, SobolSequence};
use std::fmt;
use std::iter::empty;
use std::str::FromStr;

/// Kind of optimizer, with its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum OptimizerKind {
    /// `gp`: Gaussian process with log expected improvement.
    Gp,
    /// `cma-es`: CMA-ES with BIPOP restarts.
    CmaEs,
    /// `random`: uniform, without replacement.
    Random,
    /// `sobol`: scrambled Sobol sequence.
    Sobol,
    /// `grid`: coarse-to-fine full factorial.
    Grid,
}

/// Kinds with their names on the command line and their largest numbers of parameters, in the order of help texts.
/// With more parameters the model of `gp`, the covariance matrix of `cma-es` or the lattice of `grid` could exhaust the
/// memory or take minutes.
const KINDS: [(OptimizerKind, &str, usize); 5] = [
    (OptimizerKind::Gp, "gp", 100),
    (OptimizerKind::CmaEs, "cma-es", 200),
    (OptimizerKind::Random, "random", 10_000),
    (OptimizerKind::Sobol, "sobol", 10_000),
    (OptimizerKind::Grid, "grid", 10_000),
];

impl OptimizerKind {
    /// Returns all kinds, in the order in which help texts list them.
    pub fn all() -> impl Iterator<Item = Self> {
        KINDS.into_iter().map(|(kind, ..)| kind)
    }

    /// Returns the name on the command line.
    pub fn name(self) -> &'static str {
        KINDS[self as usize].1
    }

    /// Returns the largest accepted number of parameters.
    pub fn max_parameters(self) -> usize {
        KINDS[self as usize].2
    }

    /// Returns whether the optimizer can search for a Pareto front of several objectives: it models each of
    /// them, or its points do not depend on values.
    pub fn takes_several_objectives(self) -> bool {
        self != Self::CmaEs
    }
}

impl fmt::Display for OptimizerKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for OptimizerKind {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::all().find(|kind| kind.name() == name).ok_or_else(|| {
            let valid = KINDS.map(|(_, name, _)| name).join(", ");
            format!("unknown optimizer '{name}'; valid names are {valid}")
        })
    }
}

/// Returns the optimizer of this kind over `grid`, with its default settings.
pub fn build(kind: OptimizerKind, grid: Grid, seed: u64) -> Box<dyn Optimizer + Send> {
    build_for(kind, grid, seed, &[DEFAULT_NOISE_FLOOR])
}

/// Returns the optimizer of this kind over `grid`; `noise_floors` are the smallest standard deviations of the noise
/// of each objective (for example from rounding), in its unit.
pub fn build_for(
    kind: OptimizerKind,
    grid: Grid,
    seed: u64,
    noise_floors: &[f64],
) -> Box<dyn Optimizer + Send> {
    match kind {
        OptimizerKind::Gp => Box::new(GpOptimizer::new(grid, seed, noise_floors)),
        OptimizerKind::CmaEs => Box::new(CmaEsOptimizer::new(grid, seed)),
        OptimizerKind::Random => Box::new(Sequence::new(grid, seed, empty())),
        OptimizerKind::Sobol => {
            let cube = SobolSequence::new(grid.dimension(), seed, 0, "sobol scramble");
            let cells = grid.clone();
            Box::new(Sequence::new(grid, seed, cube.map(move |unit| cells.cell(&unit))))
        }
        OptimizerKind::Grid => Box::new(Sequence::new(grid.clone(), 0, lattice(grid))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip_and_a_wrong_one_lists_the_right_ones() {
        for (i, kind) in OptimizerKind::all().enumerate() {
            assert_eq!((kind.to_string().parse(), kind as usize), (Ok(kind), i));
        }
        let error = "bayes".parse::<OptimizerKind>().unwrap_err();
        assert_eq!(
            error,
            "unknown optimizer 'bayes'; valid names are gp, cma-es, random, sobol, grid"
        );
    }
}
