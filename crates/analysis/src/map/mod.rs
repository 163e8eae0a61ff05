//! Capture map (also: capture range, region of attraction): outcomes of insertions over two position or angle errors at
//! once. A tolerance window covers only one.

mod plane;

pub use plane::{Axes, Plane};

use insertion::{Design, FailureClass, Outcome};
use parameters::plan::grid::{self, Node, TracedMap};
use plane::{LIMIT, value};
use serde::{Deserialize, Serialize};

/// Outcomes over two errors, on a grid. Its JSON round-trips exactly.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaptureMap {
    /// Name of the task.
    pub task: String,
    /// The finger's design; empty if the finger was given by its stiffness.
    pub design: Design,
    /// Shift of the start along y, then the other error.
    pub axes: [MapAxis; 2],
    /// Outcomes: a row per value of the second axis, ascending; a column per value of the first.
    pub outcomes: Vec<Vec<OutcomeCode>>,
    /// Whether each outcome was simulated; the others are inferred from their neighbours.
    pub simulated: Vec<Vec<bool>>,
    /// Number of simulated trials.
    pub trials: usize,
    /// Resolution at which the border of the inserting region was traced, mm or degrees: the step of the grid, or more
    /// if the limit on trials was reached.
    pub traced_step: f64,
    /// Area of the inserting region, in `area_unit`.
    pub area: f64,
    /// Unit of `area`: `mm2` or `mm deg`.
    pub area_unit: String,
}

/// Axis of a map: an error and its values on the grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MapAxis {
    /// Name of the error (see [`Axes`]): `y`, `x`, `yaw` or `tilt`.
    pub name: String,
    /// `mm` or `deg`.
    pub unit: String,
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Spacing of the values.
    pub step: f64,
}

impl CaptureMap {
    /// Traces the map of a finger on a task with at most 300 trials; `done` is called after each.
    pub fn trace(task: &str, design: Design, plane: &Plane<'_>, done: &(dyn Fn() + Sync)) -> Self {
        let simulated = |node| {
            let outcome = plane.outcome(node);
            done();
            outcome
        };
        let TracedMap { low, high, nodes, trials, step, .. } = grid::trace(LIMIT, &simulated);
        let inserting = nodes.values().filter(|found| found.outcome == Outcome::Inserted).count();
        let names = [["y", "mm"], plane.axes.second().0];
        let outcome = |node| nodes.get(&node).map_or(Outcome::Diverged, |found| found.outcome);
        let task = task.to_owned();
        let axes = [0, 1].map(|axis| MapAxis::new(names[axis], low[axis], high[axis]));
        let outcomes = lattice(low, high, |node| OutcomeCode(outcome(node)));
        let simulated = lattice(low, high, |node| nodes.get(&node).is_some_and(|f| f.simulated));
        let (traced_step, area) = (value(step), inserting as f64 * value(1) * value(1));
        let area_unit = format!("mm {}", names[1][1]).replace("mm mm", "mm2");
        CaptureMap { task, design, axes, outcomes, simulated, trials, traced_step, area, area_unit }
    }

    /// Returns a caption of one sentence.
    pub fn caption(&self) -> String {
        let [first, second] = self.axes.each_ref().map(|axis| &axis.name);
        let (area, unit) = (self.area, self.area_unit.replace('2', "²"));
        format!(
            "Capture range over errors of the start in {first} and {second}: {area:.1} {unit}, from {} trials",
            self.trials
        )
    }

    /// Returns the smallest and largest value of axis 0 or 1, in its unit, at which any grid point inserts.
    pub fn ends(&self, axis: usize) -> Option<[f64; 2]> {
        let row = |row: &Vec<OutcomeCode>| row.iter().any(|mark| mark.0 == Outcome::Inserted);
        let column = |at: usize| self.outcomes.iter().any(|row| row[at].0 == Outcome::Inserted);
        let inserts: Vec<bool> = match axis {
            0 => (0..self.outcomes.first()?.len()).map(column).collect(),
            _ => self.outcomes.iter().map(row).collect(),
        };
        let ends = [inserts.iter().position(|&is| is)?, inserts.iter().rposition(|&is| is)?];
        Some(ends.map(|at| self.axes[axis].value(at)))
    }

    /// Returns the interval of shifts along y around zero, mm, that insert without a second error; `None` if the point
    /// without any error does not insert.
    pub fn window_mm(&self) -> Option<[f64; 2]> {
        let [zero, other] =
            self.axes.each_ref().map(|axis| (-axis.low / axis.step).round() as usize);
        let row = self.outcomes.get(other)?;
        let inserts = |at: &usize| row.get(*at).is_some_and(|mark| mark.0 == Outcome::Inserted);
        let above = (zero..row.len()).take_while(inserts).last()?;
        let below = (0..=zero).rev().take_while(inserts).last()?;
        Some([below, above].map(|at| self.axes[0].value(at)))
    }
}

/// Returns the values of a function at all grid points, row by row.
fn lattice<T>(low: Node, high: Node, of: impl Fn(Node) -> T) -> Vec<Vec<T>> {
    let row = |other| (low[0]..=high[0]).map(|y| of([y, other])).collect();
    (low[1]..=high[1]).map(row).collect()
}

impl MapAxis {
    fn new([name, unit]: [&str; 2], low: i32, high: i32) -> Self {
        let (name, unit) = (name.to_owned(), unit.to_owned());
        MapAxis { name, unit, low: value(low), high: value(high), step: value(1) }
    }

    /// Returns the value at an index along the axis.
    pub fn value(&self, index: usize) -> f64 {
        self.low + index as f64 * self.step
    }
}

/// Outcome coded as a number: 0 inserted, 1 to 4 the failure class, -1 diverged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "i8", try_from = "i8")]
pub struct OutcomeCode(pub Outcome);

impl From<OutcomeCode> for i8 {
    fn from(OutcomeCode(outcome): OutcomeCode) -> i8 {
        match outcome {
            Outcome::Inserted => 0,
            Outcome::Failed(class) => class.number() as i8,
            Outcome::Diverged => -1,
        }
    }
}

impl TryFrom<i8> for OutcomeCode {
    type Error = String;

    fn try_from(number: i8) -> Result<Self, String> {
        Ok(OutcomeCode(match number {
            -1 => Outcome::Diverged,
            0 => Outcome::Inserted,
            class => Outcome::Failed(FailureClass::try_from(class.unsigned_abs())?),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;
    use input::units::N_PER_MM;
    use insertion::finger::Finger;
    use insertion::tests::fake::{FakeRig, window_mm};
    use insertion::trial::{Conditions, Grasp};
    use parameters::plan::grid::STEPS_PER_UNIT;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// In the closed-form rig a second error of 1 mm or 1° shortens the window by 1 mm at both ends.
    #[test]
    fn the_map_of_the_closed_form_is_the_same_on_any_number_of_threads_and_after_its_json() {
        let (rig, finger) = (FakeRig::default(), Finger::new(3.0 * N_PER_MM, 20.0 * N_PER_MM));
        let (low, high) = window_mm(&finger, &Conditions::NOMINAL);
        for axes in Axes::value_variants() {
            let plane = Plane::new(&rig, Grasp::of(&finger), *axes);
            let on = |threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let count = AtomicUsize::new(0);
                let done = || {
                    count.fetch_add(1, Ordering::Relaxed);
                };
                let trace = || CaptureMap::trace("closed form", Design::default(), &plane, &done);
                let map = pool.install(trace);
                assert_eq!(count.into_inner(), map.trials);
                map
            };
            let map = on(1);
            assert_eq!(map, on(3));
            assert_eq!(map, serde_json::from_str(&serde_json::to_string(&map).unwrap()).unwrap());
            let node = |of: fn(&MapAxis) -> f64| {
                map.axes
                    .each_ref()
                    .map(|axis| (of(axis) * f64::from(STEPS_PER_UNIT)).round() as i32)
            };
            let full = lattice(node(|axis| axis.low), node(|axis| axis.high), |node| {
                OutcomeCode(plane.outcome(node))
            });
            assert_eq!(map.outcomes, full);
            let inside = |[below, above]: [f64; 2]| {
                (0.0..0.25).contains(&(below - low)) && (0.0..0.25).contains(&(high - above))
            };
            assert!(inside(map.window_mm().unwrap()) && inside(map.ends(0).unwrap()), "{map:?}");
            let half = (high - low) / 2.0;
            let [below, above] = map.ends(1).unwrap();
            assert!(below == -above && (0.0..0.25).contains(&(half - above)), "{below}, {above}");
            assert!((map.area / (2.0 * half * half) - 1.0).abs() < 0.15, "{}", map.area);
        }
    }
}
