//! The stiffness of printed fingers, each computed once.

use super::FingerError;
use super::geometry::Geometry;
use super::infill::Design;
use super::mechanics::{self, FingerStiffness};
use crate::printed::PrintedFinger;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Remembers what was computed; equal fingers are equal to the bit, so whether a stiffness was
/// remembered changes no result.
#[derive(Debug, Default)]
pub struct Known(Mutex<BTreeMap<String, FingerStiffness>>);

impl Known {
    /// The stiffness of a finger with an infill.
    ///
    /// # Errors
    /// As of [`Geometry::new`] and [`mechanics::compute`].
    pub fn stiffness(
        &self,
        finger: &PrintedFinger,
        design: &Design,
    ) -> Result<FingerStiffness, FingerError> {
        // Shows every number so that it reads back as the same bits.
        let key = format!("{finger:?} {design:?}");
        let found = self.0.lock().ok().and_then(|known| known.get(&key).copied());
        if let Some(stiffness) = found {
            return Ok(stiffness);
        }
        let stiffness = mechanics::compute(&Geometry::new(finger, design)?)?;
        if let Ok(mut known) = self.0.lock() {
            known.insert(key, stiffness);
        }
        Ok(stiffness)
    }
}
