//! Checks of the parts of plug and socket: thickness, overlaps, gaps, latch and mass.

use super::units::length;
use super::{Problem, TaskBodies, field, mm, part_key};
use crate::body::{ConvexBody, Overlap, extent, width};
use crate::hold::SEAM;
use contact::scene::Pose;
use input::units::{GRAM, MM};
use insertion::Part;
use insertion::task::geometry;

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
    let key = part_key(body, &part.name, field(&part.solid, axis));
    length(&key, size(axis), [THIN / MM, 1000.0])
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
    let parts = case.plug.parts.iter();
    let sum: f64 = parts.clone().map(|part| geometry::volume(&part.solid)).sum();
    let [low, high] = DENSITIES;
    // Imported parts can be the skin of a solid, which lies within their hull.
    let skin = mass / sum > high && case.task.success.mated.is_some();
    let corners = || -> Vec<_> { parts.flat_map(|part| part.solid.corners()).collect() };
    let hull = if skin { geometry::hull(&corners()) } else { None };
    let hull = hull.map(|(corners, faces)| geometry::surface_moments(&corners, &faces).0);
    let volume = hull.unwrap_or(sum);
    let density = mass / volume;
    if (low..=high).contains(&density) || skin && density < low {
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
