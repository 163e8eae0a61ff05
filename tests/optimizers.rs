//! One suite for every optimizer: what the trait promises, checked for all of them.

use finger_opt::optimizer::{Grid, Observation, Optimizer, OptimizerKind, StopReason, build};
use finger_opt::space::GridPoint;
use std::collections::BTreeSet;

/// The value told for a point at the given position in the history.
type Objective = fn(&Grid, &GridPoint, usize) -> Option<f64>;

/// A smooth hill off the centre.
fn hill(grid: &Grid, point: &GridPoint, _: usize) -> Option<f64> {
    let square = |(i, u): (usize, f64)| (u - 0.3 - 0.1 * i as f64).powi(2);
    Some(-grid.unit(point).into_iter().enumerate().map(square).sum::<f64>())
}

const OBJECTIVES: [(&str, Objective); 9] = [
    ("hill", hill),
    ("constant", |_, _, _| Some(3.0)),
    ("never a value", |_, _, _| None),
    ("NaN", |_, _, _| Some(f64::NAN)),
    ("every third missing", |g, p, i| if i % 3 == 0 { None } else { hill(g, p, i) }),
    ("infinite", |g, p, i| match i % 4 {
        0 => Some(f64::INFINITY),
        1 => Some(f64::NEG_INFINITY),
        _ => hill(g, p, i),
    }),
    ("huge", |g, p, i| hill(g, p, i).map(|v| v * 1e308)),
    ("tiny", |g, p, i| hill(g, p, i).map(|v| v * 1e-308)),
    ("plateau", |g, p, i| hill(g, p, i).map(|v| (v * 5.0).ceil() / 10.0)),
];

fn grids() -> Vec<Grid> {
    [vec![21, 41], vec![6], vec![1, 9, 1, 8], vec![1001, 1001, 7], vec![2; 9], vec![1, 1]]
        .into_iter()
        .map(Grid::new)
        .collect()
}

/// Runs `batches` batches of `n`; returns the points in order.
fn run(
    optimizer: &mut dyn Optimizer,
    grid: &Grid,
    objective: Objective,
    (batches, n): (usize, usize),
) -> Vec<GridPoint> {
    let mut history = Vec::new();
    for _ in 0..batches {
        let points = optimizer.ask(n);
        let told: Vec<Observation> = points
            .iter()
            .enumerate()
            .map(|(i, point)| Observation {
                point: point.clone(),
                value: objective(grid, point, history.len() + i),
            })
            .collect();
        optimizer.tell(&told);
        history.extend(points);
    }
    history
}

fn each(mut check: impl FnMut(OptimizerKind)) {
    OptimizerKind::ALL.into_iter().for_each(&mut check);
}

fn distinct(points: &[GridPoint]) -> bool {
    points.iter().collect::<BTreeSet<_>>().len() == points.len()
}

#[test]
fn points_lie_on_the_grid_and_come_once_whatever_is_told() {
    each(|kind| {
        for grid in grids() {
            for (name, objective) in OBJECTIVES {
                for n in [1, 4, 7] {
                    let points =
                        run(&mut *build(kind, grid.clone(), 3), &grid, objective, (28 / n, n));
                    let context = format!("{kind}, {name}, batch {n}, {grid:?}");
                    assert!(points.iter().all(|p| grid.contains(p)), "{context}");
                    assert!(distinct(&points), "{context}");
                    let asked = (28 / n * n) as u64;
                    assert_eq!(points.len() as u64, asked.min(grid.size()), "{context}");
                }
            }
        }
    });
}

#[test]
fn a_grid_is_exhausted_completely_and_then_it_stops() {
    each(|kind| {
        for levels in [vec![7, 9], vec![1, 5, 2, 6], vec![61], vec![1], vec![]] {
            let grid = Grid::new(levels);
            for (name, objective) in OBJECTIVES {
                let mut optimizer = build(kind, grid.clone(), 11);
                assert_eq!(optimizer.stop(), None);
                let points = run(&mut *optimizer, &grid, objective, (20, 4));
                let context = format!("{kind}, {name}, {grid:?}");
                assert!(distinct(&points), "{context}");
                assert_eq!(points.len() as u64, grid.size(), "{context}");
                assert_eq!(optimizer.stop(), Some(StopReason::GridExhausted), "{context}");
                assert!(optimizer.ask(3).is_empty(), "{context}");
            }
        }
    });
}

#[test]
fn the_whole_infill_grid_can_be_exhausted() {
    // The Gaussian process is left out here for its cubic cost.
    each(|kind| {
        if kind != OptimizerKind::Gp {
            let grid = Grid::new(vec![21, 41]);
            let points = run(&mut *build(kind, grid.clone(), 2), &grid, hill, (216, 4));
            assert!(points.len() == 861 && distinct(&points), "{kind}");
        }
    });
}

#[test]
fn the_seed_decides_and_nothing_else() {
    each(|kind| {
        let grid = Grid::new(vec![21, 41]);
        let with = |seed| run(&mut *build(kind, grid.clone(), seed), &grid, hill, (10, 3));
        assert_eq!(with(7), with(7), "{kind}");
        // A full factorial has no randomness.
        assert_eq!(with(7) == with(8), kind == OptimizerKind::Grid, "{kind}");
    });
}

#[test]
fn a_history_told_again_leads_to_the_same_proposals() {
    each(|kind| {
        let grid = Grid::new(vec![51, 31]);
        let mut first = build(kind, grid.clone(), 5);
        let history = run(&mut *first, &grid, hill, (9, 4));
        let mut second = build(kind, grid.clone(), 5);
        for batch in history.chunks(4) {
            assert_eq!(second.ask(4), batch, "{kind}");
            let told: Vec<_> = batch
                .iter()
                .map(|p| Observation { point: p.clone(), value: hill(&grid, p, 0) })
                .collect();
            second.tell(&told);
        }
        assert_eq!(first.ask(7), second.ask(7), "{kind}");
    });
}

#[test]
fn asking_again_before_telling_gives_other_points() {
    each(|kind| {
        let grid = Grid::new(vec![9, 9]);
        let mut optimizer = build(kind, grid.clone(), 1);
        run(&mut *optimizer, &grid, hill, (6, 2));
        let mut points = optimizer.ask(4);
        points.extend(optimizer.ask(4));
        assert!(points.len() == 8 && distinct(&points), "{kind}");
        assert!(optimizer.ask(0).is_empty(), "{kind}");
        // Untold points are given up; all others still come.
        let rest = run(&mut *optimizer, &grid, hill, (20, 4));
        points.extend(rest);
        assert!(distinct(&points) && points.len() == 81 - 12, "{kind}");
    });
}

#[test]
fn observations_of_unknown_or_impossible_points_are_survived() {
    each(|kind| {
        let grid = Grid::new(vec![9, 9]);
        let mut optimizer = build(kind, grid.clone(), 1);
        let tell = |levels: Vec<u32>| Observation { point: GridPoint(levels), value: Some(1.0) };
        optimizer.tell(&[tell(vec![9, 0]), tell(vec![]), tell(vec![1, 2, 3]), tell(vec![4, 4])]);
        optimizer.tell(&[tell(vec![4, 4])]);
        let points = run(&mut *optimizer, &grid, hill, (5, 4));
        assert!(points.len() == 20 && distinct(&points), "{kind}");
    });
}

#[test]
fn those_that_learn_find_the_hill_and_those_that_spread_come_near_it() {
    each(|kind| {
        let grid = Grid::new(vec![21, 41]);
        let points = run(&mut *build(kind, grid.clone(), 4), &grid, hill, (15, 4));
        let best = points.iter().filter_map(|p| hill(&grid, p, 0)).fold(f64::MIN, f64::max);
        let enough = match kind {
            OptimizerKind::Gp => 1e-9,
            OptimizerKind::CmaEs | OptimizerKind::NelderMead => 1e-2,
            _ => 3e-2,
        };
        assert!(best > -enough, "{kind}: {best}");
    });
}
