//! The search where processes of few points stand for the whole.

use super::lbfgs::Limits;
use super::neighbours::{FEW, Neighbours};
use super::search::{Memory, Room, Search};
use crate::GridPoint;

/// Neighbours where the search climbs.
const MANY: usize = 90;
/// Candidates; a grid of fewer points is looked at whole.
const CANDIDATES: usize = 200;
/// Grids up to this size are looked at whole.
const WHOLE_GRID: u64 = 1000;
/// Starts of the climb.
const STARTS: usize = 4;
/// Acquisitions with their derivatives from one start.
const SLOPES: usize = 20;
/// Steps by single levels from one start.
const STEPS: usize = 24;

/// The unseen grid point found with the largest acquisition by the model about it;
/// `None` if no unseen point was met or none has a finite one.
pub(super) fn maximise(known: &Neighbours, room: Room) -> Option<GridPoint> {
    let candidates = match room.grid().size() {
        ..=WHOLE_GRID => room.grid().points().collect(),
        _ => room.candidates(CANDIDATES),
    };
    let promise = |point: GridPoint| {
        let x = room.grid().free_unit(&point);
        let value = known.near(&x, FEW)?.acquisition(&x);
        value.is_finite().then_some((value, point))
    };
    let unseen = candidates.into_iter().filter(|point| !room.proposed.contains(point));
    let mut ranked: Vec<(f64, GridPoint)> = unseen.filter_map(promise).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    ranked.truncate(STARTS);
    let ends = ranked.iter().filter_map(|(_, start)| climb(known, room, start));
    ends.reduce(|a, b| if b.1 > a.1 { b } else { a }).map(|(point, _)| point)
}

/// By L-BFGS as far as the model about the start reaches, then by single levels in the model
/// about where that ends.
fn climb(known: &Neighbours, room: Room, start: &GridPoint) -> Option<(GridPoint, f64)> {
    let x = room.grid().free_unit(start);
    let reach = known.reach(&x, MANY);
    let side = |by: f64| x.iter().zip(&reach).map(move |(x, r)| (x + by * r).clamp(0.0, 1.0));
    let (low, high): (Vec<f64>, Vec<f64>) = (side(-1.0).collect(), side(1.0).collect());
    let limits = Limits { low: &low, high: &high, evaluations: SLOPES };
    let trained = known.near(&x, MANY)?;
    let top = Search { trained: &trained, room }.ascend(start, &limits);
    let trained = known.near(&room.grid().free_unit(&top), MANY)?;
    let search = Search { trained: &trained, room };
    let mut memory = Memory::new();
    search.value(start, &mut memory);
    search.step_uphill(top, STEPS, &mut memory);
    room.best_unseen(memory)
}
