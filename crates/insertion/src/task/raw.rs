//! The task file as written, and the checks that turn it into a [`Task`].

use super::finger::{RawFinger, finger};
use super::latch::{RawLatch, latch};
use super::quantity::{coefficient, span};
use super::raw_part::{RawPart, parts};
use super::{
    Ending, Friction, Grip, Hold, PadTorsion, Phase, Plug, Sensed, Stage, StartRule, Strategy,
    Success, Task,
};
use input::units::{DEG, GRAM, MM};
use input::{Check, Document, InputError, shown, syntax};
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawTask {
    name: String,
    description: String,
    #[serde(default)]
    turn_in_base_deg: f64,
    plug: RawPlug,
    socket: RawSocket,
    grip: RawGrip,
    friction: RawFriction,
    #[serde(default)]
    finger: RawFinger,
    strategy: RawStrategy,
    success: RawSuccess,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPlug {
    mass_g: f64,
    part: Vec<RawPart>,
    latch: Option<RawLatch>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSocket {
    opening_x_mm: [f64; 2],
    opening_y_mm: [f64; 2],
    part: Vec<RawPart>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawGrip {
    tcp_z_mm: f64,
    shoulder_z_mm: f64,
    faces_y_mm: [f64; 2],
    force_n: f64,
    hold: Hold,
    slip_limit_mm: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFriction {
    finger_plug: f64,
    finger_plug_torsion_mm: RawTorsion,
    plug_socket: f64,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(untagged, expecting = "a number of mm, or \"patch\"")]
enum RawTorsion {
    Points(f64),
    Word(RawTorsionWord),
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
enum RawTorsionWord {
    Patch,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawStrategy {
    tilt_deg: f64,
    start_mm: [f64; 3],
    #[serde(default)]
    start: StartRule,
    phase: Vec<RawPhase>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPhase {
    name: String,
    stage: Stage,
    move_mm: [f64; 3],
    speed_mm_per_s: f64,
    motion: RawMotion,
    tolerance_mm: Option<f64>,
    settle_s: Option<f64>,
    preload_mm: Option<f64>,
    touch_force_n: Option<f64>,
    latency_s: Option<f64>,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
enum RawMotion {
    Tolerance,
    Duration,
    Touch,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSuccess {
    depth_mm: f64,
    tilt_deg: f64,
}

const MOST_PHASES: usize = 100;
/// Largest radius of the patch that torsional friction stands for, mm: larger is none.
const LARGEST_PATCH_MM: f64 = 100.0;

impl Task {
    /// Reads and checks a task; `file` is named in errors.
    ///
    /// # Errors
    /// If the text is not such a file, or a value cannot be used.
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        Task::read(&Document::parse(text, file)?)
    }

    /// Reads and checks the task of a parsed file.
    ///
    /// # Errors
    /// As of [`Task::parse`].
    pub fn read(document: &Document<'_>) -> Result<Self, InputError> {
        check(document.read()?, document.file())
    }

    /// Checks a task file that was read as TOML already; `file` is named in errors.
    ///
    /// # Errors
    /// As of [`Task::parse`].
    pub fn from_table(table: toml::Table, file: &str) -> Result<Self, InputError> {
        check(table.try_into().map_err(|error| syntax(file, "", &error))?, file)
    }
}

fn check(raw: RawTask, file: &str) -> Result<Task, InputError> {
    let check = Check { file };
    name(check, &raw.name)?;
    let held = parts(check, "plug.part", &raw.plug.part)?;
    let plug = Plug {
        latch: raw.plug.latch.as_ref().map(|raw| latch(check, raw, &held)).transpose()?,
        parts: held,
        mass: check.positive("plug.mass_g", raw.plug.mass_g)? * GRAM,
    };
    Ok(Task {
        turn: check.finite("turn_in_base_deg", raw.turn_in_base_deg)? * DEG,
        plug,
        socket: parts(check, "socket.part", &raw.socket.part)?,
        opening: [
            span(check, "socket.opening_x_mm", raw.socket.opening_x_mm)?,
            span(check, "socket.opening_y_mm", raw.socket.opening_y_mm)?,
        ],
        grip: grip(check, &raw.grip)?,
        friction: frictions(check, &raw.friction)?,
        finger: finger(check, &raw.finger)?,
        strategy: strategy(check, &raw.strategy)?,
        success: Success {
            depth: check.positive("success.depth_mm", raw.success.depth_mm)? * MM,
            tilt: check.positive("success.tilt_deg", raw.success.tilt_deg)? * DEG,
        },
        name: raw.name,
        description: raw.description,
    })
}

fn name(check: Check<'_>, name: &str) -> Result<(), InputError> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if name.is_empty() || !name.chars().all(plain) {
        return check.fail("name", "must be letters, digits, - and _ only, as in \"usb\"");
    }
    Ok(())
}

fn frictions(check: Check<'_>, raw: &RawFriction) -> Result<Friction, InputError> {
    let finger_plug = coefficient(check, "friction.finger_plug", raw.finger_plug)?;
    let finger_torsion = match raw.finger_plug_torsion_mm {
        RawTorsion::Points(mm) => PadTorsion::Points(torsion(check, mm, finger_plug)?),
        RawTorsion::Word(RawTorsionWord::Patch) => PadTorsion::Patch,
    };
    let plug_socket = coefficient(check, "friction.plug_socket", raw.plug_socket)?;
    Ok(Friction { finger_plug, finger_torsion, plug_socket })
}

/// Moment of a contact point per normal force, m.
fn torsion(check: Check<'_>, mm: f64, finger_plug: f64) -> Result<f64, InputError> {
    let key = "friction.finger_plug_torsion_mm";
    let torsion = check.not_negative(key, mm)?;
    // The moment is that of the friction at the edge of the pressed patch.
    if torsion > LARGEST_PATCH_MM * finger_plug {
        let problem = format!(
            "is {}; with a friction of {} it may be {} at most: the pressed patch has \
                 {LARGEST_PATCH_MM} mm then",
            shown(torsion),
            shown(finger_plug),
            shown(LARGEST_PATCH_MM * finger_plug)
        );
        return check.fail(key, problem);
    }
    Ok(torsion * MM)
}

fn grip(check: Check<'_>, raw: &RawGrip) -> Result<Grip, InputError> {
    let tcp_z = check.positive("grip.tcp_z_mm", raw.tcp_z_mm)? * MM;
    let shoulder_z = check.positive("grip.shoulder_z_mm", raw.shoulder_z_mm)? * MM;
    if shoulder_z <= tcp_z {
        return check.fail("grip.shoulder_z_mm", "must be above grip.tcp_z_mm");
    }
    Ok(Grip {
        tcp_z,
        shoulder_z,
        faces_y: span(check, "grip.faces_y_mm", raw.faces_y_mm)?,
        force: check.positive("grip.force_n", raw.force_n)?,
        hold: raw.hold,
        slip_limit: check.positive("grip.slip_limit_mm", raw.slip_limit_mm)? * MM,
    })
}

fn strategy(check: Check<'_>, raw: &RawStrategy) -> Result<Strategy, InputError> {
    let tilt = check.finite("strategy.tilt_deg", raw.tilt_deg)?;
    if tilt.abs() > 45.0 {
        return check.fail("strategy.tilt_deg", "must lie in -45 .. 45");
    }
    let start = check.each("strategy.start_mm", raw.start_mm, Check::distance)?;
    if raw.phase.len() > MOST_PHASES {
        let count = raw.phase.len();
        return check.fail("strategy.phase", format!("are {count}; there may be {MOST_PHASES}"));
    }
    let phases: Vec<_> = raw.phase.iter().map(|raw| phase(check, raw)).collect::<Result<_, _>>()?;
    if phases.last().is_none_or(|phase| phase.stage != Stage::Assembly) {
        return check.fail("strategy.phase", "the last phase must have stage = \"assembly\"");
    }
    let first_search = phases.iter().position(|phase| phase.stage != Stage::Approach);
    let late = phases.iter().rposition(|phase| phase.stage == Stage::Approach);
    if late > first_search {
        return check.fail("strategy.phase", "phases with stage = \"approach\" come first");
    }
    let strategy =
        Strategy { tilt: tilt * DEG, start: start.map(|v| v * MM), rule: raw.start, phases };
    match strategy.too_long(|_| 0.0, 0.0) {
        Some(problem) => check.fail("strategy.phase", problem),
        None => Ok(strategy),
    }
}

fn phase(check: Check<'_>, raw: &RawPhase) -> Result<Phase, InputError> {
    let at = |field: &str| format!("strategy.phase \"{}\" {field}", raw.name);
    if check.each(&at("move_mm"), raw.move_mm, Check::distance)? == [0.0; 3] {
        return check.fail(&at("move_mm"), "is zero; a phase must move");
    }
    let given = [
        ("tolerance_mm", raw.tolerance_mm, "tolerance"),
        ("settle_s", raw.settle_s, "duration"),
        ("preload_mm", raw.preload_mm, "touch"),
    ];
    let wanted = raw.motion as usize;
    for (i, (field, value, motion)) in given.into_iter().enumerate() {
        if i == wanted && value.is_none() {
            return check.fail(&at(field), format!("is missing; motion = \"{motion}\" needs it"));
        }
        if i != wanted && value.is_some() {
            return check.fail(&at(field), format!("goes only with motion = \"{motion}\""));
        }
    }
    let (field, value, _) = given[wanted];
    let value = check.positive(&at(field), value.unwrap_or(f64::NAN))?;
    for (field, value) in [("touch_force_n", raw.touch_force_n), ("latency_s", raw.latency_s)] {
        if value.is_some() && !matches!(raw.motion, RawMotion::Touch) {
            return check.fail(&at(field), "goes only with motion = \"touch\"");
        }
    }
    let force = raw.touch_force_n.unwrap_or(Sensed::FIRST.force);
    let latency = raw.latency_s.unwrap_or(Sensed::FIRST.latency);
    let sensed = Sensed {
        force: check.positive(&at("touch_force_n"), force)?,
        latency: check.not_negative(&at("latency_s"), latency)?,
    };
    Ok(Phase {
        name: raw.name.clone(),
        stage: raw.stage,
        displacement: raw.move_mm.map(|v| v * MM),
        speed: check.positive(&at("speed_mm_per_s"), raw.speed_mm_per_s)? * MM,
        ending: match raw.motion {
            RawMotion::Tolerance => Ending::Tolerance(value * MM),
            RawMotion::Duration => Ending::Duration(value),
            RawMotion::Touch => Ending::Touch { preload: value * MM, sensed },
        },
    })
}
