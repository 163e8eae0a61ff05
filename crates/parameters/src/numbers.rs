//! Table of all numbers in the input files and of the other numbers that may vary, with plausible bounds. The unit of a
//! number and of its bounds is the suffix of a word of its path (`_nm` is N m); without one it is dimensionless.
//!
//! In a pattern `*` matches a name, an axis or a list index (of a phase, a part, an end of a span), and `a|b` matches
//! the word `a` or `b`.

use crate::path::label;
use input::{Check, InputError, shown, wrong_unit};
use toml::Value;

/// Infill density.
pub const DENSITY: &str = "infill_density_percent";
/// Infill direction.
pub const DIRECTION: &str = "infill_direction_deg";
/// Coefficient of friction between plug and socket.
pub const FRICTION: &str = "task.friction.plug_socket";
/// Coefficient of friction between pad and plug.
pub const PAD_FRICTION: &str = "task.friction.finger_plug";
/// Increase of the width of the socket's opening in x and in y.
pub const CLEARANCE: &str = "task.clearance_mm";
/// Radius cut into the lead-in edges of plug and socket; 0 leaves them as in the task file.
pub const EDGE_RADIUS: &str = "task.edge_radius_mm";
/// Chamfer cut into the edges of the socket's opening; 0 leaves them as in the task file.
pub const CHAMFER: &str = "task.opening_chamfer_mm";
/// Common factor on the stiffness of a finger in compliance and in assembly direction.
pub const STIFFNESS: &str = "finger.stiffness";
/// Distance of a finger's remote centre of compliance below the TCP.
pub const RCC_KEY: &str = "finger.rcc_mm";
/// Rotational stiffness of a finger about x.
pub const TILTING_KEY: &str = "finger.rotation_x_nm_per_rad";
/// Stiffness along x of a compliant flange; its other stiffnesses scale in proportion.
pub const FLANGE: &str = "robot.stiffness_n_per_mm";
/// Shift of the start along x, across the compliance direction (y).
pub const START_ACROSS: &str = "cell.start_across_mm";
/// Rotation of the start about x, in addition to the tilt of the strategy.
pub const START_TILT: &str = "cell.start_tilt_deg";
/// Rotation of the socket about z.
pub const SOCKET_YAW: &str = "cell.socket_yaw_deg";

/// Kind of a number: the object to which it belongs, and how it is set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Density or direction of the infill.
    Infill,
    /// Number in a task or finger file, set before the file is checked.
    File,
    /// Number of the simulated finger, set after it is built from its files.
    Finger,
    /// Number of the simulated robot, set after it is built from its file.
    Robot,
    /// Clearance, radius or chamfer that is added to the shapes of the task; 0 leaves them unchanged.
    Added,
    /// Factor on the compliance and the assembly stiffness of the finger.
    Springs,
    /// Random error of an insertion, as the deviation from nominal.
    Error,
    /// Number in a file that is checked but cannot be set alone: it varies only together with others, or not at all.
    Fixed,
}

/// Entry of the table: pattern of the paths, and plausible bounds in their unit.
#[derive(Debug, PartialEq)]
pub struct NumberSpec {
    /// Pattern of the paths.
    pub pattern: &'static str,
    /// Kind of the numbers.
    pub kind: Kind,
    /// Smallest and largest plausible value.
    pub bounds: [f64; 2],
}

const fn number(kind: Kind, pattern: &'static str, low: f64, high: f64) -> NumberSpec {
    NumberSpec { pattern, kind, bounds: [low, high] }
}
const fn file(pattern: &'static str, low: f64, high: f64) -> NumberSpec {
    number(Kind::File, pattern, low, high)
}
const fn error(pattern: &'static str, largest: f64) -> NumberSpec {
    number(Kind::Error, pattern, -largest, largest)
}
/// A coordinate or a displacement, mm.
const fn distance(pattern: &'static str) -> NumberSpec {
    file(pattern, -1e3, 1e3)
}
/// A length, mm, or a time, s, above 0.
const fn length(pattern: &'static str) -> NumberSpec {
    file(pattern, SMALLEST, 1e3)
}
/// A length of a printed finger, mm. Above the upper bound its unit is wrong.
const fn printed(pattern: &'static str) -> NumberSpec {
    file(pattern, SMALLEST, 500.0)
}
/// A size of a part, mm. The lower bound, 1 um, is far below the smallest printable size.
const fn size(pattern: &'static str) -> NumberSpec {
    file(pattern, 1e-3, 1e3)
}
/// A stiffness, a damping or the mass of the finger, in the unit of the pattern.
const fn finger(pattern: &'static str) -> NumberSpec {
    number(Kind::Finger, pattern, SMALLEST, 1e6)
}
const fn fixed(pattern: &'static str, low: f64, high: f64) -> NumberSpec {
    number(Kind::Fixed, pattern, low, high)
}
/// Smallest value of a number that must be above 0.
const SMALLEST: f64 = 1e-9;

/// All numbers. Those of an arm's joints are fixed, since together they describe one published arm.
pub static NUMBERS: &[NumberSpec] = &[
    // A density below 1 % is probably a fraction, such as 0.2 for 20 %.
    number(Kind::Infill, DENSITY, 1.0, 100.0),
    number(Kind::Infill, DIRECTION, 0.0, 90.0),
    file("task.turn_in_base_deg", -360.0, 360.0),
    file("task.plug.mass_g", SMALLEST, 1e6),
    distance("task.plug.latch.root_mm|end_mm.*"),
    size("task.plug.latch.width_mm|thickness_mm"),
    file("task.plug.latch.modulus_gpa", SMALLEST, 1e6),
    distance("task.plug|socket.part.*.x_mm|y_mm|z_mm|centre_mm|span_mm.*"),
    distance("task.plug|socket.part.*.outline_mm|points_mm.*.*"),
    size("task.plug|socket.part.*.diameter_mm"),
    size("task.plug|socket.part.*.edges.*.chamfer_mm|radius_mm"),
    file("task.plug|socket.part.*.friction", 0.0, 5.0),
    fixed("task.plug|socket.left_out.*.x_mm|y_mm|z_mm|centre_mm|span_mm.*", -1e3, 1e3),
    fixed("task.plug|socket.left_out.*.outline_mm|points_mm.*.*", -1e3, 1e3),
    fixed("task.plug|socket.left_out.*.diameter_mm", 1e-3, 1e3),
    fixed("task.plug|socket.left_out.*.edges.*.chamfer_mm|radius_mm", 1e-3, 1e3),
    distance("task.socket.opening_x_mm|opening_y_mm.*"),
    length("task.grip.tcp_z_mm|shoulder_z_mm|slip_limit_mm"),
    distance("task.grip.faces_y_mm.*"),
    file("task.grip.force_n", SMALLEST, 1e3),
    file("task.friction.plug_socket|finger_plug", 0.0, 5.0),
    file("task.friction.finger_plug_torsion_mm", 0.0, 500.0),
    length("task.finger.rcc_mm"),
    // In mm, and in mm per degree of the infill direction.
    length("task.finger.rcc_mm.at_0_deg"),
    distance("task.finger.rcc_mm.per_deg"),
    file("task.finger.coupling.*.coefficient", -1.0, 1.0),
    file("task.strategy.tilt_deg", -45.0, 45.0),
    distance("task.strategy.start_mm.*"),
    distance("task.strategy.phase.*.move_mm.*"),
    file("task.strategy.phase.*.speed_mm_per_s|touch_force_n", SMALLEST, 1e6),
    length("task.strategy.phase.*.tolerance_mm|settle_s|preload_mm"),
    file("task.strategy.phase.*.latency_s", 0.0, 1e3),
    length("task.success.depth_mm"),
    file("task.success.tilt_deg", SMALLEST, 360.0),
    fixed("task.limits.force_n|speed_mm_per_s", SMALLEST, 1e6),
    fixed("task.mating_force.depth_mm.*", 0.0, 1e3),
    fixed("task.mating_force.force_n.*", 0.0, 1e5),
    distance("task.success.mated.tip_mm.*"),
    length("task.success.mated.lateral_mm"),
    // Dimensions from which task files of connectors are drafted.
    fixed("connector.size_mm", 0.5, 200.0),
    fixed("connector.clearance_mm", 1e-3, 20.0),
    fixed("connector.pin_mm", 0.1, 50.0),
    number(Kind::Added, CLEARANCE, -1e3, 1e3),
    number(Kind::Added, EDGE_RADIUS, 0.0, 1e3),
    number(Kind::Added, CHAMFER, 0.0, 1e3),
    printed("finger.outline.length_mm|width_mm|depth_mm|tip_mm|back_radius_mm"),
    printed("finger.notch.pad_mm|roof_mm"),
    file("finger.notch.pad_deg", 0.0, 60.0),
    printed("finger.skin|ribs.thickness_mm"),
    printed("finger.ribs.line_spacing_mm"),
    distance("finger.ribs|holes.origin_mm|offset_mm.*"),
    distance("finger.ribs.phase_mm"),
    printed("finger.base.solid_mm|clamped_mm"),
    file("finger.mount.tilt_deg", 0.0, 60.0),
    file("finger.material.modulus_gpa", 1e-4, 500.0),
    file("finger.material.poisson", 0.0, 0.5),
    file("finger.material.density_kg_per_m3", SMALLEST, 1e9),
    printed("finger.holes.spacing_mm"),
    // Smaller holes close in print.
    file("finger.holes.diameter_mm", 1.0, 500.0),
    fixed("finger.holes.count", 1.0, 20.0),
    printed("finger.holes.block.length_mm|width_mm|overlap_mm"),
    printed("finger.print.line_width_mm|smallest_gap_mm"),
    // The upper bound is a thousand times the stiffness of a solid finger.
    fixed("stiffness_assembly_n_per_mm|stiffness_compliance_n_per_mm", 1e-6, 1e6),
    number(Kind::Springs, STIFFNESS, SMALLEST, 1e6),
    // The remote centre may lie on either side of the TCP.
    number(Kind::Finger, RCC_KEY, -1e6, 1e6),
    finger("finger.rotation_x_nm_per_rad|rotation_y_nm_per_rad|rotation_z_nm_per_rad"),
    finger("finger.depth_n_per_mm|mass_g"),
    finger("finger.damping_n_s_per_m|rotational_damping_nm_s_per_rad"),
    // From the stiffness of a cushion to that of a machine tool. A larger value is probably in N/m.
    number(Kind::Robot, "robot.stiffness_n_per_mm", 0.01, 5e3),
    number(Kind::Robot, "robot.stop_force_n", 0.1, 1e5),
    number(Kind::Robot, "robot.mass_kg", 1e-3, 1e3),
    number(Kind::Robot, "robot.inertia_kg_m2", 1e-7, 1e3),
    number(Kind::Robot, "robot.damping_ratio", 1e-3, 100.0),
    fixed("robot.rotational_stiffness_nm_per_rad.*", 0.01, 1e6),
    fixed("robot.assembly_force_n", 0.1, 1e5),
    fixed("robot.home_deg|tool_turn_deg.*", -720.0, 720.0),
    fixed("robot.tool_mm.*", -1e4, 1e4),
    fixed("robot.joint.*.offset_mm|link_centre_mm.*", -1e4, 1e4),
    fixed("robot.joint.*.turn_deg.*", -720.0, 720.0),
    fixed("robot.joint.*.stiffness_nm_per_rad|limit_nm", 0.01, 1e6),
    fixed("robot.joint.*.damping_nms_per_rad", 0.0, 1e9),
    fixed("robot.joint.*.link_mass_kg", 1e-3, 1e3),
    fixed("robot.joint.*.link_inertia_kg_m2.*", 1e-7, 1e3),
    error("cell.start_y_mm|start_across_mm|grasp_across_mm|grasp_low_mm", 20.0),
    error("cell.start_tilt_deg|socket_yaw_deg", 30.0),
    error("cell.friction_finger_percent|friction_socket_percent", 100.0),
    error("cell.clearance_mm", 2.0),
    error("cell.compliance_error_sd|assembly_error_sd", 10.0),
    fixed("uncertainty.offset.sd_mm|across_sd_mm", 0.0, 20.0),
    fixed("uncertainty.yaw.sd_deg", 0.0, 30.0),
    fixed("uncertainty.friction.half_width_percent", 0.0, 99.9),
    fixed("uncertainty.stiffness.sd_factor", 0.0, 10.0),
    fixed("uncertainty.clearance.half_width_mm", 0.0, 2.0),
    fixed("uncertainty.grasp.across_sd_mm|low_max_mm", 0.0, 20.0),
    fixed("uncertainty.success_rate.trials", 1.0, 1e5),
    fixed("uncertainty.success_rate.confidence_percent", 1e-4, 99.9999),
    // A standard deviation needs two samples.
    fixed("uncertainty.robust_range.samples", 2.0, 1e5),
    fixed("uncertainty.robust_range.sd_factor", 0.0, 100.0),
];

impl NumberSpec {
    /// Returns the paths of the pattern, with `*` for a name or a list index.
    pub fn paths(&self) -> Vec<String> {
        let start = vec![String::new()];
        let paths = self.pattern.split('.').fold(start, |paths, word| {
            let each = |path: &String| word.split('|').map(|one| format!("{path}.{one}")).collect();
            paths.iter().flat_map::<Vec<String>, _>(each).collect()
        });
        paths.into_iter().map(|path| path.trim_start_matches('.').to_owned()).collect()
    }
}

/// Returns the paths of all numbers of a kind.
pub fn paths(kind: Kind) -> Vec<String> {
    NUMBERS.iter().filter(|number| number.kind == kind).flat_map(NumberSpec::paths).collect()
}

/// Returns the error message for a number that is out of the bounds of its path; `None` if it is within them or the
/// path is not in the table.
pub fn problem(path: &str, value: f64) -> Option<String> {
    let number = NUMBERS.iter().find(|number| matches(number.pattern, path))?;
    out_of_bounds(path, value, number.bounds)
}

/// Returns whether a path matches a pattern; a name in place of `*` may contain dots. Does not expand patterns, since
/// every number of every file is looked up.
fn matches(pattern: &str, path: &str) -> bool {
    let split = pattern.split_once('.');
    let (word, rest) = (split.map_or(pattern, |(word, _)| word), split.map(|(_, rest)| rest));
    let goes_on = |after: &str| match (rest, after.strip_prefix('.')) {
        (Some(rest), Some(path)) => matches(rest, path),
        (rest, _) => rest.is_none() && after.is_empty(),
    };
    if word == "*" {
        let mut ends = path.match_indices('.').map(|(end, _)| end).chain([path.len()]);
        ends.any(|end| goes_on(&path[end..]))
    } else {
        word.split('|').any(|one| path.strip_prefix(one).is_some_and(goes_on))
    }
}

/// Returns every path of the table with its entry; each `*` is replaced by the word of `path` at its position.
pub(crate) fn filled_paths(path: &str) -> impl Iterator<Item = (String, &'static NumberSpec)> {
    let words: Vec<&str> = path.split('.').collect();
    let all =
        NUMBERS.iter().flat_map(|number| number.paths().into_iter().map(move |p| (p, number)));
    all.map(move |(pattern, number)| (filled(&pattern, &words), number))
}

/// Returns a pattern with each `*` replaced by the word at its position. If there are more
/// words than in the pattern, the first `*` takes several, since names may contain dots.
fn filled(pattern: &str, words: &[&str]) -> String {
    let own: Vec<&str> = pattern.split('.').collect();
    let (mut at, mut more) = (0, words.len().saturating_sub(own.len()));
    let fill = |word: &&str| {
        let end = if *word == "*" { at + 1 + std::mem::take(&mut more) } else { at + 1 };
        let taken = words.get(at..end).filter(|_| *word == "*");
        at = end;
        taken.map_or(word.to_string(), |words| words.join("."))
    };
    own.iter().map(fill).collect::<Vec<_>>().join(".")
}

/// Checks a number against the bounds of its path.
///
/// # Errors
/// See [`problem`].
pub fn check(check: Check<'_>, path: &str, value: f64) -> Result<(), InputError> {
    problem(path, value).map_or(Ok(()), |problem| check.fail(path, problem))
}

/// Checks the numbers of a file that are in the table against their bounds; `root` is the first word of their paths.
///
/// # Errors
/// If a number is out of bounds; the error is about the first one.
pub fn check_file(root: &str, content: &Value, file: &str) -> Result<(), InputError> {
    let all: Vec<_> = NUMBERS.iter().map(|number| (number, number.pattern)).collect();
    check_value(Check { file }, "", content, &advance(&all, |word| word == root))
}

/// Entry of the table whose pattern matches the beginning of a path, and the rest of the pattern.
type PartialMatch = (&'static NumberSpec, &'static str);

/// Returns the entries whose patterns continue with a matching word, advanced by this word.
fn advance(rows: &[PartialMatch], fits: impl Fn(&str) -> bool) -> Vec<PartialMatch> {
    let after = |(number, rest): &PartialMatch| {
        let (word, rest) = rest.split_once('.').unwrap_or((rest, ""));
        word.split('|').any(&fits).then_some((*number, rest))
    };
    rows.iter().filter_map(after).collect()
}

fn check_value(
    check: Check<'_>,
    key: &str,
    value: &Value,
    rows: &[PartialMatch],
) -> Result<(), InputError> {
    match value {
        Value::Table(table) => table.iter().try_for_each(|(word, value)| {
            let key = match key {
                "" => word.clone(),
                item if item.ends_with('"') => format!("{item} {word}"),
                table => format!("{table}.{word}"),
            };
            check_value(check, &key, value, &advance(rows, |one| one == word))
        }),
        Value::Array(items) => {
            let mut below = advance(rows, |one| one == "*");
            // A pattern that ends at a list applies to all its numbers, which vary together.
            below.extend(rows.iter().filter(|(_, rest)| rest.is_empty()));
            items.iter().try_for_each(|item| {
                let name = item.get("name").and_then(Value::as_str);
                let key = name.map_or(key.to_owned(), |name| format!("{key} \"{name}\""));
                check_value(check, &key, item, &below)
            })
        }
        Value::Integer(whole) => check_value(check, key, &Value::Float(*whole as f64), rows),
        Value::Float(number) => {
            let row = rows.iter().find(|(_, rest)| rest.is_empty());
            let problem = row.and_then(|(row, _)| out_of_bounds(key, *number, row.bounds));
            problem.map_or(Ok(()), |problem| check.fail(key, problem))
        }
        _ => Ok(()),
    }
}

/// Returns the error message for a number out of bounds, in the unit of its key.
pub(crate) fn out_of_bounds(key: &str, value: f64, [low, high]: [f64; 2]) -> Option<String> {
    // A NaN is outside.
    let outside = !(low..=high).contains(&value);
    outside.then(|| {
        let unit = label(key).1;
        let other = wrong_unit::other(unit, value, [low, high]);
        let other = other.map_or(String::new(), |other| format!("; {other}"));
        let [value, low, high] = [value, low, high].map(shown);
        format!("is {value}; it must lie in {low} .. {high}{unit}{other}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_path_of_the_table_has_its_bounds_and_others_have_none() {
        for path in NUMBERS.iter().flat_map(NumberSpec::paths) {
            let named = path.replacen('*', "a name.with a dot", 1).replace('*', "0");
            assert!(problem(&named, f64::NAN).is_some(), "{named}");
        }
        for path in ["task.friction", "task.friction.plug_socket.more", "friction.plug_socket", ""]
        {
            assert_eq!(problem(path, f64::NAN), None, "{path}");
        }
        assert_eq!(problem(FRICTION, 0.2), None);
    }
}
