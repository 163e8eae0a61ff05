//! Stiffness computed from the ribs: mean of the model if few fingers were measured.

use super::{Estimate, Fitted, Samples};
use crate::stiffness::{Axis, Infill};
use finray::FingerError;
use finray::mechanics::over_phases;
use finray::printed::PrintedFinger;
use finray::stiffness::PlanarStiffness;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Computed stiffness of the fingers of one file, each computed once.
#[derive(Debug)]
pub struct Computed {
    finger: PrintedFinger,
    known: Mutex<BTreeMap<[u64; 2], Vec<[PlanarStiffness; 2]>>>,
}

impl Computed {
    /// Returns the fingers of this file.
    pub fn new(finger: &PrintedFinger) -> Self {
        Computed { finger: finger.clone(), known: Mutex::default() }
    }

    /// Returns a finger's stiffness at every phase of its ribs.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn phases(&self, infill: Infill) -> Result<Vec<[PlanarStiffness; 2]>, FingerError> {
        let key = infill.map(f64::to_bits);
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = known().get(&key) {
            return Ok(found.clone());
        }
        // Computed without the lock, so that other threads need not wait.
        let found = over_phases(&self.finger, infill[0], infill[1])?;
        known().insert(key, found.clone());
        Ok(found)
    }

    /// Returns the stiffness along an axis, N/m: geometric mean over the phases. In the assembly direction
    /// it is that of pad and roof, which has a smaller leave-one-out error than that of the pad alone.
    ///
    /// # Errors
    /// If the finger cannot be made.
    pub fn stiffness(&self, axis: Axis, infill: Infill) -> Result<f64, FingerError> {
        let phases = self.phases(infill)?;
        let logs = phases.iter().map(|[pad, pad_and_roof]| match axis {
            Axis::Compliance => libm::log(pad.in_compliance()),
            Axis::Assembly => libm::log(pad_and_roof.in_assembly()),
        });
        Ok(libm::exp(logs.sum::<f64>() / phases.len() as f64))
    }
}

/// Standard deviation of ln(measured / computed) over the eleven shipped designs, assumed for another
/// material as long as its own is not known.
pub(super) const SCATTER: [(Axis, f64); 2] = [(Axis::Compliance, 0.17), (Axis::Assembly, 0.30)];
/// Degrees of freedom of that standard deviation.
pub(super) const FREEDOM: f64 = 10.0;

/// Lognormal ratio of measured and computed stiffness.
#[derive(Debug)]
pub(super) struct Scale {
    log: f64,
    sd: f64,
    count: f64,
}

/// Fits ratios of measured and computed stiffness; `None` without any.
pub(super) fn fit(axis: Axis, ratios: &Samples) -> Option<Scale> {
    let logs = ratios.targets().mapv(libm::log);
    let log = logs.mean()?;
    let (_, scatter) = SCATTER.into_iter().find(|(of, _)| *of == axis)?;
    let count = logs.len() as f64;
    let squares = logs.mapv(|each| (each - log).powi(2)).sum() + FREEDOM * scatter * scatter;
    Some(Scale { log, sd: (squares / (FREEDOM + count - 1.0)).sqrt(), count })
}

impl Fitted for Scale {
    fn predict(&self, _: Infill) -> Estimate {
        let mean = libm::exp(self.log);
        Estimate { mean, sd: mean * self.sd * (1.0 + 1.0 / self.count).sqrt() }
    }

    fn describe(&self) -> String {
        let error_percent = 100.0 * self.sd / self.count.sqrt();
        format!("computed stiffness x {:.3}, ± {error_percent:.0} %", libm::exp(self.log))
    }
}
