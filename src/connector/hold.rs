//! What a pair of fingertips finds of a plug between them.

use super::body::{ConvexBody, clipped, span};
use input::units::MM;
use insertion::finger::{Pad, ROOF_GAP};
use insertion::task::Part;
use nalgebra::Point3;

/// A surface that is this near to where it should be is there, m.
pub const SEAM: f64 = 0.05 * MM;

/// The plug between two pads whose roofs rest at a height, plug frame, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    /// From, to of the pads in z.
    pub pad_z: [f64; 2],
    /// Outermost y of the plug between the pads, at -y and +y, with the part that is there.
    pub faces: Option<[(f64, usize); 2]>,
    /// Height of each pad that such a face covers.
    pub cover: [f64; 2],
    /// Highest z of the plug under or within each roof; none if nothing is there.
    pub under_roof: [Option<f64>; 2],
}

/// From, to in z of pads whose roofs rest on a shoulder.
pub fn pad_z(shoulder: f64) -> [f64; 2] {
    [shoulder + ROOF_GAP - Pad::PAPER.height, shoulder + ROOF_GAP]
}

/// Looks at a plug as the pads do whose roofs rest at `shoulder`; the faces they press are
/// where the plug is widest, or where the task says.
pub fn held(plug: &ConvexBody, shoulder: f64, faces_y: Option<[f64; 2]>) -> Held {
    let pad_z = pad_z(shoulder);
    let mut pieces: Vec<Vec<Point3<f64>>> = vec![Vec::new(); plug.parts.len()];
    for (i, part) in plug.stiff() {
        pieces[i] = before_pad(part, pad_z);
    }
    let faces = widest(&pieces);
    let at = faces_y.or(faces.map(|faces| faces.map(|(y, _)| y)));
    let cover = [0, 1].map(|side| at.map_or(0.0, |faces| cover(&pieces, faces[side], side)));
    let under_roof =
        [0, 1].map(|side| at.and_then(|faces| under_roof(plug, shoulder, faces[side], side)));
    Held { pad_z, faces, cover, under_roof }
}

/// What of a part lies between the pads.
fn before_pad(part: &Part, pad_z: [f64; 2]) -> Vec<Point3<f64>> {
    let within = clipped(&part.solid.corners(), 2, pad_z);
    let [low, high] = span(within.iter().map(|p| p.z));
    // What only touches the pads' edge from above or below is not between them.
    if high - low < SEAM {
        Vec::new()
    } else {
        clipped(&within, 0, [-Pad::PAPER.width / 2.0, Pad::PAPER.width / 2.0])
    }
}

fn widest(pieces: &[Vec<Point3<f64>>]) -> Option<[(f64, usize); 2]> {
    let reach = |sign: f64| {
        let each = pieces.iter().enumerate().filter(|(_, piece)| !piece.is_empty());
        let far = each.map(|(i, piece)| {
            (piece.iter().map(|p| sign * p.y).fold(f64::NEG_INFINITY, f64::max), i)
        });
        far.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(y, part)| (sign * y, part))
    };
    Some([reach(-1.0)?, reach(1.0)?])
}

/// Height over which the plug reaches a pad's face.
fn cover(pieces: &[Vec<Point3<f64>>], face: f64, side: usize) -> f64 {
    let sign = [-1.0, 1.0][side];
    let reaching = pieces.iter().filter_map(|piece| {
        let near: Vec<_> = piece.iter().filter(|p| sign * (p.y - face) > -SEAM).collect();
        let [low, high] = span(near.iter().map(|p| p.z));
        (high > low).then_some([low, high])
    });
    let [low, high] = reaching
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], [low, high]| [a.min(low), b.max(high)]);
    (high - low).max(0.0)
}

/// The highest point of the plug in the column of a roof, from the pads' middle up.
fn under_roof(plug: &ConvexBody, shoulder: f64, face: f64, side: usize) -> Option<f64> {
    // A seam inside, so that what the roof only touches from the side does not count.
    let column = match side {
        0 => [face, face + Pad::PAPER.roof - SEAM],
        _ => [face - Pad::PAPER.roof + SEAM, face],
    };
    let from = shoulder - Pad::PAPER.height / 2.0;
    let top = |part: &Part| {
        let piece = clipped(&part.solid.corners(), 1, column);
        let piece = clipped(&piece, 0, [-Pad::PAPER.width / 2.0, Pad::PAPER.width / 2.0]);
        let [low, high] = span(piece.iter().map(|p| p.y));
        let [_, top] = span(piece.iter().map(|p| p.z));
        (high - low > SEAM && top > from).then_some(top)
    };
    plug.stiff().filter_map(|(_, part)| top(part)).max_by(f64::total_cmp)
}

/// Where fingers can hold a plug that nobody said how to hold: the highest shoulder that both
/// roofs rest on, with pads that find at least this much of a face, m. Flat faces first: a cable
/// can be held, too, but a body better.
pub fn find(plug: &ConvexBody, least_cover: f64) -> Option<(f64, [f64; 2])> {
    let mut tops: Vec<f64> =
        plug.stiff().map(|(_, part)| span(part.solid.corners().iter().map(|p| p.z))[1]).collect();
    tops.sort_by(|a, b| b.total_cmp(a));
    let holds = |flat: bool| {
        tops.iter().find_map(|&shoulder| {
            let held = held(plug, shoulder, None);
            let rests = |top: &Option<f64>| top.is_some_and(|z| (z - shoulder).abs() < SEAM);
            let found = held.faces?;
            let right = held.under_roof.iter().all(rests)
                && held.cover.iter().all(|&cover| cover >= least_cover)
                && (!flat || found.iter().all(|&(y, part)| is_flat(&plug.parts[part], y)));
            right.then_some((shoulder, found.map(|(y, _)| y)))
        })
    };
    holds(true).or_else(|| holds(false))
}

/// Whether a part has a face, not an edge or a line, at this y.
fn is_flat(part: &Part, y: f64) -> bool {
    let corners = part.solid.corners();
    let [low, high] = span(corners.iter().filter(|p| (p.y - y).abs() < SEAM).map(|p| p.x));
    high - low > 1.0 * MM
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::TASKS;
    use insertion::task::Task;

    /// The grasp that the shipped files state is the one that is found in their plugs.
    #[test]
    fn the_shipped_grasps_are_found_in_their_plugs() {
        for file in TASKS {
            let task = Task::parse(file.text, file.file).unwrap();
            let plug = ConvexBody::plug(&task.plug);
            let (shoulder, faces) = find(&plug, 2.0 * MM).unwrap();
            assert!((shoulder - task.grip.shoulder_z).abs() < 1e-9, "{}", file.name);
            for (found, stated) in faces.iter().zip(task.grip.faces_y) {
                assert!((found - stated).abs() < 1e-9, "{}: {faces:?}", file.name);
            }
        }
    }
}
