//! Monitors of an attempt: force, grip, and whether the leading edge is inside the opening.

use super::classify::within;
use crate::Task;
use crate::task::geometry::hull;
use contact::scene::Pose;
use input::units::MM;
use nalgebra::{Point3, Vector3};

/// Time constant of the force filter, s, like that of a wrist sensor: the impact within a step is a numerical artefact.
const FORCE_FILTER: f64 = 0.005;
/// Time without contact after which a finger has lost the part, s: longer than a bounce.
const LOSS_TIME: f64 = 0.02;
/// Force below which a finger has no contact, N.
const LOSS_FORCE: f64 = 0.01;

/// Monitor of the filtered force and of the finger contacts.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ContactMonitor {
    /// Filtered force of the socket on the plug, N.
    pub force: Vector3<f64>,
    /// Largest filtered force of the trial, N.
    pub peak_force: f64,
    /// Largest filtered force of the phase, N.
    pub phase_peak: f64,
    /// Whether the leading edge is inside the opening; after the search, whether it was at the end of the search.
    pub entered: bool,
    /// Time for which each finger has had no contact, s.
    loose_for: [f64; 2],
}

impl ContactMonitor {
    /// Updates the filtered force and its peaks by the net force over a step, N.
    pub fn update_force(&mut self, net: &Vector3<f64>, dt: f64) {
        self.force += (net - self.force) * (dt / FORCE_FILTER);
        self.peak_force = self.peak_force.max(self.force.norm());
        self.phase_peak = self.phase_peak.max(self.force.norm());
    }

    /// Updates the contact of each finger by its force on the plug over a step, N.
    pub fn update_fingers(&mut self, forces: [f64; 2], dt: f64) {
        for (force, loose_for) in forces.into_iter().zip(&mut self.loose_for) {
            *loose_for = if force < LOSS_FORCE { *loose_for + dt } else { 0.0 };
        }
    }

    /// Returns whether both fingers have lost the part.
    pub fn dropped(&self) -> bool {
        self.loose_for.iter().all(|&time| time > LOSS_TIME)
    }

    /// Returns whether both fingers hold the part.
    pub fn gripped(&self) -> bool {
        self.loose_for.iter().all(|&time| time <= LOSS_TIME)
    }
}

/// Number of corners above which only those of their hull are checked.
const MAX_CORNERS: usize = 500;
/// Smallest depth at which an edge counts as inside, m: more than contacts penetrate, less than any preload.
const INSIDE_DEPTH: f64 = 0.15 * MM;
/// Largest overlap of an edge with a wall it touches, m: more than contacts penetrate, less than a clearance.
const WALL_OVERLAP: f64 = 0.02 * MM;

/// Corners of a plug that can enter the opening first.
#[derive(Debug, Clone)]
pub(super) struct LeadingEdge {
    /// Corners in the plug frame: z from the tip.
    corners: Vec<Point3<f64>>,
    /// Intervals of x and y in the task frame, m, wider than the opening by `WALL_OVERLAP`.
    opening: [[f64; 2]; 2],
}

impl LeadingEdge {
    pub fn new(task: &Task) -> Self {
        // A latch yields and does not guide the plug.
        let corners = task.plug.rigid().flat_map(|part| part.solid.corners());
        let corners: Vec<_> = corners.filter(|corner| corner.z < task.success.depth).collect();
        // All corners are checked in every step, so many are reduced to those of their hull.
        let reduced = if corners.len() > MAX_CORNERS { hull(&corners) } else { None };
        LeadingEdge {
            corners: reduced.map_or(corners, |(corners, _)| corners),
            opening: task.opening.map(|[from, to]| [from - WALL_OVERLAP, to + WALL_OVERLAP]),
        }
    }

    /// Returns whether the leading edge is inside the opening: its lowest corner is below the top of the socket, and
    /// no corner on the lower side of a tilted plug is above the housing; `plug` is the plug's pose in the task frame.
    pub fn inside(&self, plug: &Pose) -> bool {
        // The x and y components of `up` point to the upper side of the plug.
        let up = plug.inverse_transform_vector(&Vector3::z());
        let leads = |corner: &&Point3<f64>| corner.x * up.x + corner.y * up.y <= 0.0;
        let [x, y] = self.opening;
        let mut lowest = f64::INFINITY;
        for corner in self.corners.iter().filter(leads) {
            let place = plug * corner;
            if !within(place.x, x) || !within(place.y, y) {
                return false;
            }
            lowest = lowest.min(place.z);
        }
        lowest < -INSIDE_DEPTH
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::fixtures::task;
    use input::units::DEG;

    fn inside(name: &str, at_mm: [f64; 3], tilt_deg: f64) -> bool {
        let tilt = Pose::rotation(Vector3::x() * tilt_deg * DEG);
        let [x, y, z] = at_mm.map(|mm| mm * MM);
        LeadingEdge::new(&task(name)).inside(&(Pose::translation(x, y, z) * tilt))
    }

    #[test]
    fn an_edge_over_the_housing_is_not_inside_though_its_latch_is_lower() {
        for (name, at_mm, expected) in [
            // Plug and cavity of rj45 are 7 mm wide in x, the plug 0.5 mm off their middle.
            ("rj45", [-0.5, 0.0, 0.0], true),
            ("rj45", [2.0, 0.0, -0.1], false),
            // High over the opening.
            ("rj45", [-0.5, 0.0, 2.0], false),
            // The trailing side may stand over the housing.
            ("ket8", [0.0, 1.0, 0.0], true),
            ("ket8", [0.0, 20.0, 0.0], false),
            ("ket8", [0.0, -20.0, 0.0], false),
        ] {
            assert_eq!(inside(name, at_mm, 10.0), expected, "{name} {at_mm:?}");
        }
    }
}
