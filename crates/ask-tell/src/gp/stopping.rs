//! Stopping criterion of a search whose results are confirmed by a more costly evaluation.
//!
//! The search evaluates points approximately, so a value may drop when it is confirmed. One
//! Gaussian process models the values of the search, warped as in the optimizer; a second one over
//! the same axes models the drop, which is the searched minus the confirmed value and never
//! negative. A search is settled when no point, evaluated or not, is likely to beat the best
//! confirmed one by more than the least difference that matters.

use super::data::{Standardised, evenly_spaced, standardise};
use super::fit::{FitEffort, fit};
use super::model::Gp;
use super::optimizer::DEFAULT_NOISE_FLOOR;
use super::search::{EXHAUSTIVE, SearchRegion};
use super::training::{INCUMBENTS, MAX_FITTED};
use crate::process::{Process, distance2, matern52};
use crate::proposed::ProposedPoints;
use crate::statistics::{normal_log_cdf, normal_pdf};
use crate::{Grid, GridPoint, Observation};
use libm::{exp, sqrt};
use nalgebra::{DMatrix, DVector};

/// Length scale of the drops relative to the edge of the unit square; in other dimensions it scales
/// with the diagonal. It is fixed because length scales fitted to the few known drops were too long: one
/// large drop was extrapolated to the whole space (`docs/notes/optimizers.md`).
const DROP_LENGTH: f64 = 0.15;
/// Number of candidates sampled from a grid that is too large to be searched completely.
const CANDIDATES: usize = 6000;
/// Probability below which a gain is disregarded.
const MIN_PROBABILITY: f64 = 0.02;
/// Nodes (in standard deviations) and weights of the Gauss-Hermite rule of five points.
const NODES: [(f64, f64); 5] = [
    (-2.856_970_013_872_806, 0.011_257_411_327_720_69),
    (-1.355_626_179_974_266, 0.222_075_922_005_612_64),
    (0.0, 0.533_333_333_333_333_3),
    (1.355_626_179_974_266, 0.222_075_922_005_612_64),
    (2.856_970_013_872_806, 0.011_257_411_327_720_69),
];

/// A point of the search that was confirmed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Confirmed {
    /// Index among the observations of the search.
    pub index: usize,
    /// Confirmed value.
    pub value: f64,
    /// Whether it cannot be confirmed any further.
    pub is_final: bool,
}

/// Recommended next step.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Advice {
    /// Confirm these points, or confirm them further; indices into the observations.
    Confirm(Vec<usize>),
    /// Continue the search: a point not yet evaluated may be better.
    Search,
    /// Stop: no point is expected to improve on the best.
    Settled,
}

/// Stopping criterion, with the models of the observations and of the drops at the confirmed points.
#[derive(Debug)]
pub struct StoppingCriterion<'a> {
    grid: &'a Grid,
    observations: &'a [Observation],
    confirmed: &'a [Confirmed],
    least_gain: f64,
    drop: Option<Drops>,
}

/// Gaussian process of the drops, with mean zero: none is expected far from the confirmed points.
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

impl<'a> StoppingCriterion<'a> {
    /// Creates the criterion with its models from the observations of a single-objective search and its
    /// confirmations; `least_gain` is the least difference that matters, in the objective's unit.
    pub fn new(
        grid: &'a Grid,
        observations: &'a [Observation],
        confirmed: &'a [Confirmed],
        least_gain: f64,
    ) -> Self {
        let mut criterion =
            StoppingCriterion { grid, observations, confirmed, least_gain, drop: None };
        criterion.drop = criterion.drop_model();
        criterion
    }

    /// Fits the model of the values of the search, and returns it with these values; `None` if no observation has one.
    fn search_model(&self) -> Option<(Gp, Standardised)> {
        let values: Vec<Option<f64>> = self.observations.iter().map(Observation::value).collect();
        let data = standardise(&values, DEFAULT_NOISE_FLOOR)?.warped();
        let x: Vec<Vec<f64>> =
            self.observations.iter().map(|o| self.grid.free_unit(&o.point)).collect();
        let fitted = evenly_spaced(x.len(), MAX_FITTED).map(|i| (x[i].clone(), data.values[i]));
        let (points, values): (Vec<Vec<f64>>, Vec<f64>) = fitted.unzip();
        let effort = FitEffort::for_observations(values.len());
        let theta = fit(&points, &values, data.noise_floor, None, (effort, &|| false));
        Some((Gp::new(&x, &data.values, data.noise_floor, &theta)?, data))
    }

    /// Fits the model of the drops. Its prior standard deviation is their root mean square, but at
    /// least the difference that matters: a few small drops do not imply that all are small.
    fn drop_model(&self) -> Option<Drops> {
        let drop = |c: &Confirmed| {
            Some((c.index, (self.observations.get(c.index)?.value()? - c.value).max(0.0)))
        };
        let known: Vec<(usize, f64)> = self.confirmed.iter().filter_map(drop).collect();
        let square = known.iter().map(|(_, drop)| drop * drop).sum::<f64>() / known.len() as f64;
        let signal = square.max(self.least_gain * self.least_gain);
        let place = |&(at, _): &(usize, f64)| self.grid.free_unit(&self.observations[at].point);
        let x: Vec<Vec<f64>> = known.iter().map(place).collect();
        let length = DROP_LENGTH * sqrt(x.first()?.len() as f64 / 2.0);
        let covariance = |i: usize, j: usize| {
            let noise = if i == j { DEFAULT_NOISE_FLOOR * DEFAULT_NOISE_FLOOR } else { 0.0 };
            signal * kernel(&x[i], &x[j], length) + noise
        };
        let covariance = DMatrix::from_fn(x.len(), x.len(), covariance);
        let values: Vec<f64> = known.iter().map(|(_, drop)| *drop).collect();
        let process = Process::new(covariance, &vec![[]; x.len()], &values)?;
        Some(Drops { process, x, length, signal })
    }

    /// Returns mean and standard deviation of the drop at a point, before truncation at 0.
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

    /// Returns the recommended next step of a search without constraints. Ties are broken in favour of the
    /// lower `rank`, which has an entry for each observation; at most `at_once` points are returned.
    pub fn advise(&self, rank: &[usize], at_once: usize) -> Advice {
        let Some(best) = self.best() else {
            // Nothing is confirmed before the search itself has settled, since early leaders are soon overtaken.
            let leader = self.observations.iter().filter_map(Observation::value).reduce(f64::max);
            let search = leader.is_none_or(|leader| self.search_may_improve(leader));
            return if search { Advice::Search } else { self.confirm(f64::NEG_INFINITY, rank, 1) };
        };
        let advice = self.confirm(best, rank, at_once);
        let search = advice == Advice::Settled && self.search_may_improve(best);
        if search { Advice::Search } else { advice }
    }

    /// Returns the points to confirm next without continuing the search.
    pub fn confirm_only(&self, rank: &[usize], at_once: usize) -> Advice {
        self.confirm(self.best().unwrap_or(f64::NEG_INFINITY), rank, at_once)
    }

    /// Returns the points not yet confirmed that may beat `best` by the least gain, or else the best confirmed one
    /// if it is not final.
    fn confirm(&self, best: f64, rank: &[usize], at_once: usize) -> Advice {
        let known = |at: usize| self.confirmed.iter().any(|confirmed| confirmed.index == at);
        let contender = |at: usize| {
            let (expected, probability) = self.confirmed_value(at, best + self.least_gain)?;
            (probability >= MIN_PROBABILITY).then_some((expected, at))
        };
        let mut contenders: Vec<(f64, usize)> =
            (0..self.observations.len()).filter(|&at| !known(at)).filter_map(contender).collect();
        contenders.sort_by(|a, b| b.0.total_cmp(&a.0).then(rank[a.1].cmp(&rank[b.1])));
        contenders.truncate(at_once);
        if !contenders.is_empty() {
            return Advice::Confirm(contenders.into_iter().map(|(_, at)| at).collect());
        }
        let leaders = self.confirmed.iter().filter(|confirmed| confirmed.value >= best);
        // `rank` breaks ties.
        let leader = leaders.min_by_key(|confirmed| rank[confirmed.index]);
        let open = leader.filter(|leader| !leader.is_final);
        open.map_or(Advice::Settled, |leader| Advice::Confirm(vec![leader.index]))
    }

    /// Returns the median of the confirmed value of an evaluated point; `None` if it has no value.
    pub fn median(&self, at: usize) -> Option<f64> {
        let observation = self.observations.get(at)?;
        let (drop, _) = self.drop_at(&self.grid.free_unit(&observation.point));
        Some(observation.value()? - drop.max(0.0))
    }

    /// Returns the expected confirmed value of an evaluated point and the probability that it
    /// exceeds `threshold`; `None` if the value is missing or not positive, which is not worth
    /// confirming.
    fn confirmed_value(&self, at: usize, threshold: f64) -> Option<(f64, f64)> {
        let value = self.observations.get(at)?.value().filter(|value| *value > 0.0)?;
        let (mean, deviation) = self.drop_at(&self.grid.free_unit(&self.observations[at].point));
        let margin = value - threshold;
        let probability = match () {
            // A drop is never negative; the tolerance absorbs rounding.
            () if margin <= 1e-9 => 0.0,
            () if deviation > 0.0 => exp(normal_log_cdf((margin - mean) / deviation)),
            () => f64::from(u8::from(mean < margin)),
        };
        Some((value - positive_part(mean, deviation), probability))
    }

    /// Returns whether a point not yet evaluated may beat `best`.
    fn search_may_improve(&self, best: f64) -> bool {
        let Some(model) = self.search_model() else { return true };
        let threshold = best + self.least_gain;
        let mut proposed = ProposedPoints::new(self.grid.clone(), 0);
        for observation in self.observations {
            proposed.insert(&observation.point);
        }
        let likely = |point: &GridPoint| {
            !proposed.contains(point)
                && self.may_exceed(&model, &self.grid.free_unit(point), threshold)
        };
        match self.grid.size() <= EXHAUSTIVE {
            true => self.grid.points().any(|point| likely(&point)),
            false => self.candidates(&proposed).iter().any(likely),
        }
    }

    /// Returns whether the confirmed value at an unevaluated point exceeds `threshold` with at least
    /// [`MIN_PROBABILITY`].
    fn may_exceed(&self, (gp, data): &(Gp, Standardised), x: &[f64], threshold: f64) -> bool {
        let above = |(mean, variance): (f64, f64), threshold: f64| {
            exp(normal_log_cdf((mean - data.convert(threshold)) / sqrt(variance)))
        };
        let rough = gp.bound(x);
        if rough.0 < data.convert(threshold) && above(rough, threshold) < MIN_PROBABILITY {
            return false;
        }
        let (own, (mean, deviation)) = (gp.predict(x), self.drop_at(x));
        let at = |(node, weight): (f64, f64)| {
            weight * above(own, threshold + (mean + node * deviation).max(0.0))
        };
        NODES.into_iter().map(at).sum::<f64>() >= MIN_PROBABILITY
    }

    fn candidates(&self, proposed: &ProposedPoints) -> Vec<GridPoint> {
        let mut best: Vec<&Observation> =
            self.observations.iter().filter(|o| o.value().is_some()).collect();
        best.sort_by(|a, b| b.values[0].total_cmp(&a.values[0]));
        let incumbents: Vec<GridPoint> =
            best.into_iter().take(INCUMBENTS).map(|o| o.point.clone()).collect();
        SearchRegion { proposed, incumbents: &incumbents }.candidates(CANDIDATES)
    }
}

/// Returns the mean of the positive part of a normal random variable.
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

    const MIN_GAIN: f64 = 0.3;

    /// Returns observations of a ridge of height 5 at level 3 and one of height 4 at level 16, of 21.
    fn observations(levels: impl IntoIterator<Item = u32>) -> Vec<Observation> {
        let value = |k: u32| {
            let x = f64::from(k);
            5.0 * exp(-(x - 3.0).powi(2) / 8.0) + 4.0 * exp(-(x - 16.0).powi(2) / 8.0)
        };
        levels.into_iter().map(|k| Observation::new(GridPoint(vec![k]), Some(value(k)))).collect()
    }

    fn grid() -> Grid {
        Grid::new(vec![21])
    }

    fn advice(observations: &[Observation], confirmed: &[Confirmed]) -> Advice {
        let rank: Vec<usize> = (0..observations.len()).collect();
        StoppingCriterion::new(&grid(), observations, confirmed, MIN_GAIN).advise(&rank, 2)
    }

    #[test]
    fn the_search_continues_with_a_gap_and_the_best_point_is_confirmed_without_one() {
        // The gap between levels 5 and 17 may contain a better point.
        assert_eq!(advice(&observations([0, 3, 5, 17, 20]), &[]), Advice::Search);
        assert_eq!(advice(&observations(0..21), &[]), Advice::Confirm(vec![3]));
        assert_eq!(advice(&[], &[]), Advice::Search);
    }

    #[test]
    fn a_confirmed_best_is_confirmed_further_and_then_settled() {
        let all = observations(0..21);
        let at = |value, is_final| [Confirmed { index: 3, value, is_final }];
        assert_eq!(advice(&all, &at(5.0, false)), Advice::Confirm(vec![3]));
        assert_eq!(advice(&all, &at(5.0, true)), Advice::Settled);
    }

    #[test]
    fn after_a_drop_of_the_best_point_a_distant_candidate_is_confirmed_first() {
        let all = observations(0..21);
        let dropped = [Confirmed { index: 3, value: 2.5, is_final: false }];
        let rank: Vec<usize> = (0..all.len()).collect();
        // Points near the drop may drop as much.
        let next = StoppingCriterion::new(&grid(), &all, &dropped, MIN_GAIN).confirm_only(&rank, 1);
        assert_eq!(next, Advice::Confirm(vec![16]));
        // Values less than 0.3 above the best are no gain.
        let near = [Confirmed { index: 3, value: 4.75, is_final: true }];
        assert_eq!(advice(&all, &near), Advice::Settled);
    }

    #[test]
    fn a_known_drop_is_expected_nearby_but_not_far_away() {
        let (all, grid) = (observations(0..21), grid());
        let confirmed = [
            Confirmed { index: 3, value: 3.0, is_final: false },
            Confirmed { index: 16, value: 4.0, is_final: true },
        ];
        let criterion = StoppingCriterion::new(&grid, &all, &confirmed, MIN_GAIN);
        let loss = |at: usize| all[at].values[0] - criterion.confirmed_value(at, 0.0).unwrap().0;
        assert!(loss(3) > 1.9 && loss(4) > 1.5 && loss(15) < 0.5, "{} {}", loss(4), loss(15));
        let sure = criterion.confirmed_value(16, 3.9).unwrap().1;
        assert!(sure > 0.9 && criterion.confirmed_value(16, 4.1).unwrap().1 == 0.0, "{sure}");
    }

    #[test]
    fn the_positive_part_has_the_closed_form_mean() {
        assert!((positive_part(0.0, 1.0) - 0.398_942_280_401).abs() < 1e-9);
        assert!((positive_part(9.0, 1.0) - 9.0).abs() < 1e-9);
        assert_eq!((positive_part(-1.0, 0.0), positive_part(2.0, 0.0)), (0.0, 2.0));
    }
}
