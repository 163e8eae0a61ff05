//! Convex polygons of a flat face (Hertel and Mehlhorn 1983): triangles are joined across their edges as long as the
//! result is convex.

use super::facets::{Facets, NARROW};
use crate::mesh::root;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Returns the corners of convex polygons that cover the triangles of a flat face, counter-clockwise from outside.
pub fn polygons(facets: &Facets, flat: &[usize], normal: &Vector3<f64>) -> Vec<Vec<usize>> {
    let place: BTreeMap<usize, usize> = flat.iter().copied().zip(0..).collect();
    let mut edges: Vec<(f64, [usize; 2], [usize; 2])> = Vec::new();
    for (&face, &own) in &place {
        for (ends, other) in facets.neighbours(face) {
            if let Some(&other) = place.get(&other).filter(|other| own < **other) {
                let long = (facets.points[ends[0]] - facets.points[ends[1]]).norm();
                edges.push((long, ends, [own, other]));
            }
        }
    }
    edges.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut loops: Vec<Vec<usize>> = flat.iter().map(|&face| facets.faces[face].to_vec()).collect();
    let mut parent: Vec<usize> = (0..flat.len()).collect();
    // A join can make another one convex, so edges are tried until none is joined.
    loop {
        let before = edges.len();
        edges.retain(|(_, ends, faces)| {
            let [a, b] = faces.map(|face| root(&mut parent, face));
            if a == b {
                return false;
            }
            let Some(both) = joined(&loops[a], &loops[b], *ends) else { return false };
            if !convex(facets, &both, normal) {
                return true;
            }
            (parent[b], loops[a]) = (a, both);
            loops[b].clear();
            false
        });
        if edges.len() == before {
            break;
        }
    }
    loops.retain(|polygon| !polygon.is_empty() && has_area(facets, polygon, normal));
    loops
}

/// Returns the union of two polygons across their common edge, which the first passes from `from` to `to`.
fn joined(first: &[usize], second: &[usize], [from, to]: [usize; 2]) -> Option<Vec<usize>> {
    let at = |polygon: &[usize], [a, b]: [usize; 2]| {
        let count = polygon.len();
        (0..count).find(|&i| polygon[i] == a && polygon[(i + 1) % count] == b)
    };
    let (i, j) = (at(first, [from, to])?, at(second, [to, from])?);
    let round = |polygon: &[usize], from: usize| {
        (0..polygon.len()).map(|k| polygon[(from + k) % polygon.len()]).collect::<Vec<_>>()
    };
    // The first from `to` round to `from`, then the other corners of the second.
    let mut both = round(first, i + 1);
    both.extend(&round(second, j + 2)[..second.len() - 2]);
    // Along a second common edge the outline runs back and forth.
    while both.len() > 2 {
        let count = both.len();
        let Some(tip) = (0..count).find(|&k| both[k] == both[(k + 2) % count]) else { break };
        let (a, b) = ((tip + 1) % count, (tip + 2) % count);
        both.remove(a.max(b));
        both.remove(a.min(b));
    }
    Some(both)
}

/// Returns whether a polygon turns right at no corner, within [`NARROW`], and winds around its interior once.
fn convex(facets: &Facets, polygon: &[usize], normal: &Vector3<f64>) -> bool {
    let count = polygon.len();
    let at = |i: usize| facets.points[polygon[i % count]];
    let mut angle = 0.0;
    count > 2
        && (0..count).all(|i| {
            let (before, after) = (at(i + 1) - at(i), at(i + 2) - at(i + 1));
            let turn = before.cross(&after).dot(normal);
            angle += libm::atan2(turn, before.dot(&after));
            turn > -NARROW * (before.norm() + after.norm()) / 2.0
        })
        && angle < 1.5 * std::f64::consts::TAU
}

fn has_area(facets: &Facets, polygon: &[usize], normal: &Vector3<f64>) -> bool {
    let at = |i: usize| facets.points[polygon[i % polygon.len()]];
    let around: f64 = (0..polygon.len()).map(|i| (at(i + 1) - at(i)).norm()).sum();
    let fan = (1..polygon.len() - 1).map(|i| (at(i) - at(0)).cross(&(at(i + 1) - at(0))));
    fan.sum::<Vector3<f64>>().dot(normal) > NARROW * around
}
