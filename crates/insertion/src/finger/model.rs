//! Models of the unmeasured springs of a finger: as in the paper, or computed from the ribs.

use super::{Finger, computed};
use crate::finger::file::{infill, is_shape};
use crate::task::finger::Coupling;
use crate::{DIRECTION_KEY, Design, FingerFile, Prediction, Task};
use finray::geometry::Geometry;
use finray::mechanics::{FingerStiffness, compute};
use input::units::MM;
use input::{Check, InputError};
pub use parameters::numbers::{RCC_KEY, TILTING_KEY};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Name of a finger model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FingerModelKind {
    /// Remote centre at 21 mm, tilting stiffness 2 N m/rad; the measured stiffness acts at the centre
    #[default]
    Paper,
    /// Remote centre and tilting stiffness from the ribs; the measured stiffness acts at the pad
    Computed,
}

/// Finger model, which builds the fingers of designs.
#[derive(Debug)]
pub enum FingerSource {
    /// Model of the paper: the measured stiffness acts at one remote centre.
    Paper,
    /// Computed from the ribs.
    Computed(Box<ComputedFingers>),
}

/// Model that computes fingers from a finger file.
#[derive(Debug)]
pub struct ComputedFingers {
    /// File of shape and material.
    pub file: FingerFile,
    /// Computed stiffness by finger and infill. The computation is deterministic, so the cache changes no result.
    cache: Mutex<BTreeMap<String, FingerStiffness>>,
}

/// Source of a finger's remote centre.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CentreSource {
    /// Finger model.
    FingerModel,
    /// `rcc_mm` of the task file.
    Task,
    /// [`RCC_KEY`] of the design.
    Design,
}

impl FingerSource {
    /// Returns the name of the model.
    pub fn kind(&self) -> FingerModelKind {
        match self {
            FingerSource::Paper => FingerModelKind::Paper,
            FingerSource::Computed(_) => FingerModelKind::Computed,
        }
    }

    /// Returns the finger of a design on a task with the predicted stiffness, at the pad or, in the paper's model, at
    /// the remote centre. The caller sets the numbers of the design that this does not use: all but the remote centre
    /// and, in the computed model, the tilting stiffness.
    ///
    /// # Errors
    /// If the finger cannot be printed, or cannot have this stiffness.
    pub fn make(
        &self,
        at_pad: &Prediction,
        design: &Design,
        task: &Task,
    ) -> Result<Finger, InputError> {
        let rcc = design.get(RCC_KEY).map(|mm| mm * MM);
        let direction = design.get(DIRECTION_KEY).unwrap_or_default();
        match self {
            FingerSource::Paper => {
                let finger = Finger::new(at_pad.compliance.mean, at_pad.assembly.mean);
                let finger = finger.with_model(&task.finger, direction);
                Ok(Finger { rcc: rcc.unwrap_or(finger.rcc), ..finger })
            }
            FingerSource::Computed(fingers) => {
                if task.finger.coupling.is_some() {
                    let problem = "is set, but the ribs couple the springs of a computed finger; \
                                   delete it, or use --finger-model paper";
                    return Check { file: &task.name }.fail("finger.coupling", problem);
                }
                let rcc = rcc.or(task.finger.rcc.map(|rcc| rcc.at(direction)));
                let given = [rcc, design.get(TILTING_KEY)];
                let computed = fingers.stiffness(design)?;
                // Pad and roof are glued to the part: `docs/notes/finger.md`.
                let mut plane = computed.pad_and_roof;
                if design.0.keys().any(|key| is_shape(key)) {
                    // No such finger was measured: the measured stiffness of another shape must not make its centre
                    // impossible.
                    let [compliance, assembly] = [at_pad.compliance.mean, at_pad.assembly.mean];
                    plane = plane.corrected(compliance, assembly).unwrap_or(plane);
                }
                let (printed, across) = (&fingers.file.with(design)?, computed.cross.matrix);
                computed::finger(printed, plane, across, task.grip.shoulder(), at_pad, given)
            }
        }
    }

    /// Returns an example finger of the model, to check whether an engine supports it.
    pub fn example(&self, task: &Task) -> Finger {
        let finger = Finger::new(1.0, 1.0).with_model(&task.finger, 0.0);
        match self {
            FingerSource::Paper => finger,
            FingerSource::Computed(_) => Finger { coupling: Coupling::new([]), ..finger },
        }
    }
}

impl ComputedFingers {
    /// Creates the model of a finger file, with an empty cache.
    pub fn new(file: FingerFile) -> Self {
        ComputedFingers { file, cache: Mutex::default() }
    }

    /// Returns the stiffness of a design, computed from its ribs and cached. An infill of NaN is an error.
    ///
    /// # Errors
    /// If the finger cannot be printed.
    pub fn stiffness(&self, design: &Design) -> Result<FingerStiffness, InputError> {
        let (finger, infill) = (self.file.with(design)?, infill(design, None));
        // The debug format of a number reads back as the same bits.
        let key = format!("{finger:?} {infill:?}");
        let cached = self.cache.lock().ok().and_then(|cache| cache.get(&key).copied());
        if let Some(stiffness) = cached {
            return Ok(stiffness);
        }
        let stiffness = compute(&Geometry::new(&finger, &infill)?)?;
        if let Ok(mut cache) = self.cache.lock() {
            cache.insert(key, stiffness);
        }
        Ok(stiffness)
    }
}
