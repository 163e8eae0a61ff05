//! Commented TOML file of a task.

use super::draft::DENSITY;
use super::hold;
use input::units::{DEG, GRAM, MM};
use insertion::task::parts_file::PartsFile;
use insertion::task::{Limits, Mated, PadTorsion, TouchDetection};
use insertion::{Ending, Part, Phase, Solid, StartRule, Strategy, Task};
use nalgebra::{Point3, Vector3};

/// Comments of a task file, and the file of its parts.
#[derive(Debug, Clone, Default)]
pub struct Notes {
    /// Lines of the comment at the top.
    pub head: Vec<String>,
    /// Height of the socket's top above the origin, m.
    pub top: f64,
    /// Separate file of the parts; `None` if the task file contains them.
    pub parts: Option<PartsFile>,
    /// Whether parts that overlap, such as contact springs, were left out.
    pub left_out: bool,
}

/// Describes the height of a task's origin, from which depths are counted, by that of the socket's top above it, m. A
/// socket with a chamfer begins to enclose the plug's tip below its top.
pub fn origin(top: f64) -> String {
    match top / MM {
        ..0.005 => "on the socket's top".to_owned(),
        top_mm => format!("{top_mm:.2} mm below the socket's top"),
    }
}

/// Returns the text of a separate file of the parts.
pub fn parts_file(task: &Task) -> String {
    let [plug, socket] = &task.left_out;
    let bodies = [("plug.part", &task.plug.parts), ("socket.part", &task.socket)];
    let left_out = [("plug.left_out", plug), ("socket.left_out", socket)];
    bodies.into_iter().chain(left_out).map(|(key, of)| parts(key, of)).collect()
}

/// Returns the text of a task file.
pub fn task(task: &Task, notes: &Notes) -> String {
    let head: String = notes.head.iter().map(|line| format!("# {line}\n")).collect();
    let [name, description] = [&task.name, &task.description].map(text);
    let turn = match task.turn {
        0.0 => String::new(),
        turn => format!("turn_in_base_deg = {}\n", round(turn / DEG, 100.0)),
    };
    let [plug, socket] = match notes.parts {
        Some(_) => [String::new(), String::new()],
        None => [
            format!(
                "# Convex parts, z counted from the tip upwards.\n{}",
                parts("plug.part", &task.plug.parts) + &parts("plug.left_out", &task.left_out[0])
            ),
            parts("socket.part", &task.socket) + &parts("socket.left_out", &task.left_out[1]),
        ],
    };
    let [x, y] = task.opening.map(pair);
    let origin = origin(notes.top);
    let mut out = format!(
        "{head}# Every key, with its unit and how to choose it: docs/guide/tasks.md.\n\
         # Frame: origin in the middle of the opening, {origin}; z out of the socket; y the\n\
         # direction in which the jaws close and the start is shifted. Lengths in mm.\n\n\
         name = {name}\ndescription = {description}\n{turn}\n\
         [plug]\n# Assumed: {DENSITY} kg/m3. Weigh yours.\nmass_g = {}\n\n{plug}\
         [socket]\n# From, to of the opening, between the walls below z = 0.\n\
         opening_x_mm = {x}\nopening_y_mm = {y}\n\n{socket}{}{}\
         [success]\n# Judged at rest after the push: tip this deep below z = 0, axis this upright.\n\
         depth_mm = {}\ntilt_deg = {}\n",
        round(task.plug.mass / GRAM, 100.0),
        grip(task),
        strategy(&task.strategy),
        mm(task.success.depth),
        round(task.success.tilt / DEG, 100.0)
    );
    if let Some(Mated { tip, lateral }) = &task.success.mated {
        out += &format!(
            "\n[success.mated]\n# The plug's tip when it is mated, and the lateral tolerance of an inserted one.\n\
             tip_mm = {}\nlateral_mm = {}\n",
            list(tip.iter().map(|&v| mm(v))),
            mm(*lateral)
        );
    }
    if let Some(PartsFile { file, sha256 }) = &notes.parts {
        out += &format!(
            "\n[parts]\n# Convex parts of plug and socket.\nfile = {}\nsha256 = \"{sha256}\"\n",
            text(file)
        );
    }
    let Limits { force, speed } = task.limits;
    let limits = [("force_n", force.map(|n| format!("{n:?}"))), ("speed_mm_per_s", speed.map(mm))];
    let line = |(key, value): (&str, Option<String>)| Some(format!("{key} = {}\n", value?));
    let limits: String = limits.into_iter().filter_map(line).collect();
    if !limits.is_empty() {
        out += &format!("\n[limits]\n# From the data sheet.\n{limits}");
    }
    out + &format!(
        "\n# Contact springs{}: no force unless given here, by the depth of the tip, as on the data sheet.\n\
         # [mating_force]\n# depth_mm = [0.0, {}]\n# force_n = [0.0, 10.0]\n",
        if notes.left_out { ", whose overlap was left out of the parts" } else { "" },
        mm(task.success.depth)
    )
}

fn parts(key: &str, parts: &[Part]) -> String {
    let written = |part: &Part| {
        let friction = part.friction.map(|friction| format!("friction = {friction:?}\n"));
        format!(
            "[[{key}]]\nname = {}\n{}{}\n",
            text(&part.name),
            solid(&part.solid),
            friction.unwrap_or_default()
        )
    };
    parts.iter().map(written).collect()
}

fn solid(solid: &Solid) -> String {
    match solid {
        Solid::Box { min, max } => cuboid(min, max),
        Solid::Rounded(rounded) => {
            let cut = |(at, key, size)| format!("{{ at = \"{at}\", {key} = {} }}", mm(size));
            let edges = list(rounded.cuts().map(cut));
            cuboid(&rounded.min, &rounded.max()) + &format!("edges = {edges}\n")
        }
        Solid::Cylinder { centre, radius, z } => {
            let (centre, diameter, z) = (pair(*centre), mm(2.0 * radius), pair(*z));
            format!(
                "shape = \"cylinder\"\ncentre_mm = {centre}\ndiameter_mm = {diameter}\nz_mm = {z}\n"
            )
        }
        Solid::Prism { axis, outline, span } => {
            let (axis, span) = (["x", "y", "z"][*axis], pair(*span));
            let outline = list(outline.iter().map(|&corner| pair(corner)));
            format!(
                "shape = \"prism\"\naxis = \"{axis}\"\noutline_mm = {outline}\nspan_mm = {span}\n"
            )
        }
        Solid::Hull { points } => {
            let point = |p: &Point3<f64>| list(p.iter().map(|&v| mm(v)));
            format!("shape = \"hull\"\npoints_mm = {}\n", list(points.iter().map(point)))
        }
    }
}

fn cuboid(min: &Vector3<f64>, max: &Vector3<f64>) -> String {
    let [x, y, z] = [0, 1, 2].map(|i| pair([min[i], max[i]]));
    format!("shape = \"box\"\nx_mm = {x}\ny_mm = {y}\nz_mm = {z}\n")
}

fn grip(task: &Task) -> String {
    let (grip, friction) = (&task.grip, &task.friction);
    let [low, high] = hold::pad_z(grip.shoulder_z).map(mm);
    let [tcp, shoulder, slip] = [grip.tcp_z, grip.shoulder_z, grip.slip_limit].map(mm);
    let (faces, hold) = (pair(grip.faces_y), text(grip.hold));
    let torsion = match friction.finger_torsion {
        PadTorsion::Points(moment) => mm(moment),
        PadTorsion::Patch => "\"patch\"".to_owned(),
    };
    format!(
        "[grip]\n# The roofs of the fingertips rest on shoulder_z; their pads then reach from {low} to {high} mm\n\
         # and press the faces. tcp_z is the height of the grasp point. All counted from the tip.\n\
         tcp_z_mm = {tcp}\nshoulder_z_mm = {shoulder}\nfaces_y_mm = {faces}\nforce_n = {:?}\nhold = {hold}\n\
         # Beyond this slip the plug counts as lost.\nslip_limit_mm = {slip}\n\n\
         [friction]\nfinger_plug = {:?}\nfinger_plug_torsion_mm = {torsion}\nplug_socket = {:?}\n\n",
        grip.force, friction.finger_plug, friction.plug_socket,
    )
}

/// Returns the `[strategy]` section of a task file.
pub fn strategy(strategy: &Strategy) -> String {
    let rule = if strategy.rule == StartRule::Taught { "start = \"taught\"\n" } else { "" };
    let phases: String = strategy.phases.iter().map(phase).collect();
    let [tilt, start] = match strategy.tilt {
        0.0 => ["Upright.", "The plug's axis above x and y."],
        _ => [
            "Tilted about x: the tip's edge at -y is the lowest.",
            "The tip's lower edge over the middle of the opening in y.",
        ],
    };
    format!(
        "[strategy]\n# {tilt}\ntilt_deg = {}\n# Grasp point (TCP). {start}\nstart_mm = {}\n{rule}\n{phases}",
        round(strategy.tilt / DEG, 100.0),
        list(strategy.start.iter().map(|&v| mm(v)))
    )
}

fn phase(phase: &Phase) -> String {
    let (motion, key, value) = match phase.ending {
        Ending::Tolerance(within) => ("tolerance", "tolerance_mm", mm(within)),
        Ending::Duration(rest) => ("duration", "settle_s", round(rest, 1e4)),
        Ending::Touch { preload, .. } => ("touch", "preload_mm", mm(preload)),
    };
    let detection = match phase.ending {
        Ending::Touch { detection, .. } if detection != TouchDetection::FIRST => {
            format!("touch_force_n = {:?}\nlatency_s = {:?}\n", detection.force, detection.latency)
        }
        _ => String::new(),
    };
    format!(
        "[[strategy.phase]]\nname = {}\nstage = {}\nmove_mm = {}\nspeed_mm_per_s = {}\n\
         motion = \"{motion}\"\n{key} = {value}\n{detection}\n",
        text(&phase.name),
        text(phase.stage),
        list(phase.displacement.iter().map(|&v| mm(v))),
        mm(phase.speed),
    )
}

/// Returns a length in mm, to a tenth of a micrometre.
fn mm(length: f64) -> String {
    round(length / MM, 1e4)
}

/// Returns a TOML float, rounded to a multiple of `1 / parts`.
fn round(value: f64, parts: f64) -> String {
    // Adding zero avoids "-0.0".
    format!("{:?}", (value * parts).round() / parts + 0.0)
}

fn pair([from, to]: [f64; 2]) -> String {
    format!("[{}, {}]", mm(from), mm(to))
}

fn list(items: impl Iterator<Item = String>) -> String {
    format!("[{}]", items.collect::<Vec<_>>().join(", "))
}

/// Returns a TOML string: a text, or the name of a variant.
fn text(value: impl serde::Serialize) -> String {
    toml::Value::try_from(value).map_or(String::new(), |value| value.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::TASKS;

    /// A written task reads back as the same, to a tenth of a micrometre.
    #[test]
    fn a_written_task_reads_back_alike() {
        for file in TASKS {
            let before = Task::parse(file.text, file.file).unwrap();
            let written = task(&before, &Notes::default());
            let after = Task::parse(&written, "written").unwrap();
            assert_eq!(task(&after, &Notes::default()), written, "{}", file.name);
            assert_eq!(after.strategy.phases.len(), before.strategy.phases.len());
            assert!((after.success.depth - before.success.depth).abs() < 1e-7);
            assert_eq!(after.plug.parts.len(), before.plug.parts.len());
        }
    }
}
