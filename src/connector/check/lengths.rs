//! Lengths given in another unit than millimetres.

use super::{Case, Problem, mm, part_key};
use crate::connector::body::{longest_side, width};
use crate::connector::seat::section;
use input::units::MM;
use insertion::task::Ending;
use nalgebra::Vector3;

/// Units mistaken for millimetres, in mm.
const UNITS: [(&str, f64); 4] =
    [("metres", 1000.0), ("inches", 25.4), ("micrometres", 0.001), ("centimetres", 10.0)];

/// Ratio of plug and opening beyond which one of them is in another unit.
const OTHER_UNIT: f64 = 8.0;

pub(super) fn problems(case: &Case) -> Vec<Problem> {
    let (task, grip) = (case.task, &case.task.grip);
    let mut found: Vec<Problem> = [
        ("plug.part", width(case.plug.extent(2)), [8.0, 300.0]),
        ("socket.opening_x_mm", width(task.opening[0]), [0.5, 100.0]),
        ("socket.opening_y_mm", width(task.opening[1]), [0.5, 100.0]),
        ("grip.tcp_z_mm", grip.tcp_z, [3.0, 300.0]),
        ("grip.shoulder_z_mm", grip.shoulder_z, [3.0, 300.0]),
        ("grip.faces_y_mm", width(grip.faces_y), [1.0, 100.0]),
        ("grip.slip_limit_mm", grip.slip_limit, [0.2, 30.0]),
        ("strategy.start_mm", Vector3::from(task.strategy.start).norm(), [3.0, 500.0]),
        ("success.depth_mm", task.success.depth, [0.5, 150.0]),
    ]
    .into_iter()
    .filter_map(|(key, length, range_mm)| problem(key, length, range_mm))
    .collect();
    for (body, parts) in [("plug", &task.plug.parts), ("socket", &task.socket)] {
        found.extend(parts.iter().filter_map(|part| {
            let largest = longest_side(&part.solid.corners());
            problem(&part_key(body, &part.name, ""), largest, [0.3, 1000.0])
        }));
    }
    for phase in &task.strategy.phases {
        let of_phase = |field: &str, length: f64, range_mm: [f64; 2]| {
            problem(&format!("strategy.phase \"{}\" {field}", phase.name), length, range_mm)
        };
        let by = Vector3::from(phase.displacement).norm();
        found.extend(of_phase("move_mm", by, [0.05, 200.0]));
        found.extend(of_phase("speed_mm_per_s", phase.speed, [0.5, 2000.0]));
        found.extend(match phase.ending {
            Ending::Tolerance(value) => of_phase("tolerance_mm", value, [0.005, 10.0]),
            Ending::Touch { preload, .. } => of_phase("preload_mm", preload, [0.01, 10.0]),
            Ending::Duration(_) => None,
        });
    }
    if found.is_empty() {
        found.extend(against_opening(case));
    }
    found
}

/// Fault of a length, m, that does not lie in its range, mm.
fn problem(key: &str, length: f64, [low, high]: [f64; 2]) -> Option<Problem> {
    let value_mm = length / MM;
    if (low..=high).contains(&value_mm) {
        return None;
    }
    let (size, limit) = if value_mm < low { ("less", low) } else { ("more", high) };
    let problem = format!("{value_mm:.4} mm are {size} than such a length can be ({limit} mm)");
    let within = |(_, factor): &&(&str, f64)| (low..=high).contains(&(value_mm * factor));
    let remedy = match UNITS.iter().find(within) {
        Some((unit, factor)) => format!(
            "lengths are in mm; if these were {unit}, multiply by {factor}: {:.2} mm",
            value_mm * factor
        ),
        None => format!("between {low} and {high} mm"),
    };
    Some(Problem::new(key, problem, remedy))
}

fn against_opening(case: &Case) -> Option<Problem> {
    let section = section(&case.plug, case.task.success.depth);
    let [x, y] = [0, 1].map(|axis| width(section[axis]) / width(case.task.opening[axis]));
    let (much, what) = match (x.min(y) > OTHER_UNIT, x.max(y) < 1.0 / OTHER_UNIT) {
        (true, _) => (x.min(y), "larger"),
        (_, true) => (1.0 / x.max(y), "smaller"),
        _ => return None,
    };
    let widths = section.map(|range| mm(width(range))).join(" x ");
    Some(Problem::new(
        "socket.opening_x_mm, socket.opening_y_mm",
        format!("the plug, {widths} mm, is {much:.0} times {what} than the opening"),
        "one of the two is not in mm: multiply inches by 25.4, metres by 1000",
    ))
}
