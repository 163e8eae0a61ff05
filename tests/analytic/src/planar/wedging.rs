//! Friction cones of two contacts, and the rule for cases that statics does not decide.
//!
//! **Wedging.** Two contacts can press on one another through the peg, without any load, if the line
//! between them lies in both friction cones. The forces between them are then whatever the history
//! of the contacts has left, and any load can be held.
//!
//! **Rule.** A case is indeterminate if on its way the line between two closed contacts lies in both
//! friction cones, and the peg that is not wedged there goes on to be inserted: then both outcomes,
//! inserted and jammed, satisfy equilibrium and Coulomb's law. If the peg that is not wedged is not
//! inserted either, both outcomes are the same and the case is determinate.

use super::equilibrium::held_forces;
use super::feature::{Geometry, Touch};
use super::path::Insertion;
use super::{Assembly, Feature, V2, V3};

/// Returns by how much the line between two contacts lies inside the friction cone that it leaves
/// first, rad; negative if it lies outside.
pub fn cone_margin(first: &Touch, second: &Touch, friction: f64) -> f64 {
    let between = second.point - first.point;
    let angle = |normal: &V2, line: &V2| libm::atan2(normal.perp(line).abs(), normal.dot(line));
    let widest = angle(&first.normal, &between).max(angle(&second.normal, &-between));
    libm::atan(friction) - widest
}

/// Returns the geometry of the closed contacts.
fn closed(insertion: &Insertion) -> Vec<Touch> {
    let state = &insertion.state;
    let touch = |feature| insertion.geometry.touch(feature, &state.pose);
    state.contacts.iter().map(|contact| touch(contact.feature)).collect()
}

/// Returns whether the present contacts can be wedged.
pub fn wedges(insertion: &Insertion) -> bool {
    match closed(insertion).as_slice() {
        [first, second] => cone_margin(first, second, insertion.assembly.friction) >= 0.0,
        _ => false,
    }
}

/// Returns whether the present contacts, if they are two, can hold a load on the compliance centre.
pub fn holds(insertion: &Insertion, load: V3) -> bool {
    let friction = insertion.assembly.friction;
    match closed(insertion).as_slice() {
        &[first, second] => {
            held_forces(&[first, second], &insertion.state.pose, load, friction).is_some()
        }
        _ => false,
    }
}

/// Contacts of the left tip edge with its wall and of the right rim with its flank.
pub const TWO_POINT: [Feature; 2] = [
    Feature::PegCorner { side: 0, corner: 1, edge: 0 },
    Feature::HoleCorner { side: 1, corner: 1, edge: 2 },
];

/// Returns the pose in which a peg that leans to the right by a tilt (negative) has both contacts of
/// [`TWO_POINT`]: their gaps are linear in the position.
pub fn two_point_pose(assembly: &Assembly, tilt: f64) -> V3 {
    let geometry = Geometry::new(assembly);
    let gap =
        |i: usize, tip: V2| geometry.touch(TWO_POINT[i], &assembly.support.pose(tip, tilt)).gap;
    // The wall is upright: its gap is that across.
    let across = V2::new(-gap(0, V2::zeros()), 0.0);
    let rate = gap(1, across + V2::y()) - gap(1, across);
    assembly.support.pose(across - V2::y() * (gap(1, across) / rate), tilt)
}
