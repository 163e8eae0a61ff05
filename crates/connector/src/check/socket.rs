//! Opening, walls and depth of insertion.

use super::{Problem, TaskBodies, mm, range, widest_key};
use crate::body::width;
use crate::seat::{Seat, section};
use input::units::MM;
use nalgebra::Point3;

/// Depth below the top at which walls are searched for, m.
const BELOW: f64 = 0.1 * MM;
/// Tolerance between a wall and the stated edge, m: allows for small chamfers and polygons that approximate circles.
const TOLERANCE: f64 = 0.15 * MM;
/// Number of positions along a side at which its wall is searched for, because walls can be slanted or round.
const POSITIONS: i32 = 41;
/// Distance from the stated edge up to which a wall is searched for, m.
const REACH: f64 = 5.0 * MM;
/// Step of this search, m.
const STEP: f64 = 0.0025 * MM;
/// Step of the depth at which the wall below a chamfer is searched for, m.
const DEPTH_STEP: f64 = 0.25 * MM;
/// Compression of the contacts, by which the success depth may exceed the depth of the seat, m.
const COMPRESSION: f64 = 0.02 * MM;

/// Depth to which a plug that is too wide may enter a chamfered opening, m.
const ENTERED: f64 = 3.0 * MM;
/// Key of the success depth.
pub(super) const DEPTH_KEY: &str = "success.depth_mm";

/// Checks the sides of the opening and the height of the socket.
pub(super) fn walls(case: &TaskBodies) -> Vec<Problem> {
    let [_, top] = case.socket.extent(2);
    if top < -TOLERANCE {
        return vec![Problem::new(
            "socket.part",
            format!("the socket's highest point is at z = {} mm", mm(top)),
            "put its top at z = 0: all heights are counted from there",
        )];
    }
    let sides = (0..2).flat_map(|axis| (0..2).map(move |end| (axis, end)));
    sides.filter_map(|(axis, end)| side(case, axis, end)).collect()
}

/// Checks one side of the opening: the socket must be solid just outside the middle of the side, and the wall must
/// begin at the stated edge somewhere along the side, just below the top or below a chamfer of at most 45 degrees. The
/// correct value is measured at the middle.
fn side(case: &TaskBodies, axis: usize, end: usize) -> Option<Problem> {
    let opening = case.task.opening;
    let stated = opening[axis][end];
    let outward = [-1.0, 1.0][end];
    let other = 1 - axis;
    let part_at = |at: f64, share: f64, lower: f64| {
        let mut point = Point3::new(0.0, 0.0, -BELOW - lower);
        let [from, to] = opening[other];
        (point[axis], point[other]) = (at, from + share * (to - from));
        case.socket.part_at(&point)
    };
    let part = |at: f64| part_at(at, 0.5, 0.0);
    let solid_at = |beyond: f64, share: f64, lower: f64| {
        part_at(stated + outward * beyond, share, lower).is_some()
    };
    let solid = |beyond: f64| solid_at(beyond, 0.5, 0.0);
    let begins = |lower: f64| {
        let edge = |i: i32| {
            let share = f64::from(2 * i + 1) / f64::from(2 * POSITIONS);
            let free = [0.0, lower].iter().all(|lower| !solid_at(-TOLERANCE, share, *lower));
            free && solid_at(TOLERANCE, share, lower)
        };
        solid(TOLERANCE + lower) && solid_at(TOLERANCE, 0.5, lower) && (0..POSITIONS).any(edge)
    };
    let mut depths = (0..).map(|i| f64::from(i) * DEPTH_STEP).take_while(|lower| *lower < REACH);
    if depths.any(begins) {
        return None;
    }
    let name = ["x", "y"][axis];
    let steps = (REACH / STEP) as usize;
    // Position of the face of the wall: free before it, solid beyond it.
    let face =
        (0..2 * steps).map(|i| i as f64 * STEP - REACH).find(|&at| !solid(at) && solid(at + STEP));
    let (edge, reach) = (mm(stated), mm(REACH));
    let (problem, remedy) = match face {
        Some(at) => {
            let correct = stated + outward * (at + STEP / 2.0);
            let wall = part(correct + outward * STEP).map_or("", |i| &case.socket.parts[i].name);
            let correct = mm(correct);
            (
                format!("is {edge} mm, but `{wall}` begins at {name} = {correct} mm"),
                format!("{correct} mm, or move the wall: the two must agree"),
            )
        }
        None if solid(-TOLERANCE) => (
            format!(
                "the opening is filled with material at {edge} mm: no wall begins within {reach} mm"
            ),
            "state the opening from wall to wall, where the socket is hollow".to_owned(),
        ),
        None => (
            format!("no wall begins at {name} = {edge} mm nor within {reach} mm of it"),
            "state where the walls are, or add the wall as a [[socket.part]]".to_owned(),
        ),
    };
    Some(Problem::new(format!("socket.opening_{name}_mm"), problem, remedy))
}

/// Checks that the plug can reach the success depth.
pub(super) fn depth(case: &TaskBodies, seat: &Seat) -> Vec<Problem> {
    let success = case.task.success.depth;
    if success <= seat.depth + COMPRESSION {
        return Vec::new();
    }
    let wide: Vec<_> = (0..2).filter_map(|axis| too_wide(case, seat, axis)).collect();
    if !wide.is_empty() {
        return wide;
    }
    let by = seat.stopped_by.map_or(String::new(), |[plug, socket]| {
        format!(": `{}` meets `{}`", case.plug.parts[plug].name, case.socket.parts[socket].name)
    });
    let [bottom, top] = case.plug.extent(2);
    let [required, length, stops] = [success, top - bottom, seat.depth.min(top)].map(mm);
    vec![Problem::new(
        DEPTH_KEY,
        format!("is {required} mm; the plug, {length} mm long, stops {stops} mm below the top{by}"),
        format!("at most {:.1} mm; less, if the plug may stay tilted", (0.96 * seat.depth / MM)),
    )]
}

/// Checks that the plug is not wider than the opening over the depth that it must enter.
fn too_wide(case: &TaskBodies, seat: &Seat, axis: usize) -> Option<Problem> {
    // A shoulder that rests on the housing is not meant to go in.
    let depth = case.task.success.depth.min(seat.depth + BELOW);
    let (plug, opening) = (section(&case.plug, depth)[axis], case.task.opening[axis]);
    if width(plug) <= width(opening) || seat.depth > ENTERED.min(case.task.success.depth / 2.0) {
        return None;
    }
    let (name, has, ends) = (["x", "y"][axis], mm(width(opening)), range(opening));
    let wide = mm(width(plug));
    Some(Problem::new(
        widest_key(case, depth, axis)?,
        format!(
            "the plug is {wide} mm wide in {name} where the opening is {has} mm wide ({ends}): it cannot enter"
        ),
        format!("make it narrower than {has} mm, or widen socket.opening_{name}_mm and its walls"),
    ))
}
