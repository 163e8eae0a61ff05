//! Coarse search for seats over all axes, rotations and shifts, on height maps that bound the resting height.

use super::engagement::SIDES;
use super::frame::{Parts, rotations_to_z, turned, turns};
use super::map::{Envelope, HeightMap, NOWHERE, bounds, maps, rest};
use super::{MAX_PLAYS, MatingError, check_cancelled};
use crate::body::width;
use crate::mesh::Triangle;
use input::units::MM;
use rayon::prelude::*;
use std::sync::atomic::AtomicBool;

/// Smallest depth of a seat, m.
pub const MIN_DEPTH: f64 = 0.4 * MM;
/// Interferences of the passes, m: contact springs are drawn unloaded.
pub const INTERFERENCES: [f64; 2] = [0.0, 0.2 * MM];
/// Interference of the pass for stiff springs, m, which loses thin walls.
pub const STIFF_SPRING: f64 = 0.5 * MM;
/// Smallest cell of the coarse maps, m.
const MIN_CELL: f64 = 0.1 * MM;
/// Budgets of the search in comparisons of two cells: a fast one, and one that resolves thin walls.
pub const EFFORTS: [f64; 2] = [10e9, 160e9];
/// Number of fine cells along the side of a coarse cell.
pub const FINE: usize = 4;
/// Number of pairs of rotations between two checks of the stop flag.
const AT_ONCE: usize = 24;
/// Largest number of seats per pair of rotations: a header of two rows of 50 pins has 297, shifted by whole pitches.
const MAX_SEATS: usize = 300;

/// Seat found on the coarse maps.
pub struct CoarseSeat {
    /// Index of the direction out of the socket in [`rotations_to_z`].
    pub out: usize,
    /// Index of the rotation of the plug in [`turns`].
    pub turn: usize,
    /// Shift of the plug in cells of the fine maps.
    pub shift: [i32; 2],
    /// Smallest lift that frees the plug towards one of the four sides, m.
    pub depth: f64,
}

/// Triangles of both parts in all rotations, and their fine height maps.
pub struct Scene {
    /// Socket, rotated so that z is each of the directions out of it.
    pub sockets: Vec<Vec<Triangle>>,
    /// Plug in each rotation.
    pub plugs: Vec<Vec<Triangle>>,
    /// Cell of the fine maps, m.
    pub step: f64,
    /// Upper envelopes of the sockets.
    pub upper: Vec<HeightMap>,
    /// Lower envelopes of the plugs.
    pub lower: Vec<HeightMap>,
}

impl Scene {
    /// Creates the maps of both parts for a search of `effort` comparisons.
    pub fn new(parts: &Parts, effort: f64) -> Self {
        let sockets: Vec<_> =
            rotations_to_z().iter().map(|turn| turned(&parts.socket.triangles, turn)).collect();
        let plugs: Vec<_> =
            turns().iter().map(|turn| turned(&parts.plug.triangles, turn)).collect();
        let step = cell(&sockets, &plugs, effort) / FINE as f64;
        let (upper, lower) =
            (maps(&sockets, Envelope::Upper, step), maps(&plugs, Envelope::Lower, step));
        Scene { sockets, plugs, step, upper, lower }
    }
}

/// Returns the cell of the coarse maps with which a search takes `effort` comparisons, m.
fn cell(sockets: &[Vec<Triangle>], plugs: &[Vec<Triangle>], effort: f64) -> f64 {
    let sizes = |parts: &[Vec<Triangle>]| -> Vec<[f64; 3]> {
        parts.iter().map(|part| bounds(part).map(width)).collect()
    };
    let (sockets, plugs) = (sizes(sockets), sizes(plugs));
    let pair = |s: &[f64; 3], p: &[f64; 3]| {
        p[0].min(s[0]) * p[1].min(s[1]) * (s[0] + p[0]) * (s[1] + p[1])
    };
    let work: f64 = sockets.iter().flat_map(|s| plugs.iter().map(move |p| pair(s, p))).sum();
    // Two bounds in each of two passes, without and with interference.
    (4.0 * work / effort).sqrt().sqrt().max(MIN_CELL)
}

/// Coarse maps of a part: the outermost height of each cell, and the innermost height of blocks of two by two cells.
type Coarse = [HeightMap; 2];

fn coarse(fine: &HeightMap, erosion: usize) -> Coarse {
    let [outer, inner] = fine.eroded(erosion).coarser(FINE);
    let [before, after] = if fine.envelope == Envelope::Upper { [0, 1] } else { [1, 0] };
    [outer, inner.inner(before, after)]
}

/// Finds the seats for pairs of a direction out of the socket and a rotation of the plug, each with the number of
/// equivalent ones, with each of the interferences, m, at each limit of play.
pub fn seats(
    scene: &Scene,
    pairs: &[([usize; 2], usize)],
    interferences: &[f64],
    stop: &AtomicBool,
) -> Result<[Vec<CoarseSeat>; MAX_PLAYS.len()], MatingError> {
    let mut seats = [const { Vec::new() }; MAX_PLAYS.len()];
    for interference in interferences {
        let erosion = (interference / 2.0 / scene.step).round() as usize;
        let [sockets, plugs] = [&scene.upper, &scene.lower].map(|maps| -> Vec<Coarse> {
            maps.par_iter().map(|map| coarse(map, erosion)).collect()
        });
        for chunk in pairs.chunks(AT_ONCE) {
            check_cancelled(stop)?;
            let of = |(pair, _): &([usize; 2], usize)| {
                let [out, turn] = *pair;
                let passed = bounds(&scene.sockets[out])[2][0] - bounds(&scene.plugs[turn])[2][1];
                let rests = rests(&sockets[out], &plugs[turn], passed as f32);
                MAX_PLAYS.map(|max_play| enclosed(&rests, *pair, max_play))
            };
            let found: Vec<_> = chunk.par_iter().map(of).collect();
            for of_pair in found {
                seats.iter_mut().zip(of_pair).for_each(|(all, more)| all.extend(more));
            }
        }
    }
    Ok(seats)
}

/// Returns a lower bound of the resting height for each shift of the plug, m; at the height `passed`, m, the plug has
/// gone through the socket.
fn rests([s, s_inner]: &Coarse, [p, p_inner]: &Coarse, passed: f32) -> HeightMap {
    let extremes = |map: &HeightMap, take: fn(f32, f32) -> f32| {
        map.heights.iter().copied().fold(map.envelope.empty(), take)
    };
    let highest = extremes(s, f32::max) - extremes(p, f32::min);
    let range = [passed, highest - MIN_DEPTH as f32];
    let first = [0, 1].map(|a| s.first[a] - p.first[a] - p.count[a] as i32);
    let count = [0, 1].map(|a| s.count[a] + p.count[a] + 1);
    let mut map =
        HeightMap { envelope: Envelope::Upper, step: s.step, first, count, heights: Vec::new() };
    let height = |shift: [i32; 2]| {
        let z = rest(s, p_inner, shift, range[1]);
        let z = if z < range[1] { z.max(rest(s_inner, p, shift, range[1])) } else { z };
        // Not `clamp`: a part that is thinner than a cell has an empty map, and the range is empty.
        z.min(range[1]).max(range[0])
    };
    map.heights = map.cells().map(height).collect();
    map
}

/// Finds the seats with at most `max_play` of play, m, in which the plug is enclosed: it cannot move to any of the four
/// sides without being lifted.
fn enclosed(rests: &HeightMap, [out, turn]: [usize; 2], max_play: f64) -> Vec<CoarseSeat> {
    // Bounds widen the play by up to two cells.
    let radius = (max_play / rests.step[0]).ceil() as i32 + 2;
    let lift = |[x, y]: [i32; 2]| {
        let z = rests.at(x, y);
        let side = |[dx, dy]: [i32; 2]| {
            let path = (1..=radius).map(|r| rests.at(x + r * dx, y + r * dy));
            path.fold(z, f32::max) - z
        };
        SIDES.map(side).into_iter().fold(NOWHERE, f32::min)
    };
    let lifts = rests.cells().map(|place| (lift(place), place));
    let mut found: Vec<_> = lifts.filter(|(lift, _)| f64::from(*lift) >= MIN_DEPTH).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut seats: Vec<(f32, [i32; 2])> = Vec::new();
    for (depth, place) in found {
        let near = |other: &[i32; 2]| {
            (other[0] - place[0]).abs() <= radius / 2 && (other[1] - place[1]).abs() <= radius / 2
        };
        if seats.len() < MAX_SEATS && !seats.iter().any(|(_, other)| near(other)) {
            seats.push((depth, place));
        }
    }
    let seat = |(depth, place): (f32, [i32; 2])| {
        let shift = place.map(|cell| cell * FINE as i32 + FINE as i32 / 2);
        CoarseSeat { out, turn, shift, depth: f64::from(depth) }
    };
    seats.into_iter().map(seat).collect()
}
