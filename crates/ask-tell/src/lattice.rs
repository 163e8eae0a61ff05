//! Full factorial search from coarse to fine.

use super::{Grid, GridPoint};

/// Stage at which every axis of up to 2^32 levels is fully resolved.
const LAST_STAGE: u32 = 32;

/// Returns the points of nested lattices: stage `s` is the product of up to `2^s + 1` evenly spaced
/// levels of each axis, so stage 0 is the centre, stage 1 adds the corners and mid-sides, and the last stage is the
/// whole grid. Points of earlier stages are repeated.
///
/// Within a stage the points are visited at a stride near the golden section of their number
/// (and coprime to it), a Korobov lattice in the digits of the index: any prefix of a stage is
/// spread over the cube.
pub(super) fn lattice(grid: Grid) -> impl Iterator<Item = GridPoint> + Send {
    (0..=LAST_STAGE).flat_map(move |stage| {
        let axes = stage_levels(&grid, stage);
        let size = axes.iter().fold(1u128, |n, a| n.saturating_mul(a.len() as u128));
        // The first number at or above the golden section of `size` that is coprime to it.
        let section =
            (size / 1_000_000).saturating_mul(618_034) + size % 1_000_000 * 618_034 / 1_000_000;
        let stride = (section.max(1)..).find(|&s| gcd(s, size) == 1).unwrap_or(1);
        (0..size).map(move |visited| decode(mul_mod(visited, stride, size), &axes))
    })
}

/// Returns the levels of each axis at stage `stage`, ascending.
fn stage_levels(grid: &Grid, stage: u32) -> Vec<Vec<u32>> {
    let of_axis = |&n: &u32| -> Vec<u32> {
        let (last, parts) = (u64::from(n - 1), 1u64 << stage);
        if stage == 0 {
            return vec![(last / 2) as u32];
        }
        if parts >= last {
            return (0..n).collect();
        }
        // The middle of an even number of levels rounds down at every stage.
        (0..=parts).map(|k| ((2 * k * last + parts - 1) / (2 * parts)) as u32).collect()
    };
    grid.levels().iter().map(of_axis).collect()
}

/// Returns the point at a mixed-radix index; the last axis is the least significant digit.
fn decode(mut index: u128, axes: &[Vec<u32>]) -> GridPoint {
    let mut point = vec![0; axes.len()];
    for (level, levels) in point.iter_mut().zip(axes).rev() {
        let radix = levels.len() as u128;
        *level = levels[(index % radix) as usize];
        index /= radix;
    }
    GridPoint(point)
}

fn gcd(a: u128, b: u128) -> u128 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Returns `a * b mod m` by doubling, without overflow for `m` below 2^127.
fn mul_mod(a: u128, b: u128, m: u128) -> u128 {
    if let Some(product) = a.checked_mul(b) {
        return product % m;
    }
    let half = mul_mod(a, b / 2, m);
    let twice = half.wrapping_add(half) % m;
    if b % 2 == 1 { twice.wrapping_add(a % m) % m } else { twice }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{OptimizerKind, build};

    fn first(levels: Vec<u32>, n: usize) -> Vec<GridPoint> {
        build(OptimizerKind::Grid, Grid::new(levels), 0).ask(n)
    }

    #[test]
    fn stages_are_nested_for_every_number_of_levels() {
        for n in 1..200 {
            let grid = Grid::new(vec![n]);
            for stage in 0..9 {
                let coarse = &stage_levels(&grid, stage)[0];
                let fine = &stage_levels(&grid, stage + 1)[0];
                assert!(coarse.iter().all(|k| fine.contains(k)), "{n} levels, stage {stage}");
            }
            assert_eq!(stage_levels(&grid, 9)[0].len(), n as usize);
        }
    }

    #[test]
    fn nine_points_are_the_three_by_three_lattice() {
        let mut points = first(vec![21, 41], 9);
        assert_eq!(points[0], GridPoint(vec![10, 20]));
        points.sort();
        let expected: Vec<_> =
            [0, 10, 20].iter().flat_map(|&a| [0, 20, 40].map(|b| GridPoint(vec![a, b]))).collect();
        assert_eq!(points, expected);
    }

    #[test]
    fn a_prefix_of_a_stage_covers_every_quadrant() {
        let points = first(vec![1001, 1001], 40);
        for (left, low) in [(true, true), (true, false), (false, true), (false, false)] {
            let inside = |p: &&GridPoint| (p.0[0] < 500) == left && (p.0[1] < 500) == low;
            assert!(points.iter().filter(inside).count() >= 5);
        }
    }

    #[test]
    fn a_grid_beyond_counting_still_gives_points() {
        assert_eq!(first(vec![1_000_000; 40], 100).len(), 100);
    }
}
