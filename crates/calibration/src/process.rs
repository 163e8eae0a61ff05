//! Model of the discrepancy between bench and simulation: trends, a Gaussian process over the
//! stiffness, and noise (Kennedy and O'Hagan 2001, doi:10.1111/1467-9868.00294).
//!
//! In units of the task's scale, the mean simulated range:
//!
//! ```text
//! y = 1 + a + (1 + r) (s(theta) - 1) + b1 / ky + b2 kz + d(ky, kz) + noise
//! ```
//!
//! `s` is the simulated range at parameters `theta`; `a` an offset common to all fingers; `1 + r` is the share of the
//! simulated differences that is real (Kennedy and O'Hagan's regression parameter); the
//! stiffnesses, lateral `ky` and in assembly direction `kz`, are standardised over the space. A window
//! widens with the deflection under a contact force, proportional to `1 / ky`, and with the force of a
//! preload, proportional to `kz`. Offset, `r`, `b1` and `b2` are normal about 0 and integrated out; `d`
//! is a Matern 5/2 process.

use ask_tell::process::{Process, distance2, matern52};
use ask_tell::statistics::normal_log_cdf;
use nalgebra::{DMatrix, DVector};

/// Point of a finger in the process: its standardised `1 / ky` and `kz`.
pub type StiffnessPoint = [f64; 2];

/// Number of linear terms: offset, `r`, `1 / ky`, `kz`.
pub const TERMS: usize = 4;

/// Number of coordinates of the sampler that determine the hyperparameters.
pub const COORDINATES: usize = 5;

/// Standard deviation of the offset `a`.
const OFFSET_SD: f64 = 0.5;
/// Standard deviation of `r`: simulated differences may also be irrelevant or opposite to measured ones.
const SHARE_SD: f64 = 1.0;
/// Prior of the standard deviation of a trend, `b1` or `b2`: median and logarithmic standard deviation.
const TREND: (f64, f64) = (0.1, 1.0);
/// Prior of the standard deviation of the process: median and logarithmic standard deviation.
const PROCESS: (f64, f64) = (0.05, 0.7);
/// Prior of the length scale of the process: median and logarithmic standard deviation.
const LENGTH_SCALE: (f64, f64) = (1.5, 0.4);
/// Prior of the standard deviation of the noise: median and logarithmic standard deviation. Repeated measurements of a
/// finger differ by a few steps of 0.1 mm.
const NOISE: (f64, f64) = (0.05, 0.7);

/// Hyperparameters: standard deviations of linear terms, process and noise in units of the task's scale, and the length
/// scale of the process.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hyperparameters {
    pub terms: [f64; TERMS],
    pub process: f64,
    /// Length scale of the process, in standard deviations of the stiffness.
    pub length_scale: f64,
    pub noise: f64,
}

impl Hyperparameters {
    /// Returns the hyperparameters at standard normal coordinates; the error of the emulator, in units of the scale, is
    /// added to the process.
    pub fn from_coordinates(z: &[f64], emulator: f64) -> Self {
        let at = |i: usize, (median, sd): (f64, f64)| median * libm::exp(sd * z[i]);
        Hyperparameters {
            terms: [OFFSET_SD, SHARE_SD, at(0, TREND), at(1, TREND)],
            process: libm::hypot(at(2, PROCESS), emulator),
            length_scale: at(3, LENGTH_SCALE),
            noise: at(4, NOISE),
        }
    }

    /// Returns the prior covariance of the discrepancies of two fingers.
    pub fn covariance(&self, a: &Finger, b: &Finger) -> f64 {
        let (x, y) = (a.terms(), b.terms());
        let linear: f64 = (0..TERMS).map(|i| self.terms[i].powi(2) * x[i] * y[i]).sum();
        let distance2 = distance2(&a.place, &b.place) / self.length_scale.powi(2);
        linear + self.process.powi(2) * matern52(distance2)
    }
}

/// Finger with its simulated range, in units of the task's scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finger {
    pub place: StiffnessPoint,
    pub simulated: f64,
}

impl Finger {
    /// Returns the regressors of the linear terms.
    pub fn terms(&self) -> [f64; TERMS] {
        [1.0, self.simulated - 1.0, self.place[0], self.place[1]]
    }
}

/// Process of the discrepancy conditioned on the measurements of a bench.
#[derive(Debug, Clone)]
pub struct Conditioned {
    pub hyperparameters: Hyperparameters,
    /// Measured fingers.
    pub fingers: Vec<Finger>,
    /// Fingers with lower bounds of their ranges, on which the process is not conditioned.
    pub bounds: Vec<(Finger, f64)>,
    /// Process of the discrepancies from the simulation; its kernel includes the linear terms.
    process: Process<0>,
    /// Standard deviation of the noise of each measured range.
    pub noises: Vec<f64>,
}

impl Conditioned {
    /// Conditions on measured fingers with their ranges and numbers of measurements; `bounds` are fingers with lower
    /// bounds. `None` if the covariance is not positive definite.
    pub fn new(
        hyperparameters: Hyperparameters,
        known: &[(Finger, f64, f64)],
        bounds: Vec<(Finger, f64)>,
    ) -> Option<Self> {
        let n = known.len();
        let fingers: Vec<Finger> = known.iter().map(|(finger, ..)| *finger).collect();
        let noises: Vec<f64> =
            known.iter().map(|(.., repeats)| hyperparameters.noise / repeats.sqrt()).collect();
        let mut covariance = DMatrix::zeros(n, n);
        for j in 0..n {
            for i in j..n {
                covariance[(i, j)] = hyperparameters.covariance(&fingers[i], &fingers[j]);
            }
            covariance[(j, j)] += noises[j].powi(2);
        }
        let discrepancies: Vec<f64> = known.iter().map(|(f, y, _)| y - f.simulated).collect();
        let process = Process::new(covariance, &vec![[]; n], &discrepancies)?;
        Some(Conditioned { hyperparameters, fingers, bounds, process, noises })
    }

    /// Returns the log-likelihood of the measurements up to a constant.
    pub fn log_likelihood(&self) -> f64 {
        let bound = |(finger, bound): &(Finger, f64)| {
            let (mean, sd) = self.predict(finger);
            normal_log_cdf((mean - bound) / libm::hypot(sd, self.hyperparameters.noise))
        };
        self.process.log_likelihood() + self.bounds.iter().map(bound).sum::<f64>()
    }

    /// Returns the prior covariances of a finger's discrepancy with those of the measured fingers.
    fn cross_covariances(&self, finger: &Finger) -> DVector<f64> {
        let to = |known: &Finger| self.hyperparameters.covariance(known, finger);
        DVector::from_iterator(self.fingers.len(), self.fingers.iter().map(to))
    }

    /// Returns mean and standard deviation of the true range of a finger, in units of the scale.
    pub fn predict(&self, finger: &Finger) -> (f64, f64) {
        let k = self.cross_covariances(finger);
        let own = self.hyperparameters.covariance(finger, finger);
        let mean = finger.simulated + self.process.mean(&k, &[]);
        (mean, self.process.variance(&k, &[], own).sqrt())
    }

    /// Conditions a draw of the prior on the measurements and returns its values at `fingers` (Matheron's rule; Wilson
    /// et al. 2020, arXiv 2002.09309). `prior` is the draw's discrepancy from the simulation at `fingers`, `known` its
    /// discrepancy at the measured fingers, with their noise.
    pub fn update(&self, fingers: &[Finger], prior: &[f64], known: &[f64]) -> Vec<f64> {
        let known = DVector::from_column_slice(known);
        let weights = self.process.weights() - self.process.solve(&known);
        let value = |(finger, prior): (&Finger, &f64)| {
            finger.simulated + prior + self.cross_covariances(finger).dot(&weights)
        };
        fingers.iter().zip(prior).map(value).collect()
    }
}
