//! Stand-ins until the optimizers, the stiffness surrogate and the task and
//! robot files are merged. Only `setup.rs` and `stiffness.rs` use this module.

use finger_opt::optimizer::{Grid, Observation, Optimizer, StopReason};
use finger_opt::space::{DENSITY_KEY, DIRECTION_KEY, Design, GridPoint};
use finger_opt::stream::stream;
use finger_opt::surrogate::{Estimate, Prediction};
use finger_opt::units::N_PER_MM;
use rand::RngExt;
use serde::Deserialize;
use std::collections::HashSet;
use std::fmt;
use std::str::FromStr;

/// Stands in for `optimizer::OptimizerKind`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OptimizerKind(&'static str);

impl FromStr for OptimizerKind {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        const NAMES: [&str; 5] = ["gp", "cma-es", "random", "sobol", "grid"];
        match NAMES.into_iter().find(|known| *known == name) {
            Some(known) => Ok(OptimizerKind(known)),
            None => Err(format!("no optimizer is called `{name}`; there are {}", NAMES.join(", "))),
        }
    }
}

impl fmt::Display for OptimizerKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

/// Stands in for `optimizer::build`: always a random search.
pub fn build(_kind: OptimizerKind, grid: Grid, seed: u64) -> Box<dyn Optimizer + Send> {
    Box::new(Random { grid, seed, draws: 0, seen: HashSet::new(), best: None })
}

struct Random {
    grid: Grid,
    seed: u64,
    draws: u64,
    seen: HashSet<GridPoint>,
    /// Makes the proposals depend on what was told, as a real optimizer's do.
    best: Option<f64>,
}

impl Optimizer for Random {
    fn ask(&mut self, n: usize) -> Vec<GridPoint> {
        let mut points = Vec::new();
        while points.len() < n && self.stop().is_none() {
            self.draws += 1;
            let told = self.best.map_or(0, f64::to_bits);
            let mut random = stream(self.seed ^ told, self.draws, "placeholder");
            let levels = self.grid.levels().iter();
            let point = GridPoint(levels.map(|&n| random.random_range(0..n)).collect());
            if self.seen.insert(point.clone()) {
                points.push(point);
            }
        }
        points
    }

    fn tell(&mut self, observations: &[Observation]) {
        let values = observations.iter().filter_map(|observation| observation.value);
        self.best = values.chain(self.best).reduce(f64::max);
    }

    fn stop(&self) -> Option<StopReason> {
        (self.seen.len() as u64 == self.grid.size()).then_some(StopReason::GridExhausted)
    }
}

/// Stands in for the surrogate: a plane through the middle of the measured data.
pub fn predict(design: &Design) -> Prediction {
    let density = design.get(DENSITY_KEY).unwrap_or(20.0);
    let direction = design.get(DIRECTION_KEY).unwrap_or(20.0);
    let estimate =
        |n_per_mm: f64, sd: f64| Estimate { mean: n_per_mm * N_PER_MM, sd: sd * N_PER_MM };
    Prediction {
        compliance: estimate(0.3 + 0.09 * density + 0.02 * direction, 0.3),
        assembly: estimate(43.0 + density - direction, 2.0),
        hull_distance: 0.0,
    }
}

/// Stands in for a task or a robot: what `optimize tasks` shows of either.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Head {
    pub name: String,
    pub description: String,
}

impl Head {
    pub fn parse(text: &str, file: &str) -> Result<Self, String> {
        toml::from_str(text).map_err(|error| format!("{file}: {}", error.to_string().trim_end()))
    }
}
