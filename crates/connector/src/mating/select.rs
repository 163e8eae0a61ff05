//! Choice among refined poses.

use super::frame::Parts;
use super::map::bounds;
use super::refine::Pose;
use super::search::{LEAST, Scene};
use super::{Found, precise};
use input::units::MM;

/// Share of the best engagement that is similar: the maps know it within some hundredths.
const SIMILAR: f64 = 0.97;
/// Difference of depth of equal mates, m.
const SAME: f64 = 0.05 * MM;
/// Share of the plug's outline that walls must face over the least depth.
const GUIDED: f64 = 0.25;

/// Choice among poses, the best first; none if no pose guides the plug.
pub fn select(
    parts: &Parts,
    scene: &Scene,
    poses: &[Pose],
    (pairs, room): (&[([usize; 2], usize)], f64),
) -> Option<Found> {
    let guided = |pose: &&Pose| {
        let [x, y, z] = bounds(&scene.plugs[pose.turn]);
        let size = ((x[1] - x[0]) * (y[1] - y[0])).sqrt();
        // What sinks in wholly has fallen, and nobody could hold it.
        (LEAST..z[1] - z[0]).contains(&pose.depth) && pose.walls >= LEAST * GUIDED * size
    };
    let poses: Vec<_> = poses.iter().filter(guided).collect();
    let best = poses.first()?;
    let number = |pose: &Pose| {
        let pair = pairs.iter().find(|(pair, _)| *pair == [pose.out, pose.turn]);
        pair.map_or(1, |(_, count)| *count)
    };
    let similar = poses.iter().filter(|pose| pose.value() >= SIMILAR * best.value());
    let (equal, others): (Vec<&&Pose>, Vec<&&Pose>) = similar.partition(|pose| {
        (pose.depth - best.depth).abs() < SAME && pose.walls > SIMILAR * best.walls
    });
    let mate = |pose: &Pose| precise::mate(parts, scene, pose, room);
    if others.is_empty() {
        let count = equal.iter().map(|pose| number(pose)).sum();
        let mate = mate(best);
        return Some(if count > 1 { Found::Symmetric(mate, count) } else { Found::One(mate) });
    }
    Some(Found::Ambiguous(
        [*best].into_iter().chain(others.into_iter().copied()).map(mate).collect(),
    ))
}
