//! Local Gaussian processes of the points nearest to a location, where one process of all points would
//! cost too much.

use super::data::{Standardised, evenly_spaced};
use super::hyperparameters::Hyperparameters;
use super::model::{Gp, ScaledPoints};
use super::trained::{Goal, TrainedModels};
use std::collections::BTreeSet;

/// Number of neighbours for approximate predictions.
pub(super) const APPROXIMATE_NEIGHBOURS: usize = 24;

/// Observations for local models, each of a subset near a location (the local approximation of Gramacy and
/// Apley 2015, J. Comput. Graph. Stat. 24:561, with the nearest points instead of optimised ones).
#[derive(Debug, Clone)]
pub(super) struct LocalModels {
    /// Coordinates of the points on the free axes.
    pub x: Vec<Vec<f64>>,
    /// The points in units of the length scales of the first objective.
    scaled: ScaledPoints,
    /// Values of the objectives, then margins of the constraints, including those of points whose posterior mean
    /// counts as an observation.
    pub data: Vec<Standardised>,
    thetas: Vec<Hyperparameters>,
    /// Margin 0 of each constraint, the smallest feasible one, in the units of its model.
    pub zeros: Vec<f64>,
    pub goal: Goal,
}

impl LocalModels {
    /// Creates the models of at least one objective with values at `x`; the initial goal is any feasible point.
    pub fn new(
        x: Vec<Vec<f64>>,
        data: Vec<Standardised>,
        thetas: Vec<Hyperparameters>,
        zeros: Vec<f64>,
    ) -> Self {
        let scaled = ScaledPoints::new(&x, &thetas[0]);
        LocalModels { x, scaled, data, thetas, zeros, goal: Goal::Feasible }
    }

    /// Returns models conditioned on the `count` points nearest to a location and on `count / 3` points evenly
    /// selected from all in the order of observation, because the nearest points cluster at an optimum and do not
    /// determine the slopes around it. Returns `None` if a covariance matrix is not positive definite.
    pub fn near(&self, location: &[f64], count: usize) -> Option<TrainedModels> {
        self.models_of(&self.chosen(location, count))
    }

    /// Returns models of the points with these indices.
    pub fn models_of(&self, chosen: &BTreeSet<usize>) -> Option<TrainedModels> {
        let x: Vec<Vec<f64>> = chosen.iter().map(|&i| self.x[i].clone()).collect();
        let model = |(data, theta): (&Standardised, &Hyperparameters)| {
            let y: Vec<f64> = chosen.iter().map(|&i| data.values[i]).collect();
            Gp::new(&x, &y, data.noise_floor, theta)
        };
        let models = self.data.iter().zip(&self.thetas).map(model).collect::<Option<_>>()?;
        Some(TrainedModels { models, zeros: self.zeros.clone(), goal: self.goal.clone() })
    }

    /// Treats the posterior means at a point as observations, as [`TrainedModels::believe`].
    pub fn believe(&mut self, x: &[f64]) {
        let Some(mut near) = self.near(x, APPROXIMATE_NEIGHBOURS) else { return };
        self.scaled.push(x);
        self.x.push(x.to_vec());
        for (data, gp) in self.data.iter_mut().zip(&near.models) {
            data.values.push(gp.mean(x));
        }
        near.believe(x);
        self.goal = near.goal;
    }

    /// Returns the half widths of the trust region around a location, per axis in cube edges: half the distance (in
    /// length scales) to the farthest of its `count` nearest points.
    pub fn trust_region(&self, location: &[f64], count: usize) -> Vec<f64> {
        let far = self.by_distance(location, count).last().map_or(0.0, |&(r2, _)| r2.sqrt());
        self.scaled.inverse_length.iter().map(|i| 0.5 * far / i).collect()
    }

    /// Returns the indices of the points of the model at a location.
    fn chosen(&self, location: &[f64], count: usize) -> BTreeSet<usize> {
        let near = self.by_distance(location, count).into_iter().map(|(_, i)| i);
        near.chain(evenly_spaced(self.x.len(), count / 3)).collect()
    }

    /// Returns the squared distances, in length scales, and the indices of the nearest points, the farthest last.
    fn by_distance(&self, location: &[f64], count: usize) -> Vec<(f64, usize)> {
        let mut near: Vec<(f64, usize)> =
            self.scaled.distances2(location).into_iter().zip(0..).collect();
        let order = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        if (1..near.len()).contains(&count) {
            near.select_nth_unstable_by(count - 1, order);
            near.truncate(count);
        }
        near
    }
}

#[cfg(test)]
mod tests {
    use super::super::data::standardise;
    use super::*;

    fn known() -> LocalModels {
        let x: Vec<Vec<f64>> =
            (0..60).map(|i| vec![f64::from(i) / 59.0, f64::from(i * 23 % 60) / 59.0]).collect();
        let values: Vec<f64> = x.iter().map(|p| libm::sin(5.0 * p[0]) + p[1]).collect();
        let values: Vec<Option<f64>> = values.into_iter().map(Some).collect();
        let data = standardise(&values, 1e-3).unwrap();
        let theta =
            Hyperparameters { log_length: vec![-1.0, 0.0], log_signal: 0.0, log_noise: -12.0 };
        LocalModels::new(x, vec![data], vec![theta], Vec::new())
    }

    #[test]
    fn a_local_model_predicts_as_the_global_one() {
        let known = known();
        let location = [0.4, 0.5];
        let of = |count| known.near(&location, count).unwrap().models[0].predict(&location);
        let (whole, near) = (of(60), of(24));
        assert!((whole.0 - near.0).abs() < 0.02, "{whole:?} {near:?}");
        // With fewer observations the variance can only be larger.
        assert!(near.1 >= whole.1 - 1e-9 && near.1 < 0.05, "{whole:?} {near:?}");
        assert_eq!(known.near(&location, 60).unwrap().len(), 60);
    }

    #[test]
    fn distances_are_in_length_scales_and_some_distant_points_are_chosen() {
        let known = known();
        let near = known.by_distance(&[0.5, 0.5], 6);
        let farthest = near.iter().map(|n| n.0).fold(0.0, f64::max);
        assert!(near.len() == 6 && near.last().unwrap().0 == farthest);
        let region = known.trust_region(&[0.5, 0.5], 6);
        assert!((region[1] / region[0] - libm::exp(1.0)).abs() < 1e-12, "{region:?}");
        let chosen = known.chosen(&[0.5, 0.5], 6);
        assert!(chosen.contains(&0) && (6..=8).contains(&chosen.len()), "{chosen:?}");
    }

    #[test]
    fn a_believed_point_keeps_its_mean_and_loses_its_variance() {
        let mut known = known();
        let location = [0.11, 0.93];
        let at =
            |known: &LocalModels| known.near(&location, 30).unwrap().models[0].predict(&location);
        let before = at(&known);
        known.believe(&location);
        let after = at(&known);
        assert!((before.0 - after.0).abs() < 0.05 && after.1 < 0.1 * before.1);
    }
}
