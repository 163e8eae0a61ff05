//! Conditions of a trial: deviations of socket, start, friction and grasp from the task file.

use super::cell::WorkCell;
use crate::finger::ROOF_GAP;
use crate::task::PadTorsion;
use crate::task::geometry::other_axes;
use crate::{Pad, Part, Solid, Task};
use contact::scene::Pose;
use nalgebra::Vector3;

/// Deviations of a trial from the task file; SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// Rotation of the socket about z through the middle of its opening, rad.
    pub yaw: f64,
    /// Shift of the start along x, m.
    pub start_across: f64,
    /// Rotation of the start about x, in addition to the tilt of the search strategy, rad.
    pub start_tilt: f64,
    /// Factor on the friction between finger and plug.
    pub friction_finger: f64,
    /// Factor on the friction between plug and socket.
    pub friction_socket: f64,
    /// Increase of the width of the opening in x and in y, m.
    pub clearance: f64,
    /// Displacement of the part in the gripper along x, m.
    pub grasp_across: f64,
    /// Downward shift of the part in the gripper, m; it leaves a gap between the part's shoulder and the finger's roof.
    pub grasp_low: f64,
}

impl Conditions {
    /// Conditions of the task file.
    pub const NOMINAL: Conditions = Conditions {
        yaw: 0.0,
        start_across: 0.0,
        start_tilt: 0.0,
        friction_finger: 1.0,
        friction_socket: 1.0,
        clearance: 0.0,
        grasp_across: 0.0,
        grasp_low: 0.0,
    };

    /// Returns the task under these conditions, except the displacement in the grasp (see [`displace`](Self::displace))
    /// and yaw and shift of the start, which the trial applies.
    pub fn task(&self, nominal: &Task) -> Task {
        let mut task = nominal.clone();
        task.strategy.tilt += self.start_tilt;
        task.friction.finger_plug *= self.friction_finger;
        if let PadTorsion::Points(moment) = &mut task.friction.finger_torsion {
            *moment *= self.friction_finger;
        }
        task.friction.plug_socket *= self.friction_socket;
        // Plug parts that reach above the lower edge of the pads touch the finger, and keep their friction.
        let pads = task.grip.shoulder_z + ROOF_GAP - Pad::PUBLISHED.height;
        let below = |part: &&mut Part| part.solid.corners().iter().all(|corner| corner.z < pads);
        for part in task.plug.parts.iter_mut().filter(below).chain(&mut task.socket) {
            part.friction = part.friction.map(|mu| mu * self.friction_socket);
        }
        let half = self.clearance / 2.0;
        for part in &mut task.socket {
            let [x, y] = nominal.opening.map(|[from, to]| (from + to) / 2.0);
            let by = [(0, x), (1, y)].map(|(axis, middle)| half * side(part, axis, middle));
            part.solid.shift(by);
        }
        task.opening = nominal.opening.map(|[from, to]| [from - half, to + half]);
        task
    }

    /// Displaces the plug, its latch and its stand by the grasp displacement of these conditions.
    pub fn displace(&self, cell: &mut WorkCell) {
        let by = Pose::translation(self.grasp_across, 0.0, -self.grasp_low);
        for body in [cell.plug, cell.stand].into_iter().chain(cell.latch) {
            let pose = &mut cell.scene.bodies[body.0].pose;
            *pose = by * *pose;
        }
    }
}

/// Returns the side of the opening's middle, along an axis, on which a part lies: -1 or +1, or 0 if it lies on both.
fn side(part: &Part, axis: usize, middle: f64) -> f64 {
    let corners = part.solid.corners();
    let along = || corners.iter().map(|corner| corner[axis]);
    match (along().all(|at| at >= middle), along().all(|at| at <= middle)) {
        (true, _) => 1.0,
        (_, true) => -1.0,
        _ => 0.0,
    }
}

impl Solid {
    fn shift(&mut self, [x, y]: [f64; 2]) {
        let moved = |corner: &mut Vector3<f64>| {
            corner.x += x;
            corner.y += y;
        };
        match self {
            Solid::Box { min, max } => [min, max].into_iter().for_each(moved),
            Solid::Cylinder { centre, .. } => *centre = [centre[0] + x, centre[1] + y],
            Solid::Rounded(rounded) => moved(&mut rounded.min),
            Solid::Hull { points } => points.iter_mut().map(|p| &mut p.coords).for_each(moved),
            Solid::Prism { axis, outline, span } => {
                let by = [x, y, 0.0];
                let (first, second) = other_axes(*axis);
                *span = span.map(|at| at + by[*axis]);
                for corner in outline {
                    *corner = [corner[0] + by[first], corner[1] + by[second]];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::fixtures::task;
    use input::shipped::TASKS;
    use input::units::MM;

    fn tasks() -> impl Iterator<Item = Task> {
        TASKS.iter().map(|file| task(file.name))
    }

    #[test]
    fn nominal_conditions_change_nothing() {
        for task in tasks() {
            assert_eq!(Conditions::NOMINAL.task(&task), task);
        }
    }

    /// Free width of the socket along an axis through the middle of its opening, at the top, m.
    fn width(task: &Task, axis: usize) -> f64 {
        let middle = task.opening.map(|[from, to]| (from + to) / 2.0);
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for part in &task.socket {
            let corners = part.solid.corners();
            let along = |axis: usize| corners.iter().map(move |corner| corner[axis]);
            let lowest = |axis| along(axis).fold(f64::INFINITY, f64::min);
            let highest = |axis| along(axis).fold(f64::NEG_INFINITY, f64::max);
            let beside =
                lowest(1 - axis) < middle[1 - axis] && middle[1 - axis] < highest(1 - axis);
            if !beside || highest(2) <= -0.1 * MM {
                continue;
            }
            if highest(axis) <= middle[axis] {
                low = low.max(highest(axis));
            } else if lowest(axis) >= middle[axis] {
                high = high.min(lowest(axis));
            }
        }
        high - low
    }

    #[test]
    fn clearance_widens_every_opening_by_itself() {
        let wider = Conditions { clearance: 0.1 * MM, ..Conditions::NOMINAL };
        for task in tasks() {
            let changed = wider.task(&task);
            for axis in [0, 1] {
                let grown = width(&changed, axis) - width(&task, axis);
                assert!((grown / MM - 0.1).abs() < 1e-9, "{} axis {axis}: {grown}", task.name);
            }
        }
    }

    #[test]
    fn friction_scales_the_latch_and_its_guides_too() {
        let slippery = Conditions { friction_socket: 0.5, ..Conditions::NOMINAL };
        let rj45 = task("rj45");
        let of = |task: &Task| -> Vec<f64> {
            let parts = task.plug.parts.iter().chain(&task.socket);
            let own = parts.filter_map(|part| part.friction);
            own.chain([task.friction.plug_socket]).collect()
        };
        let (before, after) = (of(&rj45), of(&slippery.task(&rj45)));
        assert!(before.len() > 1);
        for (before, after) in before.into_iter().zip(after) {
            assert!((after - before / 2.0).abs() < 1e-15);
        }
    }
}
