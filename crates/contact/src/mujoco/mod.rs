//! A second, independent engine: MuJoCo. Only this folder knows it.
//!
//! The scene is written as MJCF ([`crate::mjcf`]) and read by MuJoCo itself. What a
//! trial does besides goes into the model's numbers: the force that drives a driven
//! body is set before each step, a servo's gains where its spring is replaced.

// `world` cannot fail: a scene that `supports` was not asked about may end here, with MuJoCo's message.
#![allow(clippy::panic)]

mod world;

use super::mjcf::{self, MjcfSettings};
use super::{Engine, Unsupported, World};
use crate::scene::Scene;
use mujoco_rs::prelude::{MjModel, MjtObjBase};
use world::MujocoWorld;

/// The engine; see [`MjcfSettings`].
#[derive(Debug, Clone, Copy, Default)]
pub struct Mujoco {
    /// How finely and how stiffly it simulates.
    pub settings: MjcfSettings,
}

impl Mujoco {
    /// The scene as MuJoCo reads it.
    fn model(&self, scene: &Scene) -> Result<MjModel, Unsupported> {
        let text = mjcf::write(scene, "scene", &self.settings).map_err(|error| {
            let (part, lacking) = (error.part, error.lacking);
            Unsupported::Lacking { engine: self.version(), part, lacking }
        })?;
        MjModel::from_xml_string(&text).map_err(|error| {
            let reason = error.to_string().trim_end().to_owned();
            Unsupported::Refused { engine: self.version(), reason }
        })
    }
}

impl Mujoco {
    /// The inverse mass with which MuJoCo weighs a body at its contacts, 1/kg.
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
    /// On a scene that it does not support.
    fn world(&self, scene: &Scene) -> Box<dyn World> {
        let model = self.model(scene).unwrap_or_else(|error| panic!("{error}"));
        Box::new(MujocoWorld::new(scene, model))
    }

    fn halved(&self) -> Box<dyn Engine> {
        let step_s = 0.5 * self.settings.step_s;
        Box::new(Mujoco { settings: MjcfSettings { step_s, ..self.settings } })
    }
}
