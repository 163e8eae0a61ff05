//! The arm as written in a robot file, and the checks that turn it into an [`Arm`].

use super::{Angles, Arm, JOINTS, Joint};
use contact::scene::{Inertia, Pose};
use input::units::{DEG, MM};
use input::{Check, InputError};
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawArm {
    pub name: String,
    pub description: String,
    pub stop_force_n: f64,
    home_deg: [f64; JOINTS],
    velocity_feed_forward: bool,
    assembly_force_n: f64,
    tool_mm: [f64; 3],
    tool_turn_deg: [f64; 3],
    joint: Vec<RawJoint>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawJoint {
    name: String,
    offset_mm: [f64; 3],
    turn_deg: [f64; 3],
    axis: RawAxis,
    stiffness_nm_per_rad: f64,
    damping_nms_per_rad: f64,
    limit_nm: f64,
    link_mass_kg: f64,
    link_centre_mm: [f64; 3],
    link_inertia_kg_m2: [f64; 3],
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
enum RawAxis {
    X,
    Y,
    Z,
}

/// The arm of a robot file.
pub(crate) fn arm(check: Check<'_>, raw: &RawArm) -> Result<Arm, InputError> {
    let joints = raw.joint.iter().map(|raw| joint(check, raw)).collect::<Result<Vec<_>, _>>()?;
    let count = joints.len();
    let Ok(joints) = <[Joint; JOINTS]>::try_from(joints) else {
        return check.fail("joint", format!("there are {count}; an arm has six [[joint]]"));
    };
    for angle in raw.home_deg {
        check.finite("home_deg", angle)?;
    }
    Ok(Arm {
        joints,
        tool: frame(check, ["tool_mm", "tool_turn_deg"], raw.tool_mm, raw.tool_turn_deg)?,
        home: Angles::from(raw.home_deg) * DEG,
        feed_forward: raw.velocity_feed_forward,
        assembly_force: check.positive("assembly_force_n", raw.assembly_force_n)?,
    })
}

fn joint(check: Check<'_>, raw: &RawJoint) -> Result<Joint, InputError> {
    let at = |field: &str| format!("joint \"{}\" {field}", raw.name);
    for moment in raw.link_inertia_kg_m2 {
        check.positive(&at("link_inertia_kg_m2"), moment)?;
    }
    for length in raw.link_centre_mm {
        check.finite(&at("link_centre_mm"), length)?;
    }
    let [offset, turn] = ["offset_mm", "turn_deg"].map(at);
    Ok(Joint {
        name: raw.name.clone(),
        frame: frame(check, [&offset, &turn], raw.offset_mm, raw.turn_deg)?,
        axis: match raw.axis {
            RawAxis::X => Vector3::x_axis(),
            RawAxis::Y => Vector3::y_axis(),
            RawAxis::Z => Vector3::z_axis(),
        },
        stiffness: check.positive(&at("stiffness_nm_per_rad"), raw.stiffness_nm_per_rad)?,
        damping: check.not_negative(&at("damping_nms_per_rad"), raw.damping_nms_per_rad)?,
        limit: check.positive(&at("limit_nm"), raw.limit_nm)?,
        link: Inertia {
            mass: check.positive(&at("link_mass_kg"), raw.link_mass_kg)?,
            centre: Point3::from(raw.link_centre_mm.map(|v| v * MM)),
            moments: Vector3::from(raw.link_inertia_kg_m2),
        },
    })
}

/// A frame by its origin (mm) and its turns about x, then y, then z (degrees).
fn frame(
    check: Check<'_>,
    keys: [&str; 2],
    origin_mm: [f64; 3],
    turn_deg: [f64; 3],
) -> Result<Pose, InputError> {
    for (key, values) in keys.into_iter().zip([origin_mm, turn_deg]) {
        for value in values {
            check.finite(key, value)?;
        }
    }
    let [x, y, z] = origin_mm.map(|v| v * MM);
    let [roll, pitch, yaw] = turn_deg.map(|v| v * DEG);
    let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Ok(Pose::from_parts(Translation3::new(x, y, z), turn))
}
