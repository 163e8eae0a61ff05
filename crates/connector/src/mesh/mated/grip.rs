//! Place at which the fingers hold a plug: two parallel faces under a top that their roofs rest on, or a handle.

use crate::body::{extent, width};
use crate::check::FACES_MM;
use crate::draft::block;
use crate::hold::{SEAM, pad_z};
use crate::mesh::Triangle;
use input::units::MM;
use insertion::finger::Pad;
use insertion::task::Part;
use nalgebra::Point3;

/// Least height of the faces between the pads, m.
const LEAST_HEIGHT: f64 = 3.0 * MM;
/// Least width of a face in x, m.
const LEAST_WIDTH: f64 = 1.0 * MM;
/// Least distance of the pads and of a handle from the socket, m.
const FREE: f64 = 0.5 * MM;
/// Least cosine between a face's normal and y.
const PARALLEL: f64 = 0.9998;
/// Length of the plug that a handle encloses, m.
const ENCLOSED: f64 = 2.0 * MM;

/// Grasp of a plug; plug frame, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Grasp {
    /// Height under the roofs.
    pub shoulder: f64,
    /// Faces at -y and at +y.
    pub faces: [f64; 2],
    /// Part between the pads.
    pub part: Part,
}

/// Interval of a face's coordinates: y, x and z.
struct Face {
    y: f64,
    x: [f64; 2],
    z: [f64; 2],
}

/// Returns the grasp of a plug at its own faces whose pads stay above `free`, m, the largest faces first.
pub fn own(plug: &[Triangle], free: f64) -> Option<Grasp> {
    let [left, right] = [-1.0, 1.0].map(|sign| faces(plug, sign));
    let pairs = left.iter().flat_map(|low| right.iter().map(move |high| (low, high)));
    let grasps = pairs.filter_map(|(low, high)| between(plug, low, high, free));
    // Of equal ones the first.
    let best = grasps.reduce(|best, next| if next.0 > best.0 { next } else { best });
    best.map(|(_, grasp)| grasp)
}

/// Upright faces that look along y in the direction of `sign`, joined at equal y.
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

fn between(plug: &[Triangle], low: &Face, high: &Face, free: f64) -> Option<(f64, Grasp)> {
    let common = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].min(b[1])];
    let (x, z) = (common(low.x, high.x), common(low.z, high.z));
    let faces = [low.y, high.y];
    let wide = width(faces) / MM;
    if width(x) < LEAST_WIDTH || !(FACES_MM[0]..=FACES_MM[1]).contains(&wide) {
        return None;
    }
    let pad = [-Pad::PAPER.width / 2.0, Pad::PAPER.width / 2.0];
    let in_pad = |p: &&Point3<f64>| pad[0] < p.x && p.x < pad[1];
    let points = || plug.iter().flatten().filter(in_pad);
    // What is under either roof carries it; both must lie at one height.
    let top = |column: [f64; 2]| {
        let near = |p: &&Point3<f64>| column[0] - SEAM < p.y && p.y < column[1] + SEAM;
        extent(points().filter(near), 2)[1]
    };
    let roof = Pad::PAPER.roof.min(width(faces) / 2.0);
    let tops = [top([faces[0], faces[0] + roof]), top([faces[1] - roof, faces[1]])];
    let shoulder = tops[0].max(tops[1]);
    let pads = pad_z(shoulder);
    let held = common(z, pads);
    let beyond = |face: &Triangle| {
        let within = extent(face, 2)[1] > pads[0] && extent(face, 2)[0] < pads[1];
        let near = extent(face, 0)[1] > pad[0] && extent(face, 0)[0] < pad[1];
        let [from, to] = extent(face, 1);
        within && near && (from < faces[0] - SEAM || to > faces[1] + SEAM)
    };
    let fails = (tops[0] - tops[1]).abs() > SEAM
        || width(held) < LEAST_HEIGHT
        || pads[0] < free + FREE
        || plug.iter().any(beyond);
    if fails {
        return None;
    }
    let part = block("grip", [x, faces, [held[0], shoulder]]);
    Some((width(held) * width(common(x, pad)), Grasp { shoulder, faces, part }))
}

/// Returns the grasp of a handle of a size (x, y, z), m, on the plug's top, which stays above `free`, m.
pub fn handle(plug: &[Triangle], [x, y, z]: [f64; 3], free: f64) -> Grasp {
    let [_, top] = extent(plug.iter().flatten(), 2);
    let low = (top - ENCLOSED).max(free + FREE);
    // The pads, too, stay above the socket.
    let shoulder = (low + z).max(free + FREE + Pad::PAPER.height);
    let faces = [-y / 2.0, y / 2.0];
    let part = block("handle", [[-x / 2.0, x / 2.0], faces, [low, shoulder]]);
    Grasp { shoulder, faces, part }
}
