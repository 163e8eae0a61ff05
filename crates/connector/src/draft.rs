//! Task from a few dimensions: plug, clearance and the body that the fingers hold.

use super::body::{clipped, extent};
use super::mesh::solid_of;
use super::pins::Pins;
use super::plan;
use input::shown;
use input::units::MM;
use insertion::task::finger::FingerModel;
use insertion::task::{Friction, Grip, Hold, Limits, PadTorsion, Plug, Success, geometry};
use insertion::{Pad, Part, Solid, StartRule, Strategy, Task};
use nalgebra::Vector3;
use parameters::numbers;
use std::f64::consts::PI;
use std::str::FromStr;

/// Smallest thickness of the walls around the opening, m.
const WALL: f64 = 5.0 * MM;
/// Distance by which the walls extend beyond the body that rests on them, m.
const BEYOND_BODY: f64 = 2.0 * MM;
/// Gap between the tip of a seated plug and the floor, m.
const BELOW_TIP: f64 = 0.5 * MM;
/// Gap between the pads and the socket when the plug is seated, m.
const BELOW_PADS: f64 = 1.0 * MM;
/// Largest overlap of the key of a round plug with the cylinder, m.
const KEY_ROOT: f64 = 0.45 * MM;
/// Volume below which a piece of a slotted wall is dropped, m3.
const SLIVER: f64 = 1e-12;
/// Thickness of the floor, m.
const FLOOR: f64 = 2.0 * MM;
/// Insertion depth of a plug without a body, as a share of its length.
const INSERTED_SHARE: f64 = 0.6;
/// Assumed density of a plug, kg/m3: plastic with some metal in it.
pub const DENSITY: f64 = 1500.0;

/// Size of a block or a cylinder, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// Extent in y, between the jaws.
    pub width: f64,
    /// Extent in x.
    pub height: f64,
    /// Extent in z.
    pub length: f64,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let usage = "give WIDTHxHEIGHTxLENGTH in mm, as in 8.25x2.4x6.65";
        let [width, height, length] = lengths(text, usage)?;
        Ok(Size { width, height, length })
    }
}

impl Size {
    /// Parses the size of a cylinder, DIAMETERxLENGTH in mm.
    ///
    /// # Errors
    /// If the text has another format, or a dimension is not within 0.5 .. 200 mm.
    pub fn round(text: &str) -> Result<Self, String> {
        let [width, length] = lengths(text, "give DIAMETERxLENGTH in mm, as in 8x12")?;
        Ok(Size { width, height: width, length })
    }
}

/// Parses the width and the height of a key, m, from WIDTHxHEIGHT in mm.
///
/// # Errors
/// As for [`Size::round`].
pub fn key(text: &str) -> Result<[f64; 2], String> {
    lengths(text, "give WIDTHxHEIGHT in mm, as in 2x1")
}

/// Parses numbers separated by an x.
pub(crate) fn separated_by_x<T: FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let numbers = text.split(['x', 'X', '×']).map(|number| number.trim().parse().ok());
    numbers.collect::<Option<Vec<T>>>()?.try_into().ok()
}

/// Parses dimensions in mm, separated by an x, to m.
fn lengths<const N: usize>(text: &str, usage: &str) -> Result<[f64; N], String> {
    let numbers: [f64; N] = separated_by_x(text).ok_or(usage)?;
    match numbers.iter().find_map(|mm| numbers::problem("connector.size_mm", *mm)) {
        Some(problem) => Err(format!("a dimension {problem}; {usage}")),
        None => Ok(numbers.map(|mm| mm * MM)),
    }
}

/// Dimensions of a plug and its socket.
#[derive(Debug, Clone, PartialEq)]
pub struct Dimensions {
    /// Part of the plug that enters the socket.
    pub plug: Size,
    /// Pins of this part, for a pin header.
    pub pins: Option<Pins>,
    /// Whether this part is a cylinder, with width and height as its diameter.
    pub round: bool,
    /// Opening minus plug, in x and in y, m.
    pub clearance: f64,
    /// Key of a round plug at +x: its width in y and its height beyond the cylinder, m.
    pub key: Option<[f64; 2]>,
    /// Chamfer at the opening of a plug that is not round, m.
    pub chamfer: Option<f64>,
    /// Body that the fingers hold; without it they hold the plug's upper end.
    pub body: Option<Size>,
}

/// Creates a task without shapes; friction, grasp force and fingers are those of the shipped tasks, or of `like`.
pub fn blank(name: &str, like: Option<&Task>) -> Task {
    let finger_torsion = PadTorsion::Points(30.0 * MM);
    let friction = Friction { finger_plug: 1.0, finger_torsion, plug_socket: 0.2 };
    let (force, hold) = like.map_or((5.0, Hold::Always), |task| (task.grip.force, task.grip.hold));
    Task {
        name: name.to_owned(),
        description: String::new(),
        turn: like.map_or(0.0, |task| task.turn),
        plug: Plug::default(),
        socket: Vec::new(),
        opening: [[0.0; 2]; 2],
        grip: Grip { force, hold, ..Grip::default() },
        friction: like.map_or(friction, |task| task.friction),
        finger: like.map_or(FingerModel::default(), |task| task.finger),
        strategy: Strategy { tilt: 0.0, start: [0.0; 3], rule: StartRule::Given, phases: vec![] },
        success: Success::default(),
        limits: like.map_or(Limits::default(), |task| task.limits),
        left_out: Default::default(),
        mating_force: None,
    }
}

/// Creates a task with these dimensions; everything else is taken from `like`.
///
/// # Errors
/// If a dimension does not fit the others or the pads, or no strategy can be derived; the text begins with the option
/// of the dimension, if there is one.
pub fn draft(name: &str, size: &Dimensions, like: Option<&Task>) -> Result<Task, String> {
    let (plug, body) = (size.plug, size.body);
    let thickness = size.pins.map_or(plug.width.min(plug.height), |pins| pins.side);
    let [width, height, clearance] =
        [plug.width, plug.height, size.clearance].map(|v| shown(v / MM));
    if size.clearance >= thickness {
        return Err(format!(
            "--clearance: is {clearance} mm; it must be less than the smallest side of the plug, {} mm",
            shown(thickness / MM)
        ));
    }
    if let Some(Pins { pitch, side, .. }) = size.pins
        && side + size.clearance >= pitch
    {
        let [pitch, hole] = [pitch, side + size.clearance].map(|v| shown(v / MM));
        return Err(format!("--pitch-mm: is {pitch} mm; it must be more than a hole, {hole} mm"));
    }
    if let (Some(_), Some(body)) = (size.pins, body)
        && (body.width < plug.width || body.height < plug.height)
    {
        let [wide, high] = [body.width, body.height].map(|v| shown(v / MM));
        return Err(format!(
            "--body: is {wide} x {high} mm; it must cover all pins, {width} x {height} mm"
        ));
    }
    let mut task = blank(name, like);
    let (shape, mut parts) = match (size.pins, size.round) {
        (Some(pins), _) => {
            let [rows, columns] = pins.count;
            (format!("{rows} x {columns} pins"), pins.parts())
        }
        (None, true) => {
            let (radius, z) = (plug.width / 2.0, [0.0, plug.length]);
            let cylinder = Solid::Cylinder { centre: [0.0; 2], radius, z };
            (format!("round plug of {width} mm"), vec![part("plug", cylinder)])
        }
        (None, false) => (format!("plug {width} x {height} mm"), vec![upright("plug", plug, 0.0)]),
    };
    task.description = format!("{shape}, {clearance} mm clearance");
    if let Some([wide, high]) = size.key {
        if wide + size.clearance >= plug.width {
            let wide = shown(wide / MM);
            return Err(format!(
                "--key: is {wide} mm wide; it must be narrower than the plug, {width} mm"
            ));
        }
        let radius = plug.width / 2.0;
        // The key starts within the cylinder, and overlaps it by no more than parts may.
        let root = libm::sqrt(radius * radius - wide * wide / 4.0).max(radius - KEY_ROOT);
        let across = [-wide / 2.0, wide / 2.0];
        parts.push(block("key", [[root, radius + high], across, [0.0, plug.length]]));
    }
    parts.extend(body.map(|body| upright("body", body, plug.length)));
    task.plug.mass = DENSITY * parts.iter().map(|part| geometry::volume(&part.solid)).sum::<f64>();
    task.plug.parts = parts;
    let held = body.unwrap_or(plug);
    task.grip.shoulder_z = plug.length + body.map_or(0.0, |body| body.length);
    task.grip.faces_y = [-held.width / 2.0, held.width / 2.0];
    let floor = body.map_or(INSERTED_SHARE * plug.length, |_| plug.length + BELOW_TIP);
    // The pads stay outside of the socket.
    let pads = Pad::PUBLISHED.height + BELOW_PADS;
    let (option, least) = match body {
        Some(_) => ("--body", pads),
        None if size.round => ("--round", pads / (1.0 - INSERTED_SHARE)),
        None => ("--plug", pads / (1.0 - INSERTED_SHARE)),
    };
    if held.length < least {
        return Err(format!(
            "{option}: is {} mm long; the pads are {} mm high and must stay outside of the socket, so \
             at least {:.1} mm are needed{}",
            shown(held.length / MM),
            Pad::PUBLISHED.height / MM,
            least / MM,
            if body.is_none() { "; or give the part that is held as --body" } else { "" }
        ));
    }
    (task.opening, task.socket) = housing(size, floor);
    if let Some(leg) = size.chamfer {
        task = task.chamfered(leg);
    }
    if size.pins.is_some() {
        // A pin in the hole of its neighbour is not a success.
        return Ok(plan::mated(task, plug.length, 0.0, [size.clearance; 2]));
    }
    plan::complete(&task)
}

fn upright(name: &str, size: Size, from: f64) -> Part {
    let half = [size.height / 2.0, size.width / 2.0];
    block(name, [[-half[0], half[0]], [-half[1], half[1]], [from, from + size.length]])
}

pub(crate) fn block(name: &str, [x, y, z]: [[f64; 2]; 3]) -> Part {
    let [min, max] = [0, 1].map(|end| Vector3::new(x[end], y[end], z[end]));
    part(name, Solid::Box { min, max })
}

pub(crate) fn part(name: &str, solid: Solid) -> Part {
    Part { name: name.to_owned(), solid, friction: None }
}

/// Returns the opening, m, and the socket: walls around the opening and a floor at the depth `floor`, m.
fn housing(size: &Dimensions, floor: f64) -> ([[f64; 2]; 2], Vec<Part>) {
    let hole = size.round.then(|| Hole::new(size.plug.width, size.clearance));
    let mut opening = [size.plug.height, size.plug.width].map(|plug| {
        let half = hole.map_or((plug + size.clearance) / 2.0, |hole| hole.flat);
        [-half, half]
    });
    let slot = size.key.map(|[wide, high]| {
        let reach = (size.plug.width + size.clearance) / 2.0 + high;
        [reach, (wide + size.clearance) / 2.0]
    });
    opening[0][1] = slot.map_or(opening[0][1], |[reach, _]| reach);
    let outer = [0, 1].map(|axis| {
        let half = opening[axis][1];
        let body = |body: Size| [body.height, body.width][axis] / 2.0 - half + BEYOND_BODY;
        let below_body = size.body.map_or(0.0, body);
        let edge = half + WALL.max(below_body);
        [-edge, edge]
    });
    let ([[left, right], [low, high]], z) = (opening, [-floor, 0.0]);
    let mut parts = match (size.pins, hole) {
        (Some(pins), _) => pins.plate(size.clearance, outer, z),
        (None, Some(hole)) => {
            let walls = hole.walls(outer.map(|[_, edge]| edge), z);
            slot.map_or(walls.clone(), |slot| slotted(&walls, slot))
        }
        (None, None) => vec![
            block("wall at -y", [outer[0], [outer[1][0], low], z]),
            block("wall at +y", [outer[0], [high, outer[1][1]], z]),
            block("wall at -x", [[outer[0][0], left], opening[1], z]),
            block("wall at +x", [[right, outer[0][1]], opening[1], z]),
        ],
    };
    parts.push(block("floor", [outer[0], outer[1], [-floor - FLOOR, -floor]]));
    (opening, parts)
}

/// Cuts a slot into the walls around a hole: from the hole to `reach` along +x, and to `half` on either
/// side of y = 0, m.
fn slotted(walls: &[Part], [reach, half]: [f64; 2]) -> Vec<Part> {
    let cut = |wall: &Part| -> Vec<Part> {
        let (corners, all) = (wall.solid.corners(), f64::INFINITY);
        if extent(&corners, 0)[1] <= 0.0 {
            return vec![wall.clone()];
        }
        let between = clipped(&corners, 1, [-half, half]);
        let pieces = [
            clipped(&corners, 1, [half, all]),
            clipped(&corners, 1, [-all, -half]),
            clipped(&between, 0, [reach, all]),
        ];
        let solids = pieces.iter().filter_map(|piece| solid_of(piece));
        let solids = solids.filter(|solid| geometry::volume(solid) > SLIVER);
        let name = |number| match number {
            1 => wall.name.clone(),
            _ => format!("{} {number}", wall.name),
        };
        (1..).zip(solids).map(|(number, solid)| part(&name(number), solid)).collect()
    };
    walls.iter().flat_map(cut).collect()
}

/// Largest error of the diameter of a hole, as a share of the clearance; the limit of [`FLATS`] has precedence.
const DIAMETER_ERROR: f64 = 0.05;
/// Smallest and largest number of flats, multiples of four, so that one faces each of -x, +x, -y and +y.
const FLATS: [u32; 2] = [16, 96];

/// Round hole, approximated by flats.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    /// Number of flats.
    pub flats: u32,
    /// Distance of each flat from the axis, m.
    pub flat: f64,
    /// Largest distance of the wall from the circle, m.
    pub deviation: f64,
}

impl Hole {
    /// Creates the hole for a plug of a diameter with a clearance, m.
    pub fn new(diameter: f64, clearance: f64) -> Self {
        let radius = (diameter + clearance) / 2.0;
        // For a deviation d, the flats are at r - d and their corners at (r - d) / cos(pi / n) = r + d.
        let deviation = |flats: u32| radius * libm::tan(PI / 2.0 / f64::from(flats)).powi(2);
        let [fewest, most] = FLATS;
        let enough = |flats: &u32| 2.0 * deviation(*flats) <= DIAMETER_ERROR * clearance;
        let flats = (fewest..most).step_by(4).find(enough).unwrap_or(most);
        let deviation = deviation(flats);
        Hole { flats, flat: radius - deviation, deviation }
    }

    /// Returns prisms that fill a rectangle of half sides `outer` in x and y, m, around the hole.
    pub fn walls(&self, outer: [f64; 2], z: [f64; 2]) -> Vec<Part> {
        let corner = |k: u32| {
            let turn = (f64::from(k) - 0.5) * 2.0 * PI / f64::from(self.flats);
            let (x, y) = (libm::cos(turn), libm::sin(turn));
            let inner = self.flat / libm::cos(PI / f64::from(self.flats));
            let far = (outer[0] / x.abs()).min(outer[1] / y.abs());
            [inner, far].map(|from| [from * x, from * y])
        };
        let wall = |k: u32| {
            let ([a, b], [d, c]) = (corner(k), corner(k + 1));
            let solid = Solid::Prism { axis: 2, outline: vec![a, b, c, d], span: z };
            part(&format!("wall {}", k + 1), solid)
        };
        (0..self.flats).map(wall).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seat::rotational_play;
    use input::units::DEG;

    #[test]
    fn a_clearance_is_less_than_the_plug_is_thick_and_sizes_are_within_bounds() {
        let plug: Size = "8x2.4x25".parse().unwrap();
        let draft = |clearance| {
            let (key, chamfer) = (None, None);
            let size =
                Dimensions { plug, pins: None, round: false, clearance, key, chamfer, body: None };
            draft("mine", &size, None)
        };
        let [tight, wide] = [0.1, 2.3].map(|mm| draft(mm * MM).unwrap().success.tilt / DEG);
        assert!((tight - 3.0).abs() < 1e-9 && (wide - 8.0).abs() < 1e-9, "{tight} {wide}");
        for clearance in [2.4 * MM, 10.0 * MM, f64::INFINITY] {
            let error = draft(clearance).unwrap_err();
            assert!(error.contains("less than the smallest side of the plug, 2.4 mm"), "{error}");
        }
        for size in ["8x2.4x1e308", "8x0.1x25", "nanx2x25", "-8x2x25"] {
            let error = size.parse::<Size>().unwrap_err();
            assert!(error.contains("must lie in 0.5 .. 200 mm"), "{size}: {error}");
        }
    }

    /// The slot removes from the walls the volume of the key with its clearance, and the task with a key passes all
    /// checks.
    #[test]
    fn a_key_has_its_slot() {
        let (diameter, clearance, [wide, high]) = (8.0 * MM, 0.1 * MM, key("2x1").unwrap());
        let hole = Hole::new(diameter, clearance);
        let walls = hole.walls([12.0 * MM; 2], [-5.0 * MM, 0.0]);
        let slot = [(diameter + clearance) / 2.0 + high, (wide + clearance) / 2.0];
        let left = slotted(&walls, slot);
        let volume = |parts: &[Part]| -> f64 {
            parts.iter().map(|part| geometry::volume(&part.solid)).sum()
        };
        // Between the circle and the end of the slot, by the circular segment.
        let (radius, half) = ((diameter + clearance) / 2.0, slot[1]);
        let under = half * libm::sqrt(radius * radius - half * half)
            + radius * radius * libm::asin(half / radius);
        let expected = 5.0 * MM * (2.0 * half * slot[0] - under);
        let found = volume(&walls) - volume(&left);
        assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
        let size = |key| Dimensions {
            plug: Size::round("8x12").unwrap(),
            pins: None,
            round: true,
            clearance,
            key: Some(key),
            chamfer: None,
            body: Some("12x12x20".parse().unwrap()),
        };
        let task = draft("keyed", &size([wide, high]), None).unwrap();
        assert!(task.plug.parts.iter().any(|part| part.name == "key"));
        assert!(crate::check::problems(&task).is_empty(), "{:?}", crate::check::problems(&task));
        // Its corner, 5.1 mm from the axis, is free by the clearance.
        let play = rotational_play(&task).unwrap();
        assert!((play.arc / MM - 0.102).abs() < 0.006, "{play:?}");
        assert!((play.angle / play.arc * 5.099 * MM - 1.0).abs() < 1e-3, "{play:?}");
        let round = Dimensions { key: None, ..size([wide, high]) };
        assert_eq!(rotational_play(&draft("round", &round, None).unwrap()), None);
        assert!(draft("keyed", &size([8.0 * MM, high]), None).is_err());
    }

    /// The ring of flats has the volume outside of the circle, and keeps the clearance.
    #[test]
    fn a_hole_is_its_circle_within_the_error_that_it_states() {
        for (diameter_mm, clearance_mm) in [(3.0, 0.1), (8.0, 0.1), (20.0, 0.2), (100.0, 0.02)] {
            let (diameter, clearance) = (diameter_mm * MM, clearance_mm * MM);
            let hole = Hole::new(diameter, clearance);
            let radius = (diameter + clearance) / 2.0;
            let corner = hole.flat / libm::cos(PI / f64::from(hole.flats));
            assert!((radius - hole.flat - hole.deviation).abs() < 1e-12);
            assert!((corner - radius - hole.deviation).abs() < 1e-12);
            assert!(hole.flats == FLATS[1] || 2.0 * hole.deviation <= DIAMETER_ERROR * clearance);
            let half = diameter;
            let walls = hole.walls([half; 2], [-5.0 * MM, 0.0]);
            let volume: f64 = walls.iter().map(|part| geometry::volume(&part.solid)).sum();
            let expected = 5.0 * MM * (4.0 * half * half - PI * radius * radius);
            // A corner of the rectangle is cut off unless an edge between two walls meets it.
            assert!((volume / expected - 1.0).abs() < 0.02, "{volume} {expected}");
        }
    }
}
