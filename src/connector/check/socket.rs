//! Opening, walls, and how deep the plug goes.

use super::{Case, Problem, field, mm, pair, part_key};
use crate::connector::body::{clipped, span};
use crate::connector::seat::{Seat, section};
use input::units::MM;
use nalgebra::Point3;

/// How far below the top the walls are looked for, m.
const BELOW: f64 = 0.1 * MM;
/// What walls and opening may differ by, m: polygons for circles, small chamfers.
const AGREE: f64 = 0.15 * MM;
/// How far from the stated edge the wall is looked for, m, and in what steps.
const LOOK: (f64, f64) = (5.0 * MM, 0.0025 * MM);
/// What success may be deeper than the seat, m: what contacts give.
const GIVE: f64 = 0.02 * MM;

/// Opening against walls, and the frame's height.
pub(super) fn walls(case: &Case) -> Vec<Problem> {
    let [_, top] = case.socket.extent(2);
    if top < -AGREE {
        return vec![Problem::new(
            "socket.part",
            format!("the socket's highest point is at z = {} mm", mm(top)),
            "put its top at z = 0: all heights are counted from there",
        )];
    }
    let sides = (0..2).flat_map(|axis| (0..2).map(move |end| (axis, end)));
    sides.filter_map(|(axis, end)| side(case, axis, end)).collect()
}

/// One side of the opening: solid just outside of it, free just inside, halfway along.
fn side(case: &Case, axis: usize, end: usize) -> Option<Problem> {
    let opening = case.task.opening;
    let stated = opening[axis][end];
    let outward = [-1.0, 1.0][end];
    let other = 1 - axis;
    let middle = (opening[other][0] + opening[other][1]) / 2.0;
    let part = |at: f64| {
        let mut point = Point3::new(0.0, 0.0, -BELOW);
        (point[axis], point[other]) = (at, middle);
        case.socket.part_at(&point)
    };
    let solid = |beyond: f64| part(stated + outward * beyond).is_some();
    if solid(AGREE) && !solid(-AGREE) {
        return None;
    }
    let key = ["socket.opening_x_mm", "socket.opening_y_mm"][axis];
    let (far, step) = LOOK;
    let steps = (far / step) as usize;
    // The face: solid beyond it, free before it.
    let face =
        (0..2 * steps).map(|i| i as f64 * step - far).find(|&at| !solid(at) && solid(at + step));
    let name = ["x", "y"][axis];
    Some(match face {
        Some(at) => {
            let right = stated + outward * (at + step / 2.0);
            let wall = part(right + outward * step).map_or("", |i| &case.socket.parts[i].name);
            Problem::new(
                key,
                format!("says {} mm, but `{wall}` begins at {name} = {} mm", mm(stated), mm(right)),
                format!("{} mm, or move the wall: the two must agree", mm(right)),
            )
        }
        None if solid(-AGREE) => Problem::new(
            key,
            format!(
                "at {} mm the opening is filled: no free side within {} mm",
                mm(stated),
                mm(far)
            ),
            "let the opening reach from wall to wall where the socket is hollow",
        ),
        None => Problem::new(
            key,
            format!("no wall begins at {name} = {} mm nor within {} mm of it", mm(stated), mm(far)),
            "state where the walls are, or add the wall as a [[socket.part]]",
        ),
    })
}

/// Success against the opening's width and what stops the plug.
pub(super) fn depth(case: &Case, seat: &Seat) -> Vec<Problem> {
    let success = case.task.success.depth;
    if success <= seat.depth + GIVE {
        return Vec::new();
    }
    let wide: Vec<_> = (0..2).filter_map(|axis| wide(case, seat, axis)).collect();
    if !wide.is_empty() {
        return wide;
    }
    let by = seat.stopped_by.map(|[plug, socket]| {
        format!(": `{}` meets `{}`", case.plug.parts[plug].name, case.socket.parts[socket].name)
    });
    let [_, top] = case.plug.extent(2);
    vec![Problem::new(
        "success.depth_mm",
        format!(
            "is {} mm, but the plug stops {} mm below the top{}",
            mm(success),
            mm(seat.depth.min(top)),
            by.unwrap_or_default()
        ),
        format!("at most {:.1} mm; less, if the plug may stay tilted", (0.96 * seat.depth / MM)),
    )]
}

/// Whether what must be inside for success is wider than the opening, and the part that is.
fn wide(case: &Case, seat: &Seat, axis: usize) -> Option<Problem> {
    // A shoulder that rests on the housing is not meant to go in.
    let depth = case.task.success.depth.min(seat.depth + BELOW);
    let [from, to] = section(&case.plug, depth)[axis];
    let [low, high] = case.task.opening[axis];
    if to - from <= high - low || seat.depth > case.task.success.depth / 2.0 {
        return None;
    }
    let width = |part: &insertion::task::Part| {
        let below = clipped(&part.solid.corners(), 2, [f64::NEG_INFINITY, depth]);
        let [from, to] = span(below.iter().map(|p| p[axis]));
        to - from
    };
    let part = case.plug.parts.iter().max_by(|a, b| width(a).total_cmp(&width(b)))?;
    let name = ["x", "y"][axis];
    Some(Problem::new(
        part_key("plug", &part.name, field(&part.solid, axis)),
        format!(
            "the plug is {} mm wide in {name} where the opening has {} mm ({}): it cannot enter",
            mm(to - from),
            mm(high - low),
            pair(case.task.opening[axis])
        ),
        format!(
            "make it narrower than {} mm, or widen socket.opening_{name}_mm and its walls",
            mm(high - low)
        ),
    ))
}
