//! Measurement of the windows of a finger at the current value and at both ends of each lever.

use super::bounds::{LeverParameter, lever_parameters};
use super::lever::{Base, Lever, Levers};
use insertion::{
    DENSITY_KEY, DIRECTION_KEY, Design, DesignError, Evaluation, Evaluator, Outcome, Plan,
    Prediction, Scenario, Search, Space, StartRule, Template, grid_mm,
};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Largest number of windows measured; levers beyond it are left out.
const MAX_WINDOWS: usize = 20;

/// Inputs of the lever analysis of a finger on a task.
pub struct LeverAnalysis<'a> {
    /// Evaluator for the windows.
    pub evaluator: &'a Evaluator,
    /// Task, one of `evaluator.templates`.
    pub template: &'a Template,
    /// Search space, whose bounds take precedence over those of the shipped files.
    pub space: &'a Space,
    /// Design of the finger.
    pub design: &'a Design,
    /// Stiffness of the finger; `None` to predict it from the design.
    pub given: Option<Prediction>,
    /// Progress callback: how many windows are measured and how many there are.
    pub done: &'a (dyn Fn([usize; 2]) + Sync),
}

/// Lever to be measured, and the index of the scenario of each end; an end that changes nothing has index 0, the
/// baseline.
type Candidate = (Lever, [usize; 2]);

impl LeverAnalysis<'_> {
    /// Measures the levers on the current thread pool. `infill` is the smallest and the largest range over infills, mm;
    /// if it is not known, the softest and the stiffest infill are measured. The result is invalid once `stop` is set.
    ///
    /// # Errors
    /// If the finger at the current values, or with the softest or stiffest infill, cannot be simulated.
    pub fn levers(
        &self,
        infill: Option<[f64; 2]>,
        stop: &AtomicBool,
    ) -> Result<Levers, DesignError> {
        let LeverAnalysis { evaluator, template, design, given, done, .. } = *self;
        let mut scenarios = vec![evaluator.apply(template, (design, given), &[])?];
        if infill.is_none() {
            for design in self.extremes()? {
                scenarios.push(evaluator.apply(template, (&design, None), &[])?);
            }
        }
        let infills = scenarios.len();
        let (candidates, left_out) = self.candidates(&mut scenarios)?;
        let (count, of) = (AtomicUsize::new(0), scenarios.len());
        let windows = scenarios.par_iter().map(|scenario| self.window(scenario, stop));
        let windows = windows.inspect(|_| done([count.fetch_add(1, Ordering::Relaxed) + 1, of]));
        let found = windows.collect::<Result<Vec<_>, _>>()?;
        let ranges: Vec<_> = found.iter().map(range_mm).collect();
        let base = Base {
            range_mm: ranges[0].unwrap_or(0.0),
            taught_start_mm: grid_mm(found[0].taught.unwrap_or(0)),
        };
        let ends =
            |(lever, windows): Candidate| Lever { ends: windows.map(|at| ranges[at]), ..lever };
        let mut levers: Vec<_> = candidates.into_iter().map(ends).collect();
        // Stable sort: equal levers keep their order.
        levers.sort_by(|a, b| b.span_mm(base).total_cmp(&a.span_mm(base)));
        let over = || {
            let all = || ranges[..infills].iter().map(|range| range.unwrap_or(0.0));
            [all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)]
        };
        let (task, infill) = (template.task.name.clone(), infill.unwrap_or_else(over));
        Ok(Levers { task, design: design.clone(), base, infill, levers, left_out, windows: of })
    }

    /// Returns the levers to measure and the names of those that exceed [`MAX_WINDOWS`]. The scenarios of their ends
    /// are appended to `scenarios`, the first of which is the baseline.
    fn candidates(
        &self,
        scenarios: &mut Vec<Scenario>,
    ) -> Result<(Vec<Candidate>, Vec<String>), DesignError> {
        let base = scenarios[0].clone();
        let (mut candidates, mut left_out) = (Vec::new(), Vec::new());
        for lever in lever_parameters(self, &base)? {
            let (mut more, mut values, mut windows) = (Vec::new(), [lever.value; 2], [0; 2]);
            for end in 0..2 {
                // A chamfer of 0 makes a different scenario of the same shape, whose window can differ.
                let changed = lever.at(self, end == 1).filter(|(value, _)| *value != lever.value);
                let Some((value, scenario)) = changed else { continue };
                if scenario != base {
                    (values[end], windows[end]) = (value, scenarios.len() + more.len());
                    more.push(scenario);
                }
            }
            if more.is_empty() {
                continue;
            }
            if scenarios.len() + more.len() > MAX_WINDOWS {
                left_out.push(lever.parameter.name);
                continue;
            }
            scenarios.append(&mut more);
            candidates.push((lever.unmeasured(values), windows));
        }
        Ok((candidates, left_out))
    }

    /// Returns the design with the softest and with the stiffest infill of the space.
    fn extremes(&self) -> Result<[Design; 2], DesignError> {
        let LeverAnalysis { evaluator, space, design, .. } = self;
        let values = |key: &'static str| {
            let of = space.parameters.iter().filter(move |parameter| parameter.key == key);
            of.flat_map(|parameter| (0..parameter.levels()).map(|level| parameter.value(level)))
        };
        let mut all = Vec::new();
        for density in values(DENSITY_KEY) {
            for direction in values(DIRECTION_KEY) {
                let stiffness = evaluator.surrogate.predict([density, direction])?.compliance.mean;
                let design = design.with(DENSITY_KEY, density).with(DIRECTION_KEY, direction);
                all.push((stiffness, design));
            }
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok([all.first(), all.last()].map(|of| of.map_or(*design, |(_, design)| design).clone()))
    }

    /// Measures the window around the start taught for a scenario.
    fn window(&self, scenario: &Scenario, stop: &AtomicBool) -> Result<Evaluation, DesignError> {
        let mut scenario = scenario.clone();
        scenario.task.strategy.rule = StartRule::Taught;
        self.evaluator.simulate(&scenario, Search::default(), &Plan::WINDOW, stop)
    }
}

fn range_mm(evaluation: &Evaluation) -> Option<f64> {
    let window = &evaluation.window;
    (window.nominal == Outcome::Inserted).then(|| window.range_mm())
}

impl LeverParameter {
    /// Returns the lever with these values at its ends, before the ranges there are measured.
    fn unmeasured(self, values: [f64; 2]) -> Lever {
        let LeverParameter { parameter, value } = self;
        // To 9 decimals, without floating-point noise.
        let rounded = |value: f64| (value * 1e9).round() / 1e9;
        let (unit, key) = (parameter.path.unit().trim().to_owned(), parameter.path.to_string());
        let (value, low, high) = (rounded(value), rounded(values[0]), rounded(values[1]));
        let source = parameter.source;
        Lever { unit, key, name: parameter.name, value, low, high, source, ends: [None; 2] }
    }
}
