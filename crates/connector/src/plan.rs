//! Grasp point, strategy and success criterion of a task, derived from the shapes of plug and socket.
//!
//! The strategy is the paper's: the tilted plug is set down beside the opening, its lower edge over the middle of the
//! opening in y; it moves along x to the sides of the opening, along -y to the wall, and is pushed in. This module
//! derives the length of each move. The over-strokes and the tilt were chosen by trying plugs of 3 to 35 mm: see
//! `docs/guide/tasks.md`. A round tip touches down with a point, which must be near the wall before it is pressed, or
//! the plug tips over: it has its own `Moves`.

use super::body::{ConvexBody, extent, width};
use super::hold::pad_contacts;
use super::seat::{self, Seat, TaskBodies, section};
use input::shipped::TASKS;
use input::units::{DEG, MM};
use insertion::task::{Mated, Success, TouchDetection};
use insertion::{Ending, Pad, Part, Phase, Solid, Stage, StartRule, Strategy, Task};

/// Distance of the TCP below the shoulder, m, as in the shipped tasks.
const BELOW_SHOULDER: f64 = 3.5 * MM;
/// Height of a tilted tip's upper edge above its lower one, m.
const RISE: f64 = 0.35 * MM;
/// Smallest and largest usual tilt, degrees.
pub const TILT_DEG: [f64; 2] = [5.0, 10.0];
/// Clear height above the socket at the start and after the approach, m.
const AIR: [f64; 2] = [5.0 * MM, 1.0 * MM];
/// Longest stroke of the touch, m.
const TOUCH: f64 = 3.0 * MM;
/// Overlap of the tip with the rim at -x when it is set down, m; at most a quarter of the tip.
const BESIDE: f64 = 1.0 * MM;
/// Over-stroke of the moves along x after the tip has met a wall, m: there and back.
const ACROSS: [f64; 2] = [0.8 * MM, 0.45 * MM];
/// Move of a round tip to either side in x, m.
const ROUND_ACROSS: f64 = 0.5 * MM;
/// Distance of the lowest point of the tip from the middle of a round opening at the start, as a share of its radius.
const ROUND_AHEAD: f64 = 0.75;
/// Amplitude of the sweep of an upright plug over its seat, m: the margin that a strategy should have.
const SWEEP: f64 = 1.0 * MM;
/// Commanded depth below the first contact during the sweep, m.
const SWEPT_PRELOAD: f64 = 0.15 * MM;
/// Commanded depth of the push below the seat, m, and its speed, m/s.
const PUSH: [f64; 2] = [4.0 * MM, 100.0 * MM];
/// Tilt that counts as upright beyond that which the play allows, degrees.
const UPRIGHT_DEG: f64 = 2.0;
/// Smallest and largest limit of the tilt of an upright plug, degrees; the largest is that of the shipped tasks.
const TILT_LIMIT_DEG: [f64; 2] = [3.0, 8.0];
/// Distance of the success depth above the seat, besides that for a tilt: m, and a share of the full depth.
const MISSING: (f64, f64) = (0.2 * MM, 0.02);
/// Share of the full depth at which the play is measured.
const WITHIN: f64 = 0.9;
/// Smallest depth at which a plug counts as entered, m.
const MIN_DEPTH: f64 = 1.0 * MM;
/// Allowance for the lateral place of a mated plug beyond its play, m.
const ASIDE: f64 = 0.1 * MM;
/// Distance below the top at which the opening of a mated plug is measured, m.
pub(crate) const BELOW_TOP: f64 = 0.1 * MM;

/// Returns the task with grasp point, strategy and success derived from shapes, opening, shoulder and faces.
///
/// # Errors
/// If the plug does not enter, or falls through the socket.
pub fn complete(task: &Task) -> Result<Task, String> {
    let bodies = TaskBodies::new(task);
    let seat = bodies.deepest();
    let no_floor =
        "the plug falls through its socket: give the socket a floor, or the plug a shoulder";
    let [by, on] = seat.stopped_by.ok_or(no_floor)?;
    if seat.depth < MIN_DEPTH {
        return Err(format!(
            "the plug does not go into the socket: upright it stops {:.2} mm below the top, \
             where `{}` meets `{}`; make the opening wider or the plug smaller",
            seat.depth / MM,
            task.plug.parts[by].name,
            task.socket[on].name
        ));
    }
    let task = planned(&bodies, &seat);
    let height = |part: &&Part| extent(part.solid.corners(), 2)[0];
    let lowest = bodies.plug.parts.iter().min_by(|a, b| height(a).total_cmp(&height(b)));
    let family = match lowest.map(|part| &part.solid) {
        Some(Solid::Cylinder { .. }) => Family::Peg,
        _ => Family::Key,
    };
    Ok(Task { strategy: family.strategy(&task, &bodies.plug, seat.depth), ..task })
}

/// Returns the task with grasp point, strategy and success derived from shapes, opening, shoulder, faces and the mated
/// pose: a depth on the axis, m, the length of the plug's nose, which enters without being guided, m, and a play in x and
/// in y, m.
pub fn mated(mut task: Task, depth: f64, nose: f64, play: [f64; 2]) -> Task {
    let lateral = libm::hypot(play[0], play[1]) / 2.0 + ASIDE;
    task.success.mated = Some(Mated { tip: [0.0, 0.0, -depth], lateral });
    let bodies = TaskBodies::new(&task);
    let task = planned(&bodies, &bodies.deepest());
    // Walls about a recess or a lead-in are above z = 0.
    let top = bodies.socket.extent(2)[1].max(0.0);
    Task { strategy: straight(&task, [top, nose], depth), ..task }
}

/// Returns the task with grasp point and success.
fn planned(bodies: &TaskBodies, seat: &Seat) -> Task {
    let (mut task, plug) = (bodies.task.clone(), &bodies.plug);
    let pads = pad_contacts(plug, task.grip.shoulder_z, Some(task.grip.faces_y));
    let cover = pads.cover[0].min(pads.cover[1]);
    task.grip.tcp_z = round_mm(task.grip.shoulder_z - BELOW_SHOULDER.min(0.8 * cover));
    task.grip.slip_limit = round_mm((Pad::PUBLISHED.height / 2.0).min(0.9 * cover));
    let play = match task.success.mated {
        // The opening is the plug with its play, whatever springs were left out.
        Some(_) => width(task.opening[1]) - width(section(plug, seat.depth - BELOW_TOP)[1]),
        None => bodies.play(WITHIN * seat.depth, seat.at, 1),
    };
    success(&mut task, plug, seat, play);
    task
}

/// Returns a strategy that sets the plug down upright over its seat, at this depth, m, sweeps it along y until it drops
/// in, and pushes; it starts above the top of the socket, m, and the nose, m, enters before the plug touches. Drawn connectors have a lead-in, and pins and tongues that a tilted plug would meet first.
fn straight(task: &Task, [top, nose]: [f64; 2], depth: f64) -> Strategy {
    let start = [0.0, 0.0, task.grip.tcp_z + top + AIR[0]].map(round_mm);
    // Of a plug with a nose, the body behind it touches.
    let push = depth + PUSH[0] - nose - SWEPT_PRELOAD;
    use {Ending::*, Stage::*};
    let touch = Touch { preload: SWEPT_PRELOAD, detection: TouchDetection::FIRST };
    let phases = vec![
        phase("approach", Approach, [0.0, 0.0, AIR[1] - AIR[0]], 150.0, Tolerance(0.1 * MM)),
        phase("touch", Search, [0.0, 0.0, -(TOUCH + top + nose)], 20.0, touch),
        phase("back", Search, [0.0, SWEEP, 0.0], 40.0, Duration(0.01)),
        phase("front", Search, [0.0, -2.0 * SWEEP, 0.0], 40.0, Duration(0.01)),
        phase("middle", Search, [0.0, SWEEP, 0.0], 40.0, Duration(0.01)),
        phase("assembly", Assembly, [0.0, 0.0, -push], PUSH[1] / MM, Duration(0.03)),
    ];
    Strategy { tilt: 0.0, start, rule: StartRule::Given, phases }
}

/// Returns whether the socket stands inside the mated plug, as pins, a post or a tongue do.
pub fn has_core(task: &Task) -> bool {
    let Some(mated) = &task.success.mated else { return false };
    let middle = task.opening.map(|[low, high]| {
        let quarter = (high - low) / 4.0;
        [low + quarter, high - quarter]
    });
    task.socket.iter().any(|part| {
        let corners = part.solid.corners();
        let inside = |axis: usize| {
            let [low, high] = extent(&corners, axis);
            low < middle[axis][1] && middle[axis][0] < high
        };
        extent(&corners, 2)[1] > mated.tip[2] + MIN_DEPTH && inside(0) && inside(1)
    })
}

/// Family of connectors for which a search strategy is known.
#[derive(Debug, Clone, PartialEq)]
pub enum Family {
    /// Connectors whose tilted tip touches down with an edge.
    Key,
    /// Connectors whose tilted tip touches down with a point.
    Peg,
    /// Connectors like that of a shipped task.
    Like(Box<Task>),
}

impl Family {
    /// Returns all families.
    pub fn all() -> impl Iterator<Item = Self> {
        let shipped = TASKS.iter().filter_map(|file| Task::parse(file.text, file.file).ok());
        [Family::Key, Family::Peg].into_iter().chain(shipped.map(|task| Family::Like(task.into())))
    }

    /// Returns the name of the family: `like a key`.
    pub fn name(&self) -> String {
        match self {
            Family::Key => "like a key".to_owned(),
            Family::Peg => "like a round peg".to_owned(),
            Family::Like(task) => format!("like {}", task.name),
        }
    }

    /// Returns the family's strategy for the shapes of a task; `None` if its plug does not go in.
    pub fn strategy_for(&self, task: &Task) -> Option<Strategy> {
        let bodies = TaskBodies::new(task);
        let seat = bodies.deepest().depth;
        (seat >= MIN_DEPTH).then(|| self.strategy(task, &bodies.plug, seat))
    }

    /// Returns the strategy for a plug that is stopped at this depth, m.
    fn strategy(&self, task: &Task, plug: &ConvexBody, seat: f64) -> Strategy {
        let tip = tip(plug);
        let rise = (RISE / width(tip[1])).min(1.0);
        let [least, most] = TILT_DEG;
        let tilt = round(libm::asin(rise) / DEG, 0.1).clamp(least, most) * DEG;
        let (search, tilt) = match self {
            Family::Key => (Moves::of_edge(task, tip), tilt),
            Family::Peg => (Moves::of_point(task, tip), tilt),
            Family::Like(other) => (Moves::like(task, tip, other), other.strategy.tilt),
        };
        let rule = StartRule::Given;
        let mut placed = task.clone();
        placed.strategy = Strategy { tilt, start: [0.0; 3], rule, phases: Vec::new() };
        let edge = seat::waypoints(&placed, plug)[0].edge;
        placed.strategy.start =
            [round_mm(search.x), round_mm(search.edge_y - edge.y), round_mm(AIR[0] - edge.z)];
        placed.strategy.phases = phases(&placed, &search, seat);
        placed.strategy
    }
}

/// Returns the extent of the tip in x and in y, m.
fn tip(plug: &ConvexBody) -> [[f64; 2]; 2] {
    section(plug, plug.extent(2)[0] + MIN_DEPTH)
}

/// Maps a coordinate from one interval to another: linearly inside, at the same distance beyond an end outside.
fn mapped(place: f64, [low, high]: [f64; 2], to: [f64; 2]) -> f64 {
    if place <= low || high <= low {
        to[0] + (place - low)
    } else if place >= high {
        to[1] + (place - high)
    } else {
        to[0] + (place - low) / (high - low) * width(to)
    }
}

/// Moves of a search strategy, m.
struct Moves {
    /// x of the plug's axis at the start.
    x: f64,
    /// y of the tip's lowest point at the start.
    edge_y: f64,
    /// Commanded depth below the first contact.
    preload: f64,
    /// Moves along x: back, to the front, and during the move to the side.
    across: [f64; 3],
    /// Descent during the move to the front.
    down: f64,
    /// Length of the move along -y.
    side: f64,
    /// Commanded depth of the push below the seat, and its speed, m/s.
    push: [f64; 2],
}

impl Moves {
    /// Returns the moves of a tip with a lower edge, set down on the rim at -x.
    fn of_edge(task: &Task, tip: [[f64; 2]; 2]) -> Self {
        let [[left, right], [low, high]] = task.opening;
        let play = right - left - width(tip[0]);
        let beside = BESIDE.min(width(tip[0]) / 4.0);
        let front = play + ACROSS[0] + ACROSS[1];
        Moves {
            x: left - tip[0][0] - beside,
            edge_y: (low + high) / 2.0,
            preload: 0.3 * MM,
            across: [beside + play + ACROSS[0], -front, 0.0],
            down: 0.5 * MM,
            side: (high - low) / 2.0 + 1.0 * MM,
            push: PUSH,
        }
    }

    /// Returns the moves of another task, with its places of the tip [`mapped`] from its opening to this one.
    fn like(task: &Task, tip: [[f64; 2]; 2], other: &Task) -> Self {
        let bodies = TaskBodies::new(other);
        let way = seat::waypoints(other, &bodies.plug);
        let free = |task: &Task, tip: [[f64; 2]; 2]| {
            [task.opening[0][0] - tip[0][0], task.opening[0][1] - tip[0][1]]
        };
        let (from, to) = (free(other, self::tip(&bodies.plug)), free(task, tip));
        let search = way.iter().filter(|point| point.stage == Stage::Search);
        let mut x = search.clone().map(|point| mapped(point.tcp.x, from, to));
        let mut y = search.map(|point| mapped(point.edge.y, other.opening[1], task.opening[1]));
        // A small tip overlaps the rim by less.
        let quarter = width(tip[0]) / 4.0;
        let touch = x.next().unwrap_or(0.0).clamp(to[0] - quarter, to[1].max(to[0]) + quarter);
        let [back, front, aside] = [(); 3].map(|()| x.next().unwrap_or(touch));
        let edge_y = y.next().unwrap_or(0.0);
        let preload = other.strategy.phases.iter().find_map(|phase| match phase.ending {
            Ending::Touch { preload, .. } => Some(preload),
            _ => None,
        });
        let search = other.strategy.phases.iter().filter(|phase| phase.stage == Stage::Search);
        let down = search.skip(1).map(|phase| -phase.displacement[2]).sum();
        let seat = bodies.deepest().depth;
        let beyond = way.last().map_or(0.0, |last| other.grip.tcp_z - last.tcp.z - seat);
        // A key that need not reach the floor may be commanded to less than its seat.
        let beyond = beyond.max(PUSH[0]);
        Moves {
            x: touch,
            edge_y,
            preload: preload.unwrap_or(0.3 * MM),
            across: [back - touch, front - back, aside - front],
            down,
            side: edge_y - y.next_back().unwrap_or(edge_y),
            push: [beyond, other.strategy.phases.last().map_or(PUSH[1], |phase| phase.speed)],
        }
    }

    /// Returns the moves of a round tip, whose lowest point is set down near the wall at -y.
    fn of_point(task: &Task, tip: [[f64; 2]; 2]) -> Self {
        let [x, [low, high]] = task.opening;
        let half = (high - low) / 2.0;
        Moves {
            x: (x[0] + x[1] - tip[0][0] - tip[0][1]) / 2.0,
            edge_y: (low + high) / 2.0 - ROUND_AHEAD * half,
            preload: 0.1 * MM,
            across: [ROUND_ACROSS, -2.0 * ROUND_ACROSS, ROUND_ACROSS],
            down: 0.1 * MM,
            side: (1.0 - ROUND_AHEAD) * half + 0.5 * MM,
            push: PUSH,
        }
    }
}

/// Sets depth and tilt of success from the play in y, m.
fn success(task: &mut Task, plug: &ConvexBody, seat: &Seat, play: f64) {
    let upright = libm::atan(play / seat.depth) / DEG + UPRIGHT_DEG;
    let [least, most] = TILT_LIMIT_DEG;
    // A shallow seat may let a plug that is mated by its shape tilt further.
    let most = if task.success.mated.is_none() { most } else { f64::INFINITY };
    let tilt = upright.ceil().clamp(least, most) * DEG;
    // Of a tilted plug, the outer end of the stopping part comes down first.
    let wide = |[part, _]: [usize; 2]| width(extent(plug.parts[part].solid.corners(), 1));
    let half = seat.stopped_by.map_or(0.0, wide) / 2.0;
    let (length, share) = MISSING;
    let depth = seat.depth * (1.0 - share) - half * libm::sin(tilt) - length;
    let depth = (depth.max(seat.depth / 2.0) / (0.1 * MM)).floor() * 0.1 * MM;
    task.success = Success { depth, tilt, mated: task.success.mated };
}

fn phases(task: &Task, search: &Moves, seat: f64) -> Vec<Phase> {
    let Moves { preload, across: [back, front, aside], down, side, push: [press, fast], .. } =
        *search;
    let searched = task.strategy.start[2] - AIR[0] - preload - down;
    let push = searched - (task.grip.tcp_z - seat - press);
    use {Ending::*, Stage::*};
    let touch = Touch { preload, detection: TouchDetection::FIRST };
    vec![
        phase("approach", Approach, [0.0, 0.0, AIR[1] - AIR[0]], 150.0, Tolerance(0.1 * MM)),
        phase("touch", Search, [0.0, 0.0, -TOUCH], 20.0, touch),
        phase("back", Search, [back, 0.0, 0.0], 80.0, Duration(0.02)),
        phase("front", Search, [front, 0.0, -down], 80.0, Duration(0.03)),
        phase("side", Search, [aside, -side, 0.0], 100.0, Duration(0.03)),
        phase("assembly", Assembly, [0.0, 0.0, -push], fast / MM, Duration(0.03)),
    ]
}

/// Creates a phase of a displacement, m, at a speed, mm/s.
fn phase(name: &str, stage: Stage, by: [f64; 3], speed: f64, ending: Ending) -> Phase {
    let displacement = by.map(round_mm);
    Phase { name: name.to_owned(), stage, displacement, speed: speed * MM, ending }
}

/// Rounds a length to 0.01 mm, as in files.
fn round_mm(length: f64) -> f64 {
    round(length / MM, 0.01) * MM
}

fn round(value: f64, step: f64) -> f64 {
    // Dividing by the inverse keeps two decimals two decimals.
    let per = (1.0 / step).round();
    (value * per).round() / per
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strategy mapped to its own task is unchanged, in y and across x.
    #[test]
    fn a_strategy_mapped_to_its_own_shapes_is_the_same() {
        for family in Family::all() {
            let Family::Like(task) = &family else { continue };
            let mapped = family.strategy_for(task).unwrap();
            let plug = ConvexBody::plug(&task.plug);
            let moved = Task { strategy: mapped, ..(**task).clone() };
            let [before, after] = [&**task, &moved].map(|task| seat::waypoints(task, &plug));
            assert_eq!(before.len(), after.len(), "{}", task.name);
            // From the touch to the push: the approach differs in what it does in the air.
            for (before, after) in before.iter().zip(&after).skip(2) {
                let off = (before.edge - after.edge).xy().norm();
                assert!(off < 0.02 * MM, "{} {}: {before:?} {after:?}", task.name, before.name);
            }
        }
    }
}
