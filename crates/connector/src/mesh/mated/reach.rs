//! Faces that the other body can touch on the way to the mated pose.

use super::verify::samples;
use crate::body::{extent, span};
use crate::mesh::Triangle;
use input::units::MM;
use nalgebra::Vector3;

/// Side of a cell of the height maps, m.
const CELL: f64 = 0.12 * MM;
/// Distance in front of a face within which the other body must pass, m: an allowance for tilt and misfit beyond the
/// play.
const ASIDE: f64 = 0.6 * MM;
/// Allowance in height, m.
const ABOVE: f64 = 0.6 * MM;
/// Height of the zones at the plug's tip and at the socket's rim that can touch during the search moves, m.
const SEARCHED: f64 = 1.5 * MM;
/// Largest distance of the search moves from the opening, m.
const SEARCH: f64 = 4.0 * MM;
/// Component of a normal along the axis, away from the other body, above which that body cannot touch the face; more
/// than 0, because the plug can be tilted.
const AWAY: f64 = 0.35;
/// Largest number of cells along one side of a map.
const MAX_CELLS: f64 = 2000.0;

/// Largest heights of triangles over the cells of a grid.
struct UpperEnvelope {
    low: [f64; 2],
    cell: f64,
    size: [usize; 2],
    heights: Vec<f64>,
}

impl UpperEnvelope {
    /// Creates the upper envelope of triangles; `sign` is the direction of z in which heights are counted.
    fn new(triangles: &[Triangle], sign: f64) -> Self {
        let ranges = [0, 1].map(|axis| extent(triangles.iter().flatten(), axis));
        let longest = ranges.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
        let cell = CELL.max(longest / MAX_CELLS);
        let low = ranges.map(|[low, _]| low - cell);
        let size = [0, 1].map(|i| ((ranges[i][1] - low[i]) / cell) as usize + 2);
        let heights = vec![f64::NEG_INFINITY; size[0] * size[1]];
        let mut map = UpperEnvelope { low, cell, size, heights };
        for triangle in triangles {
            for p in samples(triangle, 0.7 * cell, usize::MAX, 0.0) {
                let at = map.index([p.x, p.y]);
                map.heights[at] = map.heights[at].max(sign * p.z);
            }
        }
        map
    }

    /// Returns the index of the cell of a coordinate along an axis.
    fn cell_of(&self, v: f64, axis: usize) -> usize {
        (((v - self.low[axis]) / self.cell).max(0.0) as usize).min(self.size[axis] - 1)
    }

    fn index(&self, [x, y]: [f64; 2]) -> usize {
        self.cell_of(y, 1) * self.size[0] + self.cell_of(x, 0)
    }

    /// Returns the largest height over the bounding box of a triangle, extended by `aside` in front of it, m.
    fn over(&self, triangle: &Triangle, normal: &Vector3<f64>, aside: f64) -> f64 {
        let range = |axis: usize| {
            let ([low, high], ahead) = (extent(triangle, axis), normal[axis] * aside);
            [low + ahead.min(0.0) - self.cell, high + ahead.max(0.0) + self.cell]
        };
        let [x, y] = [0, 1].map(|axis| range(axis).map(|v| self.cell_of(v, axis)));
        let beside = (0..2).any(|axis| {
            let [low, high] = range(axis);
            let most = self.low[axis] + self.size[axis] as f64 * self.cell;
            high < self.low[axis] || low > most
        });
        if beside {
            return f64::NEG_INFINITY;
        }
        let row = |j: usize| &self.heights[j * self.size[0] + x[0]..=j * self.size[0] + x[1]];
        (y[0]..=y[1]).flat_map(row).copied().fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Faces that a plug and a socket can touch; both in their mated pose in the task frame.
pub struct Reach {
    socket: UpperEnvelope,
    plug: UpperEnvelope,
    /// Height of the plug's tip, m.
    tip: f64,
    /// Distance in front of a face within which the other body must pass, m.
    aside: f64,
    /// Range of the tip in x and y during the search, m.
    about: [[f64; 2]; 2],
}

impl Reach {
    /// Creates the reach of a plug in its mated pose, with a play, m, and of its socket.
    pub fn new(plug: &[Triangle], socket: &[Triangle], play: f64) -> Self {
        let [tip, _] = extent(plug.iter().flatten(), 2);
        let low: Vec<_> = plug.iter().flatten().filter(|p| p.z < tip + SEARCHED).collect();
        let about = [0, 1].map(|axis| span(low.iter().map(|p| p[axis])));
        let about = about.map(|[low, high]| [low - SEARCH, high + SEARCH]);
        let (socket, plug) = (UpperEnvelope::new(socket, 1.0), UpperEnvelope::new(plug, -1.0));
        Reach { socket, plug, tip, aside: ASIDE + play, about }
    }

    /// Returns whether the socket can touch a face of the plug.
    pub fn of_plug(&self, face: &Triangle, normal: &Vector3<f64>) -> bool {
        let [low, _] = extent(face, 2);
        let near =
            low < self.tip + SEARCHED || low < self.socket.over(face, normal, self.aside) + ABOVE;
        normal.z < AWAY && near
    }

    /// Returns whether the plug can touch a face of the socket.
    pub fn of_socket(&self, face: &Triangle, normal: &Vector3<f64>) -> bool {
        let [_, high] = extent(face, 2);
        let searched = (0..2).all(|axis| {
            let ([low, high], [from, to]) = (extent(face, axis), self.about[axis]);
            low < to && high > from
        });
        let near = -high < self.plug.over(face, normal, self.aside) + ABOVE;
        normal.z > -AWAY && (near || (high > -SEARCHED && searched))
    }
}
