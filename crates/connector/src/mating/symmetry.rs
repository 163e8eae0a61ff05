//! Rotations of the parts that are equivalent by their symmetry.

use super::frame::{rotations_to_z, turned, turns};
use super::map::{Envelope, HeightMap, bounds, maps};
use super::search::Scene;
use crate::mesh::Triangle;
use input::units::MM;
use nalgebra::{Rotation3, Vector3};
use rayon::prelude::*;

/// Largest difference between heights of equal parts, m.
const HEIGHT_TOLERANCE: f32 = 0.05e-3;
/// Number of cells of which one may differ between equal parts.
const RARE: usize = 1000;

/// Returns a representative of each class of equivalent pairs of a direction out of the socket and a rotation of the
/// plug, and the size of the class.
pub fn pairs(scene: &Scene) -> Vec<([usize; 2], usize)> {
    let (turns, count) = (turns(), turns().len());
    let step = 2.0 * scene.step;
    let plugs: Vec<_> = scene.plugs.iter().map(|plug| centred(plug)).collect();
    let plugs = maps(&plugs, Envelope::Lower, step);
    let sockets =
        turns.iter().map(|turn| turned(&scene.sockets[0], &(turn * rotations_to_z()[0].inverse())));
    let sockets: Vec<_> = sockets.map(|socket| centred(&socket)).collect();
    let sockets = maps(&sockets, Envelope::Upper, step);
    let number = |turn: Rotation3<f64>| {
        turns.iter().position(|other| (other.matrix() - turn.matrix()).amax() < MM).unwrap_or(0)
    };
    let mut root: Vec<usize> = (0..rotations_to_z().len() * count).collect();
    let mut join = |a: usize, b: usize| {
        let (a, b) = (root[a], root[b]);
        root.iter_mut().filter(|r| **r == a.max(b)).for_each(|r| *r = a.min(b));
    };
    for (a, b) in equal_pairs(&plugs) {
        (0..rotations_to_z().len()).for_each(|out| join(out * count + a, out * count + b));
    }
    for (a, b) in equal_pairs(&sockets).into_iter().filter(|(a, _)| a % 4 == 0) {
        // Turned back about z, the second socket has one of the six directions of `rotations_to_z`.
        let back = turns[b / 4 * 4] * turns[b].inverse();
        for (turn, of) in turns.iter().enumerate() {
            join(a / 4 * count + turn, b / 4 * count + number(back * of));
        }
    }
    let size = |i: usize| root.iter().filter(|root| **root == i).count();
    let first = (0..root.len()).filter(|i| root[*i] == *i);
    first.map(|i| ([i / count, i % count], size(i))).collect()
}

/// Returns a part centred in x and y, with its lowest point at z = 0.
fn centred(part: &[Triangle]) -> Vec<Triangle> {
    let [x, y, z] = bounds(part);
    let by = Vector3::new((x[0] + x[1]) / 2.0, (y[0] + y[1]) / 2.0, z[0]);
    part.iter().map(|corners| corners.map(|p| p - by)).collect()
}

/// Returns the pairs of maps that are equal, in both orders.
fn equal_pairs(maps: &[HeightMap]) -> Vec<(usize, usize)> {
    let ranges: Vec<[HeightMap; 2]> =
        maps.par_iter().map(|map| [map.eroded(1), map.dilated(1)]).collect();
    let within = |a: &HeightMap, [inner, outer]: &[HeightMap; 2]| {
        let differs = |[x, y]: &[i32; 2]| {
            let (z, one, two) = (a.at(*x, *y), inner.at(*x, *y), outer.at(*x, *y));
            z < one.min(two) - HEIGHT_TOLERANCE || z > one.max(two) + HEIGHT_TOLERANCE
        };
        a.cells().filter(differs).count() * RARE <= a.heights.len()
    };
    let near = |a: &HeightMap, b: &HeightMap| {
        (0..2).all(|i| a.count[i].abs_diff(b.count[i]) <= 1 && (a.first[i] - b.first[i]).abs() <= 1)
    };
    let all = (0..maps.len()).flat_map(|a| (0..maps.len()).map(move |b| (a, b)));
    let all: Vec<_> = all.filter(|(a, b)| a != b && near(&maps[*a], &maps[*b])).collect();
    let same =
        |(a, b): &(usize, usize)| within(&maps[*a], &ranges[*b]) && within(&maps[*b], &ranges[*a]);
    all.into_par_iter().filter(same).collect()
}
