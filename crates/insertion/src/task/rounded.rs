//! A task with round edges where its file has sharp ones.

use super::edges::{Cut, Edge, SAME, cut, named};
use super::{Part, Solid, Task};
use input::units::MM;
use nalgebra::Vector3;

/// Boxes that begin so near to the plug's tip lead in, m.
const LEAD: f64 = 2.0 * MM;
/// Largest radius, as a share of a box's smallest side: sheet metal is round at its edge.
const MOST: f64 = 0.49;
/// A wall that is so near to the opening is its wall, m.
const BESIDE: f64 = 0.15 * MM;

impl Task {
    /// The same with a radius, m, on the edges that lead in: those at the bottom of the plug's boxes
    /// at its tip, and those of the socket's boxes along the opening; of a thin box, what its
    /// thickness allows. What is no box stays as it is.
    pub fn rounded(&self, radius: f64) -> Task {
        let mut task = self.clone();
        let corners = self.plug.parts.iter().flat_map(|part| part.solid.corners());
        let tip = corners.map(|p| p.z).fold(f64::INFINITY, f64::min);
        for part in &mut task.plug.parts {
            round(part, radius, |min, _| if min.z < tip + LEAD { named("-z") } else { None });
        }
        let [x, y] = self.opening;
        for part in &mut task.socket {
            round(part, radius, |min, max| {
                let walls = [
                    (max.x - x[0], "+x+z"),
                    (min.x - x[1], "-x+z"),
                    (max.y - y[0], "+y+z"),
                    (min.y - y[1], "-y+z"),
                ];
                let beside =
                    walls.iter().filter(|(off, _)| max.z.abs() < SAME && off.abs() < BESIDE);
                Some(beside.filter_map(|(_, edge)| named(edge)).flatten().collect())
            });
        }
        task
    }
}

/// Rounds the edges of a box that `which` finds by its smallest and largest corner.
fn round(
    part: &mut Part,
    radius: f64,
    which: impl Fn(&Vector3<f64>, &Vector3<f64>) -> Option<Vec<Edge>>,
) {
    let Solid::Box { min, max } = &part.solid else { return };
    let edges = which(min, max).unwrap_or_default();
    let radius = radius.min(MOST * (max - min).min());
    let cuts: Vec<_> = edges.into_iter().map(|edge| (edge, Cut::Radius(radius))).collect();
    if cuts.is_empty() {
        return;
    }
    if let Ok(solid) = cut(min, max, &cuts) {
        part.solid = solid;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::task::geometry::volume;
    use std::f64::consts::PI;

    /// The key's four edges at the tip and the slot's four at its mouth are round, nothing else is.
    #[test]
    fn the_edges_that_lead_in_are_rounded() {
        let task = crate::fixtures::task("ket8");
        let round = task.rounded(0.3 * MM);
        let missing = |before: &Part, after: &Part| volume(&before.solid) - volume(&after.solid);
        // Along the 30 mm about the tip, but for the corners, where two cuts meet.
        let along = 30.0 * (1.0 - PI / 4.0) * 0.09;
        let tip = missing(&task.plug.parts[0], &round.plug.parts[0]) / (MM * MM * MM);
        assert!((tip / along - 1.0).abs() < 0.05, "{tip} of {along} mm3");
        for (before, after) in task.socket.iter().zip(&round.socket) {
            let less = missing(before, after) > 0.0;
            assert_eq!(less, before.name != "floor", "{}", before.name);
            let inner =
                |part: &Part| part.solid.corners().iter().map(|p| p.y.abs()).fold(9.0, f64::min);
            assert!((inner(before) - inner(after)).abs() < SAME, "{}", before.name);
        }
        assert_eq!(task.opening, round.opening);
    }
}
