//! Ends of the line or face along which a round shape touches another. parry clips the faces of the cores, whatever
//! the normal: where two edges touch along a line it often finds a single point, anywhere on the line.

use super::patches::MIN_SPACING;
use super::{MILLIMETRES, Solid};
use parry::math as pm;
use parry::query::details::contact_support_map_support_map_with_params;
use parry::query::gjk::{GJKResult, VoronoiSimplex};
use parry::query::{ContactManifold, TrackedContact};
use parry::shape::PackedFeatureId;
use rapier3d_f64::parry;

/// Angle by which one shape is rotated to find an end, rad: over a length of 10 mm it opens a gap of the default
/// prediction distance.
const TURN: f64 = 0.02;

/// Adds the points at which the shapes touch if one is rotated slightly, in each of four directions.
pub(super) fn add_ends(
    manifold: &mut ContactManifold<(), ()>,
    relative: &pm::Pose,
    solids: [&Solid; 2],
    prediction: f64,
) {
    let Some(first) = manifold.points.first() else { return };
    let [Some((a, own)), Some((b, other))] = solids.map(Solid::core) else { return };
    let (about, normal) = (first.local_p1, manifold.local_n1);
    let (u, v) = normal.any_orthonormal_pair();
    // Doubled below, since the rotation moves the shapes apart.
    let reach = prediction * MILLIMETRES + own + other;
    for (i, j) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let turn = pm::Rotation::from_scaled_axis((u * i + v * j) * TURN);
        let turned = pm::Pose::from_parts(
            about + turn * (relative.translation - about),
            turn * relative.rotation,
        );
        let mut simplex = VoronoiSimplex::new();
        let closest = contact_support_map_support_map_with_params(
            &turned,
            a,
            b,
            2.0 * reach,
            &mut simplex,
            Some(normal),
        );
        let GJKResult::ClosestPoints(p1, p2, _) = closest else { continue };
        let p2 = relative * turned.inverse_transform_point(p2);
        let [p1, p2] = [p1 + normal * own, p2 - normal * other];
        let unknown = PackedFeatureId::UNKNOWN;
        let distance = (p2 - p1).dot(normal);
        let p2 = relative.inverse_transform_point(p2);
        let limit = MIN_SPACING * MILLIMETRES;
        if manifold.points.iter().any(|point| (point.local_p1 - p1).length() < limit) {
            continue;
        }
        manifold.points.push(TrackedContact::new(p1, p2, unknown, unknown, distance));
    }
}
