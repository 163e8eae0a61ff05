//! Mated pose of a plug in its socket: the poses that were found, and the requested one.

use super::bodies::PairRequest;
use crate::context::{Context, not_stopped};
use crate::failure::{Failure, within};
use clap::ValueEnum;
use connector::mating::{Mate, MatingError, MatingResult, assembled, mates, mirrored};
use connector::mesh::axes::{InsertionAxis, JawAxis, value};
use connector::mesh::{Files, Triangle};
use input::units::{DEG, MM};
use nalgebra::Vector3;
use serde::Serialize;

/// Pose in which the plug can be mated.
#[derive(Debug, Clone, Serialize)]
pub struct MatedPose {
    /// Direction of insertion in the file of the socket.
    insert_along: String,
    /// Depth of the plug's tip below the socket's edge.
    depth_mm: f64,
    /// Angle between this pose and the first.
    turn_deg: f64,
    /// Place of the origin of the plug's file, in the file of the socket.
    origin_mm: [f64; 3],
}

impl MatedPose {
    fn new(mate: &Mate, first: &Mate) -> Self {
        MatedPose {
            insert_along: value(insert_along(mate)),
            depth_mm: mate.depth_m() / MM,
            turn_deg: mate.pose.rotation.angle_to(&first.pose.rotation) / DEG,
            origin_mm: (mate.pose.translation.vector / MM).into(),
        }
    }

    fn text(&self) -> String {
        let MatedPose { insert_along, depth_mm, turn_deg, origin_mm: [x, y, z] } = self;
        format!(
            "along {insert_along}, {depth_mm:.2} mm deep, turned by {turn_deg:.0}°, the plug's origin at \
             [{x:.2}, {y:.2}, {z:.2}] mm of the socket's file"
        )
    }
}

/// Returns the names of plug and socket; an assembly has one.
pub fn names([plug, socket]: Files) -> String {
    if plug == socket { plug.to_owned() } else { format!("{plug}, {socket}") }
}

/// Returns the requested mate and all that were found in the given direction, the best first.
///
/// # Errors
/// If there is none, or fewer than requested.
pub fn mate(
    files: Files,
    [plug, socket]: [&[Triangle]; 2],
    request: &PairRequest,
    context: &Context<'_>,
    findings: &mut Vec<(&'static str, String)>,
) -> Result<(Mate, Vec<MatedPose>), Failure> {
    let found = match request.assembly.is_some() {
        true => assembled(plug, socket).map(|mate| MatingResult { mates: vec![mate], copies: 1 }),
        false => mates(plug, socket, context.stop),
    };
    not_stopped(context.stop)?;
    let nowhere = |why: String| Failure::in_file(names(files), why);
    let found = found.map_err(|error| {
        let fits = (error == MatingError::NoFit)
            .then(|| mirrored_fit([plug, socket], request.insert_along, context));
        nowhere(match fits.flatten() {
            Some((_, text)) => format!("the plug does not fit into the socket; {text}"),
            None => error.to_string(),
        })
    });
    // The mirrored plug may have been cancelled.
    not_stopped(context.stop)?;
    let MatingResult { mates: mut all, copies } = found?;
    if copies > 1 {
        findings.push(("symmetry", format!("the first of {copies} equal poses is taken")));
    }
    if let Some(along) = request.insert_along {
        all.retain(|mate| insert_along(mate) == along);
    }
    let Some(first) = all.first() else {
        let along = request.insert_along.map(value).unwrap_or_default();
        return Err(nowhere(format!("the plug does not go in along {along}")));
    };
    let poses: Vec<_> = all.iter().map(|mate| MatedPose::new(mate, first)).collect();
    within("--pose", request.pose, &(1..=poses.len()))?;
    if poses.len() > 1 {
        let list = (1..).zip(&poses).map(|(i, pose)| format!("{i} {}", pose.text()));
        let list = list.collect::<Vec<_>>().join("; ");
        findings.push(("poses", format!("{} is taken (--pose): {list}", request.pose)));
    }
    let taken = all.swap_remove(request.pose - 1);
    if taken.missed_m > 0.0 {
        let given = request.assembly.is_some() || request.depth_mm.is_some();
        let stops = stopped_early(&taken, [plug, socket], given, context);
        not_stopped(context.stop)?;
        findings.push(("warning", stops.map_err(nowhere)?));
    }
    Ok((taken, poses))
}

/// Returns the depth over which a mirrored plug engages in the given direction, mm, and a remark on it; `None` if it
/// does not reach its seat.
fn mirrored_fit(
    [plug, socket]: [&[Triangle]; 2],
    along: Option<InsertionAxis>,
    context: &Context<'_>,
) -> Option<(f64, String)> {
    let mut found = mates(&mirrored(plug), socket, context.stop).ok()?.mates.into_iter();
    let mate = found.find(|mate| along.is_none_or(|along| insert_along(mate) == along));
    let mm = mate.filter(|mate| mate.missed_m == 0.0)?.engaged_m / MM;
    Some((mm, format!("mirrored, it engages over {mm:.2} mm: mirror one of the two")))
}

/// Returns a warning of a plug that stops before its seat; `given` is whether an assembly or the depth is given.
///
/// # Errors
/// Unless it is given, if a mirrored plug engages deeper, or if the plug stops before half of its depth.
fn stopped_early(
    mate: &Mate,
    parts: [&[Triangle]; 2],
    given: bool,
    context: &Context<'_>,
) -> Result<String, String> {
    let [engaged, missed] = [mate.engaged_m, mate.missed_m].map(|depth| depth / MM);
    let possible = engaged + missed;
    let stops = format!("the plug stops after {engaged:.2} of {possible:.2} mm, beside its seat");
    if given {
        return Ok(stops);
    }
    match mirrored_fit(parts, Some(insert_along(mate)), context) {
        Some((mm, text)) if mm > engaged => Err(format!("{stops}; {text}")),
        _ if missed > engaged => Err(format!(
            "{stops}: is a key on the wrong side, or a screw in the way? correct the file, select bodies with --plug-body, or \
             confirm the depth with --depth-mm {:.2}",
            mate.depth_m() / MM
        )),
        _ => Ok(stops),
    }
}

/// Returns the depth to be reached, m: that of the request, or that of the mated pose. `long` is the
/// length of the plug along the axis, m.
///
/// # Errors
/// If the requested depth is larger than plug and socket allow.
pub fn depth(request: &PairRequest, mate: &Mate, long: f64) -> Result<f64, Failure> {
    let Some(depth_mm) = request.depth_mm else { return Ok(mate.depth_m()) };
    // A plug that goes along a post engages over more than its length.
    let most_mm = (long.max(mate.depth_m()) / MM * 100.0).round() / 100.0;
    if depth_mm <= most_mm {
        return Ok(depth_mm * MM);
    }
    let problem = format!("plug and socket are long enough for at most {most_mm} mm");
    Err(Failure::usage(format!("--depth-mm {depth_mm}: {problem}")))
}

/// Returns the direction of insertion of a mate, in the file of the socket.
pub(super) fn insert_along(mate: &Mate) -> InsertionAxis {
    let way = -mate.out.into_inner();
    let axis = way.iamax();
    InsertionAxis::value_variants()[2 * axis + usize::from(way[axis] < 0.0)]
}

pub(super) fn jaws_of(way: &Vector3<f64>) -> JawAxis {
    [JawAxis::X, JawAxis::Y, JawAxis::Z][way.iamax()]
}
