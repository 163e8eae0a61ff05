//! Choice among refined poses.

use super::frame::Parts;
use super::map::{NOWHERE, bounds};
use super::refine::Pose;
use super::search::{MIN_DEPTH, Scene};
use super::{Mate, MatingResult, precise};
use input::units::MM;

/// Smallest share of the best engagement that counts as similar, given the resolution of the maps.
pub const SIMILAR: f64 = 0.97;
/// Largest distance and largest difference in depth between equal mates, m.
const DEPTH_TOLERANCE: f64 = 0.05 * MM;
/// Smallest facing area, as a share of [`MIN_DEPTH`] times the mean side of the plug in x and y.
const GUIDED: f64 = 0.25;

/// Width of the rim about the plug within which the height of the socket is measured, m.
const RIM: f64 = 2.0 * MM;

/// Selects the mates among poses, the best first; `None` if no pose guides the plug. `pairs` are the searched
/// directions and rotations, each with the number of equivalent ones.
pub fn select(
    parts: &Parts,
    scene: &Scene,
    poses: &[Pose],
    pairs: &[([usize; 2], usize)],
    max_play: f64,
) -> Option<MatingResult> {
    let guided = |pose: &&Pose| {
        let [x, y, z] = bounds(&scene.plugs[pose.turn]);
        let size = ((x[1] - x[0]) * (y[1] - y[0])).sqrt();
        // The plug must protrude, or it could not be grasped; a ring lowered over a post protrudes from its
        // surroundings.
        let held = pose.depth < z[1] - z[0] || z[1] + pose.z > beside(scene, pose, [x, y]);
        pose.depth >= MIN_DEPTH && held && pose.walls >= MIN_DEPTH * GUIDED * size
    };
    let poses: Vec<_> = poses.iter().filter(guided).collect();
    let best = poses.first()?;
    let equivalent = |pose: &Pose| {
        let pair = pairs.iter().find(|(pair, _)| *pair == [pose.out, pose.turn]);
        pair.map_or(1, |(_, count)| *count)
    };
    let similar = poses.iter().filter(|pose| pose.value() >= SIMILAR * best.value());
    let (equal, others): (Vec<&&Pose>, Vec<&&Pose>) = similar.partition(|pose| {
        (pose.depth - best.depth).abs() < DEPTH_TOLERANCE && pose.walls > SIMILAR * best.walls
    });
    let mut mates: Vec<Mate> = Vec::new();
    for pose in [*best].into_iter().chain(others.into_iter().copied()) {
        let mate = precise::mate(parts, scene, pose, max_play);
        // Poses in which a plug stops at different springs can have one seat.
        let same = |other: &Mate| {
            let [a, b] = [other, &mate].map(|mate| mate.pose);
            a.rotation == b.rotation
                && (a.translation.vector - b.translation.vector).norm() < DEPTH_TOLERANCE
        };
        if !mates.iter().any(same) {
            mates.push(mate);
        }
    }
    let copies = if mates.len() == 1 { equal.iter().map(|pose| equivalent(pose)).sum() } else { 1 };
    Some(MatingResult { mates, copies })
}

/// Returns the largest height of the socket just outside the bounds of a plug in x and y, m.
fn beside(scene: &Scene, pose: &Pose, plug: [[f64; 2]; 2]) -> f64 {
    let map = &scene.upper[pose.out];
    let cell = |length: f64, axis: usize| (length / map.step[axis]).floor() as i32;
    let rim = |axis: usize| cell(RIM, axis).max(2);
    let [x, y] = [0, 1].map(|axis| plug[axis].map(|v| cell(v + pose.shift[axis], axis)));
    let within = |v: i32, [low, high]: [i32; 2]| (low - 1..=high + 1).contains(&v);
    let columns = (y[0] - rim(1)..=y[1] + rim(1))
        .flat_map(|j| (x[0] - rim(0)..=x[1] + rim(0)).map(move |i| [i, j]));
    let outside = columns.filter(|&[i, j]| !(within(i, x) && within(j, y)));
    outside.map(|[i, j]| f64::from(map.at(i, j))).fold(-f64::from(NOWHERE), f64::max)
}
