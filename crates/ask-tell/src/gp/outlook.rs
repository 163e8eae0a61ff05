//! Stopping criterion of a search whose results are confirmed by a more costly evaluation.
//!
//! The search evaluates points approximately, so a value may drop when it is confirmed. One
//! Gaussian process models the values of the search, warped as in the optimizer; a second one over
//! the same axes models the drop, which is the searched minus the confirmed value and never
//! negative. A search is settled when no point, evaluated or not, is likely to beat the best
//! confirmed one by more than the least difference that matters.

use super::data::{Standardised, spread, standardise};
use super::fit::{FitEffort, fit};
use super::model::Gp;
use super::search::Room;
use crate::process::{Process, distance2, matern52};
use crate::proposed::Proposed;
use crate::statistics::{normal_log_cdf, normal_pdf};
use crate::{Grid, GridPoint, Observation};
use libm::{exp, sqrt};
use nalgebra::{DMatrix, DVector};

/// Length scale of the drops relative to the edge of the unit square; in other dimensions it scales
/// with the diagonal. It is fixed because fits to the few known drops were too long, so that one
/// large drop was extrapolated to the whole space (`docs/notes/optimizers.md`).
const DROP_LENGTH: f64 = 0.15;
/// Largest number of points to which hyperparameters are fitted.
const FITTED: usize = 200;
/// Grids up to this size are searched exhaustively, larger ones at a sample of candidates.
const EXHAUSTIVE: u64 = 20_000;
const CANDIDATES: usize = 6000;
/// Measured points around which candidates are drawn.
const INCUMBENTS: usize = 4;
/// Nodes (in standard deviations) and weights of the Gauss-Hermite rule of five points.
const NODES: [(f64, f64); 5] = [
    (-2.856_970_013_872_806, 0.011_257_411_327_720_69),
    (-1.355_626_179_974_266, 0.222_075_922_005_612_64),
    (0.0, 0.533_333_333_333_333_3),
    (1.355_626_179_974_266, 0.222_075_922_005_612_64),
    (2.856_970_013_872_806, 0.011_257_411_327_720_69),
];

/// Thresholds for a gain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// Least difference that matters, in the objective's unit.
    pub least: f64,
    /// Probability below which a gain is disregarded.
    pub probability: f64,
    /// Least standard deviation of the noise of the search, in the objective's unit.
    pub noise_floor: f64,
    /// Only values above this are worth confirming.
    pub floor: f64,
}

/// A point of the search that was confirmed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Confirmed {
    /// Its index among the observations of the search.
    pub at: usize,
    /// Its confirmed value.
    pub value: f64,
    /// Whether it cannot be confirmed any further.
    pub last: bool,
}

/// Recommended next step.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Advice {
    /// Confirm these points, or confirm them further; indices into the observations.
    Confirm(Vec<usize>),
    /// Continue the search: a point not yet evaluated may be better.
    Search,
    /// Stop: no point is expected to gain.
    Settled,
}

/// Models of the observations and of the confirmed points.
#[derive(Debug)]
pub struct Outlook<'a> {
    grid: &'a Grid,
    told: &'a [Observation],
    confirmed: &'a [Confirmed],
    gain: Gain,
    drop: Option<Drops>,
}

#[derive(Debug)]
struct Model {
    gp: Gp,
    data: Standardised,
}

/// Zero-mean process: no drop is expected far from the confirmed points.
#[derive(Debug)]
struct Drops {
    process: Process<0>,
    x: Vec<Vec<f64>>,
    length: f64,
    signal: f64,
}

fn kernel(a: &[f64], b: &[f64], length: f64) -> f64 {
    matern52(distance2(a, b) / (length * length))
}

impl Model {
    fn new(x: &[Vec<f64>], data: Standardised) -> Option<Self> {
        let some: Vec<usize> = spread(x.len(), FITTED).collect();
        let points: Vec<Vec<f64>> = some.iter().map(|&i| x[i].clone()).collect();
        let values: Vec<f64> = some.iter().map(|&i| data.values[i]).collect();
        let effort = FitEffort::for_observations(values.len());
        let theta = fit(&points, &values, data.noise_floor, None, effort);
        Some(Model { gp: Gp::new(x, &data.values, data.noise_floor, &theta)?, data })
    }
}

impl<'a> Outlook<'a> {
    /// Creates the models from the observations of a single-objective search and its confirmations.
    pub fn new(
        grid: &'a Grid,
        told: &'a [Observation],
        confirmed: &'a [Confirmed],
        gain: Gain,
    ) -> Self {
        let mut outlook = Outlook { grid, told, confirmed, gain, drop: None };
        outlook.drop = outlook.drops();
        outlook
    }

    /// Fits the model of the search; `None` if no observation has a value.
    fn searched(&self) -> Option<Model> {
        let x = |o: &Observation| self.grid.free_unit(&o.point);
        let values: Vec<Option<f64>> = self.told.iter().map(Observation::value).collect();
        let points: Vec<Vec<f64>> = self.told.iter().map(x).collect();
        Model::new(&points, standardise(&values, self.gain.noise_floor)?.warped())
    }

    /// Fits the model of the drops. Its prior standard deviation is their root mean square, but at
    /// least the difference that matters: a few small drops do not imply that all are small.
    fn drops(&self) -> Option<Drops> {
        let drop = |c: &Confirmed| Some((c.at, (self.told.get(c.at)?.value()? - c.value).max(0.0)));
        let known: Vec<(usize, f64)> = self.confirmed.iter().filter_map(drop).collect();
        let square = known.iter().map(|(_, drop)| drop * drop).sum::<f64>() / known.len() as f64;
        let signal = square.max(self.gain.least * self.gain.least);
        let x: Vec<Vec<f64>> =
            known.iter().map(|&(at, _)| self.grid.free_unit(&self.told[at].point)).collect();
        let length = DROP_LENGTH * sqrt(x.first()?.len() as f64 / 2.0);
        let covariance = |i: usize, j: usize| {
            let noise = if i == j { self.gain.noise_floor * self.gain.noise_floor } else { 0.0 };
            signal * kernel(&x[i], &x[j], length) + noise
        };
        let covariance = DMatrix::from_fn(x.len(), x.len(), covariance);
        let values: Vec<f64> = known.iter().map(|(_, drop)| *drop).collect();
        let process = Process::new(covariance, &vec![[]; x.len()], &values)?;
        Some(Drops { process, x, length, signal })
    }

    /// Mean and standard deviation of the drop at a point, before truncation at 0.
    fn drop_at(&self, x: &[f64]) -> (f64, f64) {
        self.drop.as_ref().map_or((0.0, 0.0), |drops| {
            let near = drops.x.iter().map(|other| drops.signal * kernel(other, x, drops.length));
            let near = DVector::from_iterator(drops.x.len(), near);
            let variance = drops.process.variance(&near, &[], drops.signal);
            (drops.process.mean(&near, &[]), sqrt(variance))
        })
    }

    /// Returns the best confirmed value.
    fn best(&self) -> Option<f64> {
        self.confirmed.iter().map(|confirmed| confirmed.value).reduce(f64::max)
    }

    /// Returns what to do next in a search without constraints. Ties are broken in favour of the
    /// lower `rank`; at most `at_once` points are returned.
    pub fn advise(&self, rank: &[usize], at_once: usize) -> Advice {
        let Some(best) = self.best() else {
            // Only once the search itself has settled: early leaders are soon overtaken.
            let leader = self.told.iter().filter_map(Observation::value).reduce(f64::max);
            return match leader {
                Some(leader) if !self.search_gains(leader) => {
                    self.confirm(f64::NEG_INFINITY, rank, 1)
                }
                _ => Advice::Search,
            };
        };
        match self.confirm(best, rank, at_once) {
            Advice::Settled if self.search_gains(best) => Advice::Search,
            advice => advice,
        }
    }

    /// Returns what to confirm next, considering only the points already evaluated.
    pub fn confirm_only(&self, rank: &[usize], at_once: usize) -> Advice {
        self.confirm(self.best().unwrap_or(f64::NEG_INFINITY), rank, at_once)
    }

    fn confirm(&self, best: f64, rank: &[usize], at_once: usize) -> Advice {
        let rank = |at: usize| rank.get(at).copied().unwrap_or(usize::MAX);
        let known = |at: usize| self.confirmed.iter().any(|confirmed| confirmed.at == at);
        let contender = |at: usize| {
            let (expected, probability) = self.measured(at, best + self.gain.least)?;
            (probability >= self.gain.probability).then_some((expected, at))
        };
        let mut contenders: Vec<(f64, usize)> =
            (0..self.told.len()).filter(|&at| !known(at)).filter_map(contender).collect();
        contenders.sort_by(|a, b| b.0.total_cmp(&a.0).then(rank(a.1).cmp(&rank(b.1))));
        if !contenders.is_empty() {
            return Advice::Confirm(
                contenders.into_iter().take(at_once).map(|(_, at)| at).collect(),
            );
        }
        let leaders = self.confirmed.iter().filter(|confirmed| confirmed.value >= best);
        // `rank` decides between equal ones.
        match leaders.min_by_key(|confirmed| rank(confirmed.at)) {
            Some(leader) if !leader.last => Advice::Confirm(vec![leader.at]),
            _ => Advice::Settled,
        }
    }

    /// Returns the median of the confirmed value of an evaluated point; `None` without a value.
    pub fn median(&self, at: usize) -> Option<f64> {
        let told = self.told.get(at)?;
        Some(told.value()? - self.drop_at(&self.grid.free_unit(&told.point)).0.max(0.0))
    }

    /// Returns the expected confirmed value of an evaluated point and the probability that it
    /// exceeds `bar`; `None` without a value above the floor.
    fn measured(&self, at: usize, bar: f64) -> Option<(f64, f64)> {
        let value = self.told.get(at)?.value().filter(|value| *value > self.gain.floor)?;
        let (mean, deviation) = self.drop_at(&self.grid.free_unit(&self.told[at].point));
        let room = value - bar;
        let probability = match () {
            // A drop is never negative; the tolerance absorbs rounding.
            () if room <= 1e-9 => 0.0,
            () if deviation > 0.0 => exp(normal_log_cdf((room - mean) / deviation)),
            () => f64::from(u8::from(mean < room)),
        };
        Some((value - positive_part(mean, deviation), probability))
    }

    /// Returns whether a point not yet evaluated may beat `best`.
    fn search_gains(&self, best: f64) -> bool {
        let Some(searched) = self.searched() else { return true };
        let bar = best + self.gain.least;
        let mut proposed = Proposed::new(self.grid.clone(), 0);
        for observation in self.told {
            proposed.insert(&observation.point);
        }
        let likely = |point: &GridPoint| {
            !proposed.contains(point) && self.unseen(&searched, &self.grid.free_unit(point), bar)
        };
        match self.grid.size() <= EXHAUSTIVE {
            true => self.grid.points().any(|point| likely(&point)),
            false => self.candidates(&proposed).iter().any(likely),
        }
    }

    /// Returns whether the confirmed value at an unevaluated point exceeds `bar` with at least the
    /// probability of [`Gain`].
    fn unseen(&self, searched: &Model, x: &[f64], bar: f64) -> bool {
        let Model { gp, data } = searched;
        let above = |(mean, variance): (f64, f64), bar: f64| {
            exp(normal_log_cdf((mean - data.of(bar)) / sqrt(variance)))
        };
        let rough = gp.bound(x);
        if rough.0 < data.of(bar) && above(rough, bar) < self.gain.probability {
            return false;
        }
        let (own, (mean, deviation)) = (gp.predict(x), self.drop_at(x));
        let at = |(node, weight): (f64, f64)| {
            weight * above(own, bar + (mean + node * deviation).max(0.0))
        };
        NODES.into_iter().map(at).sum::<f64>() >= self.gain.probability
    }

    fn candidates(&self, proposed: &Proposed) -> Vec<GridPoint> {
        let mut best: Vec<&Observation> =
            self.told.iter().filter(|o| o.value().is_some()).collect();
        best.sort_by(|a, b| b.values[0].total_cmp(&a.values[0]));
        let incumbents: Vec<GridPoint> =
            best.into_iter().take(INCUMBENTS).map(|o| o.point.clone()).collect();
        Room { proposed, incumbents: &incumbents, seed: 0 }.candidates(CANDIDATES)
    }
}

/// Mean of the positive part of a normal random variable.
fn positive_part(mean: f64, deviation: f64) -> f64 {
    if deviation <= 0.0 {
        return mean.max(0.0);
    }
    let z = mean / deviation;
    mean * exp(normal_log_cdf(z)) + deviation * normal_pdf(z)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAIN: Gain = Gain { least: 0.3, probability: 0.02, noise_floor: 0.03, floor: 0.0 };

    /// A ridge of height 5 at level 3 and one of height 4 at level 16, of 21.
    fn told(levels: impl IntoIterator<Item = u32>) -> Vec<Observation> {
        let value = |k: u32| {
            let x = f64::from(k);
            5.0 * exp(-(x - 3.0).powi(2) / 8.0) + 4.0 * exp(-(x - 16.0).powi(2) / 8.0)
        };
        levels.into_iter().map(|k| Observation::new(GridPoint(vec![k]), Some(value(k)))).collect()
    }

    fn grid() -> Grid {
        Grid::new(vec![21])
    }

    fn advice(told: &[Observation], confirmed: &[Confirmed]) -> Advice {
        let rank: Vec<usize> = (0..told.len()).collect();
        Outlook::new(&grid(), told, confirmed, GAIN).advise(&rank, 2)
    }

    #[test]
    fn a_search_with_a_gap_goes_on_and_one_without_confirms_its_best_first() {
        // Between 5 and 17 anything may stand.
        assert_eq!(advice(&told([0, 3, 5, 17, 20]), &[]), Advice::Search);
        assert_eq!(advice(&told(0..21), &[]), Advice::Confirm(vec![3]));
        assert_eq!(advice(&[], &[]), Advice::Search);
    }

    #[test]
    fn a_confirmed_best_is_confirmed_further_and_then_settled() {
        let all = told(0..21);
        let at = |value, last| [Confirmed { at: 3, value, last }];
        assert_eq!(advice(&all, &at(5.0, false)), Advice::Confirm(vec![3]));
        assert_eq!(advice(&all, &at(5.0, true)), Advice::Settled);
    }

    #[test]
    fn where_the_best_drops_what_may_now_be_better_is_confirmed_elsewhere_first() {
        let all = told(0..21);
        let dropped = [Confirmed { at: 3, value: 2.5, last: false }];
        let rank: Vec<usize> = (0..all.len()).collect();
        // Beside the drop as much may be lost.
        let next = Outlook::new(&grid(), &all, &dropped, GAIN).confirm_only(&rank, 1);
        assert_eq!(next, Advice::Confirm(vec![16]));
        // What is at most 0.3 above the best is no gain.
        let near = [Confirmed { at: 3, value: 4.75, last: true }];
        assert_eq!(advice(&all, &near), Advice::Settled);
    }

    #[test]
    fn a_known_drop_is_expected_nearby_and_less_so_far_off() {
        let (all, grid) = (told(0..21), grid());
        let confirmed = [
            Confirmed { at: 3, value: 3.0, last: false },
            Confirmed { at: 16, value: 4.0, last: true },
        ];
        let outlook = Outlook::new(&grid, &all, &confirmed, GAIN);
        let loss = |at: usize| all[at].values[0] - outlook.measured(at, 0.0).unwrap().0;
        assert!(loss(3) > 1.9 && loss(4) > 1.5 && loss(15) < 0.5, "{} {}", loss(4), loss(15));
        let sure = outlook.measured(16, 3.9).unwrap().1;
        assert!(sure > 0.9 && outlook.measured(16, 4.1).unwrap().1 == 0.0, "{sure}");
    }

    #[test]
    fn a_drop_is_at_least_nothing() {
        assert!((positive_part(0.0, 1.0) - 0.398_942_280_401).abs() < 1e-9);
        assert!((positive_part(9.0, 1.0) - 9.0).abs() < 1e-9);
        assert_eq!((positive_part(-1.0, 0.0), positive_part(2.0, 0.0)), (0.0, 2.0));
    }
}
