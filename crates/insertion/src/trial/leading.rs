//! Whether a search has found the socket: the edge that leads into the opening.

use super::classify::within;
use crate::task::Task;
use contact::scene::Pose;
use input::units::MM;
use nalgebra::Point3;

/// The leading edge is inside when it is this far below the socket's top, m:
/// more than contacts sink, less than any preload.
const DEPTH: f64 = 0.15 * MM;
/// An edge that leans on a wall is inside, m: more than contacts sink, less than any clearance
/// that a finger could feel.
const LEANING: f64 = 0.02 * MM;

/// The corners of the part of a plug that goes in.
#[derive(Debug, Clone)]
pub(super) struct LeadingEdge {
    /// Plug frame: z from the tip.
    corners: Vec<Point3<f64>>,
    opening: [[f64; 2]; 2],
}

impl LeadingEdge {
    /// Of a task's plug.
    pub fn new(task: &Task) -> Self {
        // A latch gives way, and leads nothing.
        let corners = task.plug.rigid().flat_map(|part| part.solid.corners());
        LeadingEdge {
            corners: corners.filter(|corner| corner.z < task.success.depth).collect(),
            opening: task.opening.map(|[from, to]| [from - LEANING, to + LEANING]),
        }
    }

    /// Whether it is inside the opening: its lowest corner is below the top, and no corner on the side
    /// of the plug that leans down stands over the housing; `plug` is the plug's pose in the task frame.
    pub fn inside(&self, plug: &Pose) -> bool {
        // Towards where the plug leans up, in its own frame.
        let up = plug.inverse_transform_vector(&nalgebra::Vector3::z());
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
        lowest < -DEPTH
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::TASKS;
    use input::units::DEG;

    fn inside(name: &str, at_mm: [f64; 3], tilt_deg: f64) -> bool {
        let shipped = TASKS.iter().find(|shipped| shipped.name == name).unwrap();
        let task = Task::parse(shipped.text, shipped.file).unwrap();
        let tilt =
            nalgebra::UnitQuaternion::from_axis_angle(&nalgebra::Vector3::x_axis(), tilt_deg * DEG);
        let [x, y, z] = at_mm.map(|mm| mm * MM);
        LeadingEdge::new(&task)
            .inside(&Pose::from_parts(nalgebra::Translation3::new(x, y, z), tilt))
    }

    #[test]
    fn an_edge_over_the_housing_is_not_inside_though_its_latch_is_lower() {
        // Plug and cavity of rj45 are 7 mm wide in x, the plug 0.5 mm off their middle.
        assert!(inside("rj45", [-0.5, 0.0, 0.0], 10.0));
        assert!(!inside("rj45", [2.0, 0.0, -0.1], 10.0));
        // High over the opening.
        assert!(!inside("rj45", [-0.5, 0.0, 2.0], 10.0));
    }

    #[test]
    fn the_trailing_side_may_stand_over_the_housing() {
        assert!(inside("ket8", [0.0, 1.0, 0.0], 10.0));
        assert!(!inside("ket8", [0.0, 20.0, 0.0], 10.0));
        assert!(!inside("ket8", [0.0, -20.0, 0.0], 10.0));
    }
}
