//! Checks of the units of a task file: lengths in mm, angles in degrees, forces in N.

use super::{Problem, TaskBodies, part_key, widest_key};
use crate::body::{longest_side, width};
use crate::seat::section;
use input::units::{DEG, MM, mm};
use input::wrong_unit::{self, WrongUnit, remedy};
use insertion::Ending;
use nalgebra::Vector3;

/// Range of widths between the jaws, mm: that of grippers in assembly cells, with a margin.
pub const FACES_MM: [f64; 2] = [1.0, 100.0];

/// Smallest plausible widths of a plug as shares of its opening: in both directions, and in one. Shipped tasks have at
/// least 0.6, a flat pin in a round hole 0.1.
const MIN_SHARE: [f64; 2] = [1.0 / 8.0, 1.0 / 20.0];
/// Largest plausible width of a plug as a share of its opening, in both directions.
const MAX_SHARE: f64 = 8.0;
/// Range of plausible tilts, degrees.
const TILT_DEG: [f64; 2] = [0.5, 15.5];
/// Grip force, and its plausible range, N.
const FORCE: &str = "grip.force_n";
const FORCE_N: [f64; 2] = [0.01, 200.0];

/// Checks lengths and angles for a wrong unit.
pub(super) fn problems(case: &TaskBodies) -> Vec<Problem> {
    let (task, grip) = (case.task, &case.task.grip);
    let keys = [
        ("plug.part", width(case.plug.extent(2)), [8.0, 300.0]),
        ("socket.opening_x_mm", width(task.opening[0]), [0.5, 300.0]),
        ("socket.opening_y_mm", width(task.opening[1]), [0.5, 300.0]),
        ("grip.tcp_z_mm", grip.tcp_z, [3.0, 300.0]),
        ("grip.shoulder_z_mm", grip.shoulder_z, [3.0, 300.0]),
        ("grip.faces_y_mm", width(grip.faces_y), FACES_MM),
        ("grip.slip_limit_mm", grip.slip_limit, [0.2, 30.0]),
        ("strategy.start_mm", Vector3::from(task.strategy.start).norm(), [3.0, 500.0]),
        ("success.depth_mm", task.success.depth, [0.5, 150.0]),
    ];
    let of_key = |(key, value, range_mm)| length(key, value, range_mm);
    let mut found: Vec<Problem> = keys.into_iter().filter_map(of_key).collect();
    // Slabs of a drawn surface may be of any size.
    let bodies = [("plug", &task.plug.parts), ("socket", &task.socket)];
    for (body, parts) in bodies.into_iter().filter(|_| task.success.mated.is_none()) {
        found.extend(parts.iter().filter_map(|part| {
            let largest = longest_side(&part.solid.corners());
            length(&part_key(body, &part.name, ""), largest, [0.3, 1000.0])
        }));
    }
    for phase in &task.strategy.phases {
        let of_phase = |field: &str, value: f64, range_mm: [f64; 2]| {
            length(&format!("strategy.phase \"{}\" {field}", phase.name), value, range_mm)
        };
        let by = Vector3::from(phase.displacement).norm();
        found.extend(of_phase("move_mm", by, [0.05, 200.0]));
        found.extend(of_phase("speed_mm_per_s", phase.speed, [0.2, 2000.0]));
        found.extend(match phase.ending {
            Ending::Tolerance(value) => of_phase("tolerance_mm", value, [0.005, 10.0]),
            Ending::Touch { preload, .. } => of_phase("preload_mm", preload, [0.01, 10.0]),
            Ending::Duration(_) => None,
        });
    }
    // Round numbers are degrees: 0.05, 0.15 and 0.25 rad are no whole degrees, and `task tune` varies a tilt by 0.1.
    for (key, tilt, step) in [
        ("strategy.tilt_deg", task.strategy.tilt, 0.05),
        ("success.tilt_deg", task.success.tilt, 1.0),
    ] {
        found.extend(problem(key, wrong_unit::angle(tilt / DEG, TILT_DEG, step)));
    }
    found.extend(problem(FORCE, wrong_unit::number(FORCE, grip.force, FORCE_N)));
    if found.is_empty() {
        found.extend(other_unit(case));
    }
    found
}

/// Checks that a length, m, or a speed, m/s, lies in its range, mm or mm/s.
pub(super) fn length(key: &str, value: f64, range_mm: [f64; 2]) -> Option<Problem> {
    problem(key, wrong_unit::number(key, value / MM, range_mm))
}

fn problem(key: &str, found: Option<WrongUnit>) -> Option<Problem> {
    found.map(|[problem, remedy]| Problem::new(key, problem, remedy))
}

/// Checks that neither the plug nor the opening is so narrow that it must be in another unit.
fn other_unit(case: &TaskBodies) -> Option<Problem> {
    let depth = case.task.success.depth;
    let [plug, opening] = [section(&case.plug, depth), case.task.opening].map(|of| of.map(width));
    let share = |axis: usize| plug[axis] / opening[axis];
    let axis = usize::from(share(1) < share(0));
    let [both, one] = MIN_SHARE;
    if share(axis) > MAX_SHARE {
        let [plug, opening] = [plug[axis], opening[axis]].map(|width| width / MM);
        let (key, wide) = (format!("socket.opening_{}_mm", ["x", "y"][axis]), mm(plug * MM));
        let problem = format!("is {} mm wide, but the plug is {wide} mm wide", mm(opening * MM));
        return Some(Problem::new(key, problem, remedy(" mm", opening, [plug, plug / both])));
    }
    if share(axis) >= one && share(1 - axis) >= both {
        return None;
    }
    let [plug, opening] = [plug[axis], opening[axis]];
    let remedy = remedy(" mm", plug / MM, [both, 1.0].map(|share| share * opening / MM));
    let ([plug, opening], name) = ([plug, opening].map(mm), ["x", "y"][axis]);
    let problem = format!("is {plug} mm wide in {name}, but the opening is {opening} mm wide");
    Some(Problem::new(widest_key(case, depth, axis)?, problem, remedy))
}
