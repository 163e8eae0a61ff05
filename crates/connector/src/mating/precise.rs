//! Resting height and lateral play of a seated plug, measured on fine maps.

use super::Mate;
use super::cells::CellSet;
use super::frame::{Parts, rotations_to_z, turns};
use super::map::{Envelope, HeightMap, Window, rest};
use super::refine::{Fine, Pose};
use super::search::Scene;
use crate::mesh::Triangle;
use input::units::MM;
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

/// Side of a cell along the axis on which play is measured, m.
const CELL: f64 = 0.005 * MM;
/// Largest number of cells of a map.
const MOST_CELLS: f64 = 1.5e6;
/// Height above the seat at which play is measured, m, so that the surface on which the plug rests does not limit it.
const LIFT: f64 = 0.1 * MM;
/// Width of the margin around interfering cells that is left out with them, m.
const MARGIN: f64 = 0.1 * MM;
/// Number of times that the plug is centred, in x and then in y.
const ROUNDS: usize = 2;

/// Measurement of play and resting height; cells in which the parts interfere are left out.
struct PlayMeasurement<'a> {
    socket: &'a [Triangle],
    plug: &'a [Triangle],
    window: Window,
    /// Cells of the plug in which the parts interfere, with a margin around them.
    interfering: CellSet,
    /// Side of these cells, m.
    step: f64,
    /// Shift of the plug in x and y, m.
    shift: [f64; 2],
}

impl PlayMeasurement<'_> {
    /// Returns the maps of socket and plug, with cells of [`CELL`] along an axis and larger ones across it.
    fn maps(&self, axis: usize) -> [HeightMap; 2] {
        let area: f64 = self.window.iter().map(|[low, high]| high - low).product();
        let mut step = [(area / MOST_CELLS / CELL).max(2.0 * CELL); 2];
        step[axis] = CELL;
        let by = Vector3::new(self.shift[0], self.shift[1], 0.0);
        let plug: Vec<Triangle> = self.plug.iter().map(|corners| corners.map(|p| p + by)).collect();
        let mut maps = [(self.socket, Envelope::Upper), (&plug, Envelope::Lower)]
            .map(|(part, envelope)| HeightMap::new(part, envelope, step, Some(self.window)));
        maps.iter_mut().for_each(|map| self.clear_interference(map));
        maps
    }

    /// Clears the interfering cells of a map.
    fn clear_interference(&self, map: &mut HeightMap) {
        if self.interfering.is_empty() {
            return;
        }
        let (nx, empty) = (map.count[0], map.envelope.empty());
        for index in 0..map.heights.len() {
            let place = [map.middle(0, index % nx), map.middle(1, index / nx)];
            let cell = [0, 1].map(|a| ((place[a] - self.shift[a]) / self.step).floor() as i32);
            if self.interfering.contains(cell) {
                map.heights[index] = empty;
            }
        }
    }

    /// Centres the plug along a lateral axis at a height, m, and returns its total play, m; it is measured up to
    /// `max_play` to either side.
    fn centre(&mut self, axis: usize, height: f64, max_play: f64) -> f64 {
        let [upper, lower] = self.maps(axis);
        let free = |offset: i32| {
            let mut shift = [0; 2];
            shift[axis] = offset;
            rest(&upper, &lower, shift, height as f32) < height as f32
        };
        let most = (max_play / CELL) as i32;
        // The pose comes from coarser maps and may overlap by a cell or two of those.
        let Some(first) = (0..=most / 8).flat_map(|k| [k, -k]).find(|k| free(*k)) else {
            return 0.0;
        };
        let high = (first..first + most).take_while(|k| free(*k)).last().unwrap_or(first);
        let low = (first - most..=first).rev().take_while(|k| free(*k)).last().unwrap_or(first);
        self.shift[axis] += f64::from(low + high) / 2.0 * CELL;
        f64::from(high - low + 1) * CELL
    }

    /// Returns the height at which the plug rests, m.
    fn rest(&self) -> f64 {
        let [upper, lower] = self.maps(0);
        f64::from(rest(&upper, &lower, [0; 2], f32::MAX))
    }
}

/// Measures resting height and play at a pose and returns the mate in the frames of the files.
pub fn mate(parts: &Parts, scene: &Scene, pose: &Pose, max_play: f64) -> Mate {
    let fine = Fine::new(scene, pose, max_play);
    let margin = (MARGIN / fine.step).ceil() as i32;
    let about = move |[x, y]: [i32; 2]| {
        (-margin..=margin).flat_map(move |dy| (-margin..=margin).map(move |dx| [x + dx, y + dy]))
    };
    let interfering: Vec<_> = fine.overlap(pose).into_iter().flat_map(about).collect();
    let interfering = CellSet::new(&interfering);
    let (socket, plug) = (&scene.sockets[pose.out], &scene.plugs[pose.turn]);
    let (window, step, shift) = (fine.window, fine.step, pose.shift);
    let mut measurement = PlayMeasurement { socket, plug, window, interfering, step, shift };
    let height = pose.z + LIFT;
    let mut play_m = [0.0; 2];
    for _ in 0..ROUNDS {
        play_m = [0, 1].map(|axis| measurement.centre(axis, height, 2.0 * max_play));
    }
    let rest = measurement.rest();
    let z = if pose.through || (rest - pose.z).abs() > LIFT { pose.z } else { rest };
    let back = (rotations_to_z()[pose.out] * parts.socket.own).inverse();
    let own = turns()[pose.turn] * parts.plug.own;
    let moved = Translation3::new(measurement.shift[0], measurement.shift[1], z)
        * UnitQuaternion::from_rotation_matrix(&own);
    let turned = UnitQuaternion::from_rotation_matrix(&back);
    Mate {
        pose: Isometry3::from_parts(Translation3::identity(), turned) * moved,
        out: Unit::new_normalize(back * Vector3::z()),
        across: [Vector3::x(), Vector3::y()].map(|axis| Unit::new_normalize(back * axis)),
        engaged_m: pose.depth,
        nose_m: pose.nose,
        play_m,
        through: pose.through,
    }
}
