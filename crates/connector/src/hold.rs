//! Grasp of a plug by two fingertips: each has a pad that presses a face of the plug, and above it a roof that rests on
//! the shoulder of the plug.

use super::body::{ConvexBody, clipped, extent, span, width};
use input::units::MM;
use insertion::finger::ROOF_GAP;
use insertion::{Pad, Part};
use nalgebra::Point3;

/// Difference up to which positions of surfaces count as equal, m.
pub const SEAM: f64 = 0.05 * MM;

/// Extent of a pad in x, plug frame, m.
pub const PAD_X: [f64; 2] = [-Pad::PUBLISHED.width / 2.0, Pad::PUBLISHED.width / 2.0];

/// Contacts of the two fingertips with a plug; plug frame, m.
#[derive(Debug, Clone, PartialEq)]
pub struct PadContacts {
    /// Lower and upper edge of the pads.
    pub pad_z: [f64; 2],
    /// Outermost y of the plug within the height and the width of the pads, at -y and at +y, each with the index of its
    /// part; `None` if no part is there.
    pub faces: Option<[(f64, usize); 2]>,
    /// Height over which each pad touches its face.
    pub cover: [f64; 2],
    /// Highest z of the plug below each roof, or inside it; `None` if nothing there is above the middle of the pads.
    pub under_roof: [Option<f64>; 2],
}

/// Returns the lower and upper edge of pads whose roofs rest on a shoulder, plug frame, m.
pub fn pad_z(shoulder: f64) -> [f64; 2] {
    [shoulder + ROOF_GAP - Pad::PUBLISHED.height, shoulder + ROOF_GAP]
}

/// Returns the contacts of fingertips whose roofs rest at `shoulder`, m, and whose pads press the faces at `faces_y`,
/// m, by default the outermost ones.
pub fn pad_contacts(plug: &ConvexBody, shoulder: f64, faces_y: Option<[f64; 2]>) -> PadContacts {
    let pad_z = pad_z(shoulder);
    let mut pieces: Vec<Vec<Point3<f64>>> = vec![Vec::new(); plug.parts.len()];
    for (i, part) in plug.stiff() {
        let within = clipped(&part.solid.corners(), 2, pad_z);
        // A part that only touches an edge of the pads from above or below is not between them.
        if width(extent(&within, 2)) >= SEAM {
            pieces[i] = clipped(&within, 0, PAD_X);
        }
    }
    let faces = outermost(&pieces);
    let at = faces_y.or(faces.map(|faces| faces.map(|(y, _)| y)));
    let cover = [0, 1].map(|side| at.map_or(0.0, |faces| cover(&pieces, faces[side], side)));
    let under_roof =
        [0, 1].map(|side| at.and_then(|faces| under_roof(plug, shoulder, faces[side], side)));
    PadContacts { pad_z, faces, cover, under_roof }
}

/// Returns the outermost y at -y and at +y, m, of the pieces (the parts clipped to the pads), each with the index of
/// its part.
fn outermost(pieces: &[Vec<Point3<f64>>]) -> Option<[(f64, usize); 2]> {
    let reach = |sign: f64| {
        let each = pieces.iter().enumerate().filter(|(_, piece)| !piece.is_empty());
        let far = each.map(|(i, piece)| {
            (piece.iter().map(|p| sign * p.y).fold(f64::NEG_INFINITY, f64::max), i)
        });
        far.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(y, part)| (sign * y, part))
    };
    Some([reach(-1.0)?, reach(1.0)?])
}

/// Returns the height over which the plug touches the pad on a side (0 at -y, 1 at +y) that presses y = `face`, m.
fn cover(pieces: &[Vec<Point3<f64>>], face: f64, side: usize) -> f64 {
    let sign = [-1.0, 1.0][side];
    let reaching = pieces.iter().filter_map(|piece| {
        let near = extent(piece.iter().filter(|p| sign * (p.y - face) > -SEAM), 2);
        (width(near) > 0.0).then_some(near)
    });
    width(span(reaching.flatten())).max(0.0)
}

/// Returns the highest z of the plug below or inside the roof on a side, m, if it is above the middle of the pads.
fn under_roof(plug: &ConvexBody, shoulder: f64, face: f64, side: usize) -> Option<f64> {
    // Narrowed by the tolerance, so that a part beside the roof does not count.
    let column = match side {
        0 => [face, face + Pad::PUBLISHED.roof - SEAM],
        _ => [face - Pad::PUBLISHED.roof + SEAM, face],
    };
    let from = shoulder - Pad::PUBLISHED.height / 2.0;
    let top = |part: &Part| {
        let piece = clipped(&clipped(&part.solid.corners(), 1, column), 0, PAD_X);
        let [_, top] = extent(&piece, 2);
        (width(extent(&piece, 1)) > SEAM && top > from).then_some(top)
    };
    plug.stiff().filter_map(|(_, part)| top(part)).max_by(f64::total_cmp)
}

/// Finds the default grasp of a plug, as z of the shoulder and y of the faces, m: the highest shoulder on which both
/// roofs can rest while each pad touches its face over at least `least_cover`, m. Flat faces are preferred to round
/// ones such as cables.
pub fn default_grasp(plug: &ConvexBody, least_cover: f64) -> Option<(f64, [f64; 2])> {
    let mut tops: Vec<f64> =
        plug.stiff().map(|(_, part)| extent(part.solid.corners(), 2)[1]).collect();
    tops.sort_by(|a, b| b.total_cmp(a));
    let grasp = |shoulder: f64, flat: bool| {
        let contacts = pad_contacts(plug, shoulder, None);
        let rests = |top: &Option<f64>| top.is_some_and(|z| (z - shoulder).abs() < SEAM);
        let faces = contacts.faces?;
        let valid = contacts.under_roof.iter().all(rests)
            && contacts.cover.iter().all(|&cover| cover >= least_cover)
            && (!flat || faces.iter().all(|&(y, part)| is_flat(&plug.parts[part], y)));
        valid.then_some((shoulder, faces.map(|(y, _)| y)))
    };
    [true, false].into_iter().find_map(|flat| tops.iter().find_map(|&top| grasp(top, flat)))
}

/// Returns whether the corners of a part at this y, m, are more than 1 mm apart in x; those of an upright cylinder are
/// not. Those of an edge along x are, but a pad does not [`cover`] it.
fn is_flat(part: &Part, y: f64) -> bool {
    let corners = part.solid.corners();
    width(extent(corners.iter().filter(|p| (p.y - y).abs() < SEAM), 0)) > 1.0 * MM
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::TASKS;
    use insertion::task::Task;

    #[test]
    fn the_shipped_grasps_are_found_in_their_plugs() {
        for file in TASKS {
            let task = Task::parse(file.text, file.file).unwrap();
            let plug = ConvexBody::plug(&task.plug);
            let (shoulder, faces) = default_grasp(&plug, 2.0 * MM).unwrap();
            assert!((shoulder - task.grip.shoulder_z).abs() < 1e-9, "{}", file.name);
            for (found, stated) in faces.iter().zip(task.grip.faces_y) {
                assert!((found - stated).abs() < 1e-9, "{}: {faces:?}", file.name);
            }
        }
    }
}
