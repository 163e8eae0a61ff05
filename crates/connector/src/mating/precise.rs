//! Resting height and lateral play of a seated plug, measured on fine maps.

use super::Mate;
use super::cells::CellSet;
use super::frame::{Parts, rotations_to_z, turns};
use super::map::{Envelope, HeightMap, Window, bounds, rest, touching};
use super::refine::{Fine, Pose, TOLERANCE};
use super::search::Scene;
use crate::body::width;
use crate::mesh::Triangle;
use input::units::MM;
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

/// Side of a cell along the axis on which play is measured, m.
const CELL: f64 = 0.005 * MM;
/// Largest number of cells of a map.
const MAX_CELLS: f64 = 1.5e6;
/// Height above the seat at which play is measured, m, so that the surface on which the plug rests does not limit it.
const LIFT: f64 = 0.1 * MM;
/// Width of the margin around interfering cells that is left out with them, m.
const MARGIN: f64 = 0.1 * MM;
/// Engagement below which the plug is only caught on an edge, as a share of its length.
const CAUGHT: f64 = 0.05;
/// Number of times that the plug is centred in x and in y, and largest one along an axis without play: a pose at a wall,
/// with a spring across it, has play in x only after it was centred in y and what it then overlaps of the spring was left
/// out.
const ROUNDS: [usize; 2] = [2, 5];

/// Measurement of play and resting height; cells in which the parts interfere are left out.
struct PlayMeasurement<'a> {
    socket: &'a [Triangle],
    plug: &'a [Triangle],
    window: Window,
    /// Cells of the plug in which the parts interfere.
    interfering: Vec<[i32; 2]>,
    /// Width of their region, m.
    interference: f64,
    /// These cells with one and with two margins around them.
    around: [CellSet; 2],
    /// Side of these cells, m.
    step: f64,
    /// Shift of the plug in x and y, m.
    shift: [f64; 2],
    /// Play between the walls along each axis, m, if springs hold the plug.
    walls: Option<[f64; 2]>,
}

impl PlayMeasurement<'_> {
    /// Returns the maps of socket and plug, with cells of [`CELL`] along an axis and larger ones across it.
    fn maps(&self, axis: usize) -> [HeightMap; 2] {
        let area: f64 = self.window.iter().map(|[low, high]| high - low).product();
        let mut step = [(area / MAX_CELLS / CELL).max(2.0 * CELL); 2];
        step[axis] = CELL;
        let by = Vector3::new(self.shift[0], self.shift[1], 0.0);
        let plug: Vec<Triangle> = self.plug.iter().map(|corners| corners.map(|p| p + by)).collect();
        let mut maps = [(self.socket, Envelope::Upper), (&plug, Envelope::Lower)]
            .map(|(part, envelope)| HeightMap::new(part, envelope, step, Some(self.window)));
        maps.iter_mut().for_each(|map| self.clear_interference(map));
        maps
    }

    /// Returns the cell of the plug at a place, m.
    fn cell(&self, place: [f64; 2]) -> [i32; 2] {
        [0, 1].map(|a| ((place[a] - self.shift[a]) / self.step).floor() as i32)
    }

    /// Leaves out more cells.
    fn leave_out(&mut self, cells: impl IntoIterator<Item = [i32; 2]>) {
        self.interfering.extend(cells);
        self.interfering.sort_unstable();
        self.interfering.dedup();
        let margin = (MARGIN / self.step).ceil() as usize;
        let cells = CellSet::new(&self.interfering);
        self.around = [margin, 2 * margin].map(|reach| cells.dilated(reach));
    }

    /// Returns the cells in which the plug touches the socket at an offset, if all are beside those left out, as along a
    /// spring; else none.
    fn spring(
        &self,
        [upper, lower]: [&HeightMap; 2],
        shift: [i32; 2],
        height: f64,
    ) -> Vec<[i32; 2]> {
        let at = |[x, y]: [i32; 2]| {
            let [i, j] = [x + shift[0] - upper.first[0], y + shift[1] - upper.first[1]];
            self.cell([upper.middle(0, i as usize), upper.middle(1, j as usize)])
        };
        let near = |cell: &[i32; 2]| self.around[1].contains(*cell);
        let cells: Vec<_> = touching([upper, lower], shift, height as f32).map(at).collect();
        if cells.iter().all(near) { cells } else { Vec::new() }
    }

    /// Clears the interfering cells of a map.
    fn clear_interference(&self, map: &mut HeightMap) {
        if self.interfering.is_empty() {
            return;
        }
        let [left_out, _] = &self.around;
        let (nx, empty) = (map.count[0], map.envelope.empty());
        for index in 0..map.heights.len() {
            if left_out.contains(self.cell([map.middle(0, index % nx), map.middle(1, index / nx)]))
            {
                map.heights[index] = empty;
            }
        }
    }

    /// Returns the smallest and the largest offset along a lateral axis, in cells, between which the plug is free at a
    /// height, m; they are searched up to `max_play`, m, to either side.
    fn free(
        &self,
        [upper, lower]: [&HeightMap; 2],
        axis: usize,
        height: f64,
        max_play: f64,
    ) -> Option<[i32; 2]> {
        let free =
            |offset: &i32| rest(upper, lower, along(axis, *offset), height as f32) < height as f32;
        let most = (max_play / CELL) as i32;
        // The pose comes from coarser maps and may overlap by a cell or two of those.
        let first = (0..=most / 8).flat_map(|k| [k, -k]).find(free)?;
        let high = (first..first + most).take_while(free).last().unwrap_or(first);
        let low = (first - most..=first).rev().take_while(free).last().unwrap_or(first);
        Some([low, high])
    }

    /// Centres the plug along a lateral axis at a height, m, and returns its total play, m; it is measured up to
    /// `max_play` to either side. A spring on one side, which the plug overlaps in its pose, is left out as far as the
    /// plug can move towards it: at most to the walls or, if they are not known, by the overlap, beyond which it could be
    /// a wall.
    fn centre(&mut self, axis: usize, height: f64, max_play: f64) -> f64 {
        let (mut found, mut least) = (None, i32::MAX);
        loop {
            let [upper, lower] = &self.maps(axis);
            let maps = [upper, lower];
            let Some([low, high]) = self.free(maps, axis, height, max_play) else { break };
            found = Some([low, high]);
            least = least.min(high - low);
            let by_overlap = f64::from(least) * CELL + self.interference;
            let most = self.walls.map_or(by_overlap, |walls| walls[axis]);
            let beyond = [low - 1, high + 1].map(|offset| along(axis, offset));
            let springs = beyond.map(|shift| self.spring(maps, shift, height));
            let one = springs[0].is_empty() != springs[1].is_empty();
            if !one || f64::from(high - low) * CELL >= most {
                break;
            }
            self.leave_out(springs.concat());
        }
        let Some([low, high]) = found else { return 0.0 };
        self.shift[axis] += f64::from(low + high) / 2.0 * CELL;
        f64::from(high - low) * CELL
    }

    /// Measures the play at a height, m, up to `max_play` to either side, without the cells that interfere, and the
    /// height at which the plug then rests.
    fn at(mut self, interfering: Vec<[i32; 2]>, height: f64, max_play: f64) -> Measured {
        self.leave_out(interfering);
        let mut play_m = [0.0; 2];
        for round in 0..ROUNDS[1] {
            for (axis, play) in play_m.iter_mut().enumerate() {
                if round < ROUNDS[0] || *play == 0.0 {
                    *play = self.centre(axis, height, max_play);
                }
            }
        }
        let [upper, lower] = self.maps(0);
        let rest = f64::from(rest(&upper, &lower, [0; 2], f32::MAX));
        Measured { shift: self.shift, play_m, rest }
    }
}

/// Play of a plug in its seat.
struct Measured {
    /// Shift of the plug to the middle of its play, m.
    shift: [f64; 2],
    /// Play along x and y, m.
    play_m: [f64; 2],
    /// Height at which the plug rests, m.
    rest: f64,
}

/// Returns the shift by an offset along an axis.
fn along(axis: usize, offset: i32) -> [i32; 2] {
    let mut shift = [0; 2];
    shift[axis] = offset;
    shift
}

/// Measures resting height and play at a pose and returns the mate in the frames of the files.
pub fn mate(parts: &Parts, scene: &Scene, pose: &Pose, max_play: f64) -> Mate {
    let fine = Fine::new(scene, pose, max_play);
    let (socket, plug) = (&scene.sockets[pose.out], &scene.plugs[pose.turn]);
    let measured = |pose: &Pose, walls| {
        let (window, step, shift) = (fine.window, fine.step, pose.shift);
        let (interfering, around) = (Vec::new(), Default::default());
        let interference = fine.interference(pose);
        let measurement = PlayMeasurement {
            socket,
            plug,
            window,
            interfering,
            interference,
            around,
            step,
            shift,
            walls,
        };
        measurement.at(fine.overlap(pose), pose.z + LIFT, 2.0 * max_play)
    };
    let lowered = fine.lowered(pose);
    let found = match &lowered {
        Some((lower, walls)) => measured(lower, Some(*walls)),
        None => {
            let found = measured(pose, None);
            // Held to a wall by springs, the plug has no play or, where they are left out, too much.
            let pressed = |(_, walls): &(Pose, [f64; 2])| {
                let free = |axis: usize| {
                    found.play_m[axis] > 0.0 && found.play_m[axis] <= walls[axis] + 2.0 * TOLERANCE
                };
                !(free(0) && free(1))
            };
            let between = fine.between_walls(pose.clone()).filter(pressed);
            between.map_or(found, |(between, walls)| measured(&between, Some(walls)))
        }
    };
    let stopped = pose.z;
    let pose = lowered.as_ref().map_or(pose, |(lower, _)| lower);
    let Measured { shift, play_m, rest } = found;
    let near = pose.z < stopped || (rest - pose.z).abs() <= LIFT;
    let z = if pose.through || !near { pose.z } else { rest };
    let engaged_m = pose.depth + pose.z - z;
    let back = (rotations_to_z()[pose.out] * parts.socket.own).inverse();
    let own = turns()[pose.turn] * parts.plug.own;
    let moved =
        Translation3::new(shift[0], shift[1], z) * UnitQuaternion::from_rotation_matrix(&own);
    let turned = UnitQuaternion::from_rotation_matrix(&back);
    Mate {
        pose: Isometry3::from_parts(Translation3::identity(), turned) * moved,
        out: Unit::new_normalize(back * Vector3::z()),
        across: [Vector3::x(), Vector3::y()].map(|axis| Unit::new_normalize(back * axis)),
        engaged_m,
        nose_m: pose.nose,
        play_m,
        through: pose.through,
        missed_m: if pose.through { 0.0 } else { fine.missed(pose) },
        caught: engaged_m < CAUGHT * width(bounds(plug)[2]),
    }
}
