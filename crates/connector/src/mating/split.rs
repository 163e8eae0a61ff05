//! Separation of an assembly into plug and socket: the plug is the set of bodies that can be withdrawn together along
//! an axis between facing walls of the others, and that touches the others least.

use super::engagement::{SIDES, WallAreas, score};
use super::frame::{Part, rotations_to_z, turned};
use super::map::{Envelope, HeightMap, NOWHERE, bounds, maps, rest};
use super::refine::{REACH, TOLERANCE};
use super::search::MIN_DEPTH;
use super::{MAX_PLAYS, MatingError};
use crate::body::{span, width};
use crate::mesh::Triangle;
use crate::mesh::skin::{bounding_box, cut};
use input::units::MM;
use nalgebra::{Point3, Vector3};
use parry::bounding_volume::{Aabb, BoundingVolume};
use parry::partitioning::{Bvh, BvhBuildStrategy};
use rapier3d_f64::parry;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Smallest cell of the maps, m.
const MIN_CELL: f64 = 0.05 * MM;
/// Largest number of cells along the side of a map.
const MAX_CELLS: f64 = 400.0;
/// Interferences that are tolerated in a withdrawal, m: contact springs are drawn unloaded.
const INTERFERENCES: [f64; 3] = [0.0, 0.2 * MM, 0.6 * MM];
/// Largest distance between faces that touch, m.
const TOUCHING: f64 = 5e-3 * MM;
/// Weight of contact areas perpendicular to the axis (a seat) relative to those parallel to it (a press fit).
const SEATED: f64 = 0.1;
/// Smallest share of the best value that counts as similar.
const SIMILAR: f64 = 0.8;
/// Smallest share of the best value that counts as equal.
const EQUAL: f64 = 0.97;
/// Largest number of neighbours that are tried at a time.
const MAX_TRIED: usize = 6;
/// Largest number of bodies.
pub const MAX_BODIES: usize = 100;

/// Indices of bodies.
type Set = BTreeSet<usize>;

/// Bodies that can be withdrawn along an axis.
struct Withdrawal {
    set: Set,
    /// Area of facing walls minus weighted contact area, m2.
    value: f64,
    /// Whether these bodies are the plug; otherwise the others are.
    plug: bool,
}

/// Returns the sets of bodies, m, in their mated pose, that may be the plug, the best first.
///
/// # Errors
/// If there are fewer than two bodies or too many, or none can be withdrawn.
pub fn plugs(bodies: &[Vec<Triangle>]) -> Result<Vec<Vec<usize>>, MatingError> {
    if !(2..=MAX_BODIES).contains(&bodies.len()) {
        return Err(MatingError::Bodies(bodies.len()));
    }
    let own = Part::new(&bodies.concat(), "assembly")?.own;
    let bodies: Vec<_> = bodies.iter().map(|body| turned(body, &own)).collect();
    let touching = contacts(&bodies);
    let axes: Vec<Vec<Withdrawal>> = rotations_to_z()
        .par_iter()
        .filter(|turn| (turn.inverse() * Vector3::z()).sum() > 0.5)
        .map(|turn| {
            let axis = (turn.inverse() * Vector3::z()).iamax();
            let contact = touching.iter().map(|(pair, areas)| {
                let beside: f64 = (0..3).filter(|i| *i != axis).map(|i| areas[i]).sum();
                (*pair, beside + SEATED * areas[axis])
            });
            let turned: Vec<_> = bodies.iter().map(|body| turned(body, turn)).collect();
            AxisMaps::new(&turned, contact.collect()).withdrawals()
        })
        .collect();
    let mut found: Vec<Withdrawal> = axes.into_iter().flatten().collect();
    // Of equal sets, that with the fewest bodies comes first, so that loose bodies stay with the socket.
    found.sort_by(|a, b| b.value.total_cmp(&a.value));
    let Some(best) = found.first().map(|best| best.value) else { return Err(MatingError::Blocked) };
    let equal = found.partition_point(|of| of.value >= EQUAL * best);
    found[..equal].sort_by_key(|of| of.set.len());
    let mut plugs: Vec<Vec<usize>> = Vec::new();
    let mut accepted: Vec<Set> = Vec::new();
    for Withdrawal { set, plug, .. } in found.into_iter().filter(|of| of.value >= SIMILAR * best) {
        let nested = |other: &Set| set.is_subset(other) || set.is_superset(other);
        if !accepted.iter().any(nested) {
            plugs.push((0..bodies.len()).filter(|i| set.contains(i) == plug).collect());
            accepted.push(set);
        }
    }
    Ok(plugs)
}

/// Returns the contact areas of each pair of bodies that touch, by the axis of their normals, m2.
fn contacts(bodies: &[Vec<Triangle>]) -> BTreeMap<[usize; 2], [f64; 3]> {
    let around = |points: &[Point3<f64>]| bounding_box(points, TOUCHING / MM);
    let boxes = |body: &Vec<Triangle>| body.iter().map(|t| around(t)).collect::<Vec<_>>();
    let boxes: Vec<Vec<Aabb>> = bodies.iter().map(boxes).collect();
    let whole: Vec<Aabb> = bodies.iter().map(|body| around(body.as_flattened())).collect();
    let trees: Vec<Bvh> =
        boxes.iter().map(|of| Bvh::from_leaves(BvhBuildStrategy::Binned, of)).collect();
    let pairs = (0..bodies.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
    let near: Vec<[usize; 2]> = pairs.filter(|[i, j]| whole[*i].intersects(&whole[*j])).collect();
    let areas = |&[i, j]: &[usize; 2]| {
        let mut sums = [0.0; 3];
        for (face, boxed) in bodies[i].iter().zip(&boxes[i]) {
            for other in trees[j].intersect_aabb(boxed) {
                let (axis, area) = common(face, &bodies[j][other as usize]);
                sums[axis] += area;
            }
        }
        ([i, j], sums)
    };
    let found: Vec<_> = near.par_iter().map(areas).collect();
    found.into_iter().filter(|(_, areas)| areas.iter().any(|area| *area > 0.0)).collect()
}

/// Returns the axis of the normals of two triangles that touch, and the area that they share, m2.
fn common(face: &Triangle, other: &Triangle) -> (usize, f64) {
    let normals = [face, other].map(|[a, b, c]| (b - a).cross(&(c - a)));
    let [Some(n), Some(m)] = normals.map(|normal| normal.try_normalize(f64::MIN_POSITIVE)) else {
        return (0, 0.0);
    };
    let axis = n.iamax();
    let apart = |p: &Point3<f64>| (p - other[0]).dot(&m).abs() > TOUCHING;
    if n.dot(&m) > -0.99 || face.iter().any(apart) {
        return (axis, 0.0);
    }
    // Part of the face within the sides of the other one.
    let mut piece = face.to_vec();
    for i in 0..3 {
        let outward = (other[(i + 1) % 3] - other[i]).cross(&m);
        piece = cut(piece, &other[i], &outward);
    }
    let fan = (1..piece.len().max(2) - 1)
        .map(|i| (piece[i] - piece[0]).cross(&(piece[i + 1] - piece[0])).norm() / 2.0);
    (axis, fan.sum())
}

/// Height maps of the bodies along an axis.
struct AxisMaps {
    /// Side of a cell, m.
    step: f64,
    upper: Vec<HeightMap>,
    lower: Vec<HeightMap>,
    /// Bounds of each body in x, y and z, m.
    bounds: Vec<[[f64; 2]; 3]>,
    /// Weighted contact area of each pair, m2.
    contact: BTreeMap<[usize; 2], f64>,
    /// Areas of the walls of the first body that face the second, m2.
    walls: BTreeMap<[usize; 2], WallAreas>,
}

impl AxisMaps {
    fn new(bodies: &[Vec<Triangle>], contact: BTreeMap<[usize; 2], f64>) -> Self {
        let bounds: Vec<_> = bodies.iter().map(|body| bounds(body)).collect();
        let side = |axis: usize| width(span(bounds.iter().flat_map(|of| of[axis])));
        let step = (side(0).max(side(1)) / MAX_CELLS).max(MIN_CELL);
        let [upper, lower] =
            [Envelope::Upper, Envelope::Lower].map(|envelope| maps(bodies, envelope, step));
        AxisMaps { step, upper, lower, bounds, contact, walls: BTreeMap::new() }
    }

    /// Returns the sets of bodies that can be withdrawn upward, at the tightest fit and the least interference that
    /// allow any.
    fn withdrawals(&mut self) -> Vec<Withdrawal> {
        for max_play in MAX_PLAYS {
            self.measure_walls(REACH * max_play);
            for interference in INTERFERENCES {
                let found = self.withdrawals_at(interference);
                if !found.is_empty() {
                    return found;
                }
            }
        }
        Vec::new()
    }

    /// Measures the walls that face one another within a reach, m.
    fn measure_walls(&mut self, reach: f64) {
        let near = |i: usize, j: usize| {
            (0..3).all(|axis| {
                let ([a, b], [c, d]) = (self.bounds[i][axis], self.bounds[j][axis]);
                a < d + reach && c < b + reach
            })
        };
        let count = self.upper.len();
        let pairs = (0..count).flat_map(|i| (0..count).map(move |j| [i, j]));
        let pairs = pairs.filter(|[i, j]| i != j && near(*i, *j));
        let maps = |i: usize| [&self.lower[i], &self.upper[i]];
        self.walls = pairs.map(|[i, j]| ([i, j], walls(maps(i), maps(j), reach))).collect();
    }

    /// Returns the sets of bodies that can be withdrawn upward with an interference, m.
    fn withdrawals_at(&self, interference: f64) -> Vec<Withdrawal> {
        let count = self.upper.len();
        let cells = (interference / self.step).ceil() as usize;
        let upper: Vec<_> = self.upper.iter().map(|map| map.eroded(cells / 2)).collect();
        let lower: Vec<_> = self.lower.iter().map(|map| map.eroded(cells - cells / 2)).collect();
        let meets =
            |i: usize, j: usize| f64::from(rest(&upper[i], &lower[j], [0; 2], NOWHERE)) > TOLERANCE;
        // For each body, those that block it from above.
        let above: Vec<Set> =
            (0..count).map(|j| (0..count).filter(|&i| i != j && meets(i, j)).collect()).collect();
        let below: Vec<Set> =
            (0..count).map(|j| (0..count).filter(|i| above[*i].contains(&j)).collect()).collect();
        let all: Set = (0..count).collect();
        let ups = (0..count).map(|i| closure(Set::from([i]), &above));
        let downs = (0..count).map(|i| &all - &closure(Set::from([i]), &below));
        let starts: BTreeSet<Set> = ups.chain(downs).collect();
        let mut ends: BTreeMap<Set, f64> = BTreeMap::new();
        for start in starts {
            let end = self.grown(start, &above);
            ends.extend(end.filter(|(_, value)| *value > MIN_DEPTH * MIN_DEPTH));
        }
        let withdrawal =
            |(set, value): (Set, f64)| Withdrawal { plug: self.is_inner(&set), set, value };
        ends.into_iter().map(withdrawal).collect()
    }

    /// Adds bodies to a set as long as its value grows; returns the set and its value.
    fn grown(&self, mut set: Set, above: &[Set]) -> Option<(Set, f64)> {
        let count = self.upper.len();
        let mut value = self.value(&set)?;
        loop {
            let share = |i: &usize| {
                let own = |j: usize| self.contact.get(&[j.min(*i), j.max(*i)]).unwrap_or(&0.0);
                let all: f64 = (0..count).map(own).sum();
                set.iter().map(|j| own(*j)).sum::<f64>() / all.max(f64::MIN_POSITIVE)
            };
            let others = (0..count).filter(|i| !set.contains(i)).map(|i| (share(&i), i));
            let mut near: Vec<(f64, usize)> = others.filter(|(share, _)| *share > 0.0).collect();
            near.sort_by(|a, b| b.0.total_cmp(&a.0));
            let next = near.into_iter().take(MAX_TRIED).filter_map(|(_, i)| {
                let mut more = set.clone();
                more.insert(i);
                let more = closure(more, above);
                Some((self.value(&more)?, more))
            });
            match next.max_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((better, more)) if better > value => (value, set) = (better, more),
                _ => return Some((set, value)),
            }
        }
    }

    /// Returns the area of the facing walls of a set and the other bodies minus their weighted contact area, m2; `None`
    /// for the set of all bodies.
    fn value(&self, set: &Set) -> Option<f64> {
        let separated = |[i, j]: &[usize; 2]| set.contains(i) && !set.contains(j);
        let mut walls = [0.0; 4];
        for (_, areas) in self.walls.iter().filter(|(pair, _)| separated(pair)) {
            (0..4).for_each(|side| walls[side] += areas[side]);
        }
        let touching =
            self.contact.iter().filter(|([i, j], _)| separated(&[*i, *j]) || separated(&[*j, *i]));
        let touching: f64 = touching.map(|(_, area)| area).sum();
        (set.len() < self.upper.len()).then(|| score(&walls) - touching)
    }

    /// Returns whether a set is narrower than the other bodies at the heights that both have.
    fn is_inner(&self, set: &Set) -> bool {
        let [own, rest] = [true, false].map(|inside| -> Vec<[[f64; 2]; 3]> {
            let bodies = (0..self.bounds.len()).filter(|i| set.contains(i) == inside);
            bodies.map(|i| self.bounds[i]).collect()
        });
        let heights = |bodies: &[[[f64; 2]; 3]]| span(bodies.iter().flat_map(|of| of[2]));
        let ([a, b], [c, d]) = (heights(&own), heights(&rest));
        let middle = (a.max(c) + b.min(d)) / 2.0;
        let area = |bodies: &[[[f64; 2]; 3]]| {
            let at = |of: &&[[f64; 2]; 3]| of[2][0] < middle && middle < of[2][1];
            let side = |axis| width(span(bodies.iter().filter(at).flat_map(|of| of[axis])));
            side(0) * side(1)
        };
        area(&own) <= area(&rest)
    }
}

/// Adds to a set all bodies that block one of its bodies, directly or through others.
fn closure(mut set: Set, above: &[Set]) -> Set {
    let mut todo: Vec<usize> = set.iter().copied().collect();
    while let Some(i) = todo.pop() {
        todo.extend(above[i].iter().filter(|j| set.insert(**j)));
    }
    set
}

/// Returns the areas of the walls of a body, by their side, that face a wall of another within a reach, m2; each body
/// is given by its lower and upper envelope.
fn walls([lower, upper]: [&HeightMap; 2], other: [&HeightMap; 2], reach: f64) -> WallAreas {
    let reach = (reach / lower.step[0]).ceil() as i32;
    let heights = |[lower, upper]: [&HeightMap; 2], x: i32, y: i32| {
        let low = lower.at(x, y);
        (low < NOWHERE).then(|| [low, upper.at(x, y)])
    };
    let mut sums = [0.0; 4];
    for [x, y] in lower.cells() {
        let Some([low, high]) = heights([lower, upper], x, y) else { continue };
        for (side, [dx, dy]) in SIDES.into_iter().enumerate() {
            // Heights that the next cell does not cover.
            let [low, high] = match heights([lower, upper], x + dx, y + dy) {
                Some([next, _]) if next > low => [low, next.min(high)],
                Some([_, next]) => [next.max(low), high],
                None => [low, high],
            };
            let faced = (1..=reach).filter_map(|r| heights(other, x + r * dx, y + r * dy));
            let faced = faced.map(|[a, b]| f64::from(b.min(high) - a.max(low)));
            if high > low {
                sums[side] += faced.fold(0.0, f64::max) * lower.step[1 - side / 2];
            }
        }
    }
    sums
}
