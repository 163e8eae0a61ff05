//! Words and numbers of reports; every number with its unit.

use input::units::N_PER_MM;
use insertion::evaluation::objective::Objectives;
use insertion::outcome::Outcome;
use insertion::space::{DENSITY_KEY, DIRECTION_KEY, Design};
use insertion::surrogate::Estimate;

/// A stiffness with its standard deviation, N/mm.
pub(super) fn stiffness(estimate: Estimate) -> String {
    let (mean, sd) = (estimate.mean / N_PER_MM, estimate.sd / N_PER_MM);
    let digits = if mean >= 10.0 { 1 } else { 2 };
    format!("{mean:.digits$} ± {sd:.digits$} N/mm")
}

/// An outcome in words, a failure with its class: `jammed (class 3)`.
pub(super) fn outcome(outcome: Outcome) -> String {
    let class = outcome.failure().map_or(String::new(), |number| format!(" (class {number})"));
    format!("{}{class}", outcome.label())
}

/// What ended a window at one side.
pub(super) fn end(end: Option<Outcome>) -> String {
    end.map_or("no failure".to_owned(), outcome)
}

/// A design in words: infill first, then whatever else the space names.
pub(super) fn design(design: &Design) -> String {
    let others = design.0.iter().filter(|(key, _)| !is_infill(key));
    let mut parts = vec![infill(design)];
    parts.retain(|infill| !infill.is_empty());
    parts.extend(others.map(|(key, value)| format!("{key} {value}")));
    parts.join(", ")
}

/// The objectives' values: a single one without its name.
pub(super) fn values(objectives: &Objectives, values: &[f64]) -> String {
    match (objectives.single(), values) {
        (Some(measure), [value]) => measure.show(*value),
        _ => objectives.show(values),
    }
}

/// Unit of a hypervolume: `mm N`.
pub fn volume_unit(objectives: &Objectives) -> String {
    let units = objectives.measures().iter().map(|measure| measure.unit());
    units.filter(|unit| !unit.is_empty()).collect::<Vec<_>>().join(" ")
}

/// Whether a key names the infill.
pub(super) fn is_infill(key: &str) -> bool {
    [DENSITY_KEY, DIRECTION_KEY].contains(&key)
}

/// The infill of a design in words; empty if it has none.
pub(super) fn infill(design: &Design) -> String {
    let density = design.get(DENSITY_KEY).map(|density| format!("{density} %"));
    let direction = design.get(DIRECTION_KEY).map(|direction| format!("{direction}°"));
    density.into_iter().chain(direction).collect::<Vec<_>>().join(", ")
}
