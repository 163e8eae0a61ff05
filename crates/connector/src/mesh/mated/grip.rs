//! Grasp of a plug: two parallel faces below a surface on which the roofs of the fingertips rest, or an added handle.

use crate::body::{clipped, extent, width};
use crate::check::FACES_MM;
use crate::draft::{Size, block};
use crate::hold::{PAD_X, SEAM, pad_z};
use crate::mesh::Triangle;
use input::units::MM;
use insertion::{Pad, Part};

/// Smallest height of the faces between the pads, m.
const MIN_HEIGHT: f64 = 3.0 * MM;
/// Smallest width of a face in x, m.
const MIN_WIDTH: f64 = 1.0 * MM;
/// Smallest distance of pads and handle from the socket, m.
const CLEAR: f64 = 0.5 * MM;
/// Ratio of areas above which a grasp across the second axis is preferred to one across the first.
const MUCH_LARGER: f64 = 2.0;
/// Smallest cosine between the normal of a face and y.
const PARALLEL: f64 = 0.9998;
/// Length of the plug that is inside the handle, m.
const ENCLOSED: f64 = 2.0 * MM;

/// Grasp of a plug; plug frame, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Grasp {
    /// Height of the surface under the roofs.
    pub shoulder: f64,
    /// Faces at -y and at +y.
    pub faces: [f64; 2],
    /// Part between the pads.
    pub part: Part,
    /// Area of either face within the width of a pad and above the socket, m2.
    pub area: f64,
}

/// Upright face: its y, and its extent in x and z, m.
struct Face {
    y: f64,
    x: [f64; 2],
    z: [f64; 2],
}

impl Grasp {
    /// Returns whether this grasp is preferred to one across the axis that comes first: whether its faces are much
    /// larger, as those of a body compared with those of its cable boot, or of similar size but narrower than the pads,
    /// which the others are not: the start errors are then along the longer side of the plug.
    pub fn replaces(&self, first: &Grasp) -> bool {
        let within =
            |grasp: &Grasp| width(extent(grasp.part.solid.corners(), 0)) < width(narrowed(PAD_X));
        let similar = first.area <= MUCH_LARGER * self.area;
        self.area > MUCH_LARGER * first.area || similar && within(self) && !within(first)
    }
}

/// Pair of faces that the fingers cannot hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rejected {
    /// Distance between the faces, m.
    pub apart: f64,
    /// Area of either face within the width of a pad and above the socket, m2.
    pub area: f64,
    /// Reason: `the pads would ...`.
    pub reason: &'static str,
}

/// Returns the grasp at the largest faces of the plug that keeps the pads above `free` (height of the mated socket's
/// top, plug frame, m), and the largest faces above `free` that the fingers cannot hold.
pub fn own(plug: &[Triangle], free: f64) -> (Option<Grasp>, Option<Rejected>) {
    let [left, right] = [-1.0, 1.0].map(|sign| faces(plug, sign));
    let (mut best, mut rejected): ((f64, Option<Grasp>), Option<Rejected>) = ((0.0, None), None);
    // Of equal areas, the first is kept.
    for (low, high) in left.iter().flat_map(|low| right.iter().map(move |high| (low, high))) {
        match grasp_at(plug, low, high, free) {
            Ok((touched, grasp)) if touched > best.0 => best = (touched, Some(grasp)),
            Ok(_) => {}
            Err(reason) => {
                let (area, apart) = (area(low, high, free), high.y - low.y);
                if area > rejected.map_or(0.0, |other| other.area) && apart > 0.0 {
                    rejected = Some(Rejected { apart, area, reason });
                }
            }
        }
    }
    (best.1, rejected)
}

/// Returns the area of two opposite faces within the width of a pad and above `free`, m2.
fn area(low: &Face, high: &Face, free: f64) -> f64 {
    let (x, z) = (common(common(low.x, high.x), PAD_X), common(low.z, high.z));
    width(x).max(0.0) * width(common(z, [free, f64::INFINITY])).max(0.0)
}

/// Returns the intersection of two intervals; its end is below its start if they do not overlap.
fn common(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].max(b[0]), a[1].min(b[1])]
}

/// Returns an interval without the tolerance at both ends, in which surfaces that only touch an end are not.
fn narrowed([low, high]: [f64; 2]) -> [f64; 2] {
    [low + SEAM, high - SEAM]
}

/// Returns the upright faces whose normals point along y in the direction of `sign`; coplanar ones are joined.
fn faces(plug: &[Triangle], sign: f64) -> Vec<Face> {
    let mut found: Vec<Face> = Vec::new();
    for face in plug {
        let [a, b, c] = *face;
        let normal = (b - a).cross(&(c - a));
        if normal.y * sign < PARALLEL * normal.norm() || normal.norm() == 0.0 {
            continue;
        }
        let (y, x, z) = (a.y, extent(face, 0), extent(face, 2));
        match found.iter_mut().find(|face| (face.y - y).abs() < SEAM / 5.0) {
            Some(face) => {
                face.x = [face.x[0].min(x[0]), face.x[1].max(x[1])];
                face.z = [face.z[0].min(z[0]), face.z[1].max(z[1])];
            }
            None => found.push(Face { y, x, z }),
        }
    }
    found
}

/// Returns the area that the pads touch at two opposite faces, and the grasp.
///
/// # Errors
/// The reason if the fingers cannot hold the plug there.
fn grasp_at(
    plug: &[Triangle],
    low: &Face,
    high: &Face,
    free: f64,
) -> Result<(f64, Grasp), &'static str> {
    let (x, z) = (common(low.x, high.x), common(low.z, high.z));
    let faces = [low.y, high.y];
    if width(x) < MIN_WIDTH {
        return Err("they are too narrow");
    }
    if !(FACES_MM[0]..=FACES_MM[1]).contains(&(width(faces) / MM)) {
        return Err("they are too close or too far apart for a gripper");
    }
    // The highest points under the two roofs must be at the same height.
    let across = narrowed(PAD_X);
    let top = |column: [f64; 2]| {
        let column = [column[0] - SEAM, column[1] + SEAM];
        plug.iter().fold(f64::NEG_INFINITY, |top, face| match extent(face, 2)[1] > top {
            true => top.max(extent(clipped(&clipped(face, 0, across), 1, column), 2)[1]),
            false => top,
        })
    };
    let roof = Pad::PUBLISHED.roof.min(width(faces) / 2.0);
    let tops = [top([faces[0], faces[0] + roof]), top([faces[1] - roof, faces[1]])];
    let shoulder = tops[0].max(tops[1]);
    let pads = pad_z(shoulder);
    let held = common(z, pads);
    let in_the_way = |face: &Triangle| {
        let beyond = |[from, to]: [f64; 2]| from < faces[0] - SEAM || to > faces[1] + SEAM;
        beyond(extent(face, 1))
            && beyond(extent(clipped(&clipped(face, 2, narrowed(pads)), 0, across), 1))
    };
    if (tops[0] - tops[1]).abs() > SEAM {
        return Err("the roofs of the fingertips would rest at different heights");
    }
    if width(held) < MIN_HEIGHT {
        return Err("the pads, with their roofs on top, would cover too little of them");
    }
    if pads[0] < free + CLEAR {
        return Err("the pads would touch the socket");
    }
    if plug.iter().any(in_the_way) {
        return Err("other parts of the plug are in the way of the pads");
    }
    let part = block("grip", [x, faces, [held[0], shoulder]]);
    let touched = width(held) * width(common(x, PAD_X));
    Ok((touched, Grasp { shoulder, faces, part, area: area(low, high, free) }))
}

/// Checks that the pads can hold a handle of a size.
///
/// # Errors
/// If they cannot: what they need.
pub fn check_handle(Size { width, height, length }: Size) -> Result<(), String> {
    let [near, far] = FACES_MM;
    if (near * MM..=far * MM).contains(&width) && height >= MIN_WIDTH && length >= MIN_HEIGHT {
        return Ok(());
    }
    let [high, long] = [MIN_WIDTH, MIN_HEIGHT].map(|side| side / MM);
    Err(format!(
        "the pads need {near} to {far} mm between the jaws, a height of at least {high} mm and a length of at least \
         {long} mm"
    ))
}

/// Returns the grasp of a handle of a size, which is added to the top of the plug and stays above `free`,
/// m.
pub fn handle(plug: &[Triangle], size: Size, free: f64) -> Grasp {
    let [_, top] = extent(plug.iter().flatten(), 2);
    let low = (top - ENCLOSED).max(free + CLEAR);
    // The pads stay above the socket too.
    let shoulder = (low + size.length).max(free + CLEAR + Pad::PUBLISHED.height);
    let [faces, x] = [size.width, size.height].map(|side| [-side / 2.0, side / 2.0]);
    let part = block("handle", [x, faces, [low, shoulder]]);
    Grasp { shoulder, faces, part, area: width(common(x, PAD_X)) * size.length }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::mated::overlap::tests::faces;

    /// Returns the faces of upright blocks about the axis: width in x, width in y, lower and upper z, mm.
    fn stacked(blocks: &[[f64; 4]]) -> Vec<Triangle> {
        let of = |&[x, y, low, high]: &[f64; 4]| {
            faces([-x / 2.0, -y / 2.0, low], [x / 2.0, y / 2.0, high])
        };
        blocks.iter().flat_map(of).collect()
    }

    #[test]
    fn larger_faces_that_cannot_be_held_are_named_with_the_reason() {
        let body = [7.0, 11.0, 10.0, 26.0];
        let held = |blocks: &[[f64; 4]]| {
            let (grasp, rejected) = own(&stacked(blocks), 8.0 * MM);
            let apart = |y: f64| (y / MM).round();
            (
                grasp.map(|grasp| apart(width(grasp.faces))),
                rejected.map(|faces| (apart(faces.apart), faces.reason)),
            )
        };
        assert_eq!(held(&[body]), (Some(11.0), None));
        // The roofs rest on a narrower block, 14 mm above the body.
        let low = "the pads, with their roofs on top, would cover too little of them";
        assert_eq!(held(&[body, [5.0, 8.0, 26.0, 40.0]]), (Some(8.0), Some((11.0, low))));
        // A collar reaches beyond the faces where the pads would be.
        let obstructed = "other parts of the plug are in the way of the pads";
        assert_eq!(held(&[body, [7.0, 13.0, 20.0, 21.0]]), (None, Some((11.0, obstructed))));
        let wide = "they are too close or too far apart for a gripper";
        assert_eq!(held(&[[7.0, 200.0, 10.0, 26.0]]), (None, Some((200.0, wide))));
    }

    /// No corner of the plug is between the pads.
    #[test]
    fn faces_wider_than_the_pads_are_held() {
        let wide = stacked(&[[8.0, 5.0, 0.0, 8.0], [14.0, 9.0, 8.0, 22.0]]);
        let (grasp, rejected) = own(&wide, 8.0 * MM);
        assert_eq!(rejected, None);
        let grasp = grasp.expect("a grasp");
        assert!((grasp.shoulder - 22.0 * MM).abs() < 1e-9);
        // Narrower faces are preferred unless they are much smaller.
        let held = |blocks: &[[f64; 4]]| own(&stacked(blocks), 8.0 * MM).0.expect("a grasp");
        let turned = held(&[[5.0, 8.0, 0.0, 8.0], [9.0, 14.0, 8.0, 22.0]]);
        assert!(turned.replaces(&grasp) && !grasp.replaces(&turned));
        let boot = held(&[[4.0, 8.0, 8.0, 22.0]]);
        assert!(!boot.replaces(&grasp));
    }

    #[test]
    fn a_body_is_held_rather_than_its_boot() {
        let held = |blocks: &[[f64; 4]]| own(&stacked(blocks), 8.0 * MM).0.expect("a grasp");
        // The roofs cannot rest on the body beside the wide side of the boot.
        let boot = held(&[[14.0, 7.0, 10.0, 28.0], [6.0, 4.0, 28.0, 38.0]]);
        let body = held(&[[7.0, 14.0, 10.0, 28.0], [4.0, 6.0, 28.0, 38.0]]);
        assert!((width(boot.faces) - 4.0 * MM).abs() < 1e-9);
        assert!((width(body.faces) - 14.0 * MM).abs() < 1e-9);
        assert!(body.replaces(&boot) && !boot.replaces(&body));
    }
}
