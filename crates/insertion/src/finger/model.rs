//! Models of the springs of a finger that were not measured: of the paper, or computed from the ribs.

use super::Finger;
use super::computed::{self, Overrides};
use crate::finger::file::{FingerFile, infill, is_shape};
use crate::space::{DIRECTION_KEY, Design};
use crate::surrogate::Prediction;
use crate::task::Task;
use crate::task::finger::Coupling;
use finray::FingerError;
use finray::mechanics::{FingerStiffness, StiffnessCache};
use input::units::MM;
pub use parameters::numbers::{CENTRE as RCC_KEY, TILTING as TILTING_KEY};
use serde::{Deserialize, Serialize};

/// A finger model by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FingerModelKind {
    /// One remote centre (21 mm) and tilting stiffness (2 N m/rad) for all, springs at the centre
    #[default]
    Paper,
    /// Both from the ribs of each design, its measured stiffness at the pad
    Computed,
}

impl FingerModelKind {
    /// Returns the name on the command line and in study files.
    pub fn name(self) -> &'static str {
        match self {
            FingerModelKind::Paper => "paper",
            FingerModelKind::Computed => "computed",
        }
    }
}

/// Source of the fingers of designs.
#[derive(Debug)]
pub enum FingerSource {
    /// As the paper models them: the measured springs sit at one remote centre.
    Paper,
    /// Computed from their ribs.
    Computed(Box<ComputedFingers>),
}

/// Fingers computed from a finger file.
#[derive(Debug)]
pub struct ComputedFingers {
    /// File of shape and material.
    pub file: FingerFile,
    cache: StiffnessCache,
}

/// Source of a finger's remote centre.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CentreFrom {
    /// The finger source itself.
    Model,
    /// `rcc_mm` of the task file.
    TaskFile,
    /// [`RCC_KEY`] of the design.
    Design,
}

impl FingerSource {
    /// Returns the name of the source.
    pub fn kind(&self) -> FingerModelKind {
        match self {
            FingerSource::Paper => FingerModelKind::Paper,
            FingerSource::Computed(_) => FingerModelKind::Computed,
        }
    }

    /// Returns the finger of a design on a task with the predicted stiffness at its pad (of the paper's model, at
    /// its centre).
    /// The caller sets its other numbers, except remote centre and tilting stiffness.
    ///
    /// # Errors
    /// If the finger cannot be printed, or cannot have this stiffness.
    pub fn make(
        &self,
        at_pad: &Prediction,
        design: &Design,
        task: &Task,
    ) -> Result<Finger, FingerError> {
        let rcc = design.get(RCC_KEY).map(|mm| mm * MM);
        let direction = design.get(DIRECTION_KEY).unwrap_or_default();
        match self {
            FingerSource::Paper => {
                let finger = Finger::new(at_pad.compliance.mean, at_pad.assembly.mean);
                let finger = finger.shaped(&task.finger, direction);
                Ok(Finger { rcc: rcc.unwrap_or(finger.rcc), ..finger })
            }
            FingerSource::Computed(fingers) => {
                let rcc = rcc.or(task.finger.rcc.map(|rcc| rcc.at(direction)));
                let overrides = Overrides { rcc, tilting: design.get(TILTING_KEY) };
                fingers.finger(at_pad, design, task, overrides)
            }
        }
    }

    /// Returns an example of such a finger, to check whether an engine supports it.
    pub fn any(&self, task: &Task) -> Finger {
        let finger = Finger::new(1.0, 1.0).shaped(&task.finger, 0.0);
        match self {
            FingerSource::Paper => finger,
            FingerSource::Computed(_) => Finger { coupling: Coupling::new([]), ..finger },
        }
    }
}

impl ComputedFingers {
    /// Creates the fingers of a file, with its rib phase.
    pub fn new(file: FingerFile) -> Self {
        ComputedFingers { file, cache: StiffnessCache::default() }
    }

    /// Returns the stiffness of a design computed from its ribs, each once. An infill of NaN is an error.
    ///
    /// # Errors
    /// If the finger cannot be printed.
    pub fn stiffness(&self, design: &Design) -> Result<FingerStiffness, FingerError> {
        self.cache.stiffness(&self.file.with(design)?, &infill(design, None))
    }

    fn finger(
        &self,
        at_pad: &Prediction,
        design: &Design,
        task: &Task,
        overrides: Overrides,
    ) -> Result<Finger, FingerError> {
        if task.finger.coupling.is_some() {
            return Err(FingerError::Coupled { task: task.name.clone() });
        }
        let computed = self.stiffness(design)?;
        // Pad and roof are glued to the part: `docs/notes/finger.md`.
        let mut plane = computed.pad_and_roof;
        if design.0.keys().any(|key| is_shape(key)) {
            // It was not measured: the correction by measured fingers must not make its centre impossible.
            plane = plane.corrected(at_pad.compliance.mean, at_pad.assembly.mean).unwrap_or(plane);
        }
        let (printed, across) = (&self.file.with(design)?, computed.cross.matrix);
        computed::finger(printed, plane, across, task.grip.shoulder(), at_pad, overrides)
    }
}
