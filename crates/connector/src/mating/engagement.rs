//! Engagement of plug and socket: area of the plug's side walls that face walls of the socket.

use super::map::{HeightMap, NOWHERE};

/// Overlapping volume that outweighs one unit of facing area, m3/m2: a depth of 0.125 mm.
const OVERLAP_PER_AREA: f64 = 0.125e-3;

/// Areas of the plug's walls with outward normals along +x, -x, +y and -y that face a wall of the socket, m2.
pub type WallAreas = [f64; 4];

/// Returns the geometric mean of the facing areas along x and y, each that of the weaker of two opposite sides, m2.
pub fn score(walls: &WallAreas) -> f64 {
    (walls[0].min(walls[1]) * walls[2].min(walls[3])).sqrt()
}

/// Outward normals of the four sides: side / 2 is the axis (0 x, 1 y), and even sides are at its positive end.
pub const SIDES: [[i32; 2]; 4] = [[1, 0], [-1, 0], [0, 1], [0, -1]];

/// Vertical strip of a side wall of the plug, one cell wide.
struct Strip {
    /// Cell at whose side the wall is.
    cell: [i32; 2],
    /// Index of the side in [`SIDES`].
    side: usize,
    /// Height of the lower envelope in the cell, m.
    low: f32,
    /// Height of the lower envelope in the next cell outward, m.
    high: f32,
}

/// Side walls of a plug.
pub struct PlugWalls {
    strips: Vec<Strip>,
    step: [f64; 2],
}

impl PlugWalls {
    /// Creates the side walls from the lower envelope of a plug: its slopes steeper than 45 degrees.
    pub fn new(plug: &HeightMap) -> Self {
        let mut strips = Vec::new();
        for [x, y] in plug.cells() {
            let low = plug.at(x, y);
            if low > NOWHERE / 2.0 {
                continue;
            }
            for (side, [dx, dy]) in SIDES.into_iter().enumerate() {
                // The wall extends from the cell's height to its neighbour's.
                let high = plug.at(x + dx, y + dy);
                if high - low > plug.step[side / 2] as f32 {
                    strips.push(Strip { cell: [x, y], side, low, high });
                }
            }
        }
        PlugWalls { strips, step: plug.step }
    }

    /// Returns the [`score`] of the facing walls and the overlapping volume as an equivalent area, m2; shift and height
    /// as for [`Self::facing`]. `plug` is the lower envelope of the plug, eroded by the tolerated interference.
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

    /// Returns the distances along the four sides from the plug's walls to those of the socket, cells: the medians by area
    /// up to `most`, so that springs and ribs on less than half of a wall do not count. Negative where they overlap; shift
    /// and height as for [`Self::facing`].
    pub fn gaps(&self, socket: &HeightMap, shift: [i32; 2], z: f32, most: i32) -> [Option<i32>; 4] {
        let mut found: [Vec<(i32, f32)>; 4] = Default::default();
        for strip in &self.strips {
            let [dx, dy] = SIDES[strip.side];
            let [x, y] = [strip.cell[0] + shift[0], strip.cell[1] + shift[1]];
            let (low, high) = (strip.low + z, strip.high + z);
            let faced =
                |gap: i32| socket.at(x + (gap + 1) * dx, y + (gap + 1) * dy).min(high) - low;
            // Of the socket behind the wall, for example its tongue inside a shell, only what the wall is in counts.
            let into = (-most..0).rev().take_while(|gap| faced(*gap) > 0.0).last();
            let gap = into.or_else(|| (0..=most).find(|gap| faced(*gap) > 0.0));
            found[strip.side].extend(gap.map(|gap| (gap, faced(gap))));
        }
        found.map(|mut gaps| {
            gaps.sort_by_key(|(gap, _)| *gap);
            let half = gaps.iter().map(|(_, height)| height).sum::<f32>() / 2.0;
            let mut sum = 0.0;
            let below = |(_, height): &&(i32, f32)| {
                sum += height;
                sum >= half
            };
            gaps.iter().find(below).map(|(gap, _)| *gap)
        })
    }

    /// Returns the areas of the walls that face a wall of the socket if the plug is shifted by `shift` cells and raised
    /// to `z`, m.
    pub fn facing(&self, socket: &SocketWalls, shift: [i32; 2], z: f32) -> WallAreas {
        let mut sums = [0.0; 4];
        for strip in &self.strips {
            let [dx, dy] = SIDES[strip.side];
            let [x, y] = [strip.cell[0] + shift[0], strip.cell[1] + shift[1]];
            let (low, high) = (strip.low + z, strip.high + z);
            // Where the socket penetrates the wall deeper than tolerated, it is a spring or a latch and does not guide
            // the plug.
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

/// Upper envelope of a socket, prepared for the search for walls that face those of a plug.
pub struct SocketWalls<'a> {
    /// Upper envelope of the socket.
    map: &'a HeightMap,
    /// For each side of a plug, largest height of the socket within reach of a wall in each cell, m.
    highest: [HeightMap; 4],
    /// Depth of the tolerated interference, cells along x and y.
    tolerance_cells: [i32; 2],
    /// The same depth, m.
    tolerance: f32,
}

impl<'a> SocketWalls<'a> {
    /// Prepares the upper envelope `map`: walls count from `tolerance` behind a wall of the plug to `reach` in front of
    /// it, m.
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

/// Returns the cells of the plug in which it overlaps the socket, if it is shifted by `shift` cells and raised to `z`,
/// m; `maps` are the upper envelope of the socket and the lower one of the plug.
pub fn overlap(maps: [&HeightMap; 2], shift: [i32; 2], z: f32) -> Vec<[i32; 2]> {
    rests(maps, shift).filter(|(_, rest)| *rest > z).map(|(cell, _)| cell).collect()
}

/// Returns each cell of the plug with the height at which this cell would rest on the socket, m; arguments as for
/// [`overlap`].
pub fn rests(maps: [&HeightMap; 2], shift: [i32; 2]) -> impl Iterator<Item = ([i32; 2], f32)> {
    let [socket, plug] = maps;
    plug.cells().map(move |[x, y]| ([x, y], socket.at(x + shift[0], y + shift[1]) - plug.at(x, y)))
}
