//! Interference of plug and socket on the way to the mated pose: drawings show contact springs unloaded, ribs
//! uncrushed, and press fits with their oversize.

use crate::body::{ConvexBody, Overlap, clipped, extent, longest_side, span};
use crate::mesh::skin::cut_below;
use contact::scene::Pose;
use input::units::MM;
use insertion::task::geometry;
use insertion::task::geometry::outline_by;
use insertion::{Part, Solid};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Overlap that rounding and facets explain, m.
pub const ROUNDING: f64 = 0.02 * MM;
/// Deepest overlap of a press fit, m: a pin of 0.64 mm in a hole of 0.6 mm with springs that narrow it by as much
/// again.
const FIT: f64 = 0.1 * MM;
/// Gap to which the faces of a press fit are cut back, m: the simulated walls do not yield, and 0.05 mm is the smallest
/// play with which strategies are known to insert.
pub const GAP: f64 = 0.025 * MM;
/// Smallest overlap that is considered, m.
const MIN_OVERLAP: f64 = 1e-3 * MM;
/// Step along the path to the mated pose, m.
const STEP: f64 = 0.2 * MM;
/// Smallest component of a normal along the axis at which an overlap belongs to a stop.
const ALONG: f64 = 0.7;
/// Height above the mated pose above which nothing may be in the way, m.
const STOP: f64 = 0.3 * MM;

/// Parts of one body that were left out or cut back, since they overlap the other body in the mated pose or on the way
/// to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Interference {
    /// Body of the parts: 0 plug, 1 socket.
    pub body: usize,
    /// Whether the faces of the parts were cut back, as for a press fit; else the parts were left out.
    pub cut_back: bool,
    /// Number of the parts.
    pub parts: usize,
    /// Deepest overlap, m.
    pub depth: f64,
    /// Smallest and largest corner of the bounding box, task frame, plug mated, m.
    pub bounds: [Point3<f64>; 2],
}

impl Interference {
    /// Returns whether a point, task frame, plug mated, is within a distance of the bounding box, m.
    pub fn is_near(&self, point: &Point3<f64>, distance: f64) -> bool {
        let [low, high] = self.bounds;
        (0..3).all(|i| (low[i] - distance..=high[i] + distance).contains(&point[i]))
    }
}

/// Removes the interference of plug and socket on the way to the mated pose, `depth` below the top, m: of two parts
/// that overlap deeply the smaller one is left out, and faces that overlap sideways by no more than a press fit are
/// cut back, as are those of a `tight` fit, which is drawn without play. Also returns the parts left out of each body.
pub fn cut(
    bodies: &mut [Vec<Part>; 2],
    depth: f64,
    tight: bool,
) -> (Vec<Interference>, [Vec<Part>; 2]) {
    let mut out = [Vec::new(), Vec::new()];
    let mut gone = leave_out(bodies, depth, FIT, &mut out);
    gone.extend(cut_back(bodies, depth, tight));
    gone.extend(leave_out(bodies, depth, ROUNDING, &mut out));
    (gone, out)
}

/// Moves the smaller of two parts that overlap by more than `least`, m, to the parts left out.
fn leave_out(
    bodies: &mut [Vec<Part>; 2],
    depth: f64,
    least: f64,
    left_out: &mut [Vec<Part>; 2],
) -> Vec<Interference> {
    let volumes = bodies.each_ref().map(|parts| -> Vec<f64> {
        parts.iter().map(|part| geometry::volume(&part.solid)).collect()
    });
    let mut out = bodies.each_ref().map(|parts| vec![0.0_f64; parts.len()]);
    let mut found: Vec<_> = overlaps(bodies, depth, least, [0.0; 2]);
    found.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    for Overlap { depth, parts: [i, j], .. } in found {
        // A spring that is left out does not take the parts along with it that pass it on the way.
        if out[0][i] > 0.0 || out[1][j] > 0.0 {
            continue;
        }
        let body = usize::from(volumes[0][i] > volumes[1][j]);
        let part = [i, j][body];
        out[body][part] = out[body][part].max(depth);
    }
    let mut gone = Vec::new();
    for (body, parts) in bodies.iter_mut().enumerate() {
        let all = std::mem::take(parts).into_iter().zip(&out[body]);
        let (left, kept): (Vec<_>, Vec<_>) = all.partition(|(_, depth)| **depth > 0.0);
        *parts = kept.into_iter().map(|(part, _)| part).collect();
        let solids = left.iter().map(|(part, deep)| (**deep, part.solid.clone())).collect();
        gone.extend(grouped(solids, body, false, depth));
        left_out[body].extend(left.into_iter().map(|(part, _)| part));
    }
    gone
}

/// Cuts faces that touch the other body sideways back to the gap of a press fit, if any overlap is more than facets
/// explain. Of two parts the smaller one is cut, so that a rib does not move a wall; a part of which nothing is left is
/// dropped.
fn cut_back(bodies: &mut [Vec<Part>; 2], depth: f64, tight: bool) -> Vec<Interference> {
    let (room, aside) = match tight {
        true => (GAP, &[[GAP, 0.0], [-GAP, 0.0], [0.0, GAP], [0.0, -GAP]][..]),
        false => (0.0, &[[0.0; 2]][..]),
    };
    let touching = aside.iter().flat_map(|&aside| overlaps(bodies, depth, MIN_OVERLAP, aside));
    let pairs: BTreeSet<[usize; 2]> = touching.map(|touch| touch.parts).collect();
    let mut left = bodies.each_ref().map(|parts| -> Vec<Option<Solid>> {
        parts.iter().map(|part| Some(part.solid.clone())).collect()
    });
    // Deepest overlap of each part that was cut, m.
    let mut cut = [BTreeMap::new(), BTreeMap::new()];
    for [i, j] in pairs {
        let [Some(own), Some(its)] = [&left[0][i], &left[1][j]] else { continue };
        let fit = Fit::new(own, its, depth);
        let Some(fit) = fit.filter(|fit| (-room..FIT).contains(&fit.depth)) else { continue };
        let below =
            |solid, at: f64, normal| cut_below(solid, &Point3::from(fit.direction * at), &normal);
        let (body, part, rest) = match geometry::volume(own) < geometry::volume(its) {
            true => (0, i, below(own, fit.faces[1] - GAP, fit.direction)),
            false => (1, j, below(its, fit.faces[0] + GAP, -fit.direction)),
        };
        left[body][part] = rest;
        let deepest = cut[body].entry(part).or_insert(0.0_f64);
        *deepest = deepest.max(fit.depth);
    }
    let deepest = cut.iter().flat_map(BTreeMap::values).copied().fold(0.0, f64::max);
    if deepest <= ROUNDING && !tight {
        return Vec::new();
    }
    let mut gone = Vec::new();
    for (body, parts) in bodies.iter_mut().enumerate() {
        let cut = cut[body].iter().map(|(&i, &deep)| (deep, parts[i].solid.clone()));
        gone.extend(grouped(cut.collect(), body, true, depth));
        let rest = std::mem::take(parts).into_iter().zip(std::mem::take(&mut left[body]));
        *parts = rest.filter_map(|(part, solid)| Some(Part { solid: solid?, ..part })).collect();
    }
    gone
}

/// Overlap of a part of the plug and one of the socket across the axis, in the direction in which it is shallowest.
struct Fit {
    /// Depth, m; negative with a gap.
    depth: f64,
    /// Direction from the plug to the socket.
    direction: Vector3<f64>,
    /// Coordinates of the faces of plug and socket along this direction, m.
    faces: [f64; 2],
}

impl Fit {
    /// Measures the overlap of solids, the plug mated `depth` below the top, m; `None` if one has no outline.
    fn new(plug: &Solid, socket: &Solid, depth: f64) -> Option<Self> {
        let own = plug.corners();
        let [low, _] = extent(&own, 2);
        let its = clipped(&socket.corners(), 2, [low - depth, f64::INFINITY]);
        let [own, its] = [own, its].map(|points| outline_by(points, |p| p.xy()));
        let normals = |outline: &[Point3<f64>], sign: f64| -> Vec<Vector3<f64>> {
            let next = outline.iter().cycle().skip(1);
            let across = outline.iter().zip(next).map(|(p, q)| (q - p).cross(&Vector3::z()));
            across.filter_map(|v| (v * sign).try_normalize(0.0)).collect()
        };
        let fit = |direction: Vector3<f64>| {
            let along =
                |points: &[Point3<f64>]| span(points.iter().map(|p| p.coords.dot(&direction)));
            let faces = [along(&own)[1], along(&its)[0]];
            Fit { depth: faces[0] - faces[1], direction, faces }
        };
        let all = normals(&own, 1.0).into_iter().chain(normals(&its, -1.0)).map(fit);
        all.min_by(|a, b| a.depth.total_cmp(&b.depth))
    }
}

/// Groups parts of a body, each with its overlap, m, into one interference for each set of parts that are close
/// together.
fn grouped(parts: Vec<(f64, Solid)>, body: usize, cut_back: bool, depth: f64) -> Vec<Interference> {
    let mut groups: Vec<Interference> = Vec::new();
    for (depth, solid) in parts {
        let corners = solid.corners();
        let ranges = [0, 1, 2].map(|axis| extent(&corners, axis));
        let bounds = [0, 1].map(|end| Point3::from(ranges.map(|range| range[end])));
        let mut own = Interference { body, cut_back, parts: 1, depth, bounds };
        let near = 0.5 * longest_side(&corners).max(0.5 * MM);
        let apart = |a: &Interference, b: &Interference| {
            let ([low, high], [from, to]) = (a.bounds, b.bounds);
            (0..3).any(|axis| from[axis] > high[axis] + near || low[axis] > to[axis] + near)
        };
        while let Some(i) = groups.iter().position(|other| !apart(other, &own)) {
            let other = groups.swap_remove(i);
            own.parts += other.parts;
            own.depth = own.depth.max(other.depth);
            own.bounds = [own.bounds[0].inf(&other.bounds[0]), own.bounds[1].sup(&other.bounds[1])];
        }
        groups.push(own);
    }
    let shift = [Vector3::new(0.0, 0.0, -depth), Vector3::zeros()][body];
    groups.iter_mut().for_each(|of| of.bounds = of.bounds.map(|corner| corner + shift));
    groups
}

/// Returns the overlaps deeper than `least`, m, on the way down, except those at the stop; the plug is shifted by x and
/// y, m.
fn overlaps(bodies: &[Vec<Part>; 2], depth: f64, least: f64, [x, y]: [f64; 2]) -> Vec<Overlap> {
    let [plug, socket] = bodies.each_ref().map(|parts| ConvexBody::new(parts));
    let steps = (depth / STEP).ceil() as usize;
    let at = |i: usize| {
        let above = i as f64 * STEP;
        let pose = Pose::translation(x, y, above - depth);
        let counts =
            |touch: &Overlap| touch.depth > least && (above > STOP || touch.normal.z.abs() < ALONG);
        plug.overlaps(&pose, &socket).filter(counts).collect::<Vec<_>>()
    };
    (0..=steps).into_par_iter().map(at).collect::<Vec<_>>().concat()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::mesh::Triangle;

    pub fn part(min_mm: [f64; 3], max_mm: [f64; 3]) -> Part {
        let [min, max] = [min_mm, max_mm].map(|p| Vector3::from(p) * MM);
        Part { name: String::new(), solid: Solid::Box { min, max }, friction: None }
    }

    /// Returns the faces of a box with these smallest and largest corners, mm.
    pub fn faces(min_mm: [f64; 3], max_mm: [f64; 3]) -> Vec<Triangle> {
        let corners = part(min_mm, max_mm).solid.corners();
        let (corners, faces) = geometry::hull(&corners).unwrap();
        faces.iter().map(|face| face.map(|corner| corners[corner])).collect()
    }

    /// Four walls about a hole of 0.6 mm, the first with a lead-in, and a floor.
    fn hole() -> Vec<Part> {
        let slope = [[-0.3, -0.3], [-0.6, 0.0], [-0.9, -0.3], [-0.6, -0.6]];
        let outline = slope.iter().map(|p| p.map(|v| v * MM)).collect();
        let lead = Solid::Prism { axis: 1, outline, span: [-0.6, 0.6].map(|y| y * MM) };
        vec![
            part([-0.6, -0.6, -4.0], [-0.3, 0.6, -0.3]),
            part([0.3, -0.6, -4.0], [0.6, 0.6, 0.0]),
            part([-0.3, -0.6, -4.0], [0.3, -0.3, 0.0]),
            part([-0.3, 0.3, -4.0], [0.3, 0.6, 0.0]),
            part([-0.6, -0.6, -4.5], [0.6, 0.6, -4.0]),
            Part { name: String::new(), solid: lead, friction: None },
        ]
    }

    #[test]
    fn a_press_fit_keeps_its_walls_and_a_spring_is_left_out() {
        let mut bodies = [vec![part([-0.32, -0.32, 0.0], [0.32, 0.32, 6.0])], hole()];
        let spring = part([-0.1, 0.1, -2.0], [0.1, 0.5, -1.5]);
        bodies[1].push(spring.clone());
        let (gone, left_out) = cut(&mut bodies, 4.0 * MM, false);
        assert_eq!(bodies.each_ref().map(Vec::len), [1, 6]);
        let sum = |cut_back| {
            let parts = gone.iter().filter(|of| of.body == 1 && of.cut_back == cut_back);
            parts.map(|of| of.parts).sum::<usize>()
        };
        assert_eq!((sum(true), sum(false)), (5, 1), "{gone:?}");
        assert_eq!(left_out, [vec![], vec![spring]]);
        // Room to either side, the slope's lower edge included, and none beyond it.
        let [pin, hole] = bodies.each_ref().map(|parts| ConvexBody::new(parts));
        let deep = |x: f64, y: f64| {
            let at = Pose::translation(x * MM, y * MM, -3.99 * MM);
            pin.overlap(&at, &hole).map_or(0.0, |found| found.depth)
        };
        for [x, y] in [[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]] {
            let near = 0.024;
            assert_eq!(deep(near * x, near * y), 0.0, "{x} {y}");
            assert!(deep(0.03 * x, 0.03 * y) > 4e-3 * MM, "{x} {y}");
        }
    }

    /// A rib that a wall would crush is cut, and the wall stays.
    #[test]
    fn a_crush_rib_moves_no_wall() {
        let rib = part([0.25, -0.05, 0.0], [0.36, 0.05, 5.0]);
        let mut bodies = [vec![part([-0.25, -0.25, 0.0], [0.25, 0.25, 6.0]), rib], hole()];
        let (gone, _) = cut(&mut bodies, 4.0 * MM, false);
        let [plug, socket] = bodies;
        assert_eq!((socket, gone.len()), (hole(), 1), "{gone:?}");
        let [_, high] = extent(plug[1].solid.corners(), 0);
        assert!((high - 0.275 * MM).abs() < 1e-9, "{high}");
    }

    /// A pin that fills its hole without overlap gets a gap on every side.
    #[test]
    fn a_fit_without_play_gets_room() {
        let mut bodies = [vec![part([-0.3, -0.3, 0.0], [0.3, 0.3, 6.0])], hole()];
        let (gone, _) = cut(&mut bodies, 4.0 * MM, true);
        assert!(gone.iter().all(|of| of.cut_back && of.depth < 1e-9), "{gone:?}");
        let [pin, hole] = bodies.each_ref().map(|parts| ConvexBody::new(parts));
        for [x, y] in [[-0.024, 0.0], [0.024, 0.0], [0.0, -0.024], [0.0, 0.024]] {
            let at = Pose::translation(x * MM, y * MM, -3.99 * MM);
            assert_eq!(pin.overlap(&at, &hole), None, "{x} {y}");
        }
    }

    /// Two faces that touch, and a pin that rests on a floor, stay as drawn.
    #[test]
    fn a_sliding_fit_stays_as_drawn() {
        let mut bodies = [vec![part([-0.3, -0.3, 0.0], [0.305, 0.3, 6.0])], hole()];
        assert_eq!(cut(&mut bodies, 4.0 * MM, false).0, []);
        assert_eq!(bodies[1], hole());
    }
}
