//! Grip point, search moves and success of a plug and a socket whose shapes are known.
//!
//! The strategy is the paper's: down beside the opening with the tip's lower edge in its middle,
//! across it until both its sides were met, along -y to the wall, and in. What is derived here is
//! how far each move goes. The over-strokes and the tilt were chosen by trying plugs of 3 to 35 mm:
//! see `docs/guide/tasks.md`. A round tip comes down with a point, which must be near the wall before it
//! is pressed, or the plug tips over: it has its own `Moves`.

use super::body::ConvexBody;
use super::path;
use super::round::stands_on_cylinder;
use super::seat::{Seat, Seating, section};
use input::units::{DEG, MM};
use insertion::finger::Pad;
use insertion::task::{Ending, Phase, Sensed, Stage, Task};

/// The TCP lies this far below the shoulder, m, as in the shipped tasks.
const BELOW_SHOULDER: f64 = 3.5 * MM;
/// How much higher than its lower edge the other side of a tilted tip is to be, m.
const RISE: f64 = 0.35 * MM;
/// Least and largest tilt, degrees.
const TILT_DEG: [f64; 2] = [5.0, 10.0];
/// Clear height above the socket at the start and after the approach, m.
const AIR: [f64; 2] = [5.0 * MM, 1.0 * MM];
/// Stroke in which the touch must find the socket, m.
const TOUCH: f64 = 3.0 * MM;
/// How far the tip stands on the rim at -x when it is set down, m; of a small tip a quarter.
const BESIDE: f64 = 1.0 * MM;
/// How far the moves along x go on after the tip has met a wall, m: there and back.
const ACROSS: [f64; 2] = [0.8 * MM, 0.45 * MM];
/// How far a round tip is moved to either side in x, m.
const ROUND_ACROSS: f64 = 0.5 * MM;
/// Share of a round opening's half that the tip's lowest point starts beyond its middle.
const ROUND_AHEAD: f64 = 0.7;
/// How far the push is commanded beyond the seat, m.
const PRESS: f64 = 4.0 * MM;
/// Tilt that counts as upright beyond what the play allows, degrees.
const UPRIGHT_DEG: f64 = 2.0;
/// Least tilt that counts as upright, degrees.
const LEAST_UPRIGHT_DEG: f64 = 3.0;
/// What may be missing of the full depth beside what a tilt takes: m, and a share.
const MISSING: (f64, f64) = (0.2 * MM, 0.02);
/// Share of the full depth at which the play is measured.
const WITHIN: f64 = 0.9;
/// A plug that goes in less than this does not go in, m.
const LEAST_DEPTH: f64 = 1.0 * MM;

/// Why no strategy can be derived.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum PlanError {
    /// The plug stays outside.
    #[error(
        "the plug does not go into the socket: upright it stops {depth_mm:.2} mm below the top, \
         where `{plug}` meets `{socket}`; make the opening wider or the plug smaller"
    )]
    NoEntry {
        /// How far it goes, mm.
        depth_mm: f64,
        /// The plug part that is stopped.
        plug: String,
        /// The socket part that stops it.
        socket: String,
    },
    /// Nothing stops the plug.
    #[error("the plug falls through its socket: give the socket a floor, or the plug a shoulder")]
    NoFloor,
}

/// Completes a task of which `plug`, `socket`, `opening` and the grip's shoulder and faces are
/// known: grasp point, strategy and success.
pub fn complete(mut task: Task) -> Result<Task, PlanError> {
    let (plug_parts, socket_parts) = (task.plug.parts.clone(), task.socket.clone());
    let (plug, socket) = (ConvexBody::new(&plug_parts), ConvexBody::new(&socket_parts));
    let seat = Seating::new(&task, &plug, &socket).deepest();
    let Some([by, on]) = seat.stopped_by else { return Err(PlanError::NoFloor) };
    if seat.depth < LEAST_DEPTH {
        return Err(PlanError::NoEntry {
            depth_mm: seat.depth / MM,
            plug: plug_parts[by].name.clone(),
            socket: socket_parts[on].name.clone(),
        });
    }
    let [bottom, _] = plug.extent(2);
    let tip = section(&plug, bottom + LEAST_DEPTH);
    grasp(&mut task, &plug);
    let play = Seating::new(&task, &plug, &socket).play(WITHIN * seat.depth, seat.at, 1);
    success(&mut task, &plug, &seat, play);
    let rise = (RISE / (tip[1][1] - tip[1][0])).min(1.0);
    let [least, most] = TILT_DEG;
    task.strategy.tilt = round(libm::asin(rise) / DEG, 0.1).clamp(least, most) * DEG;
    let search = match stands_on_cylinder(&plug_parts) {
        true => Moves::of_point(&task, tip),
        false => Moves::of_edge(&task, tip),
    };
    place_start(&mut task, &plug, &search);
    task.strategy.phases = phases(&task, &search, seat.depth);
    Ok(task)
}

/// Where the search begins and how far its moves go, m.
struct Moves {
    /// x of the plug's axis at the start.
    x: f64,
    /// y of the tip's lowest point at the start.
    edge_y: f64,
    /// Beyond first contact.
    preload: f64,
    /// Along x: back, front, and while the tip moves to the side.
    across: [f64; 3],
    /// How far the move to the front presses further down.
    down: f64,
    /// Along -y.
    side: f64,
}

impl Moves {
    /// Of a tip with a lower edge: it is set down on the rim at -x.
    fn of_edge(task: &Task, tip: [[f64; 2]; 2]) -> Self {
        let [[left, right], [low, high]] = task.opening;
        let play = right - left - (tip[0][1] - tip[0][0]);
        let beside = BESIDE.min((tip[0][1] - tip[0][0]) / 4.0);
        let front = play + ACROSS[0] + ACROSS[1];
        Moves {
            x: left - tip[0][0] - beside,
            edge_y: (low + high) / 2.0,
            preload: 0.3 * MM,
            across: [beside + play + ACROSS[0], -front, 0.0],
            down: 0.5 * MM,
            side: (high - low) / 2.0 + 1.0 * MM,
        }
    }

    /// Of a round tip: its lowest point is set down near the wall at -y.
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
        }
    }
}

fn grasp(task: &mut Task, plug: &ConvexBody) {
    let held = super::hold::held(plug, task.grip.shoulder_z, Some(task.grip.faces_y));
    let cover = held.cover[0].min(held.cover[1]);
    task.grip.tcp_z = round_mm(task.grip.shoulder_z - BELOW_SHOULDER.min(0.8 * cover));
    task.grip.slip_limit = round_mm((Pad::PAPER.height / 2.0).min(0.9 * cover));
}

/// `play` in y, m.
fn success(task: &mut Task, plug: &ConvexBody, seat: &Seat, play: f64) {
    let upright = libm::atan(play / seat.depth) / DEG + UPRIGHT_DEG;
    let tilt = upright.ceil().max(LEAST_UPRIGHT_DEG) * DEG;
    // A tilted plug is stopped where the outer end of what stops it comes down first.
    let half = seat.stopped_by.map_or(0.0, |[part, _]| {
        let [low, high] = super::body::span(plug.parts[part].solid.corners().iter().map(|p| p.y));
        (high - low) / 2.0
    });
    let (length, share) = MISSING;
    let depth = seat.depth * (1.0 - share) - half * libm::sin(tilt) - length;
    let depth = (depth.max(seat.depth / 2.0) / (0.1 * MM)).floor() * 0.1 * MM;
    task.success.depth = depth;
    task.success.tilt = tilt;
}

fn place_start(task: &mut Task, plug: &ConvexBody, search: &Moves) {
    task.strategy.start = [0.0; 3];
    task.strategy.phases = Vec::new();
    let edge = path::waypoints(task, plug)[0].edge;
    task.strategy.start =
        [round_mm(search.x), round_mm(search.edge_y - edge.y), round_mm(AIR[0] - edge.z)];
}

fn phases(task: &Task, search: &Moves, seat: f64) -> Vec<Phase> {
    let Moves { preload, across: [back, front, aside], down, side, .. } = *search;
    let searched = task.strategy.start[2] - AIR[0] - preload - down;
    let push = searched - (task.grip.tcp_z - seat - PRESS);
    let phase = |name: &str, stage, by: [f64; 3], speed: f64, ending| Phase {
        name: name.to_owned(),
        stage,
        displacement: by.map(round_mm),
        speed: speed * MM,
        ending,
    };
    use {Ending::Duration, Stage::Search};
    vec![
        phase(
            "approach",
            Stage::Approach,
            [0.0, 0.0, AIR[1] - AIR[0]],
            150.0,
            Ending::Tolerance(0.1 * MM),
        ),
        phase(
            "touch",
            Search,
            [0.0, 0.0, -TOUCH],
            20.0,
            Ending::Touch { preload, sensed: Sensed::FIRST },
        ),
        phase("back", Search, [back, 0.0, 0.0], 80.0, Duration(0.02)),
        phase("front", Search, [front, 0.0, -down], 80.0, Duration(0.03)),
        phase("side", Search, [aside, -side, 0.0], 100.0, Duration(0.03)),
        phase("assembly", Stage::Assembly, [0.0, 0.0, -push], 100.0, Duration(0.03)),
    ]
}

/// To 0.01 mm, as files have it.
fn round_mm(length: f64) -> f64 {
    round(length / MM, 0.01) * MM
}

fn round(value: f64, step: f64) -> f64 {
    // Dividing by the inverse keeps two decimals two decimals.
    let per = (1.0 / step).round();
    (value * per).round() / per
}
