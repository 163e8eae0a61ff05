//! Recommended action: headline and expected performance.

use super::words::{design as finger, evaluated, interval, mm, outcome, span};
use super::{Answer, Recommended, Ties, unsteady};
use insertion::outcome::stop_words;
use insertion::{Design, Evaluation, Measure};
use study::{BenchFinger, Recorded, StudyRecord, nearest};

/// Recommended action.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict<'a> {
    /// Print this finger.
    Print(&'a Design),
    /// Print any of the tied designs.
    Any {
        /// The safe choice.
        safe: &'a Design,
        /// Number of tied designs.
        of: usize,
    },
    /// Use a finger that has already been printed and measured.
    MeasuredBefore(&'a Design),
    /// Choose from a Pareto front.
    Choose {
        /// The best in the first objective.
        first: &'a Design,
        /// Number of designs on the front.
        of: usize,
    },
    /// No finger inserts on a task.
    NothingInserts {
        /// Index of the task.
        place: usize,
        /// The task.
        task: &'a str,
        /// The design that is nearest to inserting.
        nearest: &'a Recorded,
        /// Its evaluation on the task.
        fails: Option<&'a Evaluation>,
    },
    /// No design satisfies all constraints, or none has a value.
    NoneFeasible,
}

impl<'a> Verdict<'a> {
    pub(super) fn of(answer: &Answer<'a>) -> Self {
        if let Some((place, nearest)) = answer.record.unusable() {
            let task = answer.record.config.tasks().nth(place).unwrap_or_default();
            return Verdict::NothingInserts { place, task, nearest, fails: nearest.on(place) };
        }
        if let Some(best) = answer.record.on_bench.as_ref().and_then(|found| found.best.first()) {
            let design = &best.design;
            let mut bounds = answer.record.on_bench.iter().flat_map(|found| &found.bounds);
            let printed = bounds.any(|(printed, _)| printed == design);
            return match printed || answer.on_robot(design).is_some() {
                true => Verdict::MeasuredBefore(design),
                false => Verdict::Print(design),
            };
        }
        let Some(found) = &answer.recommended else { return Verdict::NoneFeasible };
        let first = &found.design.design;
        if let Some(front) = &answer.front {
            return Verdict::Choose { first, of: front.designs.len() };
        }
        let steady = unsteady(answer.record, found.design.index).is_none();
        let Some(ties) = found.ties.as_ref().filter(|_| steady) else {
            return Verdict::Print(first);
        };
        let of = ties.designs.len();
        match &ties.safe {
            Some(safe) if ties.any() => Verdict::Any { safe: &safe.design.design, of },
            _ => Verdict::Print(first),
        }
    }

    /// Returns the name of the verdict.
    pub(super) fn key(&self) -> &'static str {
        match self {
            Verdict::Print(_) => "print",
            Verdict::Any { .. } => "any",
            Verdict::MeasuredBefore(_) => "measured_before",
            Verdict::Choose { .. } => "choose",
            Verdict::NothingInserts { .. } => "nothing_inserts",
            Verdict::NoneFeasible => "none_feasible",
        }
    }

    /// Returns the finger to print, if there is one.
    pub fn finger(&self) -> Option<&'a Design> {
        match *self {
            Verdict::Print(design)
            | Verdict::MeasuredBefore(design)
            | Verdict::Any { safe: design, .. }
            | Verdict::Choose { first: design, .. } => Some(design),
            Verdict::NothingInserts { .. } | Verdict::NoneFeasible => None,
        }
    }

    /// Returns the first sentence of the answer.
    pub(super) fn headline(&self) -> String {
        match self {
            // The headline of a measured one is `use_now`.
            Verdict::Print(design) | Verdict::MeasuredBefore(design) => {
                format!("Print the finger with {}", finger(design))
            }
            Verdict::Any { safe, of } => {
                format!("Any of {of} fingers will do; by default print {}", finger(safe))
            }
            Verdict::Choose { first, of: 1 } => {
                format!("Print the finger with {}: best in all objectives", finger(first))
            }
            Verdict::Choose { of, .. } => {
                format!("Choose from {of} fingers: none is the best in all objectives")
            }
            Verdict::NothingInserts { task, .. } => format!("No finger inserts on {task}"),
            Verdict::NoneFeasible => "No design can be recommended".to_owned(),
        }
    }
}

/// Returns the expected performance of the finger and the evidence for the estimate, as a sentence without a full stop.
/// If the headline names a measured finger, the result of the search comes first.
pub fn expectation(answer: &Answer) -> String {
    if let Verdict::NothingInserts { nearest, fails, .. } = &answer.verdict {
        let ends = |found: &&Evaluation| {
            let stop = stop_words(found.nominal_stop());
            format!("ends with {}{stop}", outcome(found.window.nominal))
        };
        let fails = fails.as_ref().map_or("fails".to_owned(), ends);
        let nearest = finger(&nearest.design);
        return format!("the nearest to inserting, {nearest}, {fails} at the nominal start");
    }
    if let Some(best) = answer.record.on_bench.as_ref().and_then(|found| found.best.first()) {
        return on_bench(answer, best);
    }
    match &answer.recommended {
        None => no_recommendation(answer.record),
        Some(found) => {
            let any = matches!(answer.verdict, Verdict::Any { .. });
            let each = found.ties.as_ref().filter(|_| any).and_then(|set| each(found, set));
            let best = answer.use_now().map_or(String::new(), |_| answer.found() + "; ");
            let each = each.unwrap_or_else(|| simulated(found));
            format!("{best}{each}; {}", answer.trust.reason())
        }
    }
}

/// Returns the largest expected range on the bench, with the finger, unless the headline names it.
fn on_bench(answer: &Answer, best: &BenchFinger) -> String {
    let [range, low, high] = [best.range_mm, best.low_mm, best.high_mm];
    let expected = format!("{} ({low:.1} to {high:.1} at 80 %)", mm(range));
    let whose = match answer.use_now().is_some_and(|now| now.design == best.design) {
        true => format!("expect {expected}"),
        false => {
            let measured = matches!(answer.verdict, Verdict::MeasuredBefore(_));
            let not = if measured { "" } else { "not " };
            let finger = finger(&best.design);
            format!("largest expected range: {finger}, {expected}, {not}measured")
        }
    };
    let not_usable = answer.not_usable().map_or(String::new(), |text| text + "; ");
    format!("{not_usable}{whose}{}; {}", answer.unfinished(), answer.trust.reason())
}

/// Returns the reason why no design can be recommended, with the design of the least constraint violation.
fn no_recommendation(record: &StudyRecord) -> String {
    let Some(nearest) = nearest(record.current()) else {
        return "no evaluation gave a value".to_owned();
    };
    let constraints = record.config.constraints.iter().map(|limit| limit.words(&nearest.tasks()));
    let constraints = constraints.collect::<Vec<_>>().join("; ");
    format!("none satisfies all constraints; nearest {}: {constraints}", evaluated(nearest))
}

/// Returns `simulated 4.9 to 5.2 mm each`; `None` if the objective is not a length.
fn each(found: &Recommended, set: &Ties) -> Option<String> {
    let (measure, searched) = found.objective.filter(|(measure, _)| measure.unit() == "mm")?;
    let most = found.firm_range_mm.filter(|_| measure == Measure::Range).unwrap_or(searched);
    let loss = set.designs.iter().map(|(_, loss)| *loss).fold(0.0, f64::max);
    Some(format!("simulated {} each", interval([most - loss, most])))
}

/// Returns `simulated 10.1 mm (-4.4 to +5.7)`, with the value of an objective that is not a length.
fn simulated(found: &Recommended) -> String {
    let objective = found.objective.filter(|(measure, _)| measure.unit() != "mm");
    let objective = objective.map_or(String::new(), |(measure, value)| {
        format!("{} {}, ", measure.name(), measure.show(value))
    });
    let firm = found.firm_range_mm.zip(found.firm_window_mm);
    let searched = found.range_mm.map(|range_mm| (range_mm, found.window_mm));
    let note = if firm.is_none() { ", not confirmed" } else { "" };
    match firm.or(searched) {
        Some((range_mm, window_mm)) => {
            format!("simulated {objective}{} ({}){note}", mm(range_mm), span(window_mm))
        }
        None => format!("simulated {objective}no range"),
    }
}
