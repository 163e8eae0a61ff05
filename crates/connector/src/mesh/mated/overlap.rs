//! Interference of plug and socket on the way to the mated pose: contact springs are drawn unloaded, ribs uncrushed.

use crate::body::{ConvexBody, Touching, longest_side, span};
use contact::scene::Pose;
use input::units::MM;
use insertion::task::{Part, geometry};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Overlap that rounding and facets explain, m.
pub const ROUNDING: f64 = 0.02 * MM;
/// Step along the way, m.
const STEP: f64 = 0.2 * MM;
/// Component of a normal along the axis from which on an overlap is one of a stop.
const ALONG: f64 = 0.7;
/// Height above the mated pose from which on nothing may be in the way, m.
const STOP: f64 = 0.3 * MM;

/// Parts of one body that overlap the other in the mated pose or on the way to it, and were left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Interference {
    /// Body that gave way: 0 plug, 1 socket.
    pub body: usize,
    /// Number of its parts that were left out.
    pub parts: usize,
    /// Deepest overlap, m.
    pub depth: f64,
    /// Smallest and largest corner, task frame, plug mated, m.
    pub bounds: [Point3<f64>; 2],
}

impl Interference {
    /// Returns whether a place, task frame, plug mated, is within a distance of its bounds, m.
    pub fn is_near(&self, place: &Point3<f64>, distance: f64) -> bool {
        let [low, high] = self.bounds;
        (0..3).all(|i| (low[i] - distance..=high[i] + distance).contains(&place[i]))
    }
}

/// Leaves out what keeps the plug from its mated pose, `depth` below the top, m: of two parts that overlap the smaller one.
pub fn cut(plug: &mut Vec<Part>, socket: &mut Vec<Part>, depth: f64) -> Vec<Interference> {
    let found = met(plug, socket, depth);
    let volumes = [&*plug, &*socket].map(|parts| -> Vec<f64> {
        parts.iter().map(|part| geometry::volume(&part.solid)).collect()
    });
    let mut out = [vec![0.0_f64; plug.len()], vec![0.0_f64; socket.len()]];
    for Touching { depth, parts: [i, j], .. } in found {
        let body = usize::from(volumes[0][i] > volumes[1][j]);
        let part = [i, j][body];
        out[body][part] = out[body][part].max(depth);
    }
    let shift = [Vector3::new(0.0, 0.0, -depth), Vector3::zeros()];
    let mut gone = Vec::new();
    for (body, parts) in [plug, socket].into_iter().enumerate() {
        let left: Vec<(f64, Part)> = parts
            .iter()
            .cloned()
            .enumerate()
            .filter_map(|(i, part)| (out[body][i] > 0.0).then(|| (out[body][i], part)))
            .collect();
        let mut number = 0;
        parts.retain(|_| {
            number += 1;
            out[body][number - 1] == 0.0
        });
        gone.extend(groups(left).into_iter().map(|(parts, depth, [low, high])| Interference {
            body,
            parts,
            depth,
            bounds: [low + shift[body], high + shift[body]],
        }));
    }
    gone
}

/// Overlaps on the way down that are not those of the stop.
fn met(plug: &[Part], socket: &[Part], depth: f64) -> Vec<Touching> {
    let (plug, socket) = (ConvexBody::new(plug), ConvexBody::new(socket));
    let steps = (depth / STEP).ceil() as usize;
    let at = |i: usize| {
        let above = i as f64 * STEP;
        let pose = Pose::translation(0.0, 0.0, above - depth);
        let mut found = plug.overlaps(&pose, &socket, &Pose::identity());
        found.retain(|touch| {
            touch.depth > ROUNDING && (above > STOP || touch.normal.z.abs() < ALONG)
        });
        found
    };
    (0..=steps).into_par_iter().map(at).collect::<Vec<_>>().concat()
}

/// Number of parts, deepest overlap and bounds of the sets of parts that lie near to one another.
fn groups(parts: Vec<(f64, Part)>) -> Vec<(usize, f64, [Point3<f64>; 2])> {
    let mut groups: Vec<(usize, f64, [Point3<f64>; 2])> = Vec::new();
    for (depth, part) in parts {
        let corners = part.solid.corners();
        let ranges = [0, 1, 2].map(|axis| span(corners.iter().map(|p| p[axis])));
        let mut own = (1, depth, [0, 1].map(|end| Point3::from(ranges.map(|range| range[end]))));
        let near = 0.5 * longest_side(&corners).max(0.5 * MM);
        let mut i = 0;
        while i < groups.len() {
            let (count, deep, [low, high]) = groups[i];
            let apart = (0..3).any(|axis| {
                own.2[0][axis] > high[axis] + near || low[axis] > own.2[1][axis] + near
            });
            if apart {
                i += 1;
                continue;
            }
            groups.swap_remove(i);
            let bounds = [own.2[0].inf(&low), own.2[1].sup(&high)];
            own = (own.0 + count, own.1.max(deep), bounds);
            i = 0;
        }
        groups.push(own);
    }
    groups
}
