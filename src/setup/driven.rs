//! A simulated insertion that a caller drives.

use super::finger::FingerRequest;
use super::request::SetupRequest;
use crate::context::not_stopped;
use crate::failure::Failure;
use input::units::MM;
use insertion::evaluation::tolerance;
use insertion::trial::{Driven, Grasp, State};
use nalgebra::Vector3;
use std::sync::atomic::AtomicBool;

/// Returns the error of an engine that simulates nothing that could be driven.
pub(crate) fn undriven() -> Failure {
    Failure::usage("this engine simulates nothing that could be driven; use --engine direct")
}

/// A grasped part in front of its socket, which a caller commands step by step: no command of the
/// command line has it.
pub struct Insertion {
    driven: Driven,
    /// The taught start, m.
    taught: f64,
}

impl Insertion {
    /// A part between these fingers.
    ///
    /// # Errors
    /// If task, robot and finger cannot be simulated, or the engine simulates nothing; if `stop` is
    /// set meanwhile.
    pub fn new(
        setup: &SetupRequest,
        finger: &FingerRequest,
        stop: &AtomicBool,
    ) -> Result<Self, Failure> {
        let setup = setup.setup()?;
        let specimen = finger.choose(&setup)?.specimen;
        let taught = setup.evaluator.taught(&specimen, stop).map_err(Failure::input)?;
        let rig = setup.evaluator.rig(&specimen, None, 1.0).map_err(Failure::input)?;
        let grasp = Grasp { stop, ..Grasp::of(&specimen.finger) };
        let driven = rig.driven(grasp).ok_or_else(undriven)?;
        not_stopped(stop)?;
        Ok(Insertion { driven, taught: taught.map_or(0.0, tolerance::offset) })
    }

    /// Begins anew, with the start shifted by so much along y, mm.
    pub fn start(&mut self, offset_mm: f64) -> State {
        self.driven.start(self.taught + offset_mm * MM)
    }

    /// Commands a velocity of the TCP, mm/s, for a control step.
    pub fn step(&mut self, velocity_mm_per_s: [f64; 3]) -> State {
        self.driven.step(Vector3::from(velocity_mm_per_s) * MM)
    }
}
