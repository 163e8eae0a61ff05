//! The stiffness that its ribs give a finger: the physical mean where few fingers were measured.

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
    /// The fingers of this file.
    pub fn new(finger: &PrintedFinger) -> Self {
        Computed { finger: finger.clone(), known: Mutex::default() }
    }

    /// A finger's stiffness at every phase of its ribs.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn phases(&self, infill: Infill) -> Result<Vec<[PlanarStiffness; 2]>, FingerError> {
        let key = infill.map(f64::to_bits);
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = known().get(&key) {
            return Ok(found.clone());
        }
        // Not under the lock: others may compute meanwhile.
        let found = over_phases(&self.finger, infill[0], infill[1])?;
        known().insert(key, found.clone());
        Ok(found)
    }

    /// Stiffness along an axis, N/m: geometric mean over the phases. In the assembly
    /// direction pad and roof carry, which leave-one-out prefers to the pad alone.
    ///
    /// # Errors
    /// If the finger cannot be made.
    pub fn stiffness(&self, axis: Axis, infill: Infill) -> Result<f64, FingerError> {
        let phases = self.phases(infill)?;
        let logs = phases.iter().map(|[pad, pad_and_roof]| match axis {
            Axis::Compliance => pad.in_compliance().ln(),
            Axis::Assembly => pad_and_roof.in_assembly().ln(),
        });
        Ok((logs.sum::<f64>() / phases.len() as f64).exp())
    }
}
