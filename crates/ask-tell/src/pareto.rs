//! Pareto fronts and hypervolumes. All components are maximised.

/// Returns whether `a` is at least as good as `b` in every component and better in at least one.
pub fn dominates(a: &[f64], b: &[f64]) -> bool {
    let pairs = || a.iter().zip(b);
    pairs().all(|(a, b)| a >= b) && pairs().any(|(a, b)| a > b)
}

/// Returns the indices of the non-dominated points, ascending. Of several equal points only the
/// first is included.
pub fn front(points: &[Vec<f64>]) -> Vec<usize> {
    let beaten = |i: usize| {
        let by = |(j, other): (usize, &Vec<f64>)| {
            dominates(other, &points[i]) || (j < i && *other == points[i])
        };
        points.iter().enumerate().any(by)
    };
    (0..points.len()).filter(|&i| !beaten(i)).collect()
}

/// Pareto front that is updated one point at a time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Archive {
    points: Vec<Vec<f64>>,
}

impl Archive {
    /// Adds a point, removes the points that it dominates, and returns whether it is now on the
    /// front. A duplicate of a point on the front is not added.
    pub fn add(&mut self, point: Vec<f64>) -> bool {
        if self.points.iter().any(|known| *known == point || dominates(known, &point)) {
            return false;
        }
        self.points.retain(|known| !dominates(&point, known));
        self.points.push(point);
        true
    }

    /// Returns the points on the front, in the order in which they were added.
    pub fn points(&self) -> &[Vec<f64>] {
        &self.points
    }
}

/// Axis-aligned box; `high` may be infinite.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Lower corner.
    pub low: Vec<f64>,
    /// Upper corner.
    pub high: Vec<f64>,
}

/// Partitions the non-dominated region above `reference` into disjoint cells. The hypervolume
/// improvement of a new point `y` is the sum over the cells of the product of
/// `min(y, high) - low`, over those cells in which every factor is positive.
///
/// The region is sliced along the last component (hypervolume by slicing objectives, While et al.
/// 2006, IEEE Trans. Evol. Comput. 10:29, applied to the complement). Points that do not exceed
/// the reference in every component are ignored.
pub fn undominated(points: &[Vec<f64>], reference: &[f64]) -> Vec<Cell> {
    slices(&above(points, reference), reference)
}

/// Returns the points that exceed the reference in every component.
fn above<'a>(points: &'a [Vec<f64>], reference: &[f64]) -> Vec<&'a [f64]> {
    let above = |point: &&Vec<f64>| point.iter().zip(reference).all(|(p, r)| p > r);
    points.iter().filter(above).map(Vec::as_slice).collect()
}

/// Returns the cells of the region that the points do not dominate, sliced along the last component.
fn slices(points: &[&[f64]], reference: &[f64]) -> Vec<Cell> {
    let Some((&floor, lower)) = reference.split_last() else {
        // No components left: one cell, unless a point already covers it.
        let free = Cell { low: Vec::new(), high: Vec::new() };
        return if points.is_empty() { vec![free] } else { Vec::new() };
    };
    let cuts = cuts(points, lower.len(), floor);
    let mut cells = Vec::new();
    for (i, &low) in cuts.iter().enumerate() {
        let high = cuts.get(i + 1).copied().unwrap_or(f64::INFINITY);
        for mut cell in slices(&reaching(points, lower.len(), high), lower) {
            cell.low.push(low);
            cell.high.push(high);
            cells.push(cell);
        }
    }
    cells
}

/// Returns the floor and all distinct values along an axis, ascending.
fn cuts(points: &[&[f64]], axis: usize, floor: f64) -> Vec<f64> {
    let mut cuts: Vec<f64> = points.iter().map(|point| point[axis]).collect();
    cuts.push(floor);
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    cuts
}

/// Returns the points whose coordinate along an axis is at least `high`.
fn reaching<'a>(points: &[&'a [f64]], axis: usize, high: f64) -> Vec<&'a [f64]> {
    points.iter().filter(|point| point[axis] >= high).copied().collect()
}

/// Returns the hypervolume: the volume above the reference that the points dominate.
pub fn hypervolume(points: &[Vec<f64>], reference: &[f64]) -> f64 {
    volume(&above(points, reference), reference)
}

/// Returns the dominated volume, by slices along the last component.
fn volume(points: &[&[f64]], reference: &[f64]) -> f64 {
    let Some((&floor, lower)) = reference.split_last() else {
        return if points.is_empty() { 0.0 } else { 1.0 };
    };
    let slice =
        |pair: &[f64]| (pair[1] - pair[0]) * volume(&reaching(points, lower.len(), pair[1]), lower);
    cuts(points, lower.len(), floor).windows(2).map(slice).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::stream;
    use rand::RngExt;

    fn points(seed: u64, count: usize, dimension: usize) -> Vec<Vec<f64>> {
        let mut random = stream(seed, 0, "pareto test");
        // Tenths, so that ties are common.
        let mut draw = || f64::from(random.random_range(0..10u8)) / 10.0;
        (0..count).map(|_| (0..dimension).map(|_| draw()).collect()).collect()
    }

    #[test]
    fn the_front_contains_the_non_dominated_points() {
        let given = [[1.0, 3.0], [2.0, 2.0], [1.0, 2.0], [2.0, 2.0], [3.0, 0.0]].map(Vec::from);
        assert_eq!(front(&given), [0, 1, 4]);
        assert_eq!(front(&[]), [0; 0]);
        assert!(!dominates(&[1.0, 2.0], &[1.0, 2.0]));
    }

    #[test]
    fn points_added_one_by_one_give_the_same_front() {
        for seed in 0..20 {
            let all = points(seed, 40, 2 + seed as usize % 2);
            let mut archive = Archive::default();
            let added: Vec<bool> = all.iter().map(|point| archive.add(point.clone())).collect();
            let expected: Vec<Vec<f64>> = front(&all).into_iter().map(|i| all[i].clone()).collect();
            assert_eq!(archive.points(), expected);
            assert!(added[0] && added.contains(&false));
        }
    }

    #[test]
    fn the_hypervolume_matches_a_manual_calculation() {
        // 3 x 1 and 1 x 3 above (0, 0), minus the common unit square.
        let two = [[3.0, 1.0], [1.0, 3.0]].map(Vec::from);
        assert_eq!(hypervolume(&two, &[0.0, 0.0]), 5.0);
        // Below the reference in one component: nothing.
        assert_eq!(hypervolume(&two, &[0.0, 2.0]), 1.0);
        let box3 = [vec![1.0, 2.0, 3.0]];
        assert_eq!(hypervolume(&box3, &[0.0; 3]), 6.0);
        assert_eq!(hypervolume(&[], &[0.0; 3]), 0.0);
    }

    /// Returns the volume that a point adds, from the cells.
    fn added(cells: &[Cell], point: &[f64]) -> f64 {
        let side = |i: usize, cell: &Cell| (point[i].min(cell.high[i]) - cell.low[i]).max(0.0);
        cells.iter().map(|cell| (0..point.len()).map(|i| side(i, cell)).product::<f64>()).sum()
    }

    #[test]
    fn the_cells_give_the_hypervolume_improvement_of_a_point() {
        for dimension in 1..=4 {
            let reference = vec![0.15; dimension];
            for seed in 0..20 {
                let known = points(seed, 7, dimension);
                let cells = undominated(&known, &reference);
                for point in points(seed + 100, 5, dimension) {
                    let before = hypervolume(&known, &reference);
                    let after =
                        hypervolume(&[known.clone(), vec![point.clone()]].concat(), &reference);
                    let found = added(&cells, &point);
                    assert!((found - (after - before)).abs() < 1e-12, "{known:?} and {point:?}");
                }
            }
        }
    }
}
