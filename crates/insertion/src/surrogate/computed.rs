//! Stiffness computed from the ribs, and its ratio to the measured stiffness: basis of the models if fewer than seven
//! fingers were measured.

use super::{Estimate, Fitted, Samples};
use crate::stiffness::{Axis, Infill};
use finray::mechanics::over_phases;
use finray::printed::PrintedFinger;
use finray::stiffness::PlanarStiffness;
use input::InputError;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Computed stiffness of the fingers of one file; each finger is computed once.
#[derive(Debug)]
pub struct ComputedStiffness {
    finger: PrintedFinger,
    /// Stiffness along each [`Axis`], N/m; the key is the bit pattern of the infill.
    cache: Mutex<BTreeMap<[u64; 2], [f64; 2]>>,
}

impl ComputedStiffness {
    /// Creates an empty cache for the fingers of a file.
    pub fn new(finger: &PrintedFinger) -> Self {
        ComputedStiffness { finger: finger.clone(), cache: Mutex::default() }
    }

    /// Returns the stiffness along an axis, N/m: geometric mean over the possible positions of the first rib. In the
    /// compliance direction the pad is moved as a rigid face; in the assembly direction pad and roof together, because
    /// the leave-one-out error is larger with the pad alone.
    ///
    /// # Errors
    /// If the finger cannot be printed.
    pub fn stiffness(&self, axis: Axis, infill: Infill) -> Result<f64, InputError> {
        let key = infill.map(f64::to_bits);
        let cache = || self.cache.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(cached) = cache().get(&key) {
            return Ok(cached[axis as usize]);
        }
        // Computed without the lock, so that other threads need not wait.
        let phases = over_phases(&self.finger, infill[0], infill[1])?;
        let mean = |of: fn(&[PlanarStiffness; 2]) -> f64| {
            let logs = phases.iter().map(|phase| libm::log(of(phase)));
            libm::exp(logs.sum::<f64>() / phases.len() as f64)
        };
        let means = [mean(|[_, both]| both.in_assembly()), mean(|[pad, _]| pad.in_compliance())];
        cache().insert(key, means);
        Ok(means[axis as usize])
    }
}

/// Standard deviation of ln(measured / computed) over the eleven shipped designs along each of [`Axis::ALL`]; prior for
/// other materials.
pub(super) const SCATTER: [f64; 2] = [0.30, 0.17];
/// Degrees of freedom of that standard deviation.
pub(super) const DEGREES_OF_FREEDOM: f64 = 10.0;

/// Lognormal distribution of the ratio of measured to computed stiffness.
#[derive(Debug)]
pub(super) struct LognormalRatio {
    /// Mean of the logarithm.
    log: f64,
    /// Standard deviation of the logarithm.
    sd: f64,
    /// Number of measured fingers.
    count: f64,
}

/// Fits ratios of measured to computed stiffness; `None` if there are none.
pub(super) fn fit(axis: Axis, ratios: &Samples) -> Option<LognormalRatio> {
    let logs = ratios.targets().mapv(libm::log);
    let log = logs.mean()?;
    let scatter = SCATTER[axis as usize];
    let count = logs.len() as f64;
    let squares =
        logs.mapv(|each| (each - log).powi(2)).sum() + DEGREES_OF_FREEDOM * scatter * scatter;
    let sd = (squares / (DEGREES_OF_FREEDOM + count - 1.0)).sqrt();
    Some(LognormalRatio { log, sd, count })
}

impl Fitted for LognormalRatio {
    fn predict(&self, _: Infill) -> Estimate {
        let mean = libm::exp(self.log);
        Estimate { mean, sd: mean * self.sd * (1.0 + 1.0 / self.count).sqrt() }
    }

    fn describe(&self) -> String {
        let error_percent = 100.0 * self.sd / self.count.sqrt();
        format!("computed stiffness x {:.3}, ± {error_percent:.0} %", libm::exp(self.log))
    }
}
