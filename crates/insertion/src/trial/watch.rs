//! Monitors of an attempt: the force of plug and socket, and whether the fingers hold the plug.

use nalgebra::Vector3;

/// Time constant of the force filter, s, as of a wrist sensor: a step's impact is numerics.
const FORCE_FILTER: f64 = 0.005;
/// A finger that is off for this long has let go, s: longer than a bounce.
const LOSS_TIME: f64 = 0.02;
/// A finger that presses with less is off, N.
const LOSS_FORCE: f64 = 0.01;

/// Force and grasp monitors of an attempt.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Watch {
    /// Filtered net force plug-socket, N.
    pub force: Vector3<f64>,
    /// Largest filtered force in the attempt, N.
    pub peak_force: f64,
    /// Largest filtered force in the phase, N.
    pub phase_peak: f64,
    /// Whether the leading edge is inside the opening; as it was when the search ended.
    pub entered: bool,
    /// For how long each finger has been off, s.
    loose_for: [f64; 2],
}

impl Watch {
    /// Takes in the net force plug-socket over a step of `dt` seconds, N.
    pub fn see_force(&mut self, net: &Vector3<f64>, dt: f64) {
        self.force += (net - self.force) * (dt / FORCE_FILTER);
        self.peak_force = self.peak_force.max(self.force.norm());
        self.phase_peak = self.phase_peak.max(self.force.norm());
    }

    /// Takes in what each finger presses the plug with over a step, N.
    pub fn see_fingers(&mut self, pressed: [f64; 2], dt: f64) {
        for (pressed, loose_for) in pressed.into_iter().zip(&mut self.loose_for) {
            *loose_for = if pressed < LOSS_FORCE { *loose_for + dt } else { 0.0 };
        }
    }

    /// Whether both fingers have let go.
    pub fn dropped(&self) -> bool {
        self.loose_for.iter().all(|&time| time > LOSS_TIME)
    }

    /// Whether neither finger has let go.
    pub fn gripped(&self) -> bool {
        self.loose_for.iter().all(|&time| time <= LOSS_TIME)
    }
}
