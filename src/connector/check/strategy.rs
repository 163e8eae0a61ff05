//! The commanded moves: free of the socket at first, over the opening later, deep enough at last.

use super::{Case, Problem, mm, pair};
use crate::connector::body::span;
use crate::connector::path::{self, Waypoint};
use crate::connector::seat::section;
use contact::scene::Pose;
use input::units::MM;
use insertion::task::{Ending, Phase, Stage};
use nalgebra::Vector3;

/// Overlap that is rounding, m.
const ROUNDING: f64 = 0.01 * MM;
/// How finely the approach is looked through, m.
const STEP: f64 = 0.5 * MM;
/// How far above the socket the tip should be when the approach ends, m.
const AIR: f64 = 1.0 * MM;
/// How far beyond the success depth the push should be commanded, m.
const PRESS: f64 = 4.0 * MM;

pub(super) fn problems(case: &Case) -> Vec<Problem> {
    let way = path::waypoints(case.task, &case.plug);
    let mut found: Vec<Problem> = case.task.strategy.phases.iter().filter_map(upward).collect();
    if let Some(problem) = inside(case, &way) {
        found.push(problem);
    }
    // Of moves that go up nothing else can be said.
    if found.is_empty() {
        found.extend(way.iter().filter_map(short));
        found.extend(too_shallow(case, &way));
        found.extend(beside(case, &way));
    }
    found
}

fn key(name: &str) -> String {
    format!("strategy.phase \"{name}\" move_mm")
}

/// Touch and push go down.
fn upward(phase: &Phase) -> Option<Problem> {
    let z = phase.displacement[2];
    let touch = matches!(phase.ending, Ending::Touch { .. });
    if z < 0.0 || !(touch || phase.stage == Stage::Assembly) {
        return None;
    }
    let what = if touch { "a touch" } else { "the push" };
    let direction = if z > 0.0 { "goes up" } else { "does not go down" };
    Some(Problem::new(
        key(&phase.name),
        format!("z is {} mm: {what} {direction}", mm(z)),
        format!(
            "z points out of the socket: give a negative number, as in {}",
            mm(-z.abs().max(MM))
        ),
    ))
}

/// Until the touch the plug must be free.
fn inside(case: &Case, way: &[Waypoint]) -> Option<Problem> {
    let depth_at = |tcp: Vector3<f64>| {
        let pose = path::plug_pose(case.task, tcp);
        case.plug.overlap(&pose, &case.socket, &Pose::identity()).filter(|o| o.depth > ROUNDING)
    };
    let names =
        |parts: [usize; 2]| [&case.plug.parts[parts[0]].name, &case.socket.parts[parts[1]].name];
    if let Some(overlap) = depth_at(way[0].tcp) {
        let [plug, socket] = names(overlap.parts);
        let right = way[0].tcp.z + 5.0 * MM - way[0].edge.z;
        return Some(Problem::new(
            "strategy.start_mm",
            format!("at the start `{plug}` lies {} mm deep in `{socket}`", mm(overlap.depth)),
            format!("z = {} mm: 5 mm of air below the tip", mm(right)),
        ));
    }
    for pair in way.windows(2).take_while(|pair| pair[1].stage == Stage::Approach) {
        let by = pair[1].tcp - pair[0].tcp;
        let steps = (by.norm() / STEP).ceil();
        for i in 1..=steps as usize {
            let Some(overlap) = depth_at(pair[0].tcp + by * (i as f64 / steps)) else { continue };
            let [plug, socket] = names(overlap.parts);
            return Some(Problem::new(
                key(&pair[1].name),
                format!("on the way `{plug}` runs into `{socket}`"),
                format!(
                    "an approach touches nothing: let the tip end about {} mm above the top, z = {}",
                    mm(AIR),
                    mm(by.z + AIR - pair[1].edge.z)
                ),
            ));
        }
    }
    None
}

/// A touch that ends in the air.
fn short(point: &Waypoint) -> Option<Problem> {
    let by = point.short_by?;
    Some(Problem::new(
        key(&point.name),
        format!("the stroke ends {} mm above the socket", mm(by)),
        format!("at least {} mm longer: it ends at the first contact anyway", mm(by + AIR)),
    ))
}

/// A push that ends above the depth that counts.
fn too_shallow(case: &Case, way: &[Waypoint]) -> Option<Problem> {
    let depth = path::commanded_depth(case.task, way);
    let missing = case.task.success.depth - depth;
    let last = case.task.strategy.phases.last()?;
    (missing > 0.0).then(|| {
        Problem::new(
            key(&last.name),
            format!(
                "all moves together bring the tip {} mm deep; success asks for {}",
                mm(depth),
                mm(case.task.success.depth)
            ),
            format!(
                "z = {} mm: some mm more than is needed, for the springs give",
                mm(last.displacement[2] - missing - PRESS)
            ),
        )
    })
}

/// The tip must pass over the opening while it searches.
fn beside(case: &Case, way: &[Waypoint]) -> Option<Problem> {
    let [bottom, _] = case.plug.extent(2);
    let tip = section(&case.plug, bottom + AIR);
    let first = way.iter().position(|point| point.stage != Stage::Approach).unwrap_or(0);
    let search: Vec<_> =
        way[first.max(1) - 1..].iter().filter(|point| point.stage != Stage::Assembly).collect();
    let [x, y] = case.task.opening;
    let [left, right] = span(search.iter().map(|point| point.tcp.x));
    let fits = [x[0] - tip[0][0], x[1] - tip[0][1]];
    if right < fits[0].min(fits[1]) || left > fits[0].max(fits[1]) {
        return Some(Problem::new(
            "strategy.start_mm",
            format!(
                "in x the plug is searched at {} mm, but is over its opening at {}",
                pair([left, right]),
                pair(fits)
            ),
            format!("x = {} mm, or longer moves along x", mm((fits[0] + fits[1]) / 2.0)),
        ));
    }
    let [low, high] = span(search.iter().map(|point| point.edge.y));
    if high < y[0] || low > y[1] {
        let right = way[0].tcp.y + (y[0] + y[1]) / 2.0 - way[0].edge.y;
        return Some(Problem::new(
            "strategy.start_mm",
            format!(
                "in y the tip's lower edge is searched at {} mm, but the opening is at {}",
                pair([low, high]),
                pair(y)
            ),
            format!("y = {} mm puts it over the opening's middle", mm(right)),
        ));
    }
    None
}
