//! Creation of a task from the meshes of a plug and its socket, by their mated pose.

use super::bodies::{PairRequest, Parts};
use super::poses::{MatedPose, depth, insert_along, jaws_of, mate, names};
use crate::{Context, Failure};
use connector::body::{extent, longest_side, width};
use connector::draft::Size;
use connector::mating::Mate;
use connector::mesh::axes::{InsertionAxis, JawAxis, Unit, value};
use connector::mesh::mated::{GAP, HANDLE, Interference, Pair, PairTask, TOLERANCE, task};
use connector::mesh::{Files, SIZES, Surface, Triangle, reduced};
use connector::plan::Family;
use connector::seat::{RotationalPlay, rotational_play};
use connector::write::origin;
use input::counted;
use input::units::MM;
use insertion::task::Task;
use nalgebra::{Point3, Vector3};
use serde_json::{Value, json};
use std::path::Path;
use study::write_file;

/// Largest number of overlaps that are listed.
const MAX_SHOWN: usize = 4;
/// Length of a tip ahead of the part that engages above which it is named, mm: longer than rounded edges.
const MIN_NOSE_MM: f64 = 0.5;
/// Ratio of the lengths of all three sides above which two files are probably in different units.
const MAX_RATIO: f64 = 5.0;
/// Names of the bodies of an [`Interference`] or a deviation.
const BODIES: [&str; 2] = ["plug", "socket"];

/// Task of a mated pair.
pub struct MatedTask {
    /// Task, and the interference in the mated pose that was removed from its parts.
    pub made: PairTask,
    /// Name of its strategy: `like usb`.
    pub strategy: String,
    /// Unit of the files.
    pub unit: Unit,
    /// Mated poses that were found, of which the requested one is taken.
    pub poses: Vec<MatedPose>,
    /// Direction of insertion in the file of the socket.
    pub along: InsertionAxis,
    /// Axis of the socket's file along which the jaws close.
    pub jaws: JawAxis,
    /// Play in rotation, both directions together; `None` if the plug turns freely.
    pub turn: Option<RotationalPlay>,
    /// Whether the normals of plug and of socket pointed inward.
    pub inward: [bool; 2],
    /// Findings: the subject and a sentence.
    pub findings: Vec<(&'static str, String)>,
}

/// Returns the parts left out of a body as JSON.
pub fn left_out_json(of: &Interference) -> Value {
    let [from_mm, to_mm] = of.bounds.map(|p| [p.x, p.y, p.z].map(|v| v / MM));
    json!({
        "body": BODIES[of.body],
        "cut_back": of.cut_back,
        "parts": of.parts,
        "depth_mm": of.depth / MM,
        "from_mm": from_mm,
        "to_mm": to_mm,
    })
}

/// Returns the task of a plug and a socket, whose mated pose is found from their shapes; friction and grasp force are
/// those of the task `like`, if there is one.
///
/// # Errors
/// If no unit fits, or if the plug fits into the socket in no pose.
pub fn mated(
    files: Files,
    parts: Parts,
    request: &PairRequest,
    like: Option<&Task>,
    context: &Context<'_>,
) -> Result<MatedTask, Failure> {
    let triangles = parts.triangles.each_ref().map(Vec::as_slice);
    let (unit, why) = unit(files, triangles, parts.unit)?;
    check_sizes(files, triangles, unit != Unit::Mm && why.is_some(), context)?;
    let mut findings: Vec<(&str, String)> = why.map(|why| ("unit", why)).into_iter().collect();
    let drawn: [Vec<Triangle>; 2] =
        triangles.map(|of| of.iter().map(|t| t.map(|p| p * unit.metres())).collect());
    let (plug, plug_inward) = oriented(triangles[0], unit);
    let (socket, socket_inward) = oriented(triangles[1], unit);
    // Begun after the notes on the files, which would break the line of a spinner.
    let _busy = context.busy("making the task from the shapes");
    let (mate, poses) = mate(files, [&plug, &socket], request, context, &mut findings)?;
    let out = mate.out.into_inner();
    let across = mate.across.map(|way| way.into_inner());
    let chosen = |way: &&Vector3<f64>| request.jaws.is_none_or(|jaws| jaws == jaws_of(way));
    let jaws: Vec<Vector3<f64>> = across.iter().filter(chosen).copied().collect();
    if jaws.is_empty() {
        let [a, b] = across.map(|way| value(jaws_of(&way)));
        let along = value(insert_along(&mate));
        let problem = format!("--jaws: the plug goes in along {along}; give {a} or {b}");
        return Err(Failure::usage(problem));
    }
    let long = width(extent(plug.iter().flatten().map(|p| mate.pose * p), out.iamax()));
    let depth = depth(request, &mate, long)?;
    let above = out * (mate.depth_m() - depth);
    let moved = |of: &[Triangle]| -> Vec<Triangle> {
        of.iter().map(|t| t.map(|p| mate.pose * p + above)).collect()
    };
    let (raised, drawn_plug) = (moved(&plug), moved(&drawn[0]));
    let drawn: [&[Triangle]; 2] = [&drawn_plug, &drawn[1]];
    let (nose, play) = (mate.nose_m, [0, 1].map(|i| (across[i], mate.play_m[i])));
    let pair = Pair { plug: &raised, socket: &socket, drawn, out, jaws: &jaws, depth, nose, play };
    let mut made = task(&pair, &request.name(), like, request.body);
    check_held(files, &made, request)?;
    let seat = (!mate.through && depth > mate.depth_m() + TOLERANCE).then_some(mate.depth_m());
    check_drawing(files, &made, seat, &request.out().with_extension("place.svg"))?;
    findings.extend(described(&mate, [long, depth], &made, request.body));
    findings.extend(parts.finding);
    let (along, jaws) = (insert_along(&mate), jaws_of(&made.jaws));
    let like = like.map(|like| Family::Like(Box::new(like.clone())));
    let like = like.and_then(|family| Some((family.strategy_for(&made.task)?, family.name())));
    let mut strategy = "untilted sweep along y".to_owned();
    if let Some(like) = like {
        (made.task.strategy, strategy) = like;
    }
    let inward = [plug_inward, socket_inward];
    let turn = rotational_play(&made.task);
    Ok(MatedTask { made, strategy, unit, poses, along, jaws, turn, inward, findings })
}

/// Checks that the fingers hold a plug that is not the socket, and hold it along the requested axis.
///
/// # Errors
/// If they do not, with the reason.
fn check_held(files: Files, made: &PairTask, request: &PairRequest) -> Result<(), Failure> {
    if made.swapped {
        let [plug, socket] = files;
        let problem = format!(
            "the fingers find no faces to hold on the plug, which encloses the socket, but they do on the socket, {socket}: are \
             plug and socket swapped? otherwise add a handle with --body"
        );
        return Err(Failure::in_file(plug, problem));
    }
    let (Some(jaws), None, true) = (request.jaws, request.body, made.handle) else { return Ok(()) };
    let problem = match made.rejected {
        Some(faces) => {
            format!("the plug's faces {:.1} mm apart: {}", faces.apart / MM, faces.reason)
        }
        None => "the plug has no two opposite faces above the socket".to_owned(),
    };
    let jaws = value(jaws);
    Err(Failure::usage(format!(
        "--jaws {jaws}: {problem}; give another axis, or add a handle with --body"
    )))
}

/// Checks that the convex parts match the drawing; `seat` is the depth at which the plug stops, m, if it is to go deeper.
///
/// # Errors
/// If they do not, with a picture of the largest deviation in the file `closeup`.
fn check_drawing(
    files: Files,
    made: &PairTask,
    seat: Option<f64>,
    closeup: &Path,
) -> Result<(), Failure> {
    let at = |place: Point3<f64>| {
        let [x, y, z] = [place.x, place.y, place.z].map(|v| v / MM);
        format!("at [{x:.2}, {y:.2}, {z:.2}] mm of the task")
    };
    let allowed = TOLERANCE / MM;
    let (file, problem) = match (made.deviation, made.difference) {
        (Some((body, off)), _) => {
            let how = match off.out {
                Some(f64::INFINITY) => "protrude from a drawing without faces".to_owned(),
                Some(far) => format!("protrude {:.3} mm from the drawing", far / MM),
                None => "lack a face of the drawing".to_owned(),
            };
            let at = at(off.place);
            let (file, body) = (files[body].to_owned(), BODIES[body]);
            (file, format!("the convex parts of the {body} {how} {at}, in the mated pose"))
        }
        (None, Some(off)) => {
            let [drawn, parts] = off.gaps.map(|gap| gap / MM);
            let height = (off.pose.translation.z - made.mated_z()) / MM;
            let problem = format!(
                "the gap {} is {parts:.3} mm between the convex parts and {drawn:.3} mm as drawn, plug {height:.2} mm \
                 above its seat",
                at(off.place)
            );
            (names(files), problem)
        }
        (None, None) => return Ok(()),
    };
    write_file(closeup, made.closeup.as_deref().unwrap_or_default())?;
    let deepest = made.interference.iter().map(|of| of.depth / MM).fold(0.0, f64::max);
    let cause = match (seat, made.deviation.is_none() && deepest > 0.0) {
        (Some(seat), _) => {
            format!("the plug stops {:.2} mm deep: give at most that as --depth-mm", seat / MM)
        }
        (None, true) => {
            let other = if files[0] == files[1] { "" } else { "give an assembly of both, or " };
            format!(
                "plug and socket overlap by up to {deepest:.2} mm: {other}correct the drawing if they do not when mated"
            )
        }
        (None, false) => {
            "look there for faces that cross one another or are turned inside out".to_owned()
        }
    };
    let problem =
        format!("{problem}: more than the {allowed} mm allowed; {cause} ({})", closeup.display());
    Err(Failure::in_file(file, problem))
}

/// Returns findings about the mate of a plug of this length along the axis, with this depth to be reached, m, and the
/// grip.
fn described(
    mate: &Mate,
    lengths: [f64; 2],
    made: &PairTask,
    handle: Option<Size>,
) -> Vec<(&'static str, String)> {
    let [depth, nose] = [mate.depth_m(), mate.nose_m].map(|length| length / MM);
    let [long, needed] = lengths.map(|length| length / MM);
    let engaged = match depth <= long {
        true if nose > MIN_NOSE_MM => format!(
            "{:.2} mm of the plug's {long:.2} mm engage, behind a nose of {nose:.2} mm",
            depth - nose
        ),
        true => format!("{depth:.2} mm of the plug's {long:.2} mm engage"),
        false => format!("the plug of {long:.2} mm goes {depth:.2} mm along a post"),
    };
    let mut findings =
        vec![("mate", format!("{engaged}; the task's z = 0 is {}", origin(made.top)))];
    if mate.through {
        findings
            .push(("through", format!("nothing stops the plug: {needed:.2} mm must be reached")));
    }
    if made.handle {
        let Size { width, height, length } = handle.unwrap_or(HANDLE);
        let [y, x, z] = [width, height, length].map(|side| side / MM);
        let why = match handle {
            Some(_) => "",
            None => "the pads find no two opposite faces below a top face for their roofs: ",
        };
        // In the order of the option.
        let block = format!("{y:.1} x {x:.1} x {z:.1} mm");
        let text = format!("{why}a block of {block} is added on top of the plug (--body)");
        findings.push(("handle", text));
    } else {
        let apart = width(made.task.grip.faces_y) / MM;
        let grip = made.task.plug.parts.iter().rfind(|part| part.name == "grip");
        let z = grip.map_or([0.0; 2], |part| extent(part.solid.corners(), 2));
        let [low, high] = z.map(|z| z / MM);
        let text = format!(
            "faces {apart:.1} mm apart, {low:.1} to {high:.1} mm above the tip; --jaws selects others, --body adds a handle"
        );
        findings.push(("grip", text));
    }
    if let (Some(faces), None) = (made.rejected, handle) {
        let (apart, reason) = (faces.apart / MM, faces.reason);
        findings.push(("not held", format!("larger faces {apart:.1} mm apart: {reason}")));
    }
    let mut left_out: Vec<&Interference> = made.interference.iter().collect();
    left_out.sort_by(|a, b| (b.depth / MM).total_cmp(&(a.depth / MM)));
    let more = left_out.split_off(left_out.len().min(MAX_SHOWN));
    for left in left_out {
        let rounded = |p: Point3<f64>| [p.x, p.y, p.z].map(|v| (v / MM * 100.0).round() / 100.0);
        let [from, to] = left.bounds.map(rounded);
        let why = format!(
            "{} of the {}, up to {:.3} mm, from {from:?} to {to:?} mm of the task: {}",
            counted(left.parts, "part"),
            BODIES[left.body],
            left.depth / MM,
            match left.cut_back {
                true => format!("a press fit, cut back to a gap of {} mm", GAP / MM),
                false => "left out".to_owned(),
            }
        );
        findings.push(("overlap", why));
    }
    if !more.is_empty() {
        let parts: usize = more.iter().map(|left| left.parts).sum();
        let why = format!("{parts} parts in {} more places, less deep (--json)", more.len());
        findings.push(("overlap", why));
    }
    if made.interference.iter().any(|of| !of.cut_back) {
        let how = "parts left out exert no force; give the friction of contact springs in the task file, in a table \
                   [mating_force] with, for example, depth_mm = [0, 2, 6] (of the tip) and force_n = [0, 12, 8]";
        findings.push(("springs", how.to_owned()));
    }
    findings
}

/// Returns the unit in which both have the size of a connector, and the reason; millimetres if several fit.
pub fn unit(
    files: Files,
    triangles: [&[Triangle]; 2],
    given: Option<Unit>,
) -> Result<(Unit, Option<String>), Failure> {
    let longest = triangles.map(|of| longest_side(of.as_flattened()));
    let units = given.map_or(vec![Unit::Mm, Unit::M, Unit::In, Unit::Cm], |unit| vec![unit]);
    let fits = |side: f64, unit: Unit| (SIZES[0]..=SIZES[1]).contains(&(side * unit.metres()));
    let both = |unit: &Unit| longest.iter().all(|side| fits(*side, *unit));
    let plausible: Vec<Unit> = units.iter().copied().filter(both).collect();
    let Some(&unit) = plausible.first() else {
        let [plug, socket] = longest;
        let own = longest.map(|side| units.iter().copied().find(|unit| fits(side, *unit)));
        let (at, problem) = match own.map(|unit| unit.map(value)) {
            [Some(a), Some(b)] => (
                usize::from(a == "mm"),
                format!(
                    "the plug is probably {plug:.4} {a} long, but the socket {socket:.4} {b}; export both in one unit"
                ),
            ),
            [plug, _] => {
                let at = usize::from(plug.is_some());
                let read = given.map_or("mm, cm, m or in".to_owned(), value);
                let [least, most] = SIZES.map(|side| side / MM);
                let is = format!("the {} is {:.4} {read} long", BODIES[at], longest[at]);
                (at, format!("{is}; connectors are {least:.0} to {most:.0} mm long (--unit)"))
            }
        };
        return Err(Failure::in_file(files[at], problem));
    };
    if given.is_some() {
        return Ok((unit, None));
    }
    let sizes = |unit: Unit| longest.map(|side| side * unit.metres() / MM);
    let [plug, socket] = sizes(unit);
    let guessed = if unit == Unit::Mm { "" } else { ", guessed from the size (--unit)" };
    let name = value(unit);
    let mut why = format!("{name}{guessed}: plug and socket are {plug:.1} and {socket:.1} mm long");
    for other in plausible.into_iter().skip(1).filter(|_| unit != Unit::Mm) {
        let [plug, socket] = sizes(other);
        why += &format!("; in {}, {plug:.1} and {socket:.1} mm", value(other));
    }
    Ok((unit, Some(why)))
}

/// Checks that neither body is flat, and that plug and socket of separate files are not in different units. In millimetres, or in a unit that was not
/// guessed, they may be, since a small plug can enter a large housing: a note then asks.
///
/// # Errors
/// If one is flat, or has [`MAX_RATIO`] times the size of the other in a guessed unit.
fn check_sizes(
    files: Files,
    triangles: [&[Triangle]; 2],
    guessed: bool,
    context: &Context<'_>,
) -> Result<(), Failure> {
    let sides = triangles.map(|of| {
        let mut sides = [0, 1, 2].map(|axis| width(extent(of.iter().flatten(), axis)));
        sides.sort_by(f64::total_cmp);
        sides
    });
    if let Some(flat) = sides.iter().position(|[least, ..]| *least <= 0.0) {
        let problem = format!("the {} is flat; export a solid", BODIES[flat]);
        return Err(Failure::in_file(files[flat], problem));
    }
    let ratios = |[large, small]: [usize; 2]| {
        let mut ratios = [0, 1, 2].map(|i| sides[large][i] / sides[small][i]);
        ratios.sort_by(f64::total_cmp);
        ratios.iter().all(|ratio| *ratio > MAX_RATIO).then_some((large, small, ratios))
    };
    let larger = [[0, 1], [1, 0]].into_iter().filter(|_| files[0] != files[1]).find_map(ratios);
    let Some((large, small, [least, _, most])) = larger else { return Ok(()) };
    let (large, small) = (BODIES[large], BODIES[small]);
    let found =
        format!("every side of the {large} is {least:.0} to {most:.0} times that of the {small}");
    if guessed {
        let problem =
            format!("{found}; export both in one unit, or name it with --unit if they are");
        return Err(Failure::in_file(names(files), problem));
    }
    context.note(&format!("{found}: are both in one unit?"));
    Ok(())
}

/// Returns the triangles of a mesh, m, with outward normals and reduced if the mesh is large and closed; and whether
/// its normals pointed inward.
fn oriented(triangles: &[Triangle], unit: Unit) -> (Vec<Triangle>, bool) {
    if let Some(surface) = Surface::new(triangles, unit.metres()).map(reduced) {
        return (surface.triangles(), surface.was_inward);
    }
    let scaled = |triangle: &Triangle| triangle.map(|p| p * unit.metres());
    let mut triangles: Vec<Triangle> = triangles.iter().map(scaled).collect();
    let volume = |[a, b, c]: &Triangle| a.coords.dot(&b.coords.cross(&c.coords));
    let inward = triangles.iter().map(volume).sum::<f64>() < 0.0;
    if inward {
        triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    (triangles, inward)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_guessed_unit_is_named_with_the_other_plausible_ones() {
        let long =
            |x: f64| [[Point3::origin(), Point3::new(x, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)]];
        let (plug, socket) = (long(2.8), long(2.4));
        let found = |given| unit(["p", "s"], [&plug, &socket], given).unwrap();
        let why = "in, guessed from the size (--unit): plug and socket are 71.1 and 61.0 mm long; in cm, 28.0 and 24.0 mm";
        assert_eq!(found(None), (Unit::In, Some(why.to_owned())));
        assert_eq!(found(Some(Unit::Cm)), (Unit::Cm, None));
    }
}
