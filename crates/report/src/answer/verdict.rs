//! Verdict of an answer: its headline and the expected result.

use super::trust::Measured;
use super::words::{evaluated, finger, interval, mm, outcome, span};
use super::{Answer, AsGood, Recommended};
use ask_tell::statistics::mean;
use insertion::evaluation::objective::Measure;
use insertion::outcome::Outcome;
use insertion::space::Design;
use study::Recorded;

/// Share of the space from which on it is said that the finger hardly matters.
const MANY: f64 = 0.5;

/// Recommended action.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict<'a> {
    /// Print this finger.
    Print(&'a Design),
    /// Print any of a set.
    Any {
        /// Which to take without other needs.
        safe: &'a Design,
        /// Size of the set.
        of: usize,
    },
    /// This finger has been printed and measured before.
    MeasuredBefore {
        /// The finger.
        design: &'a Design,
        /// Its measured range, mm; `None` if it is known from below only, or not at all.
        range_mm: Option<f64>,
        /// Lower bound of the range, mm, if the range itself is not known.
        at_least_mm: Option<f64>,
    },
    /// Choose from a front.
    Choose {
        /// The best in the first objective.
        first: &'a Design,
        /// Size of the front.
        of: usize,
    },
    /// Nothing inserts on a task.
    NothingInserts {
        /// Place of the task among the tasks.
        place: usize,
        /// The task.
        task: &'a str,
        /// The design that comes nearest to inserting.
        nearest: &'a Recorded,
        /// How it fails at the nominal start.
        fails: Option<Outcome>,
    },
    /// No design keeps all constraints, or none has a value.
    NoneFeasible,
}

impl<'a> Verdict<'a> {
    pub(super) fn of(answer: &Answer<'a>, measured: &[Measured]) -> Self {
        if let Some((place, nearest)) = answer.record.unusable() {
            let task = answer.record.config.tasks().nth(place).unwrap_or_default();
            let fails = nearest.on(place).map(|found| found.window.nominal);
            return Verdict::NothingInserts { place, task, nearest, fails };
        }
        if let Some(best) = answer.record.on_bench.as_ref().and_then(|found| found.best.first()) {
            let design = &best.design;
            let own = measured.iter().filter(|measured| measured.design == *design);
            // A finger may be measured on several days.
            let range_mm = mean(own.map(|one| one.range_mm));
            let mut bounds = answer.record.on_bench.iter().flat_map(|found| &found.bounds);
            let bound = bounds.find(|(printed, _)| printed == design).map(|(_, mm)| *mm);
            return match (range_mm, bound) {
                (None, None) => Verdict::Print(design),
                (range_mm, bound) => {
                    Verdict::MeasuredBefore { design, range_mm, at_least_mm: bound.flatten() }
                }
            };
        }
        let Some(found) = &answer.recommended else { return Verdict::NoneFeasible };
        let first = &found.design.design;
        if let Some(front) = &answer.front {
            return Verdict::Choose { first, of: front.designs.len() };
        }
        let Some(as_good) = &found.as_good else { return Verdict::Print(first) };
        let of = as_good.designs.len();
        match &as_good.safe {
            Some(safe) if as_good.share >= MANY => Verdict::Any { safe: &safe.design.design, of },
            _ => Verdict::Print(first),
        }
    }

    /// Its name in JSON.
    pub fn key(&self) -> &'static str {
        match self {
            Verdict::Print(_) => "print",
            Verdict::Any { .. } => "any",
            Verdict::MeasuredBefore { .. } => "measured_before",
            Verdict::Choose { .. } => "choose",
            Verdict::NothingInserts { .. } => "nothing_inserts",
            Verdict::NoneFeasible => "none_feasible",
        }
    }

    /// The finger that it names, if it names one to print.
    pub fn finger(&self) -> Option<&'a Design> {
        match *self {
            Verdict::Print(design)
            | Verdict::Any { safe: design, .. }
            | Verdict::MeasuredBefore { design, .. }
            | Verdict::Choose { first: design, .. } => Some(design),
            Verdict::NothingInserts { .. } | Verdict::NoneFeasible => None,
        }
    }

    /// The sentence that stands first.
    pub fn headline(&self) -> String {
        match self {
            Verdict::Print(design) => format!("Print the finger with {}", finger(design)),
            Verdict::Any { safe, of } => {
                format!("Any of {of} fingers will do; without other needs print {}", finger(safe))
            }
            Verdict::MeasuredBefore { design, range_mm, at_least_mm } => {
                let measured = match (range_mm, at_least_mm) {
                    (Some(range_mm), _) => format!("you measured {}", mm(*range_mm)),
                    (None, Some(least_mm)) => format!("you measured {} or more", mm(*least_mm)),
                    (None, None) => "you measured no range".to_owned(),
                };
                format!("Use the finger with {}, printed already: {measured}", finger(design))
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

/// Returns the expected result of the finger and its reliability, in a sentence without its full stop.
pub fn expectation(answer: &Answer) -> String {
    if let Some(best) = answer.record.on_bench.as_ref().and_then(|found| found.best.first()) {
        let [range, low, high] = [best.range_mm, best.low_mm, best.high_mm];
        let trust = answer.trust.reason();
        return format!("expect {} ({low:.1} to {high:.1} at 80 %); {trust}", mm(range));
    }
    if let Verdict::NothingInserts { nearest, fails, .. } = &answer.verdict {
        let fails =
            fails.map_or("fails".to_owned(), |fails| format!("ends with {}", outcome(fails)));
        return format!("the nearest, {}, {fails} at the nominal start", finger(&nearest.design));
    }
    match &answer.recommended {
        None => none(answer),
        Some(found) => {
            let any = matches!(answer.verdict, Verdict::Any { .. });
            let each = found.as_good.as_ref().filter(|_| any).and_then(|set| each(found, set));
            format!("{}; {}", each.unwrap_or_else(|| simulated(found)), answer.trust.reason())
        }
    }
}

/// Why no design can be recommended.
fn none(answer: &Answer) -> String {
    let Some((design, constraints)) = &answer.nearest else {
        return "no evaluation gave a value".to_owned();
    };
    format!("none keeps all constraints; nearest {}: {}", evaluated(design), constraints.join("; "))
}

/// `simulated 4.9 to 5.2 mm each`; `None` if the objective is no length.
fn each(found: &Recommended, set: &AsGood) -> Option<String> {
    let (measure, searched) = found.objective.filter(|(measure, _)| measure.unit() == "mm")?;
    let most = found.firm_range_mm.filter(|_| measure == Measure::Range).unwrap_or(searched);
    let loss = set.designs.iter().map(|(_, loss)| *loss).fold(0.0, f64::max);
    Some(format!("simulated {} each", interval([most - loss, most])))
}

/// `simulated 10.1 mm (-4.4 to +5.7)`; of an objective that is no length its value too.
fn simulated(found: &Recommended) -> String {
    let objective = found.objective.filter(|(measure, _)| measure.unit() != "mm");
    let objective = objective.map_or(String::new(), |(measure, value)| {
        format!("{} {}, ", measure.name(), measure.show(value))
    });
    match (found.firm_range_mm.zip(found.firm_window_mm), found.range_mm) {
        (Some((range_mm, window_mm)), _) => {
            format!("simulated {objective}{} ({})", mm(range_mm), span(window_mm))
        }
        (None, Some(range_mm)) => {
            format!(
                "simulated {objective}{} ({}), not confirmed",
                mm(range_mm),
                span(found.window_mm)
            )
        }
        (None, None) => format!("simulated {objective}no range"),
    }
}
