//! The points of one batch on their way out and their values on the way back.

use super::message::PointValue;
use crate::{GridPoint, Observation};
use std::collections::BTreeMap;

/// A batch: the optimizer proposes it whole and is told of it whole and in order; in between
/// its points may be asked in parts and told one by one in any order.
#[derive(Debug, Default)]
pub(super) struct Batch {
    /// The id of its first point; the others follow.
    first: u64,
    points: Vec<GridPoint>,
    asked: usize,
    values: BTreeMap<u64, Option<f64>>,
}

impl Batch {
    /// The batch after this one.
    pub fn next(&self, points: Vec<GridPoint>) -> Batch {
        let first = self.first + self.points.len() as u64;
        Batch { first, points, ..Batch::default() }
    }

    /// Its points with their ids.
    pub fn points(&self) -> impl Iterator<Item = (u64, &GridPoint)> {
        (self.first..).zip(&self.points)
    }

    /// Whether every point has its value.
    pub fn complete(&self) -> bool {
        self.values.len() == self.points.len()
    }

    /// Hands out up to `n` points that were not asked before.
    pub fn hand_out(&mut self, n: usize) -> Vec<(u64, GridPoint)> {
        let end = self.points.len().min(self.asked.saturating_add(n));
        let part = self.points[self.asked..end].iter().cloned();
        let asked = (self.first + self.asked as u64..).zip(part).collect();
        self.asked = end;
        asked
    }

    /// The points asked and not told: `id 3`, or `ids 3, 4 and 17 more`.
    pub fn untold(&self) -> String {
        const SHOWN: usize = 8;
        let asked = self.first..self.first + self.asked as u64;
        let ids: Vec<u64> = asked.filter(|id| !self.values.contains_key(id)).collect();
        let shown: Vec<String> = ids.iter().take(SHOWN).map(u64::to_string).collect();
        let (word, shown) = (if ids.len() == 1 { "id" } else { "ids" }, shown.join(", "));
        match ids.len().saturating_sub(SHOWN) {
            0 => format!("{word} {shown}"),
            more => format!("{word} {shown} and {more} more"),
        }
    }

    /// Whether these can all be told.
    pub fn check(&self, told: &[PointValue]) -> Result<(), String> {
        let twice = |id| Err(format!("tell: id {id} is told twice; each id is told once"));
        for PointValue { id, .. } in told {
            if *id >= self.first + self.asked as u64 {
                return Err(format!("tell: id {id} was not asked"));
            }
            // All ids before this batch have their values.
            if *id < self.first || self.values.contains_key(id) {
                return twice(*id);
            }
        }
        let mut ids: Vec<u64> = told.iter().map(|told| told.id).collect();
        ids.sort_unstable();
        ids.windows(2).find(|pair| pair[0] == pair[1]).map_or(Ok(()), |pair| twice(pair[0]))
    }

    /// Keeps the value (larger is better) of a point that [`check`](Self::check) passed; gives
    /// the point.
    pub fn keep(&mut self, id: u64, value: Option<f64>) -> &GridPoint {
        self.values.insert(id, value);
        &self.points[(id - self.first) as usize]
    }

    /// All points with their values, in order.
    pub fn observations(&self) -> Vec<Observation> {
        let value = |id| self.values.get(&id).copied().flatten();
        self.points().map(|(id, point)| Observation::new(point.clone(), value(id))).collect()
    }
}
