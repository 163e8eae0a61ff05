//! Simulated insertion whose TCP the caller moves step by step.

use super::finger::FingerRequest;
use super::request::SetupRequest;
use crate::{Failure, not_stopped};
use input::units::MM;
use insertion::evaluation::tolerance;
use insertion::trial::{Driven, State};
use nalgebra::Vector3;
use std::sync::atomic::AtomicBool;

/// Returns the error for an engine that cannot be stepped by the caller.
pub(crate) fn undriven() -> Failure {
    Failure::usage("this engine has no driven simulation; use --engine direct")
}

/// Grasped part in front of its socket, commanded step by step.
pub struct Insertion {
    driven: Driven,
    /// Shift of the taught start along y, m.
    taught: f64,
}

impl Insertion {
    /// Grasps the part of the task with this finger, in front of its socket.
    ///
    /// # Errors
    /// If task, robot and finger cannot be simulated, or the engine has no driven simulation; if `stop` is
    /// set meanwhile.
    pub fn new(
        setup: &SetupRequest,
        finger: &FingerRequest,
        stop: &AtomicBool,
    ) -> Result<Self, Failure> {
        let setup = setup.setup()?;
        let scenario = finger.choose(&setup)?.scenario;
        let taught = setup.evaluator.taught(&scenario, stop)?;
        let rig = setup.evaluator.rig(&scenario, None, 1.0)?;
        let driven = rig.driven(&scenario.finger).ok_or_else(undriven)?;
        not_stopped(stop)?;
        Ok(Insertion { driven, taught: taught.map_or(0.0, tolerance::offset) })
    }

    /// Restarts with the start shifted along y, mm.
    pub fn start(&mut self, offset_mm: f64) -> State {
        self.driven.start(self.taught + offset_mm * MM)
    }

    /// Commands a velocity of the TCP, mm/s, for one control step.
    pub fn step(&mut self, velocity_mm_per_s: [f64; 3]) -> State {
        self.driven.step(Vector3::from(velocity_mm_per_s) * MM)
    }
}
