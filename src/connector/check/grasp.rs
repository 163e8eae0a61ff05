//! Pads, roofs and the faces they are to hold.

use super::{Case, Problem, mm};
use crate::connector::hold::{Held, SEAM, find, held};
use input::units::MM;

/// Least height of a pad that must press a face, m.
const LEAST_COVER: f64 = 1.0 * MM;

pub(super) fn problems(case: &Case) -> Vec<Problem> {
    let grip = &case.task.grip;
    let held = held(&case.plug, grip.shoulder_z, Some(grip.faces_y));
    let mut found = faces(case, &held);
    if found.is_empty() {
        found.extend(cover(case, &held));
    }
    found.extend(roof(case, &held));
    let [low, high] = held.pad_z;
    if !(low..=high).contains(&grip.tcp_z) {
        found.push(Problem::new(
            "grip.tcp_z_mm",
            format!(
                "{} mm is not between the pads, which reach from {} to {} mm",
                mm(grip.tcp_z),
                mm(low),
                mm(high)
            ),
            format!("about 3 mm below the shoulder: {} mm", mm(grip.shoulder_z - 3.0 * MM)),
        ));
    }
    let over = low - case.task.success.depth;
    if over < 0.0 {
        found.push(Problem::new(
            "grip.shoulder_z_mm",
            format!("at the success depth the pads reach {} mm into the socket", mm(-over)),
            format!("hold the plug at least {} mm higher, or ask for less depth", mm(-over)),
        ));
    }
    found
}

fn faces(case: &Case, held: &Held) -> Vec<Problem> {
    let stated = case.task.grip.faces_y;
    let [low, high] = held.pad_z.map(mm);
    let Some(real) = held.faces else {
        return vec![Problem::new(
            "grip.shoulder_z_mm",
            format!("between the pads, at heights of {low} to {high} mm, there is no plug"),
            better(case),
        )];
    };
    let side = |i: usize| {
        let (y, part) = real[i];
        let off = [-1.0, 1.0][i] * (stated[i] - y);
        if off.abs() <= SEAM {
            return None;
        }
        let name = &case.plug.parts[part].name;
        let (label, by) = (["-y", "+y"][i], mm(off.abs()));
        let problem = match off > 0.0 {
            true => format!(
                "the face at {label}, {} mm, is {by} mm off the plug: between the pads it ends with `{name}` at {} mm",
                mm(stated[i]),
                mm(y)
            ),
            false => format!(
                "the face at {label}, {} mm, lies {by} mm inside `{name}`, which reaches {} mm",
                mm(stated[i]),
                mm(y)
            ),
        };
        let right = format!(
            "[{}, {}]: where the plug is widest between {low} and {high} mm",
            mm(real[0].0),
            mm(real[1].0)
        );
        Some(Problem::new("grip.faces_y_mm", problem, right))
    };
    (0..2).filter_map(side).take(1).collect()
}

fn cover(case: &Case, held: &Held) -> Vec<Problem> {
    let grip = &case.task.grip;
    let cover = held.cover[0].min(held.cover[1]);
    let [low, high] = held.pad_z.map(mm);
    if cover < LEAST_COVER {
        return vec![Problem::new(
            "grip.shoulder_z_mm",
            format!("the pads, {low} to {high} mm, meet only {} mm of the grip block", mm(cover)),
            better(case),
        )];
    }
    if grip.slip_limit > cover + SEAM {
        return vec![Problem::new(
            "grip.slip_limit_mm",
            format!(
                "is {} mm, but the pads hold only {} mm of the plug: it has left them by then",
                mm(grip.slip_limit),
                mm(cover)
            ),
            format!("at most {} mm", mm(0.9 * cover)),
        )];
    }
    Vec::new()
}

/// The roofs push the plug in: they must rest on it.
fn roof(case: &Case, held: &Held) -> Option<Problem> {
    let shoulder = case.task.grip.shoulder_z;
    let wrong = |top: &Option<f64>| top.is_none_or(|z| (z - shoulder).abs() > SEAM);
    let top = held.under_roof.iter().find(|top| wrong(top))?;
    let problem = match top {
        Some(z) if *z > shoulder => format!(
            "the roofs are to rest at {} mm, but there the plug goes on to {} mm: they would lie in it",
            mm(shoulder),
            mm(*z)
        ),
        Some(z) => format!(
            "the roofs are to rest at {} mm, but the plug's shoulder is at {} mm: nothing carries the push",
            mm(shoulder),
            mm(*z)
        ),
        None => format!(
            "at {} mm there is nothing under the roofs that could carry the push",
            mm(shoulder)
        ),
    };
    Some(Problem::new("grip.shoulder_z_mm", problem, better(case)))
}

/// A grasp that would do, if there is one.
fn better(case: &Case) -> String {
    match find(&case.plug, LEAST_COVER) {
        Some((shoulder, [low, high])) => format!(
            "shoulder_z_mm = {}, tcp_z_mm = {}, faces_y_mm = [{}, {}] would hold it",
            mm(shoulder),
            mm(shoulder - 3.0 * MM),
            mm(low),
            mm(high)
        ),
        None => "give the plug a block with two faces across y and a top that the roofs rest on"
            .to_owned(),
    }
}
