//! Search for the largest acquisition with local models.

use super::lbfgs::Limits;
use super::local_models::{APPROXIMATE_NEIGHBOURS, LocalModels};
use super::search::{Acquisitions, Search, SearchRegion};
use crate::GridPoint;

/// Number of neighbours of the models for L-BFGS and steps of one level.
const NEIGHBOURS: usize = 90;
/// Number of candidates on large grids.
const CANDIDATES: usize = 200;
/// Grids up to this size are evaluated completely.
const WHOLE_GRID: u64 = 1000;
/// Number of candidates that are improved by local search.
const STARTS: usize = 4;
/// Largest number of gradient evaluations from one start.
const MAX_GRADIENTS: usize = 20;
/// Largest number of acquisitions computed for steps of one level from one start.
const MAX_STEPS: usize = 24;

/// Returns the grid point not yet proposed with the largest acquisition found, computed for each point from the models
/// near it; `None` if there is no such point with a finite acquisition.
pub(super) fn maximise(known: &LocalModels, region: SearchRegion) -> Option<GridPoint> {
    let candidates = match region.grid().size() {
        ..=WHOLE_GRID => region.grid().points().collect(),
        _ => region.candidates(CANDIDATES),
    };
    let scored = |point: GridPoint| {
        let x = region.grid().free_unit(&point);
        let value = known.near(&x, APPROXIMATE_NEIGHBOURS)?.acquisition(&x);
        value.is_finite().then_some((value, point))
    };
    let unseen = candidates.into_iter().filter(|point| !region.proposed.contains(point));
    let mut ranked: Vec<(f64, GridPoint)> = unseen.filter_map(scored).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    ranked.truncate(STARTS);
    let ends = ranked.iter().filter_map(|(_, start)| climb(known, region, start));
    ends.reduce(|a, b| if b.1 > a.1 { b } else { a }).map(|(point, _)| point)
}

/// Improves a start by L-BFGS within the trust region of the models near it, then by steps of one level with the
/// models near the result.
fn climb(known: &LocalModels, region: SearchRegion, start: &GridPoint) -> Option<(GridPoint, f64)> {
    let x = region.grid().free_unit(start);
    let half_widths = known.trust_region(&x, NEIGHBOURS);
    let side = |by: f64| x.iter().zip(&half_widths).map(move |(x, r)| (x + by * r).clamp(0.0, 1.0));
    let (low, high): (Vec<f64>, Vec<f64>) = (side(-1.0).collect(), side(1.0).collect());
    let limits = Limits { low: &low, high: &high, evaluations: MAX_GRADIENTS };
    let trained = known.near(&x, NEIGHBOURS)?;
    let top = Search { trained: &trained, region }.ascend(start, &limits);
    let trained = known.near(&region.grid().free_unit(&top), NEIGHBOURS)?;
    let search = Search { trained: &trained, region };
    let mut computed = Acquisitions::new();
    search.value(start, &mut computed);
    search.step_uphill(top, MAX_STEPS, &mut computed);
    region.best_unseen(computed)
}
