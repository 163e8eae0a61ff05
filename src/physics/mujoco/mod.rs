//! A second, independent engine: MuJoCo. Only this folder knows it.
//!
//! The scene is written as MJCF ([`crate::physics::mjcf`]) and read by MuJoCo itself. What a
//! trial does besides goes into the model's numbers: the force that drives a driven
//! body is set before each step, a servo's gains where its spring is replaced.

// `world` cannot fail: what `supports` lets through and MuJoCo refuses all the same ends here, with its message.
#![allow(clippy::panic)]

mod world;

#[cfg(test)]
mod tests;

use super::mjcf::{self, MjcfSettings};
use super::{Engine, Unsupported, World};
use crate::scene::Scene;
use mujoco_rs::prelude::MjModel;
use world::MujocoWorld;

/// The engine; see [`MjcfSettings`].
#[derive(Debug, Clone, Copy, Default)]
pub struct Mujoco {
    /// How finely and how stiffly it simulates.
    pub settings: MjcfSettings,
}

impl Engine for Mujoco {
    fn version(&self) -> String {
        format!("mujoco {}", mujoco_rs::mujoco_version())
    }

    fn supports(&self, scene: &Scene) -> Result<(), Unsupported> {
        mjcf::supports(scene).map_err(|error| Unsupported {
            engine: self.version(),
            part: error.part,
            lacking: error.lacking,
        })
    }

    /// # Panics
    /// On a scene that it does not support, and if MuJoCo refuses the model.
    fn world(&self, scene: &Scene) -> Box<dyn World> {
        let text = mjcf::write(scene, "scene", &self.settings);
        let text = text.unwrap_or_else(|error| panic!("{error}"));
        let model = MjModel::from_xml_string(&text);
        let model = model.unwrap_or_else(|error| panic!("MuJoCo refuses the model: {error}"));
        Box::new(MujocoWorld::new(scene, model))
    }

    fn halved(&self) -> Box<dyn Engine> {
        let step_s = 0.5 * self.settings.step_s;
        Box::new(Mujoco { settings: MjcfSettings { step_s, ..self.settings } })
    }
}
