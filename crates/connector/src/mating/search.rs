//! Rough search for seats: all axes, turns and shifts on coarse maps that bound the height of rest.

use super::frame::{Parts, outs, turned, turns};
use super::map::{Envelope, Map, NOWHERE, bounds, maps, rest};
use super::{MatingError, Watch};
use crate::mesh::Triangle;
use input::units::MM;
use rayon::prelude::*;

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
/// Pairs of axes between two looks at the clock.
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
    let sizes = |part: &Vec<Triangle>| bounds(part).map(|[low, high]| high - low);
    let (sockets, plugs): (Vec<_>, Vec<_>) =
        (sockets.iter().map(sizes).collect(), plugs.iter().map(sizes).collect());
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

/// Seats of pairs of axes for each of some largest plays, m.
pub fn seats<const N: usize>(
    scene: &Scene,
    pairs: &[[usize; 2]],
    rooms: &[f64; N],
    watch: &Watch,
) -> Result<[Vec<Seat>; N], MatingError> {
    let mut seats = [const { Vec::new() }; N];
    for (pass, interference) in [0.0, INTERFERENCE].into_iter().enumerate() {
        let erosion = (interference / 2.0 / scene.step).round() as usize;
        let coarse = |fine: &Vec<Map>| -> Vec<Coarse> {
            fine.par_iter().map(|map| Coarse::new(map, erosion)).collect()
        };
        let (sockets, plugs) = (coarse(&scene.upper), coarse(&scene.lower));
        for (number, few) in pairs.chunks(AT_ONCE).enumerate() {
            let done = pass * pairs.len() + number * AT_ONCE;
            watch.check(0.6 * done as f64 / (2 * pairs.len()) as f64)?;
            let of = |pair: &[usize; 2]| {
                let [out, turn] = *pair;
                let passed = bounds(&scene.sockets[out])[2][0] - bounds(&scene.plugs[turn])[2][1];
                let rests = Rests::new(&sockets[out], &plugs[turn], passed as f32);
                rooms.map(|room| rests.enclosed(*pair, room))
            };
            let found: Vec<[Vec<Seat>; N]> = few.par_iter().map(of).collect();
            for of_pair in found {
                seats.iter_mut().zip(of_pair).for_each(|(all, more)| all.extend(more));
            }
        }
    }
    Ok(seats)
}

/// Heights of rest for each shift, from below.
struct Rests {
    first: [i32; 2],
    count: [usize; 2],
    heights: Vec<f32>,
    /// Size of a shift, m.
    step: f64,
    /// Height below which the plug has gone through, m.
    passed: f32,
}

impl Rests {
    fn new(socket: &Coarse, plug: &Coarse, passed: f32) -> Self {
        let extremes = |map: &Map, take: fn(f32, f32) -> f32| {
            map.heights.iter().copied().fold(map.envelope.empty(), take)
        };
        let highest = extremes(&socket.outer, f32::max) - extremes(&plug.outer, f32::min);
        let range = [passed, highest - LEAST as f32];
        let (s, p) = (&socket.outer, &plug.outer);
        let first = [0, 1].map(|a| s.first[a] - p.first[a] - p.count[a] as i32);
        let count = [0, 1].map(|a| s.count[a] + p.count[a] + 1);
        let height = |number: usize| {
            let shift =
                [first[0] + (number % count[0]) as i32, first[1] + (number / count[0]) as i32];
            let one = rest(&socket.outer, &plug.inner, shift, range[1]);
            let z = if one < range[1] {
                one.max(rest(&socket.inner, &plug.outer, shift, range[1]))
            } else {
                one
            };
            z.clamp(range[0], range[1])
        };
        let heights = (0..count[0] * count[1]).map(height).collect();
        Rests { first, count, heights, step: s.step[0], passed }
    }

    fn at(&self, x: i32, y: i32) -> f32 {
        let inside = x >= 0 && y >= 0 && x < self.count[0] as i32 && y < self.count[1] as i32;
        if inside { self.heights[y as usize * self.count[0] + x as usize] } else { self.passed }
    }

    /// Seats from which the plug must climb to each of four sides, with at most `room` of play, m.
    fn enclosed(&self, [out, turn]: [usize; 2], room: f64) -> Vec<Seat> {
        // A bound is as wide as two cells more.
        let radius = (room / self.step).ceil() as i32 + 2;
        let mut found: Vec<(f32, [i32; 2])> = Vec::new();
        for y in 0..self.count[1] as i32 {
            for x in 0..self.count[0] as i32 {
                let z = self.at(x, y);
                let climb = |[dx, dy]: [i32; 2]| {
                    let path = (1..=radius).map(|r| self.at(x + r * dx, y + r * dy));
                    path.fold(z, f32::max) - z
                };
                let least = [[1, 0], [-1, 0], [0, 1], [0, -1]]
                    .into_iter()
                    .map(climb)
                    .fold(NOWHERE, f32::min);
                if f64::from(least) >= LEAST {
                    found.push((least, [x, y]));
                }
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut seats: Vec<(f32, [i32; 2])> = Vec::new();
        for (depth, place) in found {
            let near = |other: &[i32; 2]| {
                (other[0] - place[0]).abs() <= radius / 2
                    && (other[1] - place[1]).abs() <= radius / 2
            };
            if seats.len() < MOST_SEATS && !seats.iter().any(|(_, other)| near(other)) {
                seats.push((depth, place));
            }
        }
        let seat = |(depth, place): (f32, [i32; 2])| {
            let shift = [0, 1].map(|a| (place[a] + self.first[a]) * FINE as i32 + FINE as i32 / 2);
            Seat { out, turn, shift, depth: f64::from(depth) }
        };
        seats.into_iter().map(seat).collect()
    }
}
