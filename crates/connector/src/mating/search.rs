//! Rough search for seats: all axes, turns and shifts on coarse maps that bound the height of rest.

use super::engagement::SIDES;
use super::frame::{Parts, outs, turned, turns};
use super::map::{Envelope, Map, NOWHERE, bounds, maps, rest};
use super::{MatingError, ROOMS, check};
use crate::body::width;
use crate::mesh::Triangle;
use input::units::MM;
use rayon::prelude::*;
use std::sync::atomic::AtomicBool;

/// Least depth of a seat, m.
pub const LEAST: f64 = 0.4 * MM;
/// Interference allowed for in a second pass, m: springs are drawn unloaded.
const INTERFERENCE: f64 = 0.2 * MM;
/// Least cell of the maps, m.
const LEAST_CELL: f64 = 0.1 * MM;
/// Comparisons of two cells that a search may take: a quick one, and one for thin walls, which coarse maps lose.
pub const EFFORTS: [f64; 2] = [10e9, 160e9];
/// Cells of a fine map along a side of a coarse one.
pub const FINE: usize = 4;
/// Pairs of axes between two checks for a stop.
const AT_ONCE: usize = 24;
/// Most seats for each pair of axes: a header of two rows of 50 pins has 297, one pitch or more off and all as deep.
const MOST_SEATS: usize = 300;

/// Seat on the maps.
#[derive(Debug, Clone, Copy)]
pub struct Seat {
    /// Number of the direction out of the socket.
    pub out: usize,
    /// Number of the plug's turn.
    pub turn: usize,
    /// Shift of the plug in cells of the fine maps.
    pub shift: [i32; 2],
    /// Climb out of the seat towards the lowest side, m.
    pub depth: f64,
}

/// Turned triangles of both parts, and the fine maps.
pub struct Scene {
    /// Socket, for each direction out of it.
    pub sockets: Vec<Vec<Triangle>>,
    /// Plug in each turn.
    pub plugs: Vec<Vec<Triangle>>,
    /// Cell of the fine maps, m.
    pub step: f64,
    /// Upper envelopes of the sockets.
    pub upper: Vec<Map>,
    /// Lower envelopes of the plugs.
    pub lower: Vec<Map>,
}

impl Scene {
    /// Maps of both parts for a search of so many comparisons.
    pub fn new(parts: &Parts, effort: f64) -> Self {
        let sockets: Vec<_> =
            outs().iter().map(|turn| turned(&parts.socket.triangles, turn)).collect();
        let plugs: Vec<_> =
            turns().iter().map(|turn| turned(&parts.plug.triangles, turn)).collect();
        let step = cell(&sockets, &plugs, effort) / FINE as f64;
        let (upper, lower) =
            (maps(&sockets, Envelope::Upper, step), maps(&plugs, Envelope::Lower, step));
        Scene { sockets, plugs, step, upper, lower }
    }
}

/// Cell of the coarse maps with which the search takes its effort, m.
fn cell(sockets: &[Vec<Triangle>], plugs: &[Vec<Triangle>], effort: f64) -> f64 {
    let sizes = |parts: &[Vec<Triangle>]| -> Vec<[f64; 3]> {
        parts.iter().map(|part| bounds(part).map(width)).collect()
    };
    let (sockets, plugs) = (sizes(sockets), sizes(plugs));
    let pair = |s: &[f64; 3], p: &[f64; 3]| {
        p[0].min(s[0]) * p[1].min(s[1]) * (s[0] + p[0]) * (s[1] + p[1])
    };
    let work: f64 = sockets.iter().flat_map(|s| plugs.iter().map(move |p| pair(s, p))).sum();
    // Two bounds, with and without interference.
    (4.0 * work / effort).sqrt().sqrt().max(LEAST_CELL)
}

/// Coarse maps of a part: outermost heights, and innermost heights of two cells each way.
struct Coarse {
    outer: Map,
    inner: Map,
}

impl Coarse {
    fn new(fine: &Map, erosion: usize) -> Self {
        let [outer, inner] = fine.eroded([erosion; 2]).coarser(FINE);
        let inner = match fine.envelope {
            Envelope::Upper => inner.inner(0, 1),
            Envelope::Lower => inner.inner(1, 0),
        };
        Coarse { outer, inner }
    }
}

/// Finds the seats of pairs of axes for each of the largest plays.
pub fn seats(
    scene: &Scene,
    pairs: &[[usize; 2]],
    stop: &AtomicBool,
) -> Result<[Vec<Seat>; ROOMS.len()], MatingError> {
    let mut seats = [const { Vec::new() }; ROOMS.len()];
    for interference in [0.0, INTERFERENCE] {
        let erosion = (interference / 2.0 / scene.step).round() as usize;
        let coarse = |fine: &Vec<Map>| -> Vec<Coarse> {
            fine.par_iter().map(|map| Coarse::new(map, erosion)).collect()
        };
        let (sockets, plugs) = (coarse(&scene.upper), coarse(&scene.lower));
        for few in pairs.chunks(AT_ONCE) {
            check(stop)?;
            let of = |pair: &[usize; 2]| {
                let [out, turn] = *pair;
                let passed = bounds(&scene.sockets[out])[2][0] - bounds(&scene.plugs[turn])[2][1];
                let rests = rests(&sockets[out], &plugs[turn], passed as f32);
                ROOMS.map(|room| enclosed(&rests, *pair, room))
            };
            let found: Vec<_> = few.par_iter().map(of).collect();
            for of_pair in found {
                seats.iter_mut().zip(of_pair).for_each(|(all, more)| all.extend(more));
            }
        }
    }
    Ok(seats)
}

/// Returns the heights of rest for each shift, from below; at `passed`, m, the plug has gone through.
fn rests(socket: &Coarse, plug: &Coarse, passed: f32) -> Map {
    let extremes = |map: &Map, take: fn(f32, f32) -> f32| {
        map.heights.iter().copied().fold(map.envelope.empty(), take)
    };
    let (s, p) = (&socket.outer, &plug.outer);
    let highest = extremes(s, f32::max) - extremes(p, f32::min);
    let range = [passed, highest - LEAST as f32];
    let first = [0, 1].map(|a| s.first[a] - p.first[a] - p.count[a] as i32);
    let count = [0, 1].map(|a| s.count[a] + p.count[a] + 1);
    let mut map =
        Map { envelope: Envelope::Upper, step: s.step, first, count, heights: Vec::new() };
    let height = |shift: [i32; 2]| {
        let one = rest(s, &plug.inner, shift, range[1]);
        let z = if one < range[1] { one.max(rest(&socket.inner, p, shift, range[1])) } else { one };
        z.clamp(range[0], range[1])
    };
    map.heights = map.cells().map(height).collect();
    map
}

/// Finds the seats from which the plug must climb to each of four sides, with at most `room` of play, m.
fn enclosed(rests: &Map, [out, turn]: [usize; 2], room: f64) -> Vec<Seat> {
    // A bound is as wide as two cells more.
    let radius = (room / rests.step[0]).ceil() as i32 + 2;
    let climb = |[x, y]: [i32; 2]| {
        let z = rests.at(x, y);
        let side = |[dx, dy]: [i32; 2]| {
            let path = (1..=radius).map(|r| rests.at(x + r * dx, y + r * dy));
            path.fold(z, f32::max) - z
        };
        SIDES.map(side).into_iter().fold(NOWHERE, f32::min)
    };
    let climbs = rests.cells().map(|place| (climb(place), place));
    let mut found: Vec<_> = climbs.filter(|(climb, _)| f64::from(*climb) >= LEAST).collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut seats: Vec<(f32, [i32; 2])> = Vec::new();
    for (depth, place) in found {
        let near = |other: &[i32; 2]| {
            (other[0] - place[0]).abs() <= radius / 2 && (other[1] - place[1]).abs() <= radius / 2
        };
        if seats.len() < MOST_SEATS && !seats.iter().any(|(_, other)| near(other)) {
            seats.push((depth, place));
        }
    }
    let seat = |(depth, place): (f32, [i32; 2])| {
        let shift = place.map(|cell| cell * FINE as i32 + FINE as i32 / 2);
        Seat { out, turn, shift, depth: f64::from(depth) }
    };
    seats.into_iter().map(seat).collect()
}
