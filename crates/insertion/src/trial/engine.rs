//! Contact engines by name.

use super::Rig;
use super::run::{EngineRig, RigError};
use crate::{Finger, Robot, Task, value_name};
use contact::Engine;
use contact::direct::Direct;
#[cfg(feature = "mujoco")]
use contact::mujoco::Mujoco;
use contact::rapier::Rapier;
use serde::{Deserialize, Serialize};

/// Contact engine by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum EngineKind {
    /// Contact simulation in rapier3d
    Rapier,
    /// Implicit stepper made for sprung fingers and rigid contacts
    #[default]
    Direct,
    /// MuJoCo 3.17.0, for comparison
    #[cfg(feature = "mujoco")]
    Mujoco,
    /// A closed formula, for tests
    #[cfg(feature = "fake-engine")]
    #[value(hide = true)]
    Fake,
}

/// Engine and settings as recorded with a study; any difference may change results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EngineRecord {
    /// Name on the command line.
    pub name: String,
    /// Name and version of the engine.
    pub version: String,
    /// Settings of the engine, SI units.
    pub settings: toml::Table,
}

impl EngineKind {
    /// Returns the name on the command line and in study files.
    pub fn name(self) -> String {
        value_name(self)
    }

    /// Returns the engine with `factor` times its production time step, and its settings. For the closed formula it is
    /// a placeholder.
    fn configured(self, factor: f64) -> (Box<dyn Engine>, toml::Table) {
        // Settings are flat structs of numbers, which TOML can always hold.
        macro_rules! scaled {
            ($engine:ty $(, $settings:ident)?) => {{
                let mut engine = <$engine>::default();
                engine$(.$settings)?.step_s *= factor;
                let settings = toml::Table::try_from(engine$(.$settings)?).unwrap_or_default();
                (Box::new(engine), settings)
            }};
        }
        match self {
            EngineKind::Rapier => scaled!(Rapier),
            EngineKind::Direct => scaled!(Direct),
            #[cfg(feature = "mujoco")]
            EngineKind::Mujoco => scaled!(Mujoco, settings),
            #[cfg(feature = "fake-engine")]
            EngineKind::Fake => scaled!(Direct),
        }
    }

    /// Returns the engine with `factor` times its production time step; a placeholder unless it
    /// [simulates](Self::simulates).
    pub fn build(self, factor: f64) -> Box<dyn Engine> {
        self.configured(factor).0
    }

    /// Returns whether the engine is a simulation and not the closed formula.
    pub fn simulates(self) -> bool {
        self.name() != "fake"
    }

    /// Returns the rig for trials of one task, robot and pair of fingers, with `step_factor` times the time step.
    ///
    /// # Errors
    /// If the robot or the engine does not support the task.
    pub fn rig(
        self,
        task: &Task,
        robot: &Robot,
        finger: &Finger,
        step_factor: f64,
    ) -> Result<Box<dyn Rig>, RigError> {
        #[cfg(feature = "fake-engine")]
        if self == EngineKind::Fake {
            return Ok(Box::new(crate::tests::fake::FakeRig::from_environment()));
        }
        Ok(Box::new(EngineRig::with(task.clone(), robot, finger, self.build(step_factor))?))
    }

    /// Returns the record of the engine for a study.
    pub fn record(self) -> EngineRecord {
        let name = self.name();
        if !self.simulates() {
            return EngineRecord { version: name.clone(), name, settings: toml::Table::new() };
        }
        let (engine, settings) = self.configured(1.0);
        EngineRecord { name, version: engine.version(), settings }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn every_engine_is_recorded_with_its_version_and_settings() {
        for kind in EngineKind::value_variants() {
            assert_eq!(EngineKind::from_str(&kind.name(), false), Ok(*kind));
            let record = kind.record();
            assert!(record.version.starts_with(&kind.name()), "{record:?}");
            let simulates = kind.simulates();
            assert_eq!(record.settings.contains_key("step_s"), simulates, "{record:?}");
        }
    }
}
