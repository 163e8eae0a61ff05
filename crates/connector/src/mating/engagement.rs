//! Side walls of the plug that face walls of the socket.

use super::map::{HeightMap, NOWHERE};

/// Overlapping volume that cancels one unit of facing area, m3/m2.
const OVERLAP_PER_AREA: f64 = 0.125e-3;

/// Area of the plug's walls that look along +x, -x, +y and -y and face a wall of the socket, m2.
pub type WallAreas = [f64; 4];

/// Returns the geometric mean over both lateral axes of the smaller area of two opposite sides, m2.
pub fn score(walls: &WallAreas) -> f64 {
    (walls[0].min(walls[1]) * walls[2].min(walls[3])).sqrt()
}

/// Directions of the four sides.
pub const SIDES: [[i32; 2]; 4] = [[1, 0], [-1, 0], [0, 1], [0, -1]];

/// Vertical strip of a side wall of the plug, one cell wide.
struct Strip {
    /// Cell whose side it is.
    cell: [i32; 2],
    side: usize,
    low: f32,
    high: f32,
}

/// Side walls of a plug.
pub struct PlugWalls {
    strips: Vec<Strip>,
    step: [f64; 2],
}

impl PlugWalls {
    /// Finds the side walls of a height map that are steeper than 45 degrees.
    pub fn new(plug: &HeightMap) -> Self {
        let mut strips = Vec::new();
        for [x, y] in plug.cells() {
            let low = plug.at(x, y);
            if low > NOWHERE / 2.0 {
                continue;
            }
            for (side, [dx, dy]) in SIDES.into_iter().enumerate() {
                // Between the cell's height and its neighbour's the plug has a wall.
                let high = plug.at(x + dx, y + dy);
                if high - low > plug.step[side / 2] as f32 {
                    strips.push(Strip { cell: [x, y], side, low, high });
                }
            }
        }
        PlugWalls { strips, step: plug.step }
    }

    /// Returns the [`score`] of the facing walls, and the overlapping volume converted to an area, m2; `plug` is the
    /// lower envelope of the plug without the tolerance.
    pub fn areas(
        &self,
        socket: &SocketWalls,
        plug: &HeightMap,
        shift: [i32; 2],
        z: f32,
    ) -> [f64; 2] {
        let walls = score(&self.facing(socket, shift, z));
        let heights =
            rests([socket.map, plug], shift).map(|(_, rest)| f64::from((rest - z).max(0.0)));
        let volume = heights.sum::<f64>() * plug.step[0] * plug.step[1];
        [walls, volume / OVERLAP_PER_AREA]
    }

    /// Returns the area of the walls that face a wall of the socket; the plug is shifted by whole cells and at height
    /// `z`.
    pub fn facing(&self, socket: &SocketWalls, shift: [i32; 2], z: f32) -> WallAreas {
        let mut sums = [0.0; 4];
        for strip in &self.strips {
            let [dx, dy] = SIDES[strip.side];
            let [x, y] = [strip.cell[0] + shift[0], strip.cell[1] + shift[1]];
            let (low, high) = (strip.low + z, strip.high + z);
            // The socket penetrates the wall: a spring or a latch, not a guide.
            let into = socket.tolerance_cells[strip.side / 2] + 1;
            if socket.map.at(x - into * dx, y - into * dy) > low + socket.tolerance {
                continue;
            }
            let faced = socket.highest[strip.side].at(x, y);
            sums[strip.side] +=
                f64::from((high.min(faced) - low).max(0.0)) * self.step[1 - strip.side / 2];
        }
        sums
    }
}

/// Walls of a socket as seen from the sides of a plug.
pub struct SocketWalls<'a> {
    /// Upper envelope of the socket.
    map: &'a HeightMap,
    /// Largest heights within reach of each side.
    highest: [HeightMap; 4],
    /// Depth of the tolerated interference, cells along x and y.
    tolerance_cells: [i32; 2],
    /// The same depth, m.
    tolerance: f32,
}

impl<'a> SocketWalls<'a> {
    /// Creates the walls within `reach` of the plug that penetrate it by at most `tolerance`, m.
    pub fn new(map: &'a HeightMap, [reach, tolerance]: [f64; 2]) -> Self {
        let cells = |length: f64| map.step.map(|step| (length / step).ceil() as i32);
        let (reach, tolerance_cells) = (cells(reach), cells(tolerance));
        let highest = [0, 1, 2, 3].map(|side| {
            let axis = side / 2;
            let range = match side % 2 {
                0 => [-tolerance_cells[axis], reach[axis]],
                _ => [-reach[axis], tolerance_cells[axis]],
            };
            map.highest(axis, range)
        });
        SocketWalls { map, highest, tolerance_cells, tolerance: tolerance as f32 }
    }
}

/// Returns the cells in which the maps of socket and plug, the latter shifted and at height `z`, overlap.
pub fn overlap(maps: [&HeightMap; 2], shift: [i32; 2], z: f32) -> Vec<[i32; 2]> {
    rests(maps, shift).filter(|(_, rest)| *rest > z).map(|(cell, _)| cell).collect()
}

/// Returns each cell of the plug, whose map is the second and shifted, with the height at which it would rest on the
/// socket.
fn rests(maps: [&HeightMap; 2], shift: [i32; 2]) -> impl Iterator<Item = ([i32; 2], f32)> {
    let [socket, plug] = maps;
    plug.cells().map(move |[x, y]| ([x, y], socket.at(x + shift[0], y + shift[1]) - plug.at(x, y)))
}
