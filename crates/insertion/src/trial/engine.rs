//! What computes the contacts of a trial, by name.

use super::Rig;
use super::run::{EngineRig, RigError};
use crate::finger::Finger;
use crate::robot::Robot;
use crate::task::Task;
use contact::Engine;
use contact::direct::Direct;
#[cfg(feature = "mujoco")]
use contact::mujoco::Mujoco;
use contact::rapier::Rapier;
use serde::{Deserialize, Serialize};

/// What computes the contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum EngineKind {
    /// Contact simulation in rapier3d
    Rapier,
    /// Implicit stepper made for sprung fingers and rigid contacts
    Direct,
    /// MuJoCo 3.17.0, as a second opinion
    #[cfg(feature = "mujoco")]
    Mujoco,
    /// A closed formula, for tests
    #[cfg(feature = "fake-engine")]
    #[value(hide = true)]
    Fake,
}

/// What an [`EngineKind`] stands for.
pub enum Built {
    /// An engine that simulates scenes.
    Engine(Box<dyn Engine>),
    /// The closed formula.
    #[cfg(feature = "fake-engine")]
    ClosedForm,
}

impl Built {
    /// The engine, if it is one that simulates scenes.
    pub fn engine(self) -> Option<Box<dyn Engine>> {
        match self {
            Built::Engine(engine) => Some(engine),
            #[cfg(feature = "fake-engine")]
            Built::ClosedForm => None,
        }
    }
}

/// An engine as a study records it: whatever changes here may change results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EngineRecord {
    /// Name on the command line.
    pub name: String,
    /// What it is, with its version.
    pub version: String,
    /// All its settings, SI units.
    pub settings: toml::Table,
}

impl EngineKind {
    /// Its name on the command line and in study files.
    pub fn name(self) -> &'static str {
        match self {
            EngineKind::Rapier => "rapier",
            EngineKind::Direct => "direct",
            #[cfg(feature = "mujoco")]
            EngineKind::Mujoco => "mujoco",
            #[cfg(feature = "fake-engine")]
            EngineKind::Fake => "fake",
        }
    }

    /// The engine of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        <EngineKind as clap::ValueEnum>::from_str(name, false).ok()
    }

    /// The engine with its production step times `factor`.
    pub fn build(self, factor: f64) -> Built {
        match self {
            EngineKind::Rapier => {
                let mut engine = Rapier::default();
                engine.step_s *= factor;
                Built::Engine(Box::new(engine))
            }
            EngineKind::Direct => {
                let mut engine = Direct::default();
                engine.step_s *= factor;
                Built::Engine(Box::new(engine))
            }
            #[cfg(feature = "mujoco")]
            EngineKind::Mujoco => {
                let mut engine = Mujoco::default();
                engine.settings.step_s *= factor;
                Built::Engine(Box::new(engine))
            }
            #[cfg(feature = "fake-engine")]
            EngineKind::Fake => Built::ClosedForm,
        }
    }

    /// Whether it simulates, as opposed to the closed formula.
    pub fn simulates(self) -> bool {
        self.build(1.0).engine().is_some()
    }

    /// Where trials of one task with one robot and such fingers are run, with the engine's step
    /// times `step_factor`, if they go together.
    pub fn rig(
        self,
        task: &Task,
        robot: &Robot,
        finger: &Finger,
        step_factor: f64,
    ) -> Result<Box<dyn Rig>, RigError> {
        match self.build(step_factor) {
            Built::Engine(engine) => {
                Ok(Box::new(EngineRig::with(task.clone(), robot, finger, engine)?))
            }
            #[cfg(feature = "fake-engine")]
            Built::ClosedForm => Ok(Box::new(super::fake::FakeRig::from_environment())),
        }
    }

    /// What a study records of it.
    pub fn record(self) -> EngineRecord {
        let settings = match self {
            EngineKind::Rapier => toml::Table::try_from(Rapier::default()),
            EngineKind::Direct => toml::Table::try_from(Direct::default()),
            #[cfg(feature = "mujoco")]
            EngineKind::Mujoco => toml::Table::try_from(Mujoco::default().settings),
            #[cfg(feature = "fake-engine")]
            EngineKind::Fake => Ok(toml::Table::new()),
        };
        let engine = self.build(1.0).engine();
        let version = engine.map_or_else(|| self.name().to_owned(), |engine| engine.version());
        // Settings are flat structs of numbers, which TOML can always hold.
        EngineRecord {
            name: self.name().to_owned(),
            version,
            settings: settings.unwrap_or_default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn every_engine_is_recorded_under_its_own_version_with_its_settings() {
        for kind in EngineKind::value_variants() {
            assert_eq!(EngineKind::from_name(kind.name()), Some(*kind));
            let record = kind.record();
            assert!(record.version.starts_with(kind.name()), "{record:?}");
            let simulates = kind.simulates();
            assert_eq!(record.settings.contains_key("step_s"), simulates, "{record:?}");
        }
    }
}
