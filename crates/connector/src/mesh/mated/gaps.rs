//! Comparison of the gap between the convex parts of plug and socket with that between their drawn faces, at poses near
//! the mated one.

use super::{Interference, TOLERANCE};
use crate::body::ConvexBody;
use crate::mesh::Triangle;
use contact::scene::Pose;
use input::units::MM;
use insertion::Part;
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use parry::bounding_volume::{Aabb, BoundingVolume};
use parry::partitioning::{Bvh, BvhBuildStrategy};
use parry::query;
use parry::shape;
use rapier3d_f64::parry;
use rayon::prelude::*;

/// Number of compared poses.
const POSES: u32 = 1000;
/// Gap beyond which all gaps count as equal, m.
const WIDE: f64 = 0.1 * MM;
/// Deviation of poses beyond the play, m.
const BEYOND: f64 = 0.1 * MM;
/// Heights of the poses above the seat, m: the smallest; the range above it for every other pose; and for the rest, by
/// how much this range exceeds the depth.
const HEIGHTS: [f64; 3] = [0.03 * MM, 1.0 * MM, 0.5 * MM];
/// Smallest lever arm of a rotation, m.
const ARM: f64 = 2.0 * MM;
/// Irrational steps of a sequence that fills six dimensions evenly (Roberts 2018).
const STEPS: [f64; 6] =
    [0.898_654_4, 0.807_579_7, 0.725_735_1, 0.652_185_1, 0.586_089_0, 0.526_691_4];

/// Pose at which the gaps differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Pose of the plug in the task frame.
    pub pose: Pose,
    /// Place, task frame, m.
    pub place: Point3<f64>,
    /// Gap of the drawn faces and of the parts, m, at most 0.1 mm; 0 where they meet.
    pub gaps: [f64; 2],
}

/// Plug, in its own frame, and socket by their drawn faces and by their parts.
pub struct Bodies<'a> {
    /// Faces of plug and socket, m.
    pub drawn: [&'a [Triangle]; 2],
    /// Parts of plug and socket.
    pub parts: [&'a [Part]; 2],
    /// Depth of the mated plug, m.
    pub depth: f64,
    /// Play in x and in y, m.
    pub play: [f64; 2],
}

/// Returns the pose at which the gaps differ most, if any differ; places near removed interference are ignored.
pub fn difference(bodies: &Bodies, removed: &[Interference]) -> Option<Difference> {
    let [plug, socket] = bodies.drawn.map(Faces::new);
    let parts = bodies.parts.map(ConvexBody::new);
    let at = |number: u32| {
        let pose = pose(number, bodies);
        let beyond = |place: &Point3<f64>, distance: f64| {
            let mated = pose.inverse_transform_point(place) - Vector3::z() * bodies.depth;
            !removed.iter().any(|of| of.is_near([&mated, place][of.body], distance))
        };
        let counts = |place: &Point3<f64>| beyond(place, BEYOND);
        let (drawn, of_parts) =
            (plug.gap(&pose, &socket, counts), parts[0].gap(&pose, &parts[1], WIDE, counts));
        let gaps = [drawn, of_parts].map(|found| found.map_or(WIDE, |(gap, _)| gap.min(WIDE)));
        let [place, other] = [drawn, of_parts].map(|found| found.map(|(_, place)| place));
        let place = if gaps[0] < gaps[1] { place.or(other) } else { other.or(place) }?;
        // Near removed interference, the place of only one of the two gaps may count.
        let differs = differ(gaps) && beyond(&place, 4.0 * BEYOND);
        // If the drawn faces touch, the place found for overlapping parts can be elsewhere along them.
        let both = || {
            let own = pose.inverse_transform_point(&place);
            let near = |body: usize, at| parts[body].near(at, TOLERANCE).next().is_some();
            near(0, &own) && near(1, &place)
        };
        let differs = differs && !(gaps[0] <= 0.0 && both());
        differs.then_some(Difference { pose, place, gaps })
    };
    let found = (0..POSES).into_par_iter().filter_map(at).collect::<Vec<_>>();
    let off = |of: &Difference| (of.gaps[0] - of.gaps[1]).abs();
    found.into_iter().max_by(|a, b| off(a).total_cmp(&off(b)))
}

/// Returns whether gaps differ by more than the tolerances of two bodies, or one is closed and the other exceeds the
/// tolerance.
fn differ(gaps: [f64; 2]) -> bool {
    let [low, high] = [gaps[0].min(gaps[1]), gaps[0].max(gaps[1])];
    high - low > 2.0 * TOLERANCE || (low <= 0.0 && high > TOLERANCE)
}

/// Returns a pose near the mated one or near the path to it.
fn pose(number: u32, bodies: &Bodies) -> Pose {
    let [x, y, high, about_x, about_y, about_z] =
        STEPS.map(|step| (0.5 + f64::from(number + 1) * step).fract());
    let side = |v: f64, axis: usize| (2.0 * v - 1.0) * (bodies.play[axis] / 2.0 + BEYOND);
    let [least, near, above] = HEIGHTS;
    let height = least + high * if number.is_multiple_of(2) { near } else { bodies.depth + above };
    let arm = bodies.depth.max(ARM);
    let turn = Vector3::new(side(about_x, 1), side(about_y, 0), side(about_z, 0)) / arm;
    let shift = Translation3::new(side(x, 0), side(y, 1), height - bodies.depth);
    Pose::from_parts(shift, UnitQuaternion::from_scaled_axis(turn))
}

/// Faces with the tree of their bounding boxes, mm: parry's tolerances suit bodies of size 1.
struct Faces {
    faces: Vec<Triangle>,
    tree: Bvh,
}

fn around(face: &Triangle) -> Aabb {
    Aabb::from_points(face.map(|p| p.coords.into()))
}

impl Faces {
    fn new(faces: &[Triangle]) -> Self {
        let faces: Vec<Triangle> = faces.iter().map(|face| face.map(|p| p / MM)).collect();
        let boxes: Vec<Aabb> = faces.iter().map(around).collect();
        Faces { faces, tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes) }
    }

    /// Returns the smallest gap to other faces with these at a pose, m, and its place, among the gaps below [`WIDE`] at
    /// places that `counts` accepts.
    fn gap(
        &self,
        pose: &Pose,
        other: &Faces,
        counts: impl Fn(&Point3<f64>) -> bool,
    ) -> Option<(f64, Point3<f64>)> {
        let pose = Pose::from_parts((pose.translation.vector / MM).into(), pose.rotation);
        let triangle = |face: &Triangle| shape::Triangle::from(face.map(|p| p.coords.into()));
        let here = contact::shapes::pose(&Pose::identity(), 1.0);
        let mut least: Option<(f64, Point3<f64>)> = None;
        for face in &self.faces {
            let face = face.map(|p| pose * p);
            let near = |least: Option<(f64, _)>| least.map_or(WIDE / MM, |(gap, _)| gap);
            for next in other.tree.intersect_aabb(&around(&face).loosened(near(least))) {
                let next = &other.faces[next as usize];
                let [own, its] = [&face, next].map(triangle);
                let gap = query::distance(&here, &own, &here, &its);
                let gap = gap.map_or(0.0, |found| found.distance);
                if gap >= near(least) {
                    continue;
                }
                let meet = query::contact(&here, &own, &here, &its, gap + TOLERANCE / MM);
                let middle = face.iter().chain(next).map(|p| p.coords).sum::<Vector3<f64>>() / 6.0;
                let place = meet.ok().flatten().map_or(middle, |meet| Vector3::from(meet.point1));
                if counts(&Point3::from(place * MM)) {
                    least = Some((gap, Point3::from(place * MM)));
                }
            }
            if near(least) <= 0.0 {
                break;
            }
        }
        least.map(|(gap, place)| (gap * MM, place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::mated::overlap::tests::faces;
    use crate::mesh::mated::{Pair, task};

    fn drawn(boxes: &[[[f64; 3]; 2]]) -> Vec<Triangle> {
        boxes.iter().flat_map(|&[min, max]| faces(min, max)).collect()
    }

    /// A tube of 4 mm with a post in it, 5 mm deep, and the plug that goes between them.
    fn pair() -> [Vec<Triangle>; 2] {
        let bars = |outer: f64, inner: f64, z: [f64; 2]| {
            let [a, b] = [outer, inner];
            let bar = |x: [f64; 2], y: [f64; 2]| [[x[0], y[0], z[0]], [x[1], y[1], z[1]]];
            [
                bar([-a, a], [-a, -b]),
                bar([-a, a], [b, a]),
                bar([-a, -b], [-b, b]),
                bar([b, a], [-b, b]),
            ]
        };
        let floor = [[-5.0, -5.0, -7.0], [5.0, 5.0, -5.0]];
        let post = [[-0.9, -0.9, -5.0], [0.9, 0.9, -0.5]];
        let handle = [[-4.0, -4.0, 1.0], [4.0, 4.0, 20.0]];
        let socket = [&bars(3.0, 2.0, [-5.0, 0.0])[..], &[floor, post]].concat();
        [drawn(&[&bars(1.95, 1.0, [-5.0, 1.0])[..], &[handle]].concat()), drawn(&socket)]
    }

    #[test]
    fn parts_and_drawing_agree_on_the_gap_at_1000_poses() {
        let [plug, socket] = pair();
        let play = [0, 1].map(|axis| (Vector3::ith(axis, 1.0), 0.1 * MM));
        let jaws = [Vector3::y()];
        let pair = Pair {
            plug: &plug,
            socket: &socket,
            drawn: [&plug, &socket],
            out: Vector3::z(),
            jaws: &jaws,
            depth: 5.0 * MM,
            nose: 0.0,
            play,
        };
        let made = task(&pair, "tube", None, None);
        assert_eq!((made.difference, made.closeup), (None, None));
        let raised: Vec<Triangle> =
            plug.iter().map(|face| face.map(|p| p + Vector3::z() * 5.0 * MM)).collect();
        let (parts, play) = (&made.task.plug.parts, [0.1 * MM; 2]);
        let bodies = Bodies {
            drawn: [&raised, &socket],
            // Without the part that the fingers hold.
            parts: [&parts[..parts.len() - 1], &made.task.socket],
            depth: 5.0 * MM,
            play,
        };
        assert_eq!(difference(&bodies, &[]), None);
        // A wall that is 0.05 mm off, and one that is missing.
        let moved: Vec<Triangle> = socket.iter().map(|face| face.map(|p| p * 1.025)).collect();
        let wrong = task(&Pair { drawn: [&plug, &moved], ..pair }, "tube", None, None);
        let off = wrong.difference.unwrap();
        assert!((off.gaps[0] - off.gaps[1]).abs() > 0.03 * MM, "{off:?}");
        assert!(wrong.closeup.is_some_and(|svg| svg.starts_with("<svg")));
        let far = |part: &&Part| part.solid.corners().iter().all(|p| p.x < 1.95 * MM);
        let few: Vec<Part> = made.task.socket.iter().filter(far).cloned().collect();
        let bare = Bodies { drawn: [&raised, &socket], parts: [bodies.parts[0], &few], ..bodies };
        let off = difference(&bare, &[]).unwrap();
        assert!(off.gaps[0] + TOLERANCE < off.gaps[1], "{off:?}");
    }
}
