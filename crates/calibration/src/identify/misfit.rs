//! How far simulated curves are off the measured ones, phase by phase.

use super::question::Compared;
use super::replay::Phase;
use serde::Serialize;

const FORCES: [&str; 3] = ["fx", "fy", "fz"];

/// Root mean square of (measured less simulated) over its standard deviation, over all attempts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Misfit {
    /// Phase of the attempt: search or push.
    pub phase: &'static str,
    /// Component of the force.
    pub axis: &'static str,
    /// Under the numbers of the files.
    pub before: f64,
    /// Under what was identified.
    pub after: f64,
}

/// Of each phase and component of the force.
pub fn misfits(compared: &[Compared]) -> Vec<Misfit> {
    let phases = [(Phase::Search, "search"), (Phase::Push, "push")];
    let each = phases
        .into_iter()
        .flat_map(|phase| FORCES.into_iter().enumerate().map(move |axis| (phase, axis)));
    each.map(|((phase, name), (axis, force))| {
        let mut sums = [(0.0, 0.0); 2];
        for one in compared {
            let data = one.logged.data();
            for (sum, replayed) in sums.iter_mut().zip([&one.before.0, &one.after.0]) {
                let predicted = one.logged.predicted(replayed);
                let all = data.iter().zip(predicted).zip(one.logged.phases()).enumerate();
                for (i, ((datum, predicted), of)) in all {
                    if of == phase
                        && i % one.logged.each() == axis
                        && let Some(predicted) = predicted
                    {
                        sum.0 += ((datum.value - predicted) / datum.sd).powi(2);
                        sum.1 += 1.0;
                    }
                }
            }
        }
        let [before, after] = sums.map(|(squares, count)| (squares / f64::max(count, 1.0)).sqrt());
        Misfit { phase: name, axis: force, before, after }
    })
    .collect()
}
