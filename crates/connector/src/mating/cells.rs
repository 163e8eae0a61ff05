//! Sets of cells of a height map.

/// Set of cells: a bitmap of its bounding rectangle.
#[derive(Debug, Clone, Default)]
pub struct CellSet {
    /// First cell of the rectangle in x and y.
    first: [i32; 2],
    /// Number of cells of the rectangle in x and y.
    count: [usize; 2],
    /// Whether each cell is in the set, row by row.
    filled: Vec<bool>,
}

impl CellSet {
    /// Creates the set of these cells.
    pub fn new(cells: &[[i32; 2]]) -> Self {
        let Some(&any) = cells.first() else { return CellSet::default() };
        let around = |take: fn(i32, i32) -> i32| {
            cells.iter().fold(any, |[x, y], cell| [take(x, cell[0]), take(y, cell[1])])
        };
        let (first, last) = (around(i32::min), around(i32::max));
        let count = [0, 1].map(|axis| (last[axis] - first[axis]) as usize + 1);
        let mut set = CellSet { first, count, filled: vec![false; count[0] * count[1]] };
        for cell in cells {
            if let Some(index) = set.index(*cell) {
                set.filled[index] = true;
            }
        }
        set
    }

    /// Returns whether the set has no cells.
    pub fn is_empty(&self) -> bool {
        self.filled.is_empty()
    }

    /// Returns whether a cell is in the set.
    pub fn contains(&self, cell: [i32; 2]) -> bool {
        self.index(cell).is_some_and(|index| self.filled[index])
    }

    /// Returns the set with all cells within a distance along both axes, in cells.
    pub fn dilated(&self, reach: usize) -> CellSet {
        if self.is_empty() { CellSet::default() } else { self.spread(0, reach).spread(1, reach) }
    }

    fn spread(&self, axis: usize, reach: usize) -> CellSet {
        let (mut first, mut count) = (self.first, self.count);
        first[axis] -= reach as i32;
        count[axis] += 2 * reach;
        let mut filled = vec![false; count[0] * count[1]];
        let step = if axis == 0 { 1 } else { count[0] };
        for (index, _) in self.filled.iter().enumerate().filter(|(_, filled)| **filled) {
            let start = index / self.count[0] * count[0] + index % self.count[0];
            (0..=2 * reach).for_each(|i| filled[start + i * step] = true);
        }
        CellSet { first, count, filled }
    }

    /// Returns the index of a cell in the bitmap; `None` outside of the rectangle.
    fn index(&self, [x, y]: [i32; 2]) -> Option<usize> {
        // A negative number becomes larger than any count.
        let [i, j] = [x - self.first[0], y - self.first[1]].map(|index| index as usize);
        (i < self.count[0] && j < self.count[1]).then(|| j * self.count[0] + i)
    }

    /// Returns how often the set can be eroded by one cell along both axes until it is empty: the largest city-block
    /// distance of its cells from the cells outside, in two passes (Rosenfeld and Pfaltz, 1966, doi:10.1145/321356.321357).
    pub fn depth(&self) -> u32 {
        let [nx, ny] = self.count;
        let mut distance: Vec<u32> = self.filled.iter().map(|filled| u32::from(*filled)).collect();
        let at =
            |distance: &[u32], inside: bool, index: usize| if inside { distance[index] } else { 0 };
        for index in 0..distance.len() {
            let left = at(&distance, index % nx > 0, index.wrapping_sub(1));
            let above = at(&distance, index >= nx, index.wrapping_sub(nx));
            distance[index] *= 1 + left.min(above);
        }
        for index in (0..distance.len()).rev() {
            let right = at(&distance, index % nx + 1 < nx, index + 1);
            let below = at(&distance, index / nx + 1 < ny, index + nx);
            distance[index] = distance[index].min(1 + right.min(below));
        }
        distance.into_iter().max().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    /// Returns the number of erosions, one after the other.
    fn eroded(mut cells: BTreeSet<[i32; 2]>) -> u32 {
        let mut erosions = 0;
        while !cells.is_empty() {
            let inner = |[x, y]: &[i32; 2]| {
                [[1, 0], [-1, 0], [0, 1], [0, -1]]
                    .iter()
                    .all(|[dx, dy]| cells.contains(&[x + dx, y + dy]))
            };
            cells = cells.iter().copied().filter(inner).collect();
            erosions += 1;
        }
        erosions
    }

    proptest! {
        #[test]
        fn a_set_has_its_cells_and_is_as_deep_as_erosion_finds(
            size in [1..14_i32, 1..14_i32],
            holes in proptest::collection::vec([-9..9_i32, -9..9_i32], 0..8),
        ) {
            let all = (-5..size[1] - 5).flat_map(|y| (-5..size[0] - 5).map(move |x| [x, y]));
            let cells: Vec<[i32; 2]> = all.filter(|cell| !holes.contains(cell)).collect();
            let set = CellSet::new(&cells);
            prop_assert_eq!(set.is_empty(), cells.is_empty());
            let near = (-9..12).flat_map(|y| (-9..12).map(move |x| [x, y]));
            prop_assert!(near.into_iter().all(|cell| set.contains(cell) == cells.contains(&cell)));
            let reach = cells.len() % 3;
            let wide = set.dilated(reach);
            for (x, y) in (-12..32).flat_map(|x| (-12..32).map(move |y| (x, y))) {
                let near = cells.iter().any(|[a, b]| {
                    (a - x).abs().max((b - y).abs()) <= reach as i32
                });
                prop_assert_eq!(wide.contains([x, y]), near);
            }
            prop_assert_eq!(set.depth(), eroded(cells.into_iter().collect()));
        }
    }
}
