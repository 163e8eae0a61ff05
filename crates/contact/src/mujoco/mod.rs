//! A second, independent engine: MuJoCo, confined to this module.
//!
//! MuJoCo reads the scene as MJCF ([`crate::mjcf`]). During a simulation, values of the model are changed: the force on
//! a driven body before each step, the gains of a servo when its spring is replaced.

// `world` returns no error: it panics with MuJoCo's message on a scene that `supports` would reject.
#![allow(clippy::panic)]

mod world;

use super::mjcf::{self, MjcfSettings, NotMjcf};
use super::{Engine, Unsupported, World};
use crate::scene::Scene;
use mujoco_rs::prelude::{MjModel, MjtObjBase};
use world::MujocoWorld;

/// The engine `mujoco`.
#[derive(Debug, Clone, Copy, Default)]
pub struct Mujoco {
    /// Settings of the simulation.
    pub settings: MjcfSettings,
}

impl Mujoco {
    /// Returns the model of the scene.
    fn model(&self, scene: &Scene) -> Result<MjModel, Unsupported> {
        let text = mjcf::write(scene, "scene", &self.settings).map_err(|error| {
            let NotMjcf { part, feature } = error;
            Unsupported::Lacking { engine: self.version(), part, feature }
        })?;
        MjModel::from_xml_string(&text).map_err(|error| {
            let reason = error.to_string().trim_end().to_owned();
            Unsupported::Refused { engine: self.version(), reason }
        })
    }

    /// Returns the inverse mass that MuJoCo gives a body at its contacts, 1/kg.
    ///
    /// # Errors
    /// If it cannot simulate the scene.
    pub fn inverse_weight(&self, scene: &Scene, body: &str) -> Result<f64, Unsupported> {
        let model = self.model(scene)?;
        Ok(model.body_invweight0()[world::id(&model, MjtObjBase::mjOBJ_BODY, body)][0])
    }
}

impl Engine for Mujoco {
    fn version(&self) -> String {
        format!("mujoco {}", mujoco_rs::mujoco_version())
    }

    fn supports(&self, scene: &Scene) -> Result<(), Unsupported> {
        self.model(scene).map(|_| ())
    }

    /// # Panics
    /// If it does not support the scene.
    fn world(&self, scene: &Scene) -> Box<dyn World> {
        let model = self.model(scene).unwrap_or_else(|error| panic!("{error}"));
        Box::new(MujocoWorld::new(scene, model))
    }

    fn with_half_step(&self) -> Box<dyn Engine> {
        let step_s = 0.5 * self.settings.step_s;
        Box::new(Mujoco { settings: MjcfSettings { step_s, ..self.settings } })
    }
}
