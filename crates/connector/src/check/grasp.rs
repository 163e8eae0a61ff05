//! Checks of the grasp: pads, roofs, and the faces between the pads.

use super::{Problem, TaskBodies, interval, mm};
use crate::hold::{PadContacts, SEAM, default_grasp, pad_contacts};
use input::units::MM;

/// Smallest height over which a pad must touch its face, m.
const MIN_COVER: f64 = 1.0 * MM;

/// Checks the grasp: pads, roofs and TCP.
pub(super) fn problems(case: &TaskBodies) -> Vec<Problem> {
    let grip = &case.task.grip;
    let pads = pad_contacts(&case.plug, grip.shoulder_z, Some(grip.faces_y));
    let mut found: Vec<_> = faces(case, &pads).or_else(|| cover(case, &pads)).into_iter().collect();
    found.extend(roof(case, &pads));
    let [low, high] = pads.pad_z;
    if !(low..=high).contains(&grip.tcp_z) {
        let [tcp, low, high] = [grip.tcp_z, low, high].map(mm);
        found.push(Problem::new(
            "grip.tcp_z_mm",
            format!("{tcp} mm is not between the pads, which reach from {low} to {high} mm"),
            format!("about 3 mm below the shoulder: {} mm", mm(grip.shoulder_z - 3.0 * MM)),
        ));
    }
    let over = low - case.task.success.depth;
    if over < 0.0 {
        let by = mm(-over);
        found.push(Problem::new(
            "grip.shoulder_z_mm",
            format!("at the success depth the pads reach {by} mm into the socket"),
            format!("hold the plug at least {by} mm higher, or reduce success.depth_mm"),
        ));
    }
    found
}

/// Checks that the stated faces are those of the plug between the pads.
fn faces(case: &TaskBodies, pads: &PadContacts) -> Option<Problem> {
    let stated = case.task.grip.faces_y;
    let [low, high] = pads.pad_z.map(mm);
    let Some(real) = pads.faces else {
        return Some(Problem::new(
            "grip.shoulder_z_mm",
            format!("between the pads, at heights of {low} to {high} mm, there is no plug"),
            remedy(case),
        ));
    };
    let side = |i: usize| {
        let (y, part) = real[i];
        let off = [-1.0, 1.0][i] * (stated[i] - y);
        if off.abs() <= SEAM {
            return None;
        }
        let name = &case.plug.parts[part].name;
        let (label, by, stated, y) = (["-y", "+y"][i], mm(off.abs()), mm(stated[i]), mm(y));
        let fault = match off > 0.0 {
            true => {
                format!("is {by} mm outside `{name}`, which ends at {y} mm between the pads")
            }
            false => format!("lies {by} mm inside `{name}`, which reaches {y} mm"),
        };
        let widest = interval(real.map(|(y, _)| y));
        Some(Problem::new(
            "grip.faces_y_mm",
            format!("the face at {label}, {stated} mm, {fault}"),
            format!("{widest}: where the plug is widest between {low} and {high} mm"),
        ))
    };
    (0..2).find_map(side)
}

/// Checks that the pads cover enough of the plug, also at the slip limit.
fn cover(case: &TaskBodies, pads: &PadContacts) -> Option<Problem> {
    let grip = &case.task.grip;
    let cover = pads.cover[0].min(pads.cover[1]);
    let [low, high] = pads.pad_z.map(mm);
    let (limit, met) = (mm(grip.slip_limit), mm(cover));
    if cover < MIN_COVER {
        return Some(Problem::new(
            "grip.shoulder_z_mm",
            format!("the pads, {low} to {high} mm, touch only {met} mm of the grip block"),
            remedy(case),
        ));
    }
    (grip.slip_limit > cover + SEAM).then(|| {
        Problem::new(
            "grip.slip_limit_mm",
            format!("is {limit} mm, but the pads cover only {met} mm of the plug, so that it slips out at a smaller slip"),
            format!("at most {} mm", mm(0.9 * cover)),
        )
    })
}

/// Checks that the roofs rest on the plug, so that they can push it in.
fn roof(case: &TaskBodies, pads: &PadContacts) -> Option<Problem> {
    let shoulder = case.task.grip.shoulder_z;
    let wrong = |top: &Option<f64>| top.is_none_or(|z| (z - shoulder).abs() > SEAM);
    let top = pads.under_roof.iter().find(|top| wrong(top))?;
    let at = mm(shoulder);
    let rest = format!("the roofs should rest at {at} mm, but");
    let problem = match top.map(|z| (z > shoulder, mm(z))) {
        Some((true, top)) => {
            format!("{rest} the plug reaches {top} mm there: they would be inside it")
        }
        Some((false, top)) => {
            format!("{rest} the plug's shoulder is at {top} mm: nothing transmits the push")
        }
        None => format!("at {at} mm there is nothing under the roofs that could transmit the push"),
    };
    Some(Problem::new("grip.shoulder_z_mm", problem, remedy(case)))
}

/// Returns a grasp that would hold the plug, as advice.
fn remedy(case: &TaskBodies) -> String {
    match default_grasp(&case.plug, MIN_COVER) {
        Some((shoulder, faces)) => {
            let ([shoulder, tcp], faces) =
                ([shoulder, shoulder - 3.0 * MM].map(mm), interval(faces));
            format!(
                "shoulder_z_mm = {shoulder}, tcp_z_mm = {tcp}, faces_y_mm = {faces} would hold it"
            )
        }
        None => "give the plug a block with two faces across y and a top that the roofs rest on"
            .to_owned(),
    }
}
