//! A task from a few dimensions: plug, clearance and the body that the fingers hold.

use super::plan::{self, PlanError};
use super::round::{self, Hole};
use input::units::MM;
use insertion::finger::Pad;
use insertion::task::finger::FingerModel;
use insertion::task::{
    Friction, Grip, Hold, PadTorsion, Part, Plug, Solid, StartRule, Strategy, Success, Task,
    geometry,
};
use nalgebra::Vector3;
use std::str::FromStr;

/// Smallest and largest dimension, mm.
const LIMITS_MM: [f64; 2] = [0.5, 200.0];
/// Walls about the opening are at least this thick, m.
const WALL: f64 = 5.0 * MM;
/// How far the walls reach beyond the body that rests on them, m.
const BEYOND_BODY: f64 = 2.0 * MM;
/// Air between a seated plug's tip and the floor, m.
const BELOW_TIP: f64 = 0.5 * MM;
/// Air between the pads and the socket when the plug is seated, m.
const BELOW_PADS: f64 = 1.0 * MM;
/// Thickness of the floor, m.
const FLOOR: f64 = 2.0 * MM;
/// A plug without a body goes in by this share of its length.
const SHARE: f64 = 0.6;
/// Assumed until it was weighed, kg/m3: plastic with some metal in it.
pub const DENSITY: f64 = 1500.0;

/// Width (y, between the jaws), height (x) and length (z), m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// y.
    pub width: f64,
    /// x.
    pub height: f64,
    /// z.
    pub length: f64,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let right = "give WIDTHxHEIGHTxLENGTH in mm, as in 8.25x2.4x6.65";
        let [width, height, length] = lengths(text, right)?;
        Ok(Size { width, height, length })
    }
}

impl Size {
    /// A cylinder from DIAMETERxLENGTH in mm.
    ///
    /// # Errors
    /// If the text is something else.
    pub fn round(text: &str) -> Result<Self, String> {
        let [diameter, length] = lengths(text, "give DIAMETERxLENGTH in mm, as in 8x12")?;
        Ok(Size { width: diameter, height: diameter, length })
    }
}

/// Dimensions in mm with an x between them, in m.
fn lengths<const N: usize>(text: &str, right: &str) -> Result<[f64; N], String> {
    let numbers: Result<Vec<f64>, _> =
        text.split(['x', 'X', '×']).map(|number| number.trim().parse()).collect();
    let Ok(numbers) = <[f64; N]>::try_from(numbers.unwrap_or_default()) else {
        return Err(right.to_owned());
    };
    let [low, high] = LIMITS_MM;
    if !numbers.iter().all(|mm| (low..=high).contains(mm)) {
        return Err(format!("each dimension lies between {low} and {high} mm; {right}"));
    }
    Ok(numbers.map(|mm| mm * MM))
}

/// What a task is drafted from.
#[derive(Debug, Clone, PartialEq)]
pub struct Dimensions {
    /// What goes in.
    pub plug: Size,
    /// Whether that is a cylinder: width and height are its diameter.
    pub round: bool,
    /// Opening less plug, in x and in y, m.
    pub clearance: f64,
    /// What the fingers hold; without it they hold the plug's upper end.
    pub body: Option<Size>,
}

/// Why nothing can be drafted.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum DraftError {
    /// Too short to be held.
    #[error(
        "{option}: is {length_mm} mm long; the pads are {pad_mm} mm high and must stay outside of \
         the socket, so at least {least_mm:.1} mm are needed"
    )]
    TooShort {
        /// "--body", "--plug" or "--round".
        option: &'static str,
        /// As given, mm.
        length_mm: f64,
        /// Height of a pad, mm.
        pad_mm: f64,
        /// What would do, mm.
        least_mm: f64,
    },
    /// No strategy.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

/// What every drafted or imported task has in common, before its shapes are known: friction,
/// grasp force and fingers as in the shipped tasks, or as in another task.
pub fn blank(name: &str, like: Option<&Task>) -> Task {
    let finger_torsion = PadTorsion::Points(30.0 * MM);
    let friction = Friction { finger_plug: 1.0, finger_torsion, plug_socket: 0.2 };
    let grip = Grip {
        tcp_z: 0.0,
        shoulder_z: 0.0,
        faces_y: [0.0; 2],
        force: 5.0,
        hold: Hold::Always,
        slip_limit: Pad::PAPER.height / 2.0,
    };
    Task {
        name: name.to_owned(),
        description: String::new(),
        turn: like.map_or(0.0, |task| task.turn),
        plug: Plug { parts: Vec::new(), mass: 0.0, latch: None },
        socket: Vec::new(),
        opening: [[0.0; 2]; 2],
        grip: like.map_or(grip, |task| Grip {
            force: task.grip.force,
            hold: task.grip.hold,
            ..grip
        }),
        friction: like.map_or(friction, |task| task.friction),
        finger: like.map_or(FingerModel::default(), |task| task.finger),
        strategy: Strategy {
            tilt: 0.0,
            start: [0.0; 3],
            rule: StartRule::Given,
            phases: Vec::new(),
        },
        success: Success { depth: 0.0, tilt: 0.0 },
    }
}

/// A task of these dimensions; what they do not decide is taken from `like`.
pub fn draft(name: &str, size: &Dimensions, like: Option<&Task>) -> Result<Task, DraftError> {
    let (plug, body) = (size.plug, size.body);
    let mut task = blank(name, like);
    let mm = |length: f64| length / MM;
    let shape = match size.round {
        true => format!("round plug of {} mm", mm(plug.width)),
        false => format!("plug {} x {} mm", mm(plug.width), mm(plug.height)),
    };
    task.description = format!("{shape}, {} mm clearance", mm(size.clearance));
    let top = plug.length + body.map_or(0.0, |body| body.length);
    let mut parts = match size.round {
        true => vec![round::peg("plug", plug.width / 2.0, plug.length)],
        false => vec![upright("plug", plug, 0.0)],
    };
    parts.extend(body.map(|body| upright("body", body, plug.length)));
    task.plug.mass = DENSITY * parts.iter().map(|part| geometry::volume(&part.solid)).sum::<f64>();
    task.plug.parts = parts;
    let held = body.unwrap_or(plug);
    task.grip.shoulder_z = top;
    task.grip.faces_y = [-held.width / 2.0, held.width / 2.0];
    let floor = match body {
        Some(_) => plug.length + BELOW_TIP,
        None => SHARE * plug.length,
    };
    long_enough(size, top)?;
    (task.opening, task.socket) = housing(size, floor);
    Ok(plan::complete(task)?)
}

/// The pads must stay outside of the socket.
fn long_enough(size: &Dimensions, top: f64) -> Result<(), DraftError> {
    let pads = Pad::PAPER.height + BELOW_PADS;
    let (option, length, least) = match size.body {
        Some(body) => ("--body", body.length, pads),
        None => {
            let option = if size.round { "--round" } else { "--plug" };
            (option, top, pads / (1.0 - SHARE))
        }
    };
    if length >= least {
        return Ok(());
    }
    Err(DraftError::TooShort {
        option,
        length_mm: length / MM,
        pad_mm: Pad::PAPER.height / MM,
        least_mm: least / MM,
    })
}

fn upright(name: &str, size: Size, from: f64) -> Part {
    let half = [size.height / 2.0, size.width / 2.0];
    block(name, [[-half[0], half[0]], [-half[1], half[1]], [from, from + size.length]])
}

fn block(name: &str, [x, y, z]: [[f64; 2]; 3]) -> Part {
    let solid =
        Solid::Box { min: Vector3::new(x[0], y[0], z[0]), max: Vector3::new(x[1], y[1], z[1]) };
    Part { name: name.to_owned(), solid, friction: None }
}

/// Walls about the opening and a floor.
fn housing(size: &Dimensions, floor: f64) -> ([[f64; 2]; 2], Vec<Part>) {
    let hole = size.round.then(|| Hole::new(size.plug.width, size.clearance));
    let opening = [size.plug.height, size.plug.width].map(|plug| {
        let half = hole.map_or((plug + size.clearance) / 2.0, |hole| hole.flat);
        [-half, half]
    });
    let body = size.body.map(|body| [body.height, body.width]);
    let outer = [0, 1].map(|axis| {
        let half = opening[axis][1];
        let below_body = body.map_or(0.0, |body| body[axis] / 2.0 - half + BEYOND_BODY);
        let edge = half + WALL.max(below_body);
        [-edge, edge]
    });
    let ([[left, right], [low, high]], z) = (opening, [-floor, 0.0]);
    let mut parts = match hole {
        Some(hole) => hole.walls(outer.map(|[_, edge]| edge), z),
        None => vec![
            block("wall at -y", [outer[0], [outer[1][0], low], z]),
            block("wall at +y", [outer[0], [high, outer[1][1]], z]),
            block("wall at -x", [[outer[0][0], left], opening[1], z]),
            block("wall at +x", [[right, outer[0][1]], opening[1], z]),
        ],
    };
    parts.push(block("floor", [outer[0], outer[1], [-floor - FLOOR, -floor]]));
    (opening, parts)
}
