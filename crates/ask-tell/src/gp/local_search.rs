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

/// One search for the best unseen point.
pub(super) struct LocalSearch<'a> {
    pub known: &'a Neighbours,
    pub room: Room<'a>,
}

impl LocalSearch<'_> {
    /// The unseen grid point found with the largest acquisition by the model about it;
    /// `None` if no unseen point was met or none has a finite one.
    pub fn maximise(&self) -> Option<GridPoint> {
        let mut ranked: Vec<(f64, GridPoint)> = self
            .candidates()
            .into_iter()
            .filter(|point| !self.room.proposed.contains(point))
            .filter_map(|point| Some((self.promise(&point)?, point)))
            .collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        ranked.truncate(STARTS);
        let ends = ranked.iter().filter_map(|(_, start)| self.climb(start));
        ends.reduce(|a, b| if b.1 > a.1 { b } else { a }).map(|(point, _)| point)
    }

    fn candidates(&self) -> Vec<GridPoint> {
        if self.room.grid().size() <= WHOLE_GRID {
            return self.room.every_point().collect();
        }
        self.room.candidates(CANDIDATES)
    }

    /// The acquisition, roughly.
    fn promise(&self, point: &GridPoint) -> Option<f64> {
        let x = self.room.unit(point);
        let value = self.known.about(&x, FEW)?.acquisition(&x);
        value.is_finite().then_some(value)
    }

    /// By L-BFGS as far as the model about the start reaches, then by single levels in the model
    /// about where that ends.
    fn climb(&self, start: &GridPoint) -> Option<(GridPoint, f64)> {
        let x = self.room.unit(start);
        let reach = self.known.reach(&x, MANY);
        let side = |by: f64| x.iter().zip(&reach).map(move |(x, r)| (x + by * r).clamp(0.0, 1.0));
        let (low, high): (Vec<f64>, Vec<f64>) = (side(-1.0).collect(), side(1.0).collect());
        let limits = Limits { low: &low, high: &high, evaluations: SLOPES };
        let trained = self.known.about(&x, MANY)?;
        let top = Search { trained: &trained, room: self.room }.ascend_within(start, &limits);
        let trained = self.known.about(&self.room.unit(&top), MANY)?;
        let search = Search { trained: &trained, room: self.room };
        let mut memory = Memory::new();
        search.value(start, &mut memory);
        search.step_uphill(top, STEPS, &mut memory);
        self.room.best_unseen(memory)
    }
}
