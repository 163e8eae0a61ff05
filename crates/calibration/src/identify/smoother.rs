//! Ensemble smoother with multiple data assimilation, ES-MDA (Emerick and Reynolds 2013,
//! doi:10.1016/j.cageo.2012.03.011), for few unknowns and many, partly missing, data.
//!
//! The ensemble has ten members per unknown only. Their covariance with the data is therefore that of a linear
//! regression of the data on the unknowns; its residuals count as errors of the data, so that the spread does not
//! collapse onto members that fit by chance.

use ask_tell::normal::StandardNormal;
use ask_tell::statistics::Moments;
use ask_tell::stream::stream;
use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use rayon::prelude::*;

/// Coordinates of the unknowns, in which the prior is standard normal.
pub type Coordinates = Vec<f64>;

/// Predictions of the data by a member, in the order of the data; `None` for data that it does not predict.
pub type Predicted = Vec<Option<f64>>;

/// Measured value with the standard deviation of its error, including that of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Datum {
    pub value: f64,
    pub sd: f64,
}

/// Settings of the smoother.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Members per unknown.
    pub members: usize,
    /// Number of assimilations; the variances of the data are multiplied by it.
    pub rounds: usize,
    /// Number of successive data of a kind over which errors are correlated; the variances are multiplied by it, too.
    pub correlated: f64,
    pub seed: u64,
}

/// Result of the smoother.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// Members after the last round.
    pub members: Vec<Coordinates>,
    /// Posterior standard deviation of each unknown as expected from a linear model of the first members, 0 to 1.
    pub expected_sd: Vec<f64>,
    /// Root mean square of (measured - predicted) / sd for the members' mean, before each round and after the last.
    pub misfit: Vec<f64>,
    /// Fraction of the data that at least a quarter of the last members predict.
    pub compared: f64,
}

/// Largest residual, in combined standard deviations of the datum and of the members; larger ones are clipped, so that
/// an event, such as a contact, that a member predicts at another time does not dominate.
const MAX_RESIDUAL: f64 = 3.0;
/// Largest coordinate, in standard deviations of the prior.
const MAX_COORDINATE: f64 = 3.0;
/// Smallest fraction of the members that must predict a datum for it to be used.
const MIN_SHARE: f64 = 0.25;

/// Draws members and assimilates the data; `predict` is called in parallel.
pub fn smooth<E: Send>(
    unknowns: usize,
    data: &[Datum],
    settings: Settings,
    predict: impl Fn(&[f64]) -> Result<Predicted, E> + Sync,
) -> Result<Smoothed, E> {
    // Without unknowns, a single member, for the misfit.
    let count = (settings.members * unknowns).max(1);
    let mut random = stream(settings.seed, 0, "members");
    let mut members: Vec<Coordinates> = (0..count)
        .map(|_| (0..unknowns).map(|_| random.sample(StandardNormal)).collect())
        .collect();
    let rounds = if unknowns == 0 { 0 } else { settings.rounds };
    let simulate = |members: &[Coordinates]| -> Result<Ensemble, E> {
        let predicted = members.par_iter().map(|member| predict(member));
        Ok(Ensemble::of(data, &predicted.collect::<Result<Vec<Predicted>, E>>()?))
    };
    let mut ensemble = simulate(&members)?;
    let (mut misfit, mut expected_sd) = (vec![ensemble.misfit()], Vec::new());
    for round in 0..rounds {
        let regression = Regression::of(&members, &ensemble);
        if round == 0 {
            expected_sd = regression.expected_sd(settings.correlated);
        }
        let mut random = stream(settings.seed, round as u64 + 1, "perturbed data");
        let factor = settings.rounds as f64 * settings.correlated;
        members = regression.updated(&members, &ensemble, factor, &mut random);
        ensemble = simulate(&members)?;
        misfit.push(ensemble.misfit());
    }
    let compared = ensemble.data.len() as f64 / data.len().max(1) as f64;
    Ok(Smoothed { members, expected_sd, misfit, compared })
}

/// Data that enough members predict, and their predictions; a missing prediction is the mean of the others.
struct Ensemble {
    data: Vec<Datum>,
    /// One row per datum, one column per member.
    predicted: DMatrix<f64>,
}

impl Ensemble {
    fn of(data: &[Datum], predicted: &[Predicted]) -> Self {
        let members = predicted.len();
        let (mut kept, mut rows) = (Vec::new(), Vec::new());
        for (i, datum) in data.iter().enumerate() {
            let values: Vec<Option<f64>> = predicted.iter().map(|member| member[i]).collect();
            let Moments { count, mean, .. } = Moments::of(values.iter().flatten());
            if count < MIN_SHARE * members as f64 || count == 0.0 {
                continue;
            }
            kept.push(*datum);
            rows.extend(values.into_iter().map(|value| value.unwrap_or(mean)));
        }
        Ensemble { predicted: DMatrix::from_row_slice(kept.len(), members, &rows), data: kept }
    }

    fn misfit(&self) -> f64 {
        let each = self.data.iter().zip(self.predicted.row_iter());
        let squares = each.map(|(datum, row)| ((datum.value - row.mean()) / datum.sd).powi(2));
        (squares.sum::<f64>() / self.data.len().max(1) as f64).sqrt()
    }
}

/// Linear regression of the data on the unknowns over the members.
struct Regression {
    /// One row per datum, one column per unknown.
    slopes: DMatrix<f64>,
    /// Sum of the variances of the error and of the residuals of each datum.
    variances: DVector<f64>,
    /// Inverse of the covariance of the members.
    precision: DMatrix<f64>,
}

impl Regression {
    fn of(members: &[Coordinates], ensemble: &Ensemble) -> Self {
        let (count, unknowns) = (members.len(), members[0].len());
        let z = centred(DMatrix::from_fn(unknowns, count, |i, j| members[j][i]));
        let d = centred(ensemble.predicted.clone());
        // A small ridge, in case all members are equal.
        let gram =
            &z * z.transpose() + DMatrix::identity(unknowns, unknowns) * (1e-9 * count as f64);
        let inverse = gram.try_inverse().unwrap_or_else(|| DMatrix::zeros(unknowns, unknowns));
        let slopes = &d * z.transpose() * &inverse;
        let residuals = &d - &slopes * &z;
        let degrees = count.saturating_sub(unknowns + 1).max(1) as f64;
        let own = ensemble.data.iter().map(|datum| datum.sd * datum.sd);
        let unexplained = residuals.row_iter().map(|row| row.norm_squared() / degrees);
        let sums = own.zip(unexplained).map(|(a, b)| a + b);
        let variances = DVector::from_iterator(ensemble.data.len(), sums);
        Regression { slopes, variances, precision: inverse * count as f64 }
    }

    /// Returns the transposed slopes, divided by `factor` times the variances.
    fn weighted(&self, factor: f64) -> DMatrix<f64> {
        let mut weighted = self.slopes.transpose();
        for (mut column, variance) in weighted.column_iter_mut().zip(self.variances.iter()) {
            column /= variance * factor;
        }
        weighted
    }

    /// Returns the standard deviations of the posterior of a linear model with this regression.
    fn expected_sd(&self, correlated: f64) -> Vec<f64> {
        let posterior = (&self.precision + self.weighted(correlated) * &self.slopes).try_inverse();
        let size = self.precision.nrows();
        let posterior = posterior.unwrap_or_else(|| DMatrix::identity(size, size));
        posterior.diagonal().iter().map(|variance| variance.max(0.0).sqrt().min(1.0)).collect()
    }

    /// Returns the members after assimilation of the perturbed data.
    fn updated(
        &self,
        members: &[Coordinates],
        ensemble: &Ensemble,
        factor: f64,
        random: &mut impl rand::Rng,
    ) -> Vec<Coordinates> {
        let weighted = self.weighted(factor);
        let Some(covariance) = (&self.precision + &weighted * &self.slopes).try_inverse() else {
            return members.to_vec();
        };
        let gain = covariance * weighted;
        let rows = ensemble.predicted.row_iter().zip(self.variances.iter());
        let limits: Vec<f64> =
            rows.map(|(row, variance)| MAX_RESIDUAL * (row.variance() + variance).sqrt()).collect();
        let each = members.iter().zip(ensemble.predicted.column_iter());
        let update = |(member, predicted): (&Coordinates, nalgebra::DVectorView<'_, f64>)| {
            let innovation = DVector::from_fn(ensemble.data.len(), |i, _| {
                let sd = self.variances[i].sqrt();
                let noise: f64 = random.sample(StandardNormal);
                let residual = ensemble.data[i].value - predicted[i];
                residual.clamp(-limits[i], limits[i]) + factor.sqrt() * sd * noise
            });
            let step = &gain * innovation;
            let moved = member.iter().zip(step.iter()).map(|(z, by)| z + by);
            moved.map(|z| z.clamp(-MAX_COORDINATE, MAX_COORDINATE)).collect()
        };
        each.map(update).collect()
    }
}

/// Subtracts the mean of each row.
fn centred(mut rows: DMatrix<f64>) -> DMatrix<f64> {
    rows.row_iter_mut().for_each(|mut row| row.add_scalar_mut(-row.mean()));
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    const SETTINGS: Settings = Settings { members: 20, rounds: 4, correlated: 1.0, seed: 0 };

    /// A line through noise: its posterior is known in closed form.
    #[test]
    fn of_a_linear_model_the_posterior_is_gaussian_and_known() {
        // d_i = z0 + i z1 + noise of 0.5, z0 = 0.4, z1 = -0.8.
        let at = |i: usize| i as f64 / 10.0;
        let mut random = stream(7, 0, "noise");
        let data: Vec<Datum> = (0..20)
            .map(|i| {
                let noise: f64 = random.sample(StandardNormal);
                Datum { value: 0.4 - 0.8 * at(i) + 0.5 * noise, sd: 0.5 }
            })
            .collect();
        let predict =
            |z: &[f64]| Ok::<_, Infallible>((0..20).map(|i| Some(z[0] + at(i) * z[1])).collect());
        let settings = Settings { members: 400, ..SETTINGS };
        let found = smooth(2, &data, settings, predict).unwrap();
        let (mut a, mut b) = (DMatrix::<f64>::identity(2, 2), DVector::zeros(2));
        for (i, datum) in data.iter().enumerate() {
            let row = DVector::from_vec(vec![1.0, at(i)]);
            a += &row * row.transpose() / 0.25;
            b += row * datum.value / 0.25;
        }
        let covariance = a.try_inverse().unwrap();
        let mean = &covariance * b;
        for i in 0..2 {
            let moments = Moments::of(found.members.iter().map(|member| member[i]));
            let (m, sd) = (moments.mean, moments.sample_deviation());
            let known = covariance[(i, i)].sqrt();
            assert!((m - mean[i]).abs() < 0.15 * known, "{m} and {}", mean[i]);
            assert!((sd / known - 1.0).abs() < 0.15, "{sd} and {known}");
            assert!((found.expected_sd[i] / known - 1.0).abs() < 0.1);
        }
        assert!(found.misfit[4] < found.misfit[0] && found.compared == 1.0);
    }

    #[test]
    fn with_nothing_to_fit_the_misfit_is_known_all_the_same() {
        let data = [Datum { value: 3.0, sd: 1.5 }; 4];
        let predict = |_: &[f64]| Ok::<_, Infallible>(vec![Some(0.0); 4]);
        let found = smooth(0, &data, SETTINGS, predict).unwrap();
        assert_eq!((found.misfit, found.compared), (vec![2.0], 1.0));
    }

    #[test]
    fn what_no_datum_tells_keeps_its_spread_and_missing_data_change_nothing() {
        let data = vec![Datum { value: 1.0, sd: 0.1 }; 10];
        let predict = |z: &[f64]| {
            let silent = z[1] > 0.0;
            Ok::<_, Infallible>((0..10).map(|i| (i < 5 || !silent).then_some(z[0])).collect())
        };
        let found = smooth(2, &data, SETTINGS, predict).unwrap();
        let spread = |i: usize| {
            let values = found.members.iter().map(|member| member[i]);
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)])
        };
        assert!(spread(0)[0] > 0.7 && spread(0)[1] < 1.3, "{:?}", spread(0));
        assert!(spread(1)[0] < -1.2 && spread(1)[1] > 1.2, "{:?}", spread(1));
        assert!(found.expected_sd[1] > 0.9);
        assert_eq!(found, smooth(2, &data, SETTINGS, predict).unwrap());
    }
}
