//! Mate of the plug and the socket of an assembly, which are in their mated pose.

use super::frame::{Part, Parts, rotations_to_z, turned};
use super::refine::{Pose, settled_areas};
use super::search::{EFFORTS, Scene};
use super::{MAX_PLAYS, Mate, MatingError, precise};
use crate::mesh::Triangle;

/// Returns the mate of a plug and a socket that are mated, both in the frame of the assembly, m. Its direction of
/// withdrawal is the one with the largest engagement (facing area minus penalty for overlap), of two equal ones that in
/// which the plug protrudes.
///
/// # Errors
/// If a part is empty, or the plug is blocked or loose in every direction.
pub fn assembled(plug: &[Triangle], socket: &[Triangle]) -> Result<Mate, MatingError> {
    let socket = Part::new(socket, "socket")?;
    let own = socket.own;
    if plug.is_empty() {
        return Err(MatingError::Empty("plug"));
    }
    let parts = Parts { plug: Part { own, triangles: turned(plug, &own) }, socket };
    let scene = Scene::new(&parts, EFFORTS[0]);
    let poses = (0..rotations_to_z().len()).map(|out| {
        // The plug is rotated like the socket: `rotations_to_z` has every fourth rotation of `turns`.
        let pose = Pose { out, turn: 4 * out, ..Pose::default() };
        settled_areas(&scene, pose, MAX_PLAYS[0])
    });
    let value = |(pose, out): &(Pose, f64)| pose.value() * (1.0 + PROTRUSION_BONUS * out.signum());
    let best = poses.max_by(|a, b| value(a).total_cmp(&value(b)));
    let (pose, _) = best.filter(|(pose, _)| pose.value() > 0.0).ok_or(MatingError::Blocked)?;
    Ok(precise::mate(&parts, &scene, &pose, MAX_PLAYS[0]))
}

/// Increase of the engagement in the direction in which the plug protrudes, as a share.
const PROTRUSION_BONUS: f64 = 0.01;
