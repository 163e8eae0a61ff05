//! The task file as written, and the checks that turn it into a [`Task`].

use super::geometry::{Part, Solid};
use super::raw_finger::RawFinger;
use super::{Ending, Friction, Grip, Hold, Phase, Plug, Stage, StartRule, Strategy, Success, Task};
use crate::input::{Check, InputError, read};
use crate::units::{DEG, GRAM, MM};
use nalgebra::Vector3;
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
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSocket {
    opening_x_mm: [f64; 2],
    opening_y_mm: [f64; 2],
    part: Vec<RawPart>,
}

#[derive(Deserialize)]
#[serde(tag = "shape", rename_all = "kebab-case", deny_unknown_fields)]
enum RawPart {
    Box {
        name: String,
        x_mm: [f64; 2],
        y_mm: [f64; 2],
        z_mm: [f64; 2],
        friction: Option<f64>,
    },
    Cylinder {
        name: String,
        centre_mm: [f64; 2],
        diameter_mm: f64,
        z_mm: [f64; 2],
        friction: Option<f64>,
    },
    Prism {
        name: String,
        axis: RawAxis,
        outline_mm: Vec<[f64; 2]>,
        span_mm: [f64; 2],
        friction: Option<f64>,
    },
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
enum RawAxis {
    X,
    Y,
    Z,
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
    finger_plug_torsion_mm: f64,
    plug_socket: f64,
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
    stage: RawStage,
    move_mm: [f64; 3],
    speed_mm_per_s: f64,
    motion: RawMotion,
    tolerance_mm: Option<f64>,
    settle_s: Option<f64>,
    preload_mm: Option<f64>,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
enum RawStage {
    Approach,
    Search,
    Assembly,
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

/// Reads and checks a task; `file` is named in errors.
pub fn parse(text: &str, file: &str) -> Result<Task, InputError> {
    check(read(text, file)?, file)
}

/// Checks a task that was read already; `file` is named in errors.
pub fn from_table(table: toml::Table, file: &str) -> Result<Task, InputError> {
    let raw = table.try_into().map_err(|error: toml::de::Error| InputError::Syntax {
        file: file.to_owned(),
        message: error.to_string().trim_end().to_owned(),
    })?;
    check(raw, file)
}

fn check(raw: RawTask, file: &str) -> Result<Task, InputError> {
    let check = Check { file };
    check.name(&raw.name)?;
    let plug = Plug {
        parts: check.parts("plug.part", &raw.plug.part)?,
        mass: check.positive("plug.mass_g", raw.plug.mass_g)? * GRAM,
    };
    Ok(Task {
        turn: check.finite("turn_in_base_deg", raw.turn_in_base_deg)? * DEG,
        plug,
        socket: check.parts("socket.part", &raw.socket.part)?,
        opening: [
            check.span("socket.opening_x_mm", raw.socket.opening_x_mm)?,
            check.span("socket.opening_y_mm", raw.socket.opening_y_mm)?,
        ],
        grip: check.grip(&raw.grip)?,
        friction: Friction {
            finger_plug: check.friction("friction.finger_plug", raw.friction.finger_plug)?,
            finger_torsion: check.not_negative(
                "friction.finger_plug_torsion_mm",
                raw.friction.finger_plug_torsion_mm,
            )? * MM,
            plug_socket: check.friction("friction.plug_socket", raw.friction.plug_socket)?,
        },
        finger: check.finger(&raw.finger)?,
        strategy: check.strategy(&raw.strategy)?,
        success: Success {
            depth: check.positive("success.depth_mm", raw.success.depth_mm)? * MM,
            tilt: check.positive("success.tilt_deg", raw.success.tilt_deg)? * DEG,
        },
        name: raw.name,
        description: raw.description,
    })
}

impl Check<'_> {
    /// The name becomes part of a folder's name.
    fn name(&self, name: &str) -> Result<(), InputError> {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if name.is_empty() || !name.chars().all(plain) {
            return self.fail("name", "must be letters, digits, - and _ only, as in \"usb\"");
        }
        Ok(())
    }

    fn friction(&self, key: &str, value: f64) -> Result<f64, InputError> {
        if (0.0..=5.0).contains(&value) {
            return Ok(value);
        }
        self.fail(key, format!("is {value}; a coefficient of friction lies in 0 .. 5"))
    }

    fn span(&self, key: &str, span: [f64; 2]) -> Result<[f64; 2], InputError> {
        self.finite(key, span[0])?;
        self.finite(key, span[1])?;
        if span[0] >= span[1] {
            let [a, b] = span;
            return self.fail(key, format!("is [{a}, {b}]; the first must be below the second"));
        }
        Ok([span[0] * MM, span[1] * MM])
    }

    fn parts(&self, key: &str, parts: &[RawPart]) -> Result<Vec<Part>, InputError> {
        if parts.is_empty() {
            return self.fail(key, "needs at least one part");
        }
        parts.iter().map(|part| self.part(key, part)).collect()
    }

    fn part(&self, key: &str, part: &RawPart) -> Result<Part, InputError> {
        let (name, friction) = match part {
            RawPart::Box { name, friction, .. }
            | RawPart::Cylinder { name, friction, .. }
            | RawPart::Prism { name, friction, .. } => (name, *friction),
        };
        let at = |field: &str| format!("{key} \"{name}\" {field}");
        let solid = match part {
            RawPart::Box { x_mm, y_mm, z_mm, .. } => {
                let x = self.span(&at("x_mm"), *x_mm)?;
                let y = self.span(&at("y_mm"), *y_mm)?;
                let z = self.span(&at("z_mm"), *z_mm)?;
                Solid::Box {
                    min: Vector3::new(x[0], y[0], z[0]),
                    max: Vector3::new(x[1], y[1], z[1]),
                }
            }
            RawPart::Cylinder { centre_mm, diameter_mm, z_mm, .. } => Solid::Cylinder {
                centre: [
                    self.finite(&at("centre_mm"), centre_mm[0])? * MM,
                    self.finite(&at("centre_mm"), centre_mm[1])? * MM,
                ],
                radius: self.positive(&at("diameter_mm"), *diameter_mm)? * MM / 2.0,
                z: self.span(&at("z_mm"), *z_mm)?,
            },
            RawPart::Prism { axis, outline_mm, span_mm, .. } => Solid::Prism {
                axis: *axis as usize,
                outline: self.outline(&at("outline_mm"), outline_mm)?,
                span: self.span(&at("span_mm"), *span_mm)?,
            },
        };
        let friction = friction.map(|mu| self.friction(&at("friction"), mu)).transpose()?;
        Ok(Part { name: name.clone(), solid, friction })
    }

    /// A strictly convex outline: every turn is to the same side.
    fn outline(&self, key: &str, outline: &[[f64; 2]]) -> Result<Vec<[f64; 2]>, InputError> {
        if outline.len() < 3 {
            return self.fail(key, "needs at least three corners");
        }
        let n = outline.len();
        let mut turns = Vec::with_capacity(n);
        for i in 0..n {
            let [a, b, c] = [outline[i], outline[(i + 1) % n], outline[(i + 2) % n]];
            self.finite(key, a[0])?;
            self.finite(key, a[1])?;
            turns.push((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]));
        }
        let convex = turns.iter().all(|&t| t > 1e-9) || turns.iter().all(|&t| t < -1e-9);
        if !convex {
            return self.fail(key, "is not convex; split the part into convex parts");
        }
        Ok(outline.iter().map(|p| [p[0] * MM, p[1] * MM]).collect())
    }

    fn grip(&self, raw: &RawGrip) -> Result<Grip, InputError> {
        let tcp_z = self.positive("grip.tcp_z_mm", raw.tcp_z_mm)? * MM;
        let shoulder_z = self.positive("grip.shoulder_z_mm", raw.shoulder_z_mm)? * MM;
        if shoulder_z <= tcp_z {
            return self.fail("grip.shoulder_z_mm", "must be above grip.tcp_z_mm");
        }
        Ok(Grip {
            tcp_z,
            shoulder_z,
            faces_y: self.span("grip.faces_y_mm", raw.faces_y_mm)?,
            force: self.positive("grip.force_n", raw.force_n)?,
            hold: raw.hold,
            slip_limit: self.positive("grip.slip_limit_mm", raw.slip_limit_mm)? * MM,
        })
    }

    fn strategy(&self, raw: &RawStrategy) -> Result<Strategy, InputError> {
        let tilt = self.finite("strategy.tilt_deg", raw.tilt_deg)?;
        if tilt.abs() > 45.0 {
            return self.fail("strategy.tilt_deg", "must lie in -45 .. 45");
        }
        for value in raw.start_mm {
            self.finite("strategy.start_mm", value)?;
        }
        let phases: Vec<_> =
            raw.phase.iter().map(|phase| self.phase(phase)).collect::<Result<_, _>>()?;
        if phases.last().is_none_or(|phase| phase.stage != Stage::Assembly) {
            return self.fail("strategy.phase", "the last phase must have stage = \"assembly\"");
        }
        let first_search = phases.iter().position(|phase| phase.stage != Stage::Approach);
        let late = phases.iter().rposition(|phase| phase.stage == Stage::Approach);
        if late > first_search {
            return self.fail("strategy.phase", "phases with stage = \"approach\" come first");
        }
        Ok(Strategy {
            tilt: tilt * DEG,
            start: raw.start_mm.map(|v| v * MM),
            rule: raw.start,
            phases,
        })
    }

    fn phase(&self, raw: &RawPhase) -> Result<Phase, InputError> {
        let at = |field: &str| format!("strategy.phase \"{}\" {field}", raw.name);
        for value in raw.move_mm {
            self.finite(&at("move_mm"), value)?;
        }
        if raw.move_mm == [0.0; 3] {
            return self.fail(&at("move_mm"), "is zero; a phase must move");
        }
        let given = [
            ("tolerance_mm", raw.tolerance_mm, "tolerance"),
            ("settle_s", raw.settle_s, "duration"),
            ("preload_mm", raw.preload_mm, "touch"),
        ];
        let wanted = raw.motion as usize;
        for (i, (field, value, motion)) in given.into_iter().enumerate() {
            if i == wanted && value.is_none() {
                return self
                    .fail(&at(field), format!("is missing; motion = \"{motion}\" needs it"));
            }
            if i != wanted && value.is_some() {
                return self.fail(&at(field), format!("goes only with motion = \"{motion}\""));
            }
        }
        let (field, value, _) = given[wanted];
        let value = self.positive(&at(field), value.unwrap_or(f64::NAN))?;
        Ok(Phase {
            name: raw.name.clone(),
            stage: match raw.stage {
                RawStage::Approach => Stage::Approach,
                RawStage::Search => Stage::Search,
                RawStage::Assembly => Stage::Assembly,
            },
            displacement: raw.move_mm.map(|v| v * MM),
            speed: self.positive(&at("speed_mm_per_s"), raw.speed_mm_per_s)? * MM,
            ending: match raw.motion {
                RawMotion::Tolerance => Ending::Tolerance(value * MM),
                RawMotion::Duration => Ending::Duration(value),
                RawMotion::Touch => Ending::Touch { preload: value * MM },
            },
        })
    }
}
