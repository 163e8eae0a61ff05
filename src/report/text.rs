//! Words and numbers of reports; every number with its unit.

use crate::evaluation::objective::Objectives;
use crate::input::space::{DENSITY_KEY, DIRECTION_KEY, Design};
use crate::outcome::{FailureClass, Outcome};
use crate::surrogate::Estimate;
use crate::units::N_PER_MM;

/// Text that is safe within HTML, in elements and in quoted attributes.
pub(super) fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            c => safe.push(c),
        }
    }
    safe
}

/// A stiffness with its standard deviation, N/mm.
pub(super) fn stiffness(estimate: Estimate) -> String {
    let (mean, sd) = (estimate.mean / N_PER_MM, estimate.sd / N_PER_MM);
    let digits = if mean >= 10.0 { 1 } else { 2 };
    format!("{mean:.digits$} ± {sd:.digits$} N/mm")
}

/// What ended a window at one side.
pub(super) fn end(outcome: Option<Outcome>) -> String {
    match outcome {
        None => "no failure up to the search limit".to_owned(),
        Some(outcome) => outcome_words(outcome),
    }
}

/// An outcome in words, a failure with its class number.
pub(super) fn outcome_words(outcome: Outcome) -> String {
    match outcome {
        Outcome::Inserted => "inserted".to_owned(),
        Outcome::Failed(class) => format!("{} {}", class.number(), class.label()),
        Outcome::Diverged => "simulation diverged".to_owned(),
    }
}

/// The same, short enough for a plot.
pub(super) fn end_short(outcome: Option<Outcome>) -> &'static str {
    match outcome {
        None => "no failure",
        Some(Outcome::Inserted) => "inserted",
        Some(Outcome::Diverged) => "diverged",
        Some(Outcome::Failed(class)) => match class {
            FailureClass::ContactLossBeforeSearch => "1 lost early",
            FailureClass::PlugMissed => "2 missed",
            FailureClass::Jammed => "3 jammed",
            FailureClass::ContactLossInInsertion => "4 lost",
        },
    }
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
    let mut parts = Vec::new();
    if let Some(density) = design.get(DENSITY_KEY) {
        parts.push(format!("{density} %"));
    }
    if let Some(direction) = design.get(DIRECTION_KEY) {
        parts.push(format!("{direction}°"));
    }
    parts.join(", ")
}
