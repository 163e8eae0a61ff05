//! Closing of gaps in a surface: in files, common corners can differ by rounding, and a corner can lie in the middle
//! of a neighbour's edge.

use super::edges;
use input::units::MM;
use nalgebra::Point3;
use std::collections::{BTreeMap, BTreeSet};

/// Widest gap that is closed, m.
pub const GAP: f64 = 0.1 * MM;
/// Largest number of corners on open edges; all pairs of them are compared.
const MAX_CORNERS: usize = 4000;
/// Largest number of passes that split edges, and therefore of corners on one edge.
const ROUNDS: usize = 16;

/// Joins corners of open edges that are close together, and splits open edges at corners close to them. Returns whether
/// any edge was open.
pub fn mend(points: &[Point3<f64>], faces: &mut Vec<[usize; 3]>) -> bool {
    let corners: BTreeSet<usize> = open_edges(faces).into_keys().flatten().collect();
    if corners.is_empty() || corners.len() > MAX_CORNERS {
        return false;
    }
    let mut kept: Vec<usize> = Vec::new();
    let mut joined = BTreeMap::new();
    for &corner in &corners {
        let away = |&other: &usize| (points[corner] - points[other]).norm();
        match kept.iter().map(|other| (away(other), *other)).min_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((far, other)) if far < GAP => {
                joined.insert(corner, other);
            }
            _ => kept.push(corner),
        }
    }
    faces.iter_mut().for_each(|face| *face = face.map(|at| *joined.get(&at).unwrap_or(&at)));
    let solid = |[a, b, c]: &[usize; 3]| a != b && b != c && c != a;
    faces.retain(solid);
    for _ in 0..ROUNDS {
        let open = open_edges(faces);
        let corners: BTreeSet<usize> = open.keys().flatten().copied().collect();
        let mut changed = BTreeSet::new();
        for (edge, face) in open {
            let near = corners.iter().filter_map(|&c| Some((edge_distance(points, edge, c)?, c)));
            let Some((_, corner)) = near.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
            if changed.insert(face) {
                let whole = faces[face];
                let with = |end: usize| whole.map(|at| if at == end { corner } else { at });
                faces[face] = with(edge[0]);
                faces.push(with(edge[1]));
            }
        }
        faces.retain(solid);
        if changed.is_empty() {
            break;
        }
    }
    true
}

/// Returns the open edges, those with an odd number of faces, each with the last of its faces.
fn open_edges(faces: &[[usize; 3]]) -> BTreeMap<[usize; 2], usize> {
    let mut found: BTreeMap<[usize; 2], (usize, usize)> = BTreeMap::new();
    for (number, face) in faces.iter().enumerate() {
        for [a, b] in edges(*face) {
            let edge = found.entry([a.min(b), a.max(b)]).or_default();
            *edge = (edge.0 + 1, number);
        }
    }
    let odd = found.into_iter().filter(|(_, (count, _))| count % 2 == 1);
    odd.map(|(edge, (_, face))| (edge, face)).collect()
}

/// Returns the distance of a corner from an edge, m, if it is close to the edge and between its ends.
fn edge_distance(points: &[Point3<f64>], [a, b]: [usize; 2], corner: usize) -> Option<f64> {
    if corner == a || corner == b {
        return None;
    }
    let (along, to) = (points[b] - points[a], points[corner] - points[a]);
    let share = to.dot(&along) / along.norm_squared();
    let far = (to - along * share).norm();
    (share > 0.0 && share < 1.0 && far < GAP).then_some(far)
}
