//! Checks of the parts of plug and socket: thickness, overlaps, gaps, latch, mass, and units of lengths.

use super::{Problem, TaskBodies, field, mm, part_key};
use crate::body::{ConvexBody, Overlap, extent, longest_side, width};
use crate::hold::SEAM;
use crate::seat::section;
use contact::scene::Pose;
use input::units::{GRAM, MM};
use insertion::task::{Ending, Part, geometry};
use nalgebra::Vector3;

/// Largest overlap of joined parts, m.
const OVERLAP: f64 = 0.5 * MM;
/// Thickness below which a part has no useful mass or contact surface, m.
const THIN: f64 = 0.01 * MM;
/// Lightest and heaviest material, kg/m3: foam, tungsten.
const DENSITIES: [f64; 2] = [100.0, 20e3];
/// Densities of plastic and steel for advice, kg/m3.
const USUAL: [f64; 2] = [1000.0, 7850.0];

pub(super) fn problems(case: &TaskBodies) -> Vec<Problem> {
    let mut found = Vec::new();
    for (name, body) in [("plug", &case.plug), ("socket", &case.socket)] {
        found.extend(body.parts.iter().filter_map(|part| thin(name, part)));
        found.extend(overlaps(name, body));
    }
    found.extend(gaps(&case.plug));
    found.extend(flexure(case));
    found
}

fn thin(body: &str, part: &Part) -> Option<Problem> {
    let corners = part.solid.corners();
    let size = |axis: usize| width(extent(&corners, axis));
    let axis = (0..3).find(|&axis| size(axis) < THIN)?;
    Some(Problem::new(
        part_key(body, &part.name, field(&part.solid, axis)),
        format!("the part is {:.4} mm thick: it has no mass", size(axis) / MM),
        "give it a thickness, or leave it out",
    ))
}

fn overlaps(name: &str, body: &ConvexBody) -> Vec<Problem> {
    let here = Pose::identity();
    let own = body.overlaps(&here, body).filter(|found| found.parts[0] < found.parts[1]);
    let deep = own.filter(|found| found.depth > OVERLAP);
    deep.map(|Overlap { depth, parts, .. }| {
        let [i, j] = parts.map(|i| &body.parts[i]);
        let counted = if name == "plug" { ": its mass is counted twice there" } else { "" };
        Problem::new(
            part_key(name, &i.name, ""),
            format!("is {} mm deep in `{}`{counted}", mm(depth), j.name),
            "let the parts end where they meet; a common face is enough",
        )
    })
    .collect()
}

/// Checks that the flexure of a latch connects a fixed part of the plug to a moving one.
fn flexure(case: &TaskBodies) -> Vec<Problem> {
    let Some(latch) = &case.task.plug.latch else { return Vec::new() };
    let [root, end] = &latch.flexure;
    let ends =
        [(root, false, "root_mm", "is fixed"), (end, true, "end_mm", "moves with the latch")];
    let off = ends.into_iter().filter(|(point, moves, ..)| {
        !case.plug.near(point, SEAM).any(|part| latch.parts.contains(&part) == *moves)
    });
    off.map(|(.., key, motion)| {
        let problem = format!("is not on a part that {motion}");
        let remedy = "put it on the plug's surface, or correct the parts of the latch";
        Problem::new(format!("plug.latch.{key}"), problem, remedy)
    })
    .collect()
}

/// Checks that a plug is one piece: every part is connected to the first.
fn gaps(plug: &ConvexBody) -> Option<Problem> {
    let count = plug.parts.len();
    let mut joined = vec![0];
    loop {
        let touches = |j: usize| joined.iter().any(|&i| plug.own_gap(i, j) <= SEAM);
        let Some(next) = (0..count).find(|j| !joined.contains(j) && touches(*j)) else { break };
        joined.push(next);
    }
    let loose = (0..count).find(|j| !joined.contains(j));
    let problem = |j: usize| {
        let gaps = joined.iter().map(|&i| (plug.own_gap(i, j), i));
        let (gap, i) = gaps.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let (part, near) = (&plug.parts[j], &plug.parts[i]);
        let range = |part: &Part, axis: usize| extent(part.solid.corners(), axis);
        // Returns whether the parts are separated along an axis.
        let apart = |axis: &usize| {
            let ([a, b], [c, d]) = (range(part, *axis), range(near, *axis));
            (c - b).max(a - d) > SEAM / 2.0
        };
        let axis = [2, 1, 0].into_iter().find(apart).unwrap_or(2);
        let ([low, high], near) = (range(near, axis).map(mm), &near.name);
        let axis_name = ["x", "y", "z"][axis];
        Some(Problem::new(
            part_key("plug", &part.name, field(&part.solid, axis)),
            format!("a gap of {} mm to `{near}`: the plug is not one piece", mm(gap)),
            format!("let the parts meet; `{near}` reaches from {low} to {high} mm in {axis_name}"),
        ))
    };
    loose.and_then(problem)
}

pub(super) fn mass(case: &TaskBodies) -> Option<Problem> {
    let mass = case.task.plug.mass;
    let volume: f64 = case.plug.parts.iter().map(|part| geometry::volume(&part.solid)).sum();
    let density = mass / volume;
    let [low, high] = DENSITIES;
    if (low..=high).contains(&density) {
        return None;
    }
    let [plastic, steel] = USUAL.map(|usual| usual * volume / GRAM);
    let than = if density < low { "less than foam" } else { "more than tungsten" };
    let (grams, cm3) = (mass / GRAM, volume * 1e6);
    Some(Problem::new(
        "plug.mass_g",
        format!("{grams} g for {cm3:.2} cm3 is {density:.2} kg/m3, {than}"),
        format!("plausible masses: {plastic:.1} g if of plastic, {steel:.1} g if of steel"),
    ))
}

/// Range of widths between the jaws, mm: that of grippers in assembly cells, with a margin.
pub const FACES_MM: [f64; 2] = [1.0, 100.0];

/// Units mistaken for millimetres, in mm.
const UNITS: [(&str, f64); 4] =
    [("metres", 1000.0), ("inches", 25.4), ("micrometres", 0.001), ("centimetres", 10.0)];

/// Size ratio of plug and opening beyond which one of them must be in another unit.
const OTHER_UNIT: f64 = 8.0;

pub(super) fn lengths(case: &TaskBodies) -> Vec<Problem> {
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
    let of_key = |(key, length, range_mm)| problem(key, length, range_mm);
    let mut found: Vec<Problem> = keys.into_iter().filter_map(of_key).collect();
    // Slabs of a drawn surface may be of any size.
    let bodies = [("plug", &task.plug.parts), ("socket", &task.socket)];
    for (body, parts) in bodies.into_iter().filter(|_| task.success.mated.is_none()) {
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
        found.extend(other_unit(case));
    }
    found
}

/// Checks that a length, m, lies in its range, mm.
fn problem(key: &str, length: f64, [low, high]: [f64; 2]) -> Option<Problem> {
    let value_mm = length / MM;
    if (low..=high).contains(&value_mm) {
        return None;
    }
    let (size, limit) = if value_mm < low { ("less", low) } else { ("more", high) };
    let problem = format!("{value_mm:.4} mm is {size} than the plausible {limit} mm");
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

/// Checks that plug and opening are in the same unit.
fn other_unit(case: &TaskBodies) -> Option<Problem> {
    let section = section(&case.plug, case.task.success.depth);
    let [x, y] = [0, 1].map(|axis| width(section[axis]) / width(case.task.opening[axis]));
    let (ratio, size) = match (x.min(y) > OTHER_UNIT, x.max(y) < 1.0 / OTHER_UNIT) {
        (true, _) => (x.min(y), "larger"),
        (_, true) => (1.0 / x.max(y), "smaller"),
        _ => return None,
    };
    let widths = section.map(|range| mm(width(range))).join(" x ");
    Some(Problem::new(
        "socket.opening_x_mm, socket.opening_y_mm",
        format!("the plug, {widths} mm, is {ratio:.0} times {size} than the opening"),
        "one of the two is not in mm: multiply inches by 25.4, metres by 1000",
    ))
}
