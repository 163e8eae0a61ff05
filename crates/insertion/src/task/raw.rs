//! Deserialized contents of a task file, and their conversion to a [`Task`].

use super::finger::{RawFinger, finger};
use super::latch::{RawLatch, check_latch};
use super::mating_force::{RawMatingForce, mating_force};
use super::parts_file::PartsFile;
use super::raw_part::{RawPart, interval, parts};
use super::{
    Ending, Friction, Grip, Limits, PadTorsion, Part, Phase, Plug, Stage, Strategy, Success, Task,
    TouchDetection,
};
use input::units::MM;
use input::units::read::{deg, gram, mm};
use input::{Check, Document, InputError, shown, syntax};
use parameters::numbers;
use serde::Deserialize;
use toml::{Table, Value};

/// Task file; SI units.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawTask {
    name: String,
    description: String,
    #[serde(rename = "turn_in_base_deg", default, deserialize_with = "deg")]
    turn: f64,
    plug: RawPlug,
    socket: RawSocket,
    grip: Grip,
    friction: Friction,
    #[serde(default)]
    finger: RawFinger,
    strategy: Strategy<RawPhase>,
    success: Success,
    #[serde(default)]
    limits: Limits,
    mating_force: Option<RawMatingForce>,
    parts: Option<PartsFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPlug {
    #[serde(rename = "mass_g", deserialize_with = "gram")]
    mass: f64,
    #[serde(default)]
    part: Vec<RawPart>,
    #[serde(default)]
    left_out: Vec<RawPart>,
    latch: Option<RawLatch>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSocket {
    #[serde(rename = "opening_x_mm", deserialize_with = "mm")]
    opening_x: [f64; 2],
    #[serde(rename = "opening_y_mm", deserialize_with = "mm")]
    opening_y: [f64; 2],
    #[serde(default)]
    part: Vec<RawPart>,
    #[serde(default)]
    left_out: Vec<RawPart>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPhase {
    name: String,
    stage: Stage,
    #[serde(rename = "move_mm", deserialize_with = "mm")]
    displacement: [f64; 3],
    #[serde(rename = "speed_mm_per_s", deserialize_with = "mm")]
    speed: f64,
    motion: RawMotion,
    #[serde(rename = "tolerance_mm", default, deserialize_with = "mm")]
    tolerance: Option<f64>,
    settle_s: Option<f64>,
    #[serde(rename = "preload_mm", default, deserialize_with = "mm")]
    preload: Option<f64>,
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

/// Largest radius of the contact patch that the torsional friction may represent, mm.
const MAX_PATCH_MM: f64 = 100.0;

impl Task {
    /// Reads and checks a task; `file` is named in errors.
    ///
    /// # Errors
    /// If the text is not a task file, or a value is out of range.
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        Task::read(&Document::parse(text, file)?)
    }

    /// Reads and checks the task of a parsed file.
    ///
    /// # Errors
    /// Same as for [`Task::parse`].
    pub fn read(document: &Document<'_>) -> Result<Self, InputError> {
        let raw = document.read()?;
        numbers::check_file("task", &document.read()?, document.file())?;
        convert(raw, document.file())
    }

    /// Converts and checks a task file that is already parsed as TOML; `file` is named in errors.
    ///
    /// # Errors
    /// Same as for [`Task::parse`].
    pub fn from_table(table: Table, file: &str) -> Result<Self, InputError> {
        let table = Value::Table(table);
        numbers::check_file("task", &table, file)?;
        convert(table.try_into().map_err(|error| syntax(file, "", &error))?, file)
    }
}

/// Returns whether the name of a task may contain this character.
pub fn is_of_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '-' || c == '_'
}

/// Returns a name of a task.
///
/// # Errors
/// If it is empty or contains another character than letters, digits, - and _.
pub fn checked_name(name: &str) -> Result<String, &'static str> {
    let is_name = !name.is_empty() && name.chars().all(is_of_name);
    is_name.then(|| name.to_owned()).ok_or("must be letters, digits, - and _ only, as in \"usb\"")
}

/// Converts a task whose numbers have been checked by [`numbers::check_file`].
fn convert(raw: RawTask, file: &str) -> Result<Task, InputError> {
    let (check, RawSocket { opening_x, opening_y, part, left_out }) = (Check { file }, raw.socket);
    if let Err(problem) = checked_name(&raw.name) {
        return check.fail("name", problem);
    }
    if let (true, Some(PartsFile { file, .. })) = (part.is_empty(), &raw.parts) {
        return check.fail("parts.file", format!("{file} must lie beside the task file"));
    }
    let plug_parts = parts(check, "plug.part", raw.plug.part)?;
    let latch = raw.plug.latch.map(|raw| check_latch(check, &raw, &plug_parts)).transpose()?;
    interval(check, "grip.faces_y_mm", raw.grip.faces_y)?;
    if raw.grip.shoulder_z <= raw.grip.tcp_z {
        return check.fail("grip.shoulder_z_mm", "must be above grip.tcp_z_mm");
    }
    check_torsion(check, &raw.friction)?;
    let (strategy, limits) = (strategy(check, raw.strategy)?, raw.limits);
    check_speed(check, &strategy, limits)?;
    Ok(Task {
        name: raw.name,
        description: raw.description,
        turn: raw.turn,
        plug: Plug { latch, parts: plug_parts, mass: raw.plug.mass },
        socket: parts(check, "socket.part", part)?,
        opening: [
            interval(check, "socket.opening_x_mm", opening_x)?,
            interval(check, "socket.opening_y_mm", opening_y)?,
        ],
        grip: raw.grip,
        friction: raw.friction,
        finger: finger(check, &raw.finger)?,
        strategy,
        success: raw.success,
        limits,
        left_out: [
            drawn(check, "plug.left_out", raw.plug.left_out)?,
            drawn(check, "socket.left_out", left_out)?,
        ],
        mating_force: raw.mating_force.map(|raw| mating_force(check, raw)).transpose()?,
    })
}

/// Converts and checks parts that are only drawn, if there are any.
fn drawn(check: Check<'_>, key: &str, left_out: Vec<RawPart>) -> Result<Vec<Part>, InputError> {
    if left_out.is_empty() { Ok(Vec::new()) } else { parts(check, key, left_out) }
}

/// Checks that no phase is faster than the connector allows.
fn check_speed(check: Check<'_>, strategy: &Strategy, limits: Limits) -> Result<(), InputError> {
    let Some(most) = limits.speed else { return Ok(()) };
    // Speed and limit are converted to SI alike, so a phase may have exactly the speed of the limit.
    let Some(fast) = strategy.phases.iter().find(|phase| phase.speed > most) else { return Ok(()) };
    let [speed, most] = [fast.speed, most].map(|speed| shown(speed / MM));
    let problem = format!("is {speed}; limits.speed_mm_per_s allows at most {most}");
    check.fail(&format!("strategy.phase \"{}\" speed_mm_per_s", fast.name), problem)
}

/// Checks that the torsional friction of a pad is at most that of the largest contact patch.
fn check_torsion(check: Check<'_>, friction: &Friction) -> Result<(), InputError> {
    let PadTorsion::Points(torsion) = friction.finger_torsion else { return Ok(()) };
    // Largest moment per unit of normal force: all friction acts at the edge of the largest patch.
    let (torsion, most) = (torsion / MM, MAX_PATCH_MM * friction.finger_plug);
    if torsion <= most {
        return Ok(());
    }
    let [torsion, friction, most] = [torsion, friction.finger_plug, most].map(shown);
    let problem = format!(
        "is {torsion}; with a friction of {friction} it must be at most {most}: the contact patch then has \
         a radius of {MAX_PATCH_MM} mm"
    );
    check.fail("friction.finger_plug_torsion_mm", problem)
}

fn strategy(check: Check<'_>, raw: Strategy<RawPhase>) -> Result<Strategy, InputError> {
    let key = "strategy.phase";
    let Strategy { tilt, start, rule, phases: raw } = raw;
    let phases: Vec<_> = raw.into_iter().map(|raw| phase(check, raw)).collect::<Result<_, _>>()?;
    if phases.last().is_none_or(|phase| phase.stage != Stage::Assembly) {
        return check.fail(key, "the last phase must have stage = \"assembly\"");
    }
    if !phases.is_sorted_by_key(|phase| phase.stage != Stage::Approach) {
        return check.fail(key, "phases with stage = \"approach\" must come first");
    }
    let strategy = Strategy { tilt, start, rule, phases };
    strategy.check_time(|_| 0.0, 0.0).or_else(|problem| check.fail(key, problem))?;
    Ok(strategy)
}

fn phase(check: Check<'_>, raw: RawPhase) -> Result<Phase, InputError> {
    let at = |field: &str| format!("strategy.phase \"{}\" {field}", raw.name);
    if raw.displacement == [0.0; 3] {
        return check.fail(&at("move_mm"), "is zero; a phase must move");
    }
    // The field that each motion requires, in the order of `RawMotion`; then the optional fields.
    let fields = [
        ("tolerance_mm", raw.tolerance, 0, "tolerance"),
        ("settle_s", raw.settle_s, 1, "duration"),
        ("preload_mm", raw.preload, 2, "touch"),
        ("touch_force_n", raw.touch_force_n, 2, "touch"),
        ("latency_s", raw.latency_s, 2, "touch"),
    ];
    let own = raw.motion as usize;
    if let Some((field, .., motion)) =
        fields.iter().find(|(_, value, of, _)| *of != own && value.is_some())
    {
        return check.fail(&at(field), format!("is valid only with motion = \"{motion}\""));
    }
    let (field, value, _, motion) = fields[own];
    let Some(value) = value else {
        return check.fail(&at(field), format!("is missing; motion = \"{motion}\" requires it"));
    };
    let ending = match raw.motion {
        RawMotion::Tolerance => Ending::Tolerance(value),
        RawMotion::Duration => Ending::Duration(value),
        RawMotion::Touch => {
            let force = raw.touch_force_n.unwrap_or(TouchDetection::FIRST.force);
            let latency = raw.latency_s.unwrap_or(TouchDetection::FIRST.latency);
            Ending::Touch { preload: value, detection: TouchDetection { force, latency } }
        }
    };
    let RawPhase { name, stage, displacement, speed, .. } = raw;
    Ok(Phase { name, stage, displacement, speed, ending })
}
