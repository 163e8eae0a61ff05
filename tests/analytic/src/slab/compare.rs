//! Agreement of an engine with the referee over many insertions.

use super::{Rounding, run};
use crate::planar::{Outcome, Record, Trial};
use contact::Engine;

/// Insertion in the referee and in an engine.
#[derive(Debug, Clone)]
pub struct Case {
    /// Number of the insertion.
    pub index: u64,
    /// Its setup.
    pub trial: Trial,
    /// Course in the referee.
    pub expected: Record,
    /// Course in the engine; none if it diverged.
    pub found: Option<Record>,
}

impl Case {
    /// Simulates an insertion in an engine.
    pub fn new(
        engine: &dyn Engine,
        (index, trial, expected): (u64, Trial, Record),
        rounding: Rounding,
    ) -> Self {
        let found = run(engine, &trial, rounding).ok();
        Case { index, trial, expected, found }
    }

    /// Returns whether the engine has the outcome of the referee.
    pub fn agrees(&self) -> bool {
        self.found.as_ref().is_some_and(|found| found.outcome == self.expected.outcome)
    }

    /// Returns the peaks of the force, N, and the mean difference of the forces over the depth, N, of
    /// an insertion that both complete.
    pub fn forces(&self) -> Option<([f64; 2], f64)> {
        let found = self.found.as_ref()?;
        let inserted = |record: &Record| record.outcome == Outcome::Inserted;
        if !inserted(&self.expected) || !inserted(found) {
            return None;
        }
        let peak = |record: &Record| record.forces.iter().map(|force| force[1]).fold(0.0, f64::max);
        let differences = found.forces.iter().filter(|[depth, _]| *depth > 0.0);
        let differences =
            differences.map(|[depth, force]| (force - at(&self.expected, *depth)).abs());
        let (sum, count) = differences.fold((0.0, 0.0), |(sum, count), d| (sum + d, count + 1.0));
        Some(([peak(&self.expected), peak(found)], sum / f64::max(count, 1.0)))
    }
}

/// Returns the force at a depth, N, by linear interpolation; the depth never falls by much.
fn at(record: &Record, depth: f64) -> f64 {
    let after = record.forces.iter().position(|force| force[0] >= depth);
    let Some(after) = after else { return record.forces.last().map_or(0.0, |force| force[1]) };
    let [d1, f1] = record.forces[after];
    let [d0, f0] = record.forces[after.saturating_sub(1)];
    let share = if d1 > d0 { (depth - d0) / (d1 - d0) } else { 1.0 };
    f0 + share * (f1 - f0)
}

/// Agreement of an engine over determinate cases.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// Number of cases that statics decides.
    pub determinate: usize,
    /// Number of those in which the engine has the outcome of the referee.
    pub agreeing: usize,
    /// Median and 90 % quantile of the error of the peak force, N, of insertions of both.
    pub peak: [f64; 2],
    /// Median and 90 % quantile of the mean difference of the forces over the depth, N.
    pub mean: [f64; 2],
}

/// Returns the agreement over cases.
pub fn agreement(cases: &[Case]) -> Agreement {
    let determinate: Vec<_> = cases.iter().filter(|case| !case.expected.indeterminate()).collect();
    let forces: Vec<_> = determinate.iter().filter_map(|case| case.forces()).collect();
    let quantiles = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let last = values.len().saturating_sub(1);
            values.get((share * last as f64).round() as usize).copied().unwrap_or(f64::NAN)
        };
        [at(0.5), at(0.9)]
    };
    Agreement {
        determinate: determinate.len(),
        agreeing: determinate.iter().filter(|case| case.agrees()).count(),
        peak: quantiles(forces.iter().map(|([a, b], _)| (b - a).abs()).collect()),
        mean: quantiles(forces.iter().map(|(_, mean)| *mean).collect()),
    }
}

/// Returns the disagreements as text, one a line.
pub fn table(cases: &[Case]) -> String {
    let wrong = cases.iter().filter(|case| !case.expected.indeterminate() && !case.agrees());
    let line = |case: &Case| {
        let Trial { assembly, lateral, tilt, .. } = case.trial;
        let found = case.found.as_ref().map(|found| found.outcome);
        let peak = |record: &Record| record.forces.iter().map(|f| f[1]).fold(0.0, f64::max);
        format!(
            "{} {:?} {found:?} wedge {} mu {:.3} rho {:.3} rim {:.3} clearance {:.3} x {:.4} mm \
             tilt {:.2} mrad peaks {:.2} {:.2} N end {:.3} {:.3} mm\n",
            case.index,
            case.expected.outcome,
            case.expected.could_wedge,
            assembly.friction,
            1e3 * assembly.peg.radius,
            1e3 * assembly.hole.radius,
            2e3 * (assembly.hole.half_width - assembly.peg.half_width),
            1e3 * lateral,
            1e3 * tilt,
            peak(&case.expected),
            case.found.as_ref().map_or(f64::NAN, peak),
            1e3 * case.expected.forces.last().map_or(0.0, |f| f[0]),
            1e3 * case.found.as_ref().and_then(|f| f.forces.last()).map_or(0.0, |f| f[0]),
        )
    };
    wrong.map(line).collect()
}
