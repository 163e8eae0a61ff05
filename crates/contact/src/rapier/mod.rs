//! rapier3d in double precision, to compare `direct` with: a general engine for games and robots,
//! slower and less exact here (`docs/notes/simulation.md`, "Engines").

mod world;

use super::{Engine, Unsupported, World, unsupported_parts};
use crate::scene::Scene;
use world::RapierWorld;

/// The engine `rapier` and its settings, for parts of a few millimetres. rapier's defaults are made for games with
/// parts of about 1 m; with them, 10 N cause a penetration of 0.7 mm.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Rapier {
    /// Length of a step, s; collisions are detected once per step.
    pub step_s: f64,
    /// Number of solver substeps in a step.
    pub substeps: usize,
    /// Natural frequency f of a contact, Hz. rapier scales a contact's stiffness with the effective mass: a 5 g
    /// connector wedged by 70 N penetrates a wall by 0.21 mm at 2 kHz, 0.024 mm at 6 kHz, 0.014 mm at 8 kHz (check
    /// T10). But a contact that is too stiff for the length h of a substep, beyond about `2 pi f h = 1.7`, chatters
    /// when a part is squeezed between two others, and the part slips: with substeps of 25 us from 12 kHz (check T5).
    pub contact_hz: f64,
    /// Damping ratio of a contact; 1 is critical.
    pub contact_damping_ratio: f64,
    /// Gap below which a contact is predicted, m: larger than any displacement in a step, smaller than the gaps between
    /// faces that must not interact.
    pub prediction: f64,
    /// Highest speed at which a penetration is corrected, m/s. It bounds the force of a contact: at 0.5 m/s a 5 g
    /// connector wedged by 70 N penetrates by 2.4 mm at 2 kHz, and one wedged by 200 N by 1.1 mm at 8 kHz (check T10).
    /// With the default the bound is about 3 kN on such a part.
    pub corrective_velocity: f64,
    /// Penetration that is not corrected, m.
    pub allowed_error: f64,
}

impl Default for Rapier {
    fn default() -> Self {
        Rapier {
            step_s: 1e-4,
            substeps: 4,
            contact_hz: 8e3,
            contact_damping_ratio: 1.0,
            prediction: 0.5e-3,
            corrective_velocity: 10.0,
            allowed_error: 1e-7,
        }
    }
}

impl Engine for Rapier {
    fn version(&self) -> String {
        format!("rapier3d-f64 {}", rapier3d_f64::VERSION)
    }

    fn supports(&self, scene: &Scene) -> Result<(), Unsupported> {
        let Some((part, feature)) = unsupported_parts(scene).next() else { return Ok(()) };
        Err(Unsupported::Lacking { engine: self.version(), part: part.to_owned(), feature })
    }

    /// # Panics
    /// If it does not support the scene.
    #[allow(clippy::panic)]
    fn world(&self, scene: &Scene) -> Box<dyn World> {
        if let Err(unsupported) = self.supports(scene) {
            panic!("{unsupported}");
        }
        Box::new(RapierWorld::new(scene, self))
    }

    fn with_half_step(&self) -> Box<dyn Engine> {
        Box::new(Rapier { step_s: 0.5 * self.step_s, ..*self })
    }
}
