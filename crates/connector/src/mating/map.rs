//! Height maps.

use super::cells::CellSet;
use crate::body::extent;
use crate::mesh::Triangle;
use rayon::prelude::*;

/// Height of a column without material, m; finite, so that sums stay finite.
pub const NOWHERE: f32 = 1e6;

/// Side of a part whose heights a map contains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Envelope {
    /// Highest point of each column.
    Upper,
    /// Lowest point of each column.
    Lower,
}

impl Envelope {
    /// Returns the height of a column without material.
    pub fn empty(self) -> f32 {
        if self == Envelope::Upper { -NOWHERE } else { NOWHERE }
    }

    /// Returns the outermost of two heights: the higher one of an upper envelope, the lower one of a lower envelope.
    fn outer(self, a: f32, b: f32) -> f32 {
        if (self == Envelope::Upper) == (a > b) { a } else { b }
    }

    /// Returns the innermost of two heights.
    fn inner(self, a: f32, b: f32) -> f32 {
        if (self == Envelope::Upper) == (a > b) { b } else { a }
    }
}

/// Rectangle in x and y, m: lower and upper bound of each axis.
pub type Window = [[f64; 2]; 2];

/// Height map: heights at the centres of cells, m.
#[derive(Debug, Clone)]
pub struct HeightMap {
    /// Side of the part.
    pub envelope: Envelope,
    /// Size of a cell in x and y, m.
    pub step: [f64; 2],
    /// Index of the first cell in x and y; cell i extends from i to i + 1 steps.
    pub first: [i32; 2],
    /// Number of cells in x and y.
    pub count: [usize; 2],
    /// Heights, row by row.
    pub heights: Vec<f32>,
}

/// Returns the bounds of triangles in x, y and z, m.
pub fn bounds(triangles: &[Triangle]) -> [[f64; 2]; 3] {
    [0, 1, 2].map(|axis| extent(triangles.iter().flatten(), axis))
}

impl HeightMap {
    /// Creates the map of triangles with cells of `step`, m, within a window or else of all triangles.
    pub fn new(
        triangles: &[Triangle],
        envelope: Envelope,
        step: [f64; 2],
        window: Option<Window>,
    ) -> Self {
        let [x, y, _] = bounds(triangles);
        let [wx, wy] = window.unwrap_or([x, y]);
        let ranges = [[x[0].max(wx[0]), x[1].min(wx[1])], [y[0].max(wy[0]), y[1].min(wy[1])]];
        let first = [0, 1].map(|axis| (ranges[axis][0] / step[axis]).floor() as i32);
        let count = [0, 1].map(|axis| {
            let last = (ranges[axis][1] / step[axis]).floor() as i32;
            usize::try_from(last - first[axis] + 1).unwrap_or(0)
        });
        let heights = vec![envelope.empty(); count[0] * count[1]];
        let mut map = HeightMap { envelope, step, first, count, heights };
        triangles.iter().for_each(|triangle| map.rasterize(triangle));
        map
    }

    /// Returns the coordinate of the centre of a cell along an axis, m.
    pub fn middle(&self, axis: usize, index: usize) -> f64 {
        (f64::from(self.first[axis]) + index as f64 + 0.5) * self.step[axis]
    }

    /// Rasterizes a triangle.
    fn rasterize(&mut self, [a, b, c]: &Triangle) {
        let area = (b - a).xy().perp(&(c - a).xy());
        let [low, high] = extent([a, b, c], 1);
        let Some([from, to]) = self.between(1, low, high) else { return };
        if area.abs() < 1e-3 * self.step[0] * self.step[1] * 1e-3 {
            return;
        }
        let normal = (b - a).cross(&(c - a));
        let slope = [-normal.x / normal.z, -normal.y / normal.z];
        let [bottom, top] = extent([a, b, c], 2);
        for row in from..=to {
            let y = self.middle(1, row);
            let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
            for (p, q) in [(a, b), (b, c), (c, a)] {
                let (p, q) = if p.y <= q.y { (p, q) } else { (q, p) };
                if p.y <= y && y <= q.y {
                    let x =
                        if q.y > p.y { p.x + (q.x - p.x) * (y - p.y) / (q.y - p.y) } else { p.x };
                    left = left.min(x).min(if q.y > p.y { x } else { q.x });
                    right = right.max(x).max(if q.y > p.y { x } else { q.x });
                }
            }
            let Some([start, end]) = self.between(0, left, right) else { continue };
            let at = a.z + slope[1] * (y - a.y);
            for column in start..=end {
                let z = at + slope[0] * (self.middle(0, column) - a.x);
                let z = z.clamp(bottom, top) as f32;
                let cell = &mut self.heights[row * self.count[0] + column];
                *cell = self.envelope.outer(*cell, z);
            }
        }
    }

    /// Returns the first and the last cell whose centres lie between two coordinates along an axis.
    fn between(&self, axis: usize, low: f64, high: f64) -> Option<[usize; 2]> {
        let first = f64::from(self.first[axis]) + 0.5;
        let from = (low / self.step[axis] - first - 1e-9).ceil().max(0.0);
        let to = (high / self.step[axis] - first + 1e-9).floor().min(self.count[axis] as f64 - 1.0);
        (from <= to).then_some([from as usize, to as usize])
    }

    /// Returns the indices of the cells, row by row.
    pub fn cells(&self) -> impl Iterator<Item = [i32; 2]> + use<> {
        let ([x, y], [nx, ny]) = (self.first, self.count.map(|count| count as i32));
        (y..y + ny).flat_map(move |y| (x..x + nx).map(move |x| [x, y]))
    }

    /// Returns the height of a cell; outside the map, the height of a column without material.
    pub fn at(&self, x: i32, y: i32) -> f32 {
        // A negative index becomes larger than any count.
        let [i, j] = [x - self.first[0], y - self.first[1]].map(|index| index as usize);
        if i < self.count[0] && j < self.count[1] {
            self.heights[j * self.count[0] + i]
        } else {
            self.envelope.empty()
        }
    }

    /// Returns the map without material in some cells.
    pub fn without(&self, cells: &CellSet) -> HeightMap {
        let height = |(cell, z): ([i32; 2], &f32)| {
            if cells.contains(cell) { self.envelope.empty() } else { *z }
        };
        HeightMap { heights: self.cells().zip(&self.heights).map(height).collect(), ..*self }
    }

    /// Returns the map eroded by a radius: the innermost height within it of each cell.
    pub fn eroded(&self, radius: usize) -> HeightMap {
        self.inner(radius, radius)
    }

    /// Returns the map dilated by a radius: the outermost height within it of each cell.
    pub fn dilated(&self, radius: usize) -> HeightMap {
        self.filtered(radius, radius, |a, b| self.envelope.outer(a, b))
    }

    /// Returns the innermost height of each cell, the `before` cells before it and the `after` cells after it.
    pub fn inner(&self, before: usize, after: usize) -> HeightMap {
        self.filtered(before, after, |a, b| self.envelope.inner(a, b))
    }

    /// Returns the largest height of the cells at offsets from `low` to `high` from each cell along an axis.
    pub fn highest(&self, axis: usize, [low, high]: [i32; 2]) -> HeightMap {
        let wide = usize::try_from(high - low + 1).unwrap_or(1);
        let (mut map, mut done) = (self.clone(), 1);
        while done < wide {
            let by = done.min(wide - done);
            map = map.higher(axis, by);
            done += by;
        }
        map.first[axis] -= low;
        map
    }

    /// Returns the larger height of each cell and the cell `by` after it along an axis.
    fn higher(&self, axis: usize, by: usize) -> HeightMap {
        let mut map = HeightMap { heights: Vec::new(), ..*self };
        map.first[axis] -= by as i32;
        map.count[axis] += by;
        map.heights = vec![-NOWHERE; map.count[0] * map.count[1]];
        let (nx, shift) = (map.count[0], if axis == 0 { by } else { by * map.count[0] });
        for (row, heights) in self.heights.chunks(self.count[0].max(1)).enumerate() {
            for start in [row * nx, row * nx + shift] {
                let cells = map.heights[start..].iter_mut().zip(heights);
                cells.for_each(|(cell, height)| *cell = cell.max(*height));
            }
        }
        map
    }

    /// Applies a filter along x, then along y, over the cells `before` and `after` each cell.
    fn filtered(&self, before: usize, after: usize, take: impl Fn(f32, f32) -> f32) -> HeightMap {
        let [nx, ny] = self.count;
        let mut map = self.clone();
        if nx == 0 || ny == 0 || (before, after) == (0, 0) {
            return map;
        }
        let empty = self.envelope.empty();
        let along = |row: &mut [f32]| {
            let old = row.to_vec();
            for by in -(before as isize)..=after as isize {
                // Cells whose neighbour `by` cells after them is in the row.
                let from = usize::try_from(-by).unwrap_or(0).min(nx);
                let to = usize::try_from(nx as isize - by).unwrap_or(0).clamp(from, nx);
                let near = &old[from.saturating_add_signed(by).min(nx)..];
                row[..from].iter_mut().for_each(|a| *a = take(*a, empty));
                row[from..to].iter_mut().zip(near).for_each(|(a, b)| *a = take(*a, *b));
                row[to..].iter_mut().for_each(|a| *a = take(*a, empty));
            }
        };
        map.heights.chunks_mut(nx).for_each(along);
        let old = map.heights.clone();
        for (j, row) in map.heights.chunks_mut(nx).enumerate() {
            for at in j as isize - before as isize..=(j + after) as isize {
                match usize::try_from(at).ok().filter(|at| *at < ny) {
                    Some(at) => {
                        let other = &old[at * nx..(at + 1) * nx];
                        row.iter_mut().zip(other).for_each(|(a, b)| *a = take(*a, *b));
                    }
                    None => row.iter_mut().for_each(|a| *a = take(*a, empty)),
                }
            }
        }
        map
    }

    /// Returns two maps whose cells are `factor` times as large, with the outermost and with the innermost heights.
    pub fn coarser(&self, factor: usize) -> [HeightMap; 2] {
        let factor = factor as i32;
        let first = self.first.map(|first| first.div_euclid(factor));
        let last = [0, 1].map(|axis| {
            (self.first[axis] + self.count[axis] as i32 - 1).div_euclid(factor) - first[axis] + 1
        });
        let count = last.map(|count| usize::try_from(count).unwrap_or(0));
        let step = self.step.map(|step| step * f64::from(factor));
        [Envelope::outer as fn(Envelope, f32, f32) -> f32, Envelope::inner].map(|take| {
            let envelope = self.envelope;
            let mut map = HeightMap { envelope, step, first, count, heights: Vec::new() };
            let height = |[x, y]: [i32; 2]| {
                let cells = (0..factor * factor).map(|i| [i % factor, i / factor]);
                let fine = cells.map(|[i, j]| self.at(x * factor + i, y * factor + j));
                fine.reduce(|a, b| take(envelope, a, b)).unwrap_or(envelope.empty())
            };
            map.heights = map.cells().map(height).collect();
            map
        })
    }
}

/// Returns the height at which a plug shifted by whole cells rests on a socket, m; stops once it reaches `enough`.
pub fn rest(socket: &HeightMap, plug: &HeightMap, shift: [i32; 2], enough: f32) -> f32 {
    let (snx, pnx) = (socket.count[0], plug.count[0]);
    let span = |axis: usize| {
        let offset = plug.first[axis] + shift[axis] - socket.first[axis];
        let from = (-offset).max(0);
        let to = (plug.count[axis] as i32).min(socket.count[axis] as i32 - offset);
        (offset, from, to)
    };
    let ((ox, fromx, tox), (oy, fromy, toy)) = (span(0), span(1));
    if fromx >= tox || fromy >= toy {
        return -NOWHERE;
    }
    let mut highest = -NOWHERE;
    // Rows far apart first, to detect a misfit early.
    for phase in 0..8 {
        for row in (fromy + phase..toy).step_by(8) {
            let plug_row = row as usize * pnx;
            let socket_row = (row + oy) as usize * snx;
            let p = &plug.heights[plug_row + fromx as usize..plug_row + tox as usize];
            let s = &socket.heights
                [socket_row + (fromx + ox) as usize..socket_row + (tox + ox) as usize];
            highest = row_rest(s, p, highest);
        }
        if highest >= enough {
            break;
        }
    }
    highest
}

/// Returns the cells of a plug, shifted by whole cells, that a socket holds at least as high as `least`, m.
pub fn touching<'a>(
    [socket, plug]: [&'a HeightMap; 2],
    [dx, dy]: [i32; 2],
    least: f32,
) -> impl Iterator<Item = [i32; 2]> + use<'a> {
    plug.cells().filter(move |&[x, y]| socket.at(x + dx, y + dy) - plug.at(x, y) >= least)
}

fn row_rest(socket: &[f32], plug: &[f32], highest: f32) -> f32 {
    let mut lanes = [highest; 8];
    let (s, p) = (socket.chunks_exact(8), plug.chunks_exact(8));
    let tail = s.remainder().iter().zip(p.remainder());
    let tail = tail.fold(highest, |high, (s, p)| if s - p > high { s - p } else { high });
    for (s, p) in s.zip(p) {
        for i in 0..8 {
            let z = s[i] - p[i];
            lanes[i] = if z > lanes[i] { z } else { lanes[i] };
        }
    }
    lanes.iter().fold(tail, |high, z| if *z > high { *z } else { high })
}

/// Creates the maps of a part in several rotations.
pub fn maps(parts: &[Vec<Triangle>], envelope: Envelope, step: f64) -> Vec<HeightMap> {
    parts.par_iter().map(|part| HeightMap::new(part, envelope, [step; 2], None)).collect()
}
