//! Checks of the commanded moves: free approach, search over the opening, deep enough push.

use super::{Problem, TaskBodies, mm, range};
use crate::body::{Overlap, span, width};
use crate::seat::{self, Waypoint, section};
use input::units::MM;
use insertion::{Ending, Phase, Stage};
use nalgebra::{Translation3, Vector3};

/// Overlap that counts as rounding, m.
const ROUNDING: f64 = 0.01 * MM;
/// Step of the collision check along the approach, m.
const STEP: f64 = 0.5 * MM;
/// Recommended clear height of the tip at the end of the approach, m.
const AIR: f64 = 1.0 * MM;
/// Recommended distance of the commanded end of the push beyond the success depth, m.
const PRESS: f64 = 4.0 * MM;

pub(super) fn problems(case: &TaskBodies) -> Vec<Problem> {
    let way = seat::waypoints(case.task, &case.plug);
    let mut found: Vec<Problem> = case.task.strategy.phases.iter().filter_map(upward).collect();
    found.extend(collisions(case, &way).or_else(|| enclosed(case, &way)));
    // The other checks are meaningless for moves that go up.
    if found.is_empty() {
        found.extend(way.iter().filter_map(short_touch));
        found.extend(too_shallow(case, &way));
        found.extend(missed_opening(case, &way));
    }
    found
}

fn key(name: &str) -> String {
    format!("strategy.phase \"{name}\" move_mm")
}

/// Checks that a touch or push goes down.
fn upward(phase: &Phase) -> Option<Problem> {
    let z = phase.displacement[2];
    let touch = matches!(phase.ending, Ending::Touch { .. });
    if z < 0.0 || !(touch || phase.stage == Stage::Assembly) {
        return None;
    }
    let motion = if touch { "a touch" } else { "the push" };
    let direction = if z > 0.0 { "goes up" } else { "does not go down" };
    let (z, down) = (mm(z), mm(-z.abs().max(MM)));
    Some(Problem::new(
        key(&phase.name),
        format!("z is {z} mm: {motion} {direction}"),
        format!("z points out of the socket: give a negative number, as in {down}"),
    ))
}

/// Checks for collisions at the start and on the approach.
fn collisions(case: &TaskBodies, way: &[Waypoint]) -> Option<Problem> {
    let collision = |tcp: Vector3<f64>| {
        let pose = seat::plug_pose(case.task, tcp);
        let Overlap { depth, parts: [plug, socket], .. } =
            case.plug.overlap(&pose, &case.socket)?;
        let names = [&case.plug.parts[plug].name, &case.socket.parts[socket].name];
        (depth > ROUNDING).then_some((depth, names))
    };
    if let Some((depth, [plug, socket])) = collision(way[0].tcp) {
        let correct = way[0].tcp.z + 5.0 * MM - way[0].edge.z;
        return Some(Problem::new(
            "strategy.start_mm",
            format!("at the start `{plug}` is {} mm deep in `{socket}`", mm(depth)),
            format!("z = {} mm: 5 mm of air below the tip", mm(correct)),
        ));
    }
    for pair in way.windows(2).take_while(|pair| pair[1].stage == Stage::Approach) {
        let by = pair[1].tcp - pair[0].tcp;
        let steps = (by.norm() / STEP).ceil();
        for i in 1..=steps as usize {
            let at = pair[0].tcp + by * (i as f64 / steps);
            let Some((_, [plug, socket])) = collision(at) else { continue };
            let (air, z) = (mm(AIR), mm(by.z + AIR - pair[1].edge.z));
            return Some(Problem::new(
                key(&pair[1].name),
                format!("on the way `{plug}` runs into `{socket}`"),
                format!(
                    "an approach touches nothing: let the tip end about {air} mm above the top, z = {z}"
                ),
            ));
        }
    }
    None
}

/// Checks that the approach ends outside of the socket, which a shifted trial moves aside.
fn enclosed(case: &TaskBodies, way: &[Waypoint]) -> Option<Problem> {
    let last = way.iter().rfind(|point| point.stage == Stage::Approach)?;
    let pose = seat::plug_pose(case.task, last.tcp);
    let [bottom, _] = case.plug.extent(2);
    let half = section(&case.plug, bottom + AIR).map(|range| width(range) / 2.0);
    let blocked = |by: Vector3<f64>| {
        let overlap = case.plug.overlap(&(Translation3::from(by) * pose), &case.socket);
        overlap.is_some_and(|overlap| overlap.depth > ROUNDING)
    };
    let sides = [-1.0, 1.0].map(|sign| [0, 1].map(|i| Vector3::ith(i, sign * half[i])));
    if !sides.into_iter().flatten().all(blocked) {
        return None;
    }
    let (z, [_, top]) = (last.edge.z, case.socket.extent(2));
    let correct = way[0].tcp.z + top.max(0.0) + AIR - z;
    Some(Problem::new(
        "strategy.start_mm",
        format!("`{}` ends inside of the socket, with the tip at z = {} mm", last.name, mm(z)),
        format!("z = {} mm at least: the trial begins above the socket", mm(correct)),
    ))
}

/// Checks that the stroke of a touch reaches the socket.
fn short_touch(point: &Waypoint) -> Option<Problem> {
    let by = point.short_by?;
    Some(Problem::new(
        key(&point.name),
        format!("the stroke ends {} mm above the socket", mm(by)),
        format!("at least {} mm longer: the move stops at the first contact", mm(by + AIR)),
    ))
}

/// Checks that the moves reach the success depth.
fn too_shallow(case: &TaskBodies, way: &[Waypoint]) -> Option<Problem> {
    // Depth of the tip of an upright plug at the end of the path; a touch stops its body, behind a nose.
    let depth = way.last().map_or(0.0, |last| case.task.grip.tcp_z - last.tcp.z) + case.nose();
    let missing = case.task.success.depth - depth;
    let last = case.task.strategy.phases.last().filter(|_| missing > 0.0)?;
    let z = mm(last.displacement[2] - missing - PRESS);
    let [depth, required] = [depth, case.task.success.depth].map(mm);
    Some(Problem::new(
        key(&last.name),
        format!("all moves together bring the tip {depth} mm deep; success requires {required} mm"),
        format!("z = {z} mm: a few mm more than needed, since the springs yield"),
    ))
}

/// Checks that the search passes over the opening.
fn missed_opening(case: &TaskBodies, way: &[Waypoint]) -> Option<Problem> {
    let [bottom, _] = case.plug.extent(2);
    let tip = section(&case.plug, bottom + AIR);
    let first = way.iter().position(|point| point.stage != Stage::Approach).unwrap_or(0);
    let search: Vec<_> =
        way[first.max(1) - 1..].iter().filter(|point| point.stage != Stage::Assembly).collect();
    let [x, y] = case.task.opening;
    let over = span(search.iter().map(|point| point.tcp.x));
    let fits = [x[0] - tip[0][0], x[1] - tip[0][1]];
    let fits = [fits[0].min(fits[1]), fits[0].max(fits[1])];
    let low = span(search.iter().map(|point| point.edge.y));
    let middle = |[low, high]: [f64; 2]| (low + high) / 2.0;
    // The search begins with the lower edge over the middle.
    let axes = [
        ("the plug", over, fits, middle(over)),
        ("the tip's lower edge", low, y, search.first()?.edge.y),
    ];
    let (axis, (body, moved, open, at)) = axes
        .into_iter()
        .enumerate()
        .find(|(_, (_, moved, open, _))| moved[1] < open[0] || moved[0] > open[1])?;
    let name = ["x", "y"][axis];
    let correct = mm(way[0].tcp[axis] + middle(open) - at);
    let [moved, open] = [moved, open].map(range);
    Some(Problem::new(
        "strategy.start_mm",
        format!("the search moves {body} {moved} in {name}; it is over the opening only {open}"),
        format!("{name} = {correct} mm, or other moves: the search must pass over the opening"),
    ))
}
