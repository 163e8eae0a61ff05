//! A purpose-built engine: implicit springs, rigid contacts with friction, a
//! direct solution of each step.
//!
//! Velocity-level implicit time stepping (Stewart and Trinkle 1996, Int. J.
//! Numer. Meth. Eng. 39; Anitescu and Potra 1997, Nonlinear Dynamics 14): joints
//! and contacts are solved together for the velocities at the end of the step, so
//! that neither stiff springs nor light bodies limit the step, and a statically
//! indeterminate grasp has one well-conditioned solution.
//!
//! Left out: restitution, and the gyroscopic moment beyond first order in the step.

mod blocks;
mod body;
mod cone;
mod contacts;
mod dense;
mod joints;
mod patch;
mod solver;
mod world;

#[cfg(test)]
mod tests;

use super::{Engine, World};
use crate::scene::Scene;

/// How finely it simulates.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct DirectSettings {
    /// Length of a step, s.
    pub step_s: f64,
    /// Gap at which a contact is foreseen, m: farther than anything moves in a step.
    pub prediction: f64,
    /// Stiffness of a contact point, N/m, whatever the masses. It stands for the
    /// give of loaded edges, socket and board, which the exact boxes lack, and
    /// makes the forces of a redundant contact unique. It decides when a key
    /// wedges: `docs/notes/calibration.md`.
    pub contact_stiffness: f64,
    /// Damping of a contact point, N s/m, above critical for a 40 g key
    /// (published damping ratios are 0.5 and 1). With less, a released wedge
    /// rebounds and check T5 is missed; with little, contacts chatter at small
    /// steps, lose friction and let wedged keys through.
    pub contact_damping: f64,
    /// How friction holds a sticking point, N s/m: a force F creeps at F over it
    /// (5 N: 2.5 um/s), whatever the masses and the step.
    pub stick_damping: f64,
    /// Fastest a penetration is pushed out, m/s.
    pub push_out: f64,
}

impl Default for DirectSettings {
    fn default() -> Self {
        DirectSettings {
            step_s: 5e-4,
            prediction: 0.2e-3,
            contact_stiffness: 5.5e5,
            contact_damping: 1500.0,
            stick_damping: 2e6,
            push_out: 0.2,
        }
    }
}

/// The engine; see [`DirectSettings`].
#[derive(Debug, Clone, Copy, Default)]
pub struct Direct {
    /// How finely it simulates.
    pub settings: DirectSettings,
}

impl Engine for Direct {
    fn version(&self) -> String {
        format!("direct {}", env!("CARGO_PKG_VERSION"))
    }

    fn world(&self, scene: &Scene) -> Box<dyn World> {
        Box::new(world::DirectWorld::new(scene, &self.settings))
    }

    fn halved(&self) -> Box<dyn Engine> {
        let step_s = 0.5 * self.settings.step_s;
        Box::new(Direct { settings: DirectSettings { step_s, ..self.settings } })
    }
}
