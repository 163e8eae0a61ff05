//! Refinement of rough seats: shift, height, interference and engagement.

use super::engagement::{Sides, common, score};
use super::frame::Parts;
use super::map::{Envelope, Map, NOWHERE, bounds, rest};
use super::search::{FINE, MOST_PLAY, Scene, Seat};
use super::{MatingError, Watch};
use crate::mesh::Triangle;
use input::units::MM;
use rayon::prelude::*;

/// Distance within which two walls face one another, m.
const REACH: f64 = 0.3 * MM;
/// Interference at which parts were not drawn for one another, m.
const MOST_OVERLAP: f64 = 2.0 * MM;
/// Interference tried, m.
const OVERLAPS: [f64; 9] = [0.0, 0.02e-3, 0.05e-3, 0.1e-3, 0.15e-3, 0.2e-3, 0.3e-3, 0.4e-3, 0.5e-3];
/// Interference of faces that touch, m.
const TOLERANCE: f64 = 0.02 * MM;
/// Difference of heights of one seat, m.
const LEVEL: f32 = 0.02e-3;
/// Least cell, m, and most cells of a map.
const LEAST_CELL: f64 = 0.01 * MM;
const MOST_CELLS: f64 = 1e6;
/// Most times that the middle of the shifts tried moves.
const MOST_MOVES: usize = 4;
/// Most seats refined, and share of the best that is still refined.
const MOST: usize = 48;
const SHARE: f64 = 0.4;

/// Pose on the maps, refined.
#[derive(Debug, Clone)]
pub struct Pose {
    /// Number of the direction out of the socket.
    pub out: usize,
    /// Number of the plug's turn.
    pub turn: usize,
    /// Shift of the turned plug in the turned socket, m.
    pub shift: [f64; 2],
    /// Height, m.
    pub z: f64,
    /// Whether nothing stops the plug.
    pub through: bool,
    /// Interference, m.
    pub overlap: f64,
    /// Area of facing walls on the weaker sides, m2.
    pub walls: f64,
    /// Area of interfering walls, m2.
    pub jam: f64,
    /// Climb out of the seat towards the lowest side, m.
    pub depth: f64,
}

impl Pose {
    /// Engagement, less for interference.
    pub fn value(&self) -> f64 {
        (self.walls - self.jam / 2.0) * (1.0 - self.overlap / MOST_OVERLAP)
    }

    fn near(&self, other: &Pose) -> bool {
        let apart = [0, 1].map(|a| (self.shift[a] - other.shift[a]).abs());
        (self.out, self.turn) == (other.out, other.turn)
            && apart.into_iter().all(|v| v < MOST_PLAY)
            && (self.z - other.z).abs() < MOST_PLAY
    }
}

/// Heights of the lowest and the highest place of a part, m.
fn heights(part: &[Triangle]) -> [f64; 2] {
    bounds(part)[2]
}

/// Height of a plug: that of its seat, or with its tip at the far side of the socket.
fn seated(z: f32, socket: [f64; 2], plug: [f64; 2]) -> (f64, bool) {
    let z = f64::from(z);
    if z + plug[1] < socket[0] {
        ((socket[0] - plug[0]).max(socket[1] - plug[1]), true)
    } else {
        (z, false)
    }
}

/// Shifts near a shift with the lowest rest, and that.
fn lowest(socket: &Map, plug: &Map, about: [i32; 2], radius: i32) -> (Vec<[i32; 2]>, f32) {
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

/// Shift nearest to the mean of shifts.
fn middle(shifts: &[[i32; 2]]) -> [i32; 2] {
    let mean = [0, 1].map(|a| {
        shifts.iter().map(|shift| f64::from(shift[a])).sum::<f64>() / shifts.len() as f64
    });
    let off = |shift: &[i32; 2]| {
        (f64::from(shift[0]) - mean[0]).powi(2) + (f64::from(shift[1]) - mean[1]).powi(2)
    };
    let nearest = shifts.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest.copied().unwrap_or_default()
}

/// Climb out of a seat towards its lowest side, m.
fn climb(socket: &Map, plug: &Map, shift: [i32; 2], z: f64, reach: i32) -> f64 {
    let mut least = f64::INFINITY;
    for [dx, dy] in [[1, 0], [-1, 0], [0, 1], [0, -1]] {
        let path = (1..=reach).map(|r| rest(socket, plug, [shift[0] + r * dx, shift[1] + r * dy], NOWHERE));
        least = least.min(f64::from(path.fold(-NOWHERE, f32::max)) - z);
    }
    least.max(0.0)
}

/// Refines seats; the best first.
pub fn refined(
    _parts: &Parts,
    (scene, seats): (Scene, Vec<Seat>),
    watch: &Watch,
) -> Result<(Scene, Vec<Pose>), MatingError> {
    watch.check(0.6)?;
    let eroded = |maps: &Vec<Map>| -> Vec<[Map; 2]> {
        let radius = ((0.1 * MM / scene.step).round() as usize).max(1);
        maps.par_iter().map(|map| [1, radius.max(2)].map(|r| map.eroded([r; 2]))).collect()
    };
    let (upper, lower) = (eroded(&scene.upper), eroded(&scene.lower));
    let faces: Vec<Sides> = scene.lower.par_iter().map(Sides::new).collect();
    let rough = |seat: &Seat| {
        let poses = [0, 1].map(|level| {
            let (socket, plug) = (&upper[seat.out][level], &lower[seat.turn][level]);
            let level = lowest(socket, plug, seat.shift, FINE as i32 / 2 + 1);
            let (shift, z) = (middle(&level.0), level.1);
            let (z, through) =
                seated(z, heights(&scene.sockets[seat.out]), heights(&scene.plugs[seat.turn]));
            let sides = faces[seat.turn].facing(
                &scene.upper[seat.out],
                (shift, z as f32),
                [REACH, scene.step],
            );
            Pose {
                out: seat.out,
                turn: seat.turn,
                shift: shift.map(|s| f64::from(s) * scene.step),
                z,
                through,
                overlap: 0.0,
                walls: score(&sides),
                jam: 0.0,
                depth: seat.depth,
            }
        });
        poses.into_iter().max_by(|a, b| a.walls.total_cmp(&b.walls))
    };
    let mut poses: Vec<Pose> = seats.par_iter().filter_map(rough).collect();
    poses.sort_by(|a, b| b.walls.total_cmp(&a.walls));
    let mut kept: Vec<Pose> = Vec::new();
    for pose in poses {
        let good = kept.first().is_none_or(|best| pose.walls > SHARE * best.walls);
        if good && kept.len() < MOST && !kept.iter().any(|other| other.near(&pose)) {
            kept.push(pose);
        }
    }
    watch.check(0.7)?;
    if std::env::var("D").is_ok() { for p in &kept { eprintln!("rough {p:?}"); } }
    let mut fine: Vec<Pose> = kept.par_iter().filter_map(|pose| finer(&scene, pose)).collect();
    fine.sort_by(|a, b| b.value().total_cmp(&a.value()));
    Ok((scene, fine))
}

/// Seat on maps of fine cells, with as much interference as makes it best.
fn finer(scene: &Scene, pose: &Pose) -> Option<Pose> {
    let (socket, plug) = (&scene.sockets[pose.out], &scene.plugs[pose.turn]);
    let [px, py, _] = bounds(plug);
    let [sx, sy, _] = bounds(socket);
    let overlapping = |p: [f64; 2], s: [f64; 2], shift: f64| {
        [(p[0] + shift).max(s[0]) - 2.0 * MM, (p[1] + shift).min(s[1]) + 2.0 * MM]
    };
    let window = [overlapping(px, sx, pose.shift[0]), overlapping(py, sy, pose.shift[1])];
    let area: f64 = window.iter().map(|[low, high]| (high - low).max(0.0)).product();
    let step = (area / MOST_CELLS).sqrt().max(LEAST_CELL);
    let back = [0, 1].map(|a| window[a].map(|v| v - pose.shift[a]));
    let upper = Map::new(socket, Envelope::Upper, [step; 2], Some(window));
    let lower = Map::new(plug, Envelope::Lower, [step; 2], Some(back));
    let (faces, tight) = (Sides::new(&lower), lower.eroded([(TOLERANCE / step).ceil() as usize; 2]));
    let about = pose.shift.map(|v| (v / step).round() as i32);
    let radius = (1.5 * scene.step / step).ceil() as i32 + 1;
    let mut best: Option<Pose> = None;
    let mut last = None;
    for overlap in OVERLAPS {
        let cells = (overlap / step).round() as usize;
        if last.replace(cells) == Some(cells) {
            continue;
        }
        let (s, p) = (upper.eroded([cells / 2; 2]), lower.eroded([cells - cells / 2; 2]));
        let settle = |mut about: [i32; 2]| {
            let mut found = None;
            for _ in 0..MOST_MOVES {
                let (level, z) = lowest(&s, &p, about, radius);
                let (z, through) = seated(z, heights(socket), heights(plug));
                let engaged = |shift: &[i32; 2]| {
                    score(&faces.facing(&upper, (*shift, z as f32), [REACH, TOLERANCE]))
                };
                let scores: Vec<_> = level.iter().map(engaged).collect();
                let most = scores.iter().copied().fold(0.0, f64::max);
                let good = level.iter().zip(&scores).filter(|(_, score)| **score >= 0.99 * most);
                let shift = middle(&good.map(|(shift, _)| *shift).collect::<Vec<_>>());
                found = Some((shift, z, engaged(&shift), through));
                // The best place may lie beyond the shifts tried.
                if (0..2).all(|a| (shift[a] - about[a]).abs() < radius) {
                    break;
                }
                about = shift;
            }
            found
        };
        let Some((shift, z, walls, through)) = settle(about) else { continue };
        let jam = common(&upper, &tight, shift, z as f32) / overlap.max(step);
        let side = ((MOST_PLAY + overlap) / step).ceil() as i32;
        let next = Pose {
            shift: shift.map(|v| f64::from(v) * step),
            z,
            through,
            overlap,
            walls,
            jam,
            ..*pose
        };
        if std::env::var("D").is_ok() { eprintln!("out {} turn {} shift {:?} e {:.3} z {:.3} walls {:.2} jam {:.2} climb {:.2} plateau {} step {:.4}", next.out, next.turn, next.shift.map(|v| v*1e3), overlap*1e3, z*1e3, next.walls*1e6, next.jam*1e6, climb(&s, &p, shift, z, side)*1e3, 0, step*1e3); }
        if best.as_ref().is_none_or(|best| next.value() > best.value()) {
            best = Some(Pose { depth: climb(&s, &p, shift, z, side), ..next });
        }
    }
    best
}
