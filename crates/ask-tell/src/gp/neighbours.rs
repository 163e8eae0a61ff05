//! Processes of the points about a place, where one of all points would cost too much.

use super::data::{Standardised, spread};
use super::hyperparameters::Hyperparameters;
use super::model::{Gp, Scaled};
use super::trained::{Goal, Trained};

/// Neighbours of a place of which a rough answer will do.
pub(super) const FEW: usize = 24;

/// All that is known, for models of a part of it (the local approximation of Gramacy and
/// Apley 2015, J. Comput. Graph. Stat. 24:561, with the nearest points in place of chosen ones).
#[derive(Debug, Clone)]
pub(super) struct Neighbours {
    /// The points, free axes alone.
    pub x: Vec<Vec<f64>>,
    /// The points in the length scales of the first objective.
    scaled: Scaled,
    /// Values of the objectives, then of the constraints; of believed points, too.
    pub data: Vec<Standardised>,
    thetas: Vec<Hyperparameters>,
    /// Values from which on the constraints are kept.
    pub zeros: Vec<f64>,
    pub goal: Goal,
}

impl Neighbours {
    /// Of the values at `x`, at least one objective's; any point is looked for.
    pub fn new(
        x: Vec<Vec<f64>>,
        data: Vec<Standardised>,
        thetas: Vec<Hyperparameters>,
        zeros: Vec<f64>,
    ) -> Self {
        let scaled = Scaled::new(&x, &thetas[0]);
        Neighbours { x, scaled, data, thetas, zeros, goal: Goal::Feasible }
    }

    /// The models of the `count` points nearest to a place and of a third as many spread over the
    /// others in the order in which they came: those nearest to an optimum crowd it, and know
    /// nothing of the slopes around. `None` if a model cannot be made.
    pub fn about(&self, place: &[f64], count: usize) -> Option<Trained> {
        self.of(&self.chosen(place, count))
    }

    /// The models of these points.
    pub fn of(&self, chosen: &[usize]) -> Option<Trained> {
        let x: Vec<Vec<f64>> = chosen.iter().map(|&i| self.x[i].clone()).collect();
        let model = |(data, theta): (&Standardised, &Hyperparameters)| {
            let y: Vec<f64> = chosen.iter().map(|&i| data.values[i]).collect();
            Gp::new(&x, &y, data.noise_floor, theta)
        };
        let models = self.data.iter().zip(&self.thetas).map(model).collect::<Option<_>>()?;
        Some(Trained { models, zeros: self.zeros.clone(), goal: self.goal.clone() })
    }

    /// Takes the means at a point for observed there, as [`Trained::believe`].
    pub fn believe(&mut self, x: &[f64]) {
        let Some(mut near) = self.about(x, FEW) else { return };
        self.scaled.push(x);
        self.x.push(x.to_vec());
        for (data, gp) in self.data.iter_mut().zip(&near.models) {
            data.values.push(gp.mean(x));
        }
        near.believe(x);
        self.goal = near.goal;
    }

    /// Half the edges of a box about a place in which the nearest `count` points say enough.
    pub fn reach(&self, place: &[f64], count: usize) -> Vec<f64> {
        let far = self.by_distance(place, count).last().map_or(0.0, |&(r2, _)| r2.sqrt());
        self.scaled.inverse_length.iter().map(|i| 0.5 * far / i).collect()
    }

    /// Ascending.
    fn chosen(&self, place: &[f64], count: usize) -> Vec<usize> {
        let near = self.by_distance(place, count).into_iter().map(|(_, i)| i);
        let mut chosen: Vec<usize> = near.chain(spread(self.x.len(), count / 3)).collect();
        chosen.sort_unstable();
        chosen.dedup();
        chosen
    }

    /// The nearest points with their squared distances, the farthest of them last.
    fn by_distance(&self, place: &[f64], count: usize) -> Vec<(f64, usize)> {
        let mut near: Vec<(f64, usize)> =
            self.scaled.distances2(place).into_iter().zip(0..).collect();
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
    use super::super::data::Scale;
    use super::*;

    fn known() -> Neighbours {
        let x: Vec<Vec<f64>> =
            (0..60).map(|i| vec![f64::from(i) / 59.0, f64::from(i * 23 % 60) / 59.0]).collect();
        let values: Vec<f64> = x.iter().map(|p| libm::sin(5.0 * p[0]) + p[1]).collect();
        let data = Standardised { values, noise_floor: 1e-6, zero: 0.0, scale: Scale::default() };
        let theta =
            Hyperparameters { log_length: vec![-1.0, 0.0], log_signal: 0.0, log_noise: -12.0 };
        Neighbours::new(x, vec![data], vec![theta], Vec::new())
    }

    #[test]
    fn neighbours_of_a_place_say_there_what_all_points_say() {
        let known = known();
        let place = [0.4, 0.5];
        let of = |count| known.about(&place, count).unwrap().models[0].predict(&place);
        let (whole, near) = (of(60), of(24));
        assert!((whole.0 - near.0).abs() < 0.02, "{whole:?} {near:?}");
        // What is left out is not known: the variance can only be larger.
        assert!(near.1 >= whole.1 - 1e-9 && near.1 < 0.05, "{whole:?} {near:?}");
        assert_eq!(known.about(&place, 60).unwrap().len(), 60);
    }

    #[test]
    fn distances_are_in_length_scales_and_some_points_are_far() {
        let known = known();
        let near = known.by_distance(&[0.5, 0.5], 6);
        let farthest = near.iter().map(|n| n.0).fold(0.0, f64::max);
        assert!(near.len() == 6 && near.last().unwrap().0 == farthest);
        let reach = known.reach(&[0.5, 0.5], 6);
        assert!((reach[1] / reach[0] - libm::exp(1.0)).abs() < 1e-12, "{reach:?}");
        let chosen = known.chosen(&[0.5, 0.5], 6);
        assert!(chosen.contains(&0) && (6..=8).contains(&chosen.len()), "{chosen:?}");
    }

    #[test]
    fn a_believed_point_is_known_with_its_mean() {
        let mut known = known();
        let place = [0.11, 0.93];
        let at = |known: &Neighbours| known.about(&place, 30).unwrap().models[0].predict(&place);
        let before = at(&known);
        known.believe(&place);
        let after = at(&known);
        assert!((before.0 - after.0).abs() < 0.05 && after.1 < 0.1 * before.1);
    }
}
