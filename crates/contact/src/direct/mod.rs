//! Engine `direct`: rigid bodies with implicit springs and frictional contacts.
//!
//! Velocity-level implicit time stepping (Stewart and Trinkle 1996, Int. J. Numer. Meth. Eng. 39; Anitescu and Potra
//! 1997, Nonlinear Dynamics 14): joints and contacts are solved together for the velocities at the end of the step, so
//! that neither stiff springs nor light bodies limit the step, and a statically indeterminate grasp has one
//! well-conditioned solution.
//!
//! Not modelled: restitution, and the gyroscopic moment beyond first order in the step. The checks T1 to T15 to which
//! comments refer are listed in `docs/notes/simulation.md`, "Engines and checks".

mod blocks;
mod body;
mod cone;
mod contacts;
mod dense;
mod impact;
mod joints;
mod patch;
mod solver;
mod world;

#[cfg(test)]
mod tests;

use super::{Engine, World};
use crate::scene::Scene;

/// The engine `direct` and its settings.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Direct {
    /// Length of a step, s.
    pub step_s: f64,
    /// Gap below which a contact is predicted, m: larger than any displacement in a step.
    pub prediction: f64,
    /// Stiffness of a contact point, which is a corner of a contact patch, N/m; independent of masses and facets. It
    /// models the compliance of loaded edges, socket and board, which rigid bodies lack, and makes the forces of a
    /// statically indeterminate contact unique. It determines when a plug wedges: `docs/notes/calibration.md`.
    pub contact_stiffness: f64,
    /// Damping of a contact point, N s/m: overcritical for a plug of 40 g (published simulations have damping ratios of
    /// 0.5 and 1). With less, a wedged plug rebounds when released and check T5 fails; with much less, contacts chatter
    /// at small steps, lose friction and let wedged plugs through.
    pub contact_damping: f64,
    /// Tangential damping of a sticking contact point, N s/m: under a tangential force F the point creeps at F divided
    /// by the damping (5 N: 2.5 um/s), independent of masses and step.
    pub stick_damping: f64,
    /// Highest speed at which a penetration is corrected, m/s.
    pub push_out: f64,
}

impl Default for Direct {
    fn default() -> Self {
        Direct {
            step_s: 5e-4,
            prediction: 0.2e-3,
            contact_stiffness: 5.5e5,
            contact_damping: 1500.0,
            stick_damping: 2e6,
            push_out: 0.2,
        }
    }
}

impl Engine for Direct {
    fn version(&self) -> String {
        format!("direct {}", env!("CARGO_PKG_VERSION"))
    }

    fn world(&self, scene: &Scene) -> Box<dyn World> {
        Box::new(world::DirectWorld::new(scene, self))
    }

    fn with_half_step(&self) -> Box<dyn Engine> {
        Box::new(Direct { step_s: 0.5 * self.step_s, ..*self })
    }
}
