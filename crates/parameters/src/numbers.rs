//! Table of all numbers that can vary, with plausible bounds. Each path contains its unit.
//!
//! In a pattern `*` matches a name or a list index (a phase, a part, an end of a span), and `a|b`
//! either word.

/// Infill density.
pub const DENSITY: &str = "infill_density_percent";
/// Infill direction.
pub const DIRECTION: &str = "infill_direction_deg";
/// Friction between plug and socket.
pub const FRICTION: &str = "task.friction.plug_socket";
/// Friction between pad and plug.
pub const PAD_FRICTION: &str = "task.friction.finger_plug";
/// Change of the width of the socket's opening.
pub const CLEARANCE: &str = "task.clearance_mm";
/// Radius of the lead-in edges, for a task with sharp ones.
pub const EDGE_RADIUS: &str = "task.edge_radius_mm";
/// Chamfer at the socket's opening, for a task without one.
pub const CHAMFER: &str = "task.opening_chamfer_mm";
/// Common factor on the stiffness of a finger in compliance and in assembly direction.
pub const STIFFNESS: &str = "finger.stiffness";
/// Distance of a finger's remote centre of compliance below the TCP.
pub const CENTRE: &str = "finger.rcc_mm";
/// Rotational spring of a finger about x.
pub const TILTING: &str = "finger.rotation_x_nm_per_rad";
/// Stiffness along x of a compliant flange; its other stiffnesses scale in proportion.
pub const FLANGE: &str = "robot.stiffness_n_per_mm";
/// Shift of the start along x.
pub const START_ACROSS: &str = "cell.start_across_mm";
/// Rotation of the start about x, in addition to the tilt of the search.
pub const START_TILT: &str = "cell.start_tilt_deg";
/// Rotation of the socket about z.
pub const SOCKET_YAW: &str = "cell.socket_yaw_deg";

/// Object on which a number is set, and how.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A coordinate of the infill.
    Infill,
    /// In the text of a task or finger file, before its checks.
    File,
    /// In the finger built from the files.
    Finger,
    /// In the robot built from its file.
    Robot,
    /// Added to a shape of the task; its nominal value is 0.
    Added,
    /// Factor on both springs of the finger.
    Springs,
    /// Random error of an insertion, relative to nominal.
    Error,
}

/// Row of the table: pattern of the paths, and plausible bounds in their unit.
#[derive(Debug, PartialEq)]
pub struct Number {
    /// Pattern of the paths.
    pub pattern: &'static str,
    /// Object on which it is set.
    pub kind: Kind,
    /// Smallest and largest plausible value.
    pub bounds: [f64; 2],
}

const fn number(kind: Kind, pattern: &'static str, low: f64, high: f64) -> Number {
    Number { pattern, kind, bounds: [low, high] }
}
const fn file(pattern: &'static str, low: f64, high: f64) -> Number {
    number(Kind::File, pattern, low, high)
}
const fn error(pattern: &'static str, largest: f64) -> Number {
    number(Kind::Error, pattern, -largest, largest)
}
/// A coordinate or a difference of two, mm.
const fn distance(pattern: &'static str) -> Number {
    file(pattern, -1e3, 1e3)
}
/// A length above 0, mm, or a time, s.
const fn length(pattern: &'static str) -> Number {
    file(pattern, LEAST, 1e3)
}
/// Least value of a number that must be positive.
const LEAST: f64 = 1e-9;

/// All numbers that can vary. The joint parameters of an arm are excluded: together they describe
/// one published arm.
pub static NUMBERS: &[Number] = &[
    // A density of 0 is not a valid finger.
    number(Kind::Infill, DENSITY, 0.1, 100.0),
    number(Kind::Infill, DIRECTION, 0.0, 90.0),
    file("task.turn_in_base_deg", -360.0, 360.0),
    file("task.plug.mass_g", LEAST, 1e6),
    distance("task.plug.latch.root_mm|end_mm.*"),
    length("task.plug.latch.width_mm|thickness_mm"),
    file("task.plug.latch.modulus_gpa", LEAST, 1e6),
    distance("task.plug|socket.part.*.x_mm|y_mm|z_mm|centre_mm|span_mm.*"),
    distance("task.plug|socket.part.*.outline_mm|points_mm.*.*"),
    length("task.plug|socket.part.*.diameter_mm"),
    length("task.plug|socket.part.*.edges.*.chamfer_mm|radius_mm"),
    file("task.plug|socket.part.*.friction", 0.0, 5.0),
    distance("task.socket.opening_x_mm|opening_y_mm.*"),
    length("task.grip.tcp_z_mm|shoulder_z_mm|slip_limit_mm"),
    distance("task.grip.faces_y_mm.*"),
    file("task.grip.force_n", LEAST, 1e6),
    file("task.friction.plug_socket|finger_plug", 0.0, 5.0),
    file("task.friction.finger_plug_torsion_mm", 0.0, 500.0),
    distance("task.finger.rcc_mm"),
    distance("task.finger.rcc_mm.at_0_deg|per_deg"),
    file("task.finger.coupling.*.coefficient", -1.0, 1.0),
    file("task.strategy.tilt_deg", -45.0, 45.0),
    distance("task.strategy.start_mm.*"),
    distance("task.strategy.phase.*.move_mm.*"),
    file("task.strategy.phase.*.speed_mm_per_s|touch_force_n", LEAST, 1e6),
    length("task.strategy.phase.*.tolerance_mm|settle_s|preload_mm"),
    file("task.strategy.phase.*.latency_s", 0.0, 1e3),
    length("task.success.depth_mm"),
    file("task.success.tilt_deg", LEAST, 360.0),
    number(Kind::Added, CLEARANCE, -1e3, 1e3),
    number(Kind::Added, EDGE_RADIUS, 0.0, 1e3),
    number(Kind::Added, CHAMFER, 0.0, 1e3),
    length("finger.outline.length_mm|width_mm|depth_mm|tip_mm|back_radius_mm"),
    length("finger.notch.pad_mm|roof_mm"),
    file("finger.notch.pad_deg", 0.0, 60.0),
    length("finger.skin|ribs.thickness_mm"),
    length("finger.ribs.line_spacing_mm"),
    distance("finger.ribs|holes.origin_mm|offset_mm.*"),
    distance("finger.ribs.phase_mm"),
    length("finger.base.solid_mm|clamped_mm"),
    file("finger.mount.tilt_deg", 0.0, 60.0),
    file("finger.material.modulus_gpa", 1e-4, 500.0),
    file("finger.material.poisson", 0.0, 0.5),
    file("finger.material.density_kg_per_m3", LEAST, 1e9),
    length("finger.holes.spacing_mm|diameter_mm"),
    length("finger.holes.block.length_mm|width_mm|overlap_mm"),
    length("finger.print.line_width_mm|smallest_gap_mm"),
    number(Kind::Springs, STIFFNESS, LEAST, 1e6),
    // The remote centre may lie on either side of the TCP.
    number(Kind::Finger, CENTRE, -1e6, 1e6),
    number(
        Kind::Finger,
        "finger.rotation_x_nm_per_rad|rotation_y_nm_per_rad|rotation_z_nm_per_rad",
        LEAST,
        1e6,
    ),
    number(Kind::Finger, "finger.depth_n_per_mm|mass_g", LEAST, 1e6),
    number(Kind::Finger, "finger.damping_n_s_per_m|rotational_damping_nm_s_per_rad", LEAST, 1e6),
    number(Kind::Robot, "robot.stiffness_n_per_mm|stop_force_n", LEAST, 1e6),
    number(Kind::Robot, "robot.mass_kg|inertia_kg_m2|damping_ratio", LEAST, 1e6),
    error("cell.start_y_mm|start_across_mm|grasp_across_mm|grasp_low_mm", 20.0),
    error("cell.start_tilt_deg|socket_yaw_deg", 30.0),
    error("cell.friction_finger_percent|friction_socket_percent", 100.0),
    error("cell.clearance_mm", 2.0),
    error("cell.compliance_error_sd|assembly_error_sd", 10.0),
];

impl Number {
    /// Returns its paths, with `*` for a name or a list index.
    pub fn paths(&self) -> Vec<String> {
        let start = vec![String::new()];
        let paths = self.pattern.split('.').fold(start, |paths, word| {
            let each = |path: &String| word.split('|').map(|one| format!("{path}.{one}")).collect();
            paths.iter().flat_map::<Vec<String>, _>(each).collect()
        });
        paths.into_iter().map(|path| path.trim_start_matches('.').to_owned()).collect()
    }
}

/// Returns the paths of a kind.
pub fn paths(kind: Kind) -> Vec<String> {
    NUMBERS.iter().filter(|number| number.kind == kind).flat_map(Number::paths).collect()
}
