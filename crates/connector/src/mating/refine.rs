//! Refinement of coarse seats: shift, height, interference and engagement.

use super::cells::CellSet;
use super::engagement::{PlugWalls, SIDES, SocketWalls, overlap, rests, score};
use super::map::{Envelope, HeightMap, NOWHERE, Window, bounds, rest, touching};
use super::search::{CoarseSeat, FINE, Scene};
use super::select::SIMILAR;
use super::{MatingError, check_cancelled};
use input::units::MM;
use rayon::prelude::*;
use std::sync::atomic::AtomicBool;

/// Largest distance between walls that face each other, as a share of the play.
pub const REACH: f64 = 0.6;
/// Tried interferences, m.
const OVERLAPS: [f64; 10] =
    [0.0, 0.02e-3, 0.05e-3, 0.1e-3, 0.15e-3, 0.2e-3, 0.3e-3, 0.5e-3, 0.8e-3, 1.25e-3];
/// Interference up to which faces count as touching, m.
pub const TOLERANCE: f64 = 0.02 * MM;
/// Largest difference between resting heights that count as equal, m.
const LEVEL: f32 = 0.02e-3;
/// Smallest cell of a map, m.
const MIN_CELL: f64 = 0.01 * MM;
/// Largest number of cells of a map.
const MAX_CELLS: f64 = 1e6;
/// Largest number of moves of the search window.
const MAX_MOVES: usize = 4;
/// Largest number of refined seats.
const MAX_POSES: usize = 24;
/// Smallest facing area of a refined seat, as a share of the largest one.
const SHARE: f64 = 0.4;

/// Step of the depth at which more walls could face each other, m.
const DROP: f64 = 0.1 * MM;
/// Further depth up to which a plug is in its seat, m: the height of a chamfer at the edge of the socket, or of a gap below
/// the body of a plug whose tip is on the floor.
const SEATED: f64 = 1.0 * MM;
/// Largest interference of a contact spring, m.
const MAX_SPRING: f64 = 0.6 * MM;
/// Share of the largest area of walls that face one another from which all of them count as facing.
const FULL_AREA: f64 = 0.995;

/// Refined pose of the plug.
#[derive(Debug, Clone, Default)]
pub struct Pose {
    /// Index of the direction out of the socket.
    pub out: usize,
    /// Index of the rotation of the plug.
    pub turn: usize,
    /// Shift of the turned plug in the turned socket, m.
    pub shift: [f64; 2],
    /// Height, m.
    pub z: f64,
    /// Whether nothing stops the plug.
    pub through: bool,
    /// Area of facing walls on the weaker sides, m2.
    pub walls: f64,
    /// Penalty for the overlapping volume, as an area, m2.
    pub penalty: f64,
    /// Smallest lift that frees the plug towards one of the four sides, m.
    pub depth: f64,
    /// Height above the plug's tip of the part of the plug that this lift frees last, m: more than 0 if a narrower nose
    /// is ahead of it.
    pub nose: f64,
}

impl Pose {
    /// Returns the facing area minus the penalty, m2.
    pub fn value(&self) -> f64 {
        self.walls - self.penalty
    }

    fn near(&self, other: &Pose, max_play: f64) -> bool {
        let apart = [0, 1].map(|a| (self.shift[a] - other.shift[a]).abs());
        (self.out, self.turn) == (other.out, other.turn)
            && apart.into_iter().all(|v| v < max_play)
            && (self.z - other.z).abs() < max_play
    }
}

/// Returns the height of a seated plug, and whether it passes through the socket: then its tip is placed at the far
/// side.
fn seated(z: f32, socket: [f64; 2], plug: [f64; 2]) -> (f64, bool) {
    let z = f64::from(z);
    if z + plug[1] < socket[0] {
        ((socket[0] - plug[0]).max(socket[1] - plug[1]), true)
    } else {
        (z, false)
    }
}

/// Returns the shifts near a shift with the lowest resting height, and that height.
fn lowest([socket, plug]: [&HeightMap; 2], about: [i32; 2], radius: i32) -> (Vec<[i32; 2]>, f32) {
    let mut low = NOWHERE;
    let mut rests = Vec::new();
    let mut shifts: Vec<_> =
        (-radius..=radius).flat_map(|y| (-radius..=radius).map(move |x| [x, y])).collect();
    shifts.sort_by_key(|[x, y]| x * x + y * y);
    for [x, y] in shifts {
        let shift = [about[0] + x, about[1] + y];
        let z = rest(socket, plug, shift, low + 2.0 * LEVEL);
        low = low.min(z);
        rests.push((shift, z));
    }
    rests.retain(|(_, z)| *z <= low + LEVEL);
    (rests.into_iter().map(|(shift, _)| shift).collect(), low)
}

/// Returns the shift nearest to the mean of shifts.
fn middle(shifts: &[[i32; 2]]) -> [i32; 2] {
    let mean = [0, 1]
        .map(|a| shifts.iter().map(|shift| f64::from(shift[a])).sum::<f64>() / shifts.len() as f64);
    let off = |shift: &[i32; 2]| {
        (f64::from(shift[0]) - mean[0]).powi(2) + (f64::from(shift[1]) - mean[1]).powi(2)
    };
    let nearest = shifts.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.copied().unwrap_or_default()
}

/// Returns the smallest height that frees the plug towards one of the four sides, m, and the shift at which the plug
/// touches the socket there.
fn freed(socket: &HeightMap, plug: &HeightMap, shift: [i32; 2], reach: i32) -> (f32, [i32; 2]) {
    let side = |[dx, dy]: [i32; 2]| {
        let shifts = (1..=reach).map(|r| [shift[0] + r * dx, shift[1] + r * dy]);
        let rests = shifts.map(|at| (rest(socket, plug, at, NOWHERE), at));
        rests.fold((-NOWHERE, shift), |high, next| if next.0 > high.0 { next } else { high })
    };
    let sides = SIDES.map(side).into_iter();
    sides.fold((NOWHERE, shift), |low, next| if next.0 < low.0 { next } else { low })
}

/// Refines seats into poses, the best first.
pub fn refined(
    scene: &Scene,
    seats: &[CoarseSeat],
    max_play: f64,
    stop: &AtomicBool,
) -> Result<Vec<Pose>, MatingError> {
    check_cancelled(stop)?;
    let mut poses = estimated(scene, seats, max_play);
    poses.sort_by(|a, b| b.walls.total_cmp(&a.walls));
    let mut kept: Vec<Pose> = Vec::new();
    for pose in poses {
        let good = kept.first().is_none_or(|best| pose.walls > SHARE * best.walls);
        if good && kept.len() < MAX_POSES && !kept.iter().any(|other| other.near(&pose, max_play)) {
            kept.push(pose);
        }
    }
    check_cancelled(stop)?;
    let mut fine: Vec<Pose> =
        kept.par_iter().filter_map(|pose| Fine::new(scene, pose, max_play).best(pose)).collect();
    fine.sort_by(|a, b| b.value().total_cmp(&a.value()));
    Ok(fine)
}

/// Returns a pose with its areas and depth, and the height of the middle of the plug above that of the socket, m.
pub fn settled_areas(scene: &Scene, pose: Pose, max_play: f64) -> (Pose, f64) {
    let fine = Fine::new(scene, &pose, max_play);
    let [socket, plug] = fine.heights;
    let at = fine.cells(&pose);
    let [walls, penalty] = fine.sides.areas(&fine.faces(), &fine.tight, at, pose.z as f32 + LEVEL);
    let lowest = f64::from(rest(&fine.upper, &fine.tight, at, NOWHERE));
    let through = seated(lowest.min(pose.z) as f32, socket, plug).1;
    let outside = pose.z + (plug[0] + plug[1] - socket[0] - socket[1]) / 2.0;
    (fine.with_depth(Pose { walls, penalty, through, ..pose }), outside)
}

/// Returns a first estimate of the pose in each seat.
fn estimated(scene: &Scene, seats: &[CoarseSeat], max_play: f64) -> Vec<Pose> {
    let step = scene.step;
    let radii = [0.0, 0.1 * MM, 0.2 * MM].map(|r| ((r / step).round() as usize).max(1));
    let eroded = |maps: &[HeightMap]| -> Vec<[HeightMap; 3]> {
        maps.par_iter().map(|map| radii.map(|r| map.eroded(r))).collect()
    };
    let (upper, lower) = (eroded(&scene.upper), eroded(&scene.lower));
    let sides: Vec<_> = scene.lower.par_iter().map(PlugWalls::new).collect();
    let limits = [REACH * max_play, step];
    let faces: Vec<_> = scene.upper.par_iter().map(|map| SocketWalls::new(map, limits)).collect();
    let estimate = |&CoarseSeat { out, turn, shift, depth }: &CoarseSeat| {
        let [socket, plug] = [&scene.sockets[out], &scene.plugs[turn]].map(|part| bounds(part)[2]);
        let poses = upper[out].iter().zip(&lower[turn]).map(|(s, p)| {
            let (shifts, z) = lowest([s, p], shift, FINE as i32 / 2 + 1);
            let cells = middle(&shifts);
            let (z, through) = seated(z, socket, plug);
            let [walls, penalty] = sides[turn].areas(&faces[out], &lower[turn][0], cells, z as f32);
            let shift = cells.map(|cell| f64::from(cell) * step);
            Pose { out, turn, shift, z, through, walls, penalty, depth, nose: 0.0 }
        });
        poses.max_by(|a, b| a.walls.total_cmp(&b.walls))
    };
    seats.par_iter().filter_map(estimate).collect()
}

/// Maps of fine cells about a pose.
pub struct Fine {
    /// Side of a cell, m.
    pub step: f64,
    upper: HeightMap,
    lower: HeightMap,
    /// Lower envelope of the plug, eroded by [`TOLERANCE`].
    tight: HeightMap,
    sides: PlugWalls,
    /// Lowest and highest z of socket and plug, m.
    heights: [[f64; 2]; 2],
    /// Rectangle of the socket that the plug can touch, m.
    pub window: Window,
    /// Radius of the search for the lowest shift, cells.
    radius: i32,
    /// Limit of the play, m.
    max_play: f64,
}

impl Fine {
    /// Creates the maps about a pose.
    pub fn new(scene: &Scene, pose: &Pose, max_play: f64) -> Self {
        let (socket, plug) = (&scene.sockets[pose.out], &scene.plugs[pose.turn]);
        let ([px, py, pz], [sx, sy, sz]) = (bounds(plug), bounds(socket));
        let common = |p: [f64; 2], s: [f64; 2], shift: f64| {
            [(p[0] + shift).max(s[0]) - 4.0 * max_play, (p[1] + shift).min(s[1]) + 4.0 * max_play]
        };
        let window = [common(px, sx, pose.shift[0]), common(py, sy, pose.shift[1])];
        let area: f64 = window.iter().map(|[low, high]| (high - low).max(0.0)).product();
        let step = (area / MAX_CELLS).sqrt().max(MIN_CELL);
        let back = [0, 1].map(|a| window[a].map(|v| v - pose.shift[a]));
        let upper = HeightMap::new(socket, Envelope::Upper, [step; 2], Some(window));
        let lower = HeightMap::new(plug, Envelope::Lower, [step; 2], Some(back));
        let tight = lower.eroded((TOLERANCE / step).ceil() as usize);
        let radius = (1.5 * scene.step / step).ceil() as i32 + 1;
        let (sides, heights) = (PlugWalls::new(&lower), [sz, pz]);
        Fine { step, upper, lower, tight, sides, heights, window, radius, max_play }
    }

    fn faces(&self) -> SocketWalls<'_> {
        SocketWalls::new(&self.upper, [REACH * self.max_play, TOLERANCE])
    }

    /// Returns the shift of a pose in cells.
    fn cells(&self, pose: &Pose) -> [i32; 2] {
        pose.shift.map(|v| (v / self.step).round() as i32)
    }

    /// Returns the best of the poses refined with each tried interference.
    fn best(&self, pose: &Pose) -> Option<Pose> {
        let faces = self.faces();
        let mut about = self.cells(pose);
        let (mut best, mut last): (Option<Pose>, _) = (None, None);
        for overlap in OVERLAPS {
            let cells = (overlap / self.step).round() as usize;
            if last.replace(cells) == Some(cells) {
                continue;
            }
            let s = self.upper.eroded(cells / 2);
            let p = self.lower.eroded(cells - cells / 2);
            let Some((shift, z)) = self.settled([&s, &p], &faces, about) else { continue };
            let (z, through) = seated(z, self.heights[0], self.heights[1]);
            let [walls, penalty] = self.sides.areas(&faces, &self.tight, shift, z as f32);
            let at = shift.map(|v| f64::from(v) * self.step);
            let next = Pose { shift: at, z, through, walls, penalty, ..*pose };
            if best.as_ref().is_none_or(|best| next.value() > best.value()) {
                about = shift;
                best = Some(next);
            }
        }
        best.map(|best| self.with_depth(best))
    }

    /// Returns the pose with its depth and the length of its nose.
    fn with_depth(&self, pose: Pose) -> Pose {
        let shift = self.cells(&pose);
        let overlap = CellSet::new(&self.overlap(&pose));
        let side = ((self.max_play + 2.0 * self.width(&overlap)) / self.step).ceil() as i32;
        let (s, p) = (&self.upper, self.tight.without(&overlap));
        let (height, at) = freed(s, &p, shift, side);
        let depth = (f64::from(height) - pose.z).max(0.0);
        // By the edge of the socket: within the tolerance, a chamfer of the tip touches it at several heights.
        let met = touching([s, &p], at, height - LEVEL);
        let edge = met.map(|[x, y]| s.at(x + at[0], y + at[1])).fold(-NOWHERE, f32::max);
        let nose = f64::from(edge - height) - self.heights[1][0];
        let nose = if depth > 0.0 { nose.max(0.0) } else { 0.0 };
        Pose { depth, nose, ..pose }
    }

    /// Returns the shift near `about` with the lowest resting height and, among equal ones, the largest facing area;
    /// and that height, m.
    fn settled(
        &self,
        maps: [&HeightMap; 2],
        faces: &SocketWalls,
        mut about: [i32; 2],
    ) -> Option<([i32; 2], f32)> {
        let mut found = None;
        for _ in 0..MAX_MOVES {
            let (level, z) = lowest(maps, about, self.radius);
            let (seat, _) = seated(z, self.heights[0], self.heights[1]);
            let engaged = |shift: &[i32; 2]| score(&self.sides.facing(faces, *shift, seat as f32));
            let scores: Vec<_> = level.iter().map(engaged).collect();
            let most = scores.iter().copied().fold(0.0, f64::max);
            let good = level.iter().zip(&scores).filter(|(_, score)| **score >= 0.99 * most);
            let shift = middle(&good.map(|(shift, _)| *shift).collect::<Vec<_>>());
            found = Some((shift, z));
            // The best shift may lie beyond the tried ones.
            if (0..2).all(|a| (shift[a] - about[a]).abs() < self.radius) {
                break;
            }
            about = shift;
        }
        found
    }

    /// Returns the deeper pose in which most walls face one another, with the play between them along x and y, m, if only
    /// springs stop the plug before it.
    pub fn lowered(&self, pose: &Pose) -> Option<(Pose, [f64; 2])> {
        let missed = if pose.through { 0.0 } else { self.missed(pose) };
        // The plug can rest a little higher, on its body.
        let lowered = |raised: i32| {
            let by = Some(missed - f64::from(raised) * DROP).filter(|by| *by > SEATED)?;
            let (lower, play) = self.between_walls(Pose { z: pose.z - by, ..pose.clone() })?;
            let springs = self.interference(&lower) <= MAX_SPRING;
            springs.then(|| (self.with_depth(lower), play))
        };
        (0..4).find_map(lowered)
    }

    /// Returns a pose moved to the middle between the walls that face the plug, and the play between them along x and y,
    /// m: without springs and ribs on less than half of a wall. `None` without walls on four sides that leave it room.
    pub fn between_walls(&self, pose: Pose) -> Option<(Pose, [f64; 2])> {
        let most = (2.0 * self.max_play / self.step).ceil() as i32;
        let (at, z) = (self.cells(&pose), pose.z as f32 + LEVEL);
        let [a, b, c, d] = self.sides.gaps(&self.upper, at, z, most);
        let [a, b, c, d] = [a?, b?, c?, d?].map(|gap| f64::from(gap) * self.step);
        let ([x, y], play) = (pose.shift, [a + b, c + d]);
        let middle = Pose { shift: [x + (a - b) / 2.0, y + (c - d) / 2.0], ..pose };
        play.iter().all(|play| *play >= -2.0 * TOLERANCE).then_some((middle, play))
    }

    /// Returns the cells that both parts fill at a pose.
    pub fn overlap(&self, pose: &Pose) -> Vec<[i32; 2]> {
        overlap([&self.upper, &self.tight], self.cells(pose), pose.z as f32 + LEVEL)
    }

    /// Returns the least further depth at which most walls would face one another if nothing stopped the plug above the
    /// floor, m: 0 if it is at most [`SEATED`] or those at its seat are [`SIMILAR`], as they are unless a key or a screw is
    /// in the way.
    pub fn missed(&self, pose: &Pose) -> f64 {
        let (faces, at) = (self.faces(), self.cells(pose));
        let walls = |by: f64| score(&self.sides.facing(&faces, at, (pose.z - by) as f32 + LEVEL));
        let most = pose.z - self.floor(pose) + f64::from(LEVEL);
        let lower = (1..).map(|i| f64::from(i) * DROP).take_while(|by| *by < most);
        let areas: Vec<(f64, f64)> = lower.map(|by| (walls(by), by)).collect();
        let most = areas.iter().fold(0.0, |most, (area, _)| area.max(most));
        // In a deep socket the area stays the same below the depth at which all walls face one another.
        let first = areas.into_iter().find(|(area, _)| *area >= FULL_AREA * most);
        let missed = |(_, by): &(f64, f64)| *by > SEATED && SIMILAR * most > walls(0.0);
        first.filter(missed).map_or(0.0, |(_, by)| by)
    }

    /// Returns the height of the plug at which half of its engaged tip meets the socket or, without a floor, all of the
    /// plug has passed the socket, m.
    fn floor(&self, pose: &Pose) -> f64 {
        let [socket, plug] = self.heights;
        let end = (plug[0] + pose.nose + pose.depth) as f32;
        let tip = |([x, y], _): &([i32; 2], f32)| self.tight.at(*x, *y) < end;
        let rests = rests([&self.upper, &self.tight], self.cells(pose)).filter(tip);
        let mut heights: Vec<f32> = rests.map(|(_, height)| height).collect();
        heights.sort_by(f32::total_cmp);
        let middle = heights.get(heights.len() / 2).copied().unwrap_or(-NOWHERE);
        f64::from(middle).max(socket[0] - plug[1])
    }

    /// Returns the width of the region that both parts fill at a pose, m.
    pub fn interference(&self, pose: &Pose) -> f64 {
        self.width(&CellSet::new(&self.overlap(pose)))
    }

    fn width(&self, cells: &CellSet) -> f64 {
        let width = if cells.is_empty() { 0.0 } else { TOLERANCE };
        (0..cells.depth()).fold(width, |width, _| width + 2.0 * self.step)
    }
}
