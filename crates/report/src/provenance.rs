//! Outcomes of all trials of a study, and its provenance.

use super::elements::{definitions, table};
use crate::answer::{Answer, command, lines, words};
use crate::glossary::explained;
use insertion::stiffness::Axis;
use insertion::surrogate::Model;
use insertion::{Evaluation, FailureClass, Measure, Outcome};
use maud::{Markup, html};
use parameters::numbers::RCC_KEY;
use study::{Provenance, Recorded, StudyRecord};

/// Names of lines that are omitted here, because other sections of the page show them.
const ELSEWHERE: [&str; 8] = [
    "best design",
    "firm range",
    "window",
    "ends",
    "from its ribs",
    "ties",
    "safe choice",
    "least force",
];

/// Returns collapsed notes on the interpretation of the numbers, further numbers and settings, and the command that
/// reproduces the study.
pub(super) fn section(answer: &Answer, model: &Model) -> Markup {
    // With measurements `lines::recommended` already contains the lines of `lines::simulated`.
    let alone = answer.recommended.iter().filter(|_| answer.record.on_bench.is_none());
    let all = answer.recommended.iter().flat_map(|found| lines::recommended(answer, found));
    let found = alone.flat_map(|found| lines::simulated(answer, found)).chain(all);
    let found = found.filter(|_| answer.verdict.finger().is_some());
    let more: Vec<_> = found.filter(|(name, _)| !ELSEWHERE.contains(&name.as_str())).collect();
    html! {
        details {
            summary { "How to read the numbers" }
            ul { @for text in reading(answer, model) { li { (explained(&text)) } } }
        }
        @if !more.is_empty() {
            details { summary { "More about the finger recommended by simulation" } (definitions(&more)) }
        }
        details { summary { "Settings and hashes" } (provenance(answer.record)) }
        p {
            a href="evaluations.csv" { "evaluations.csv" } ", " a href="journal.jsonl" { "journal.jsonl" }
            ". The same study again, in its folder:"
        }
        pre { code { (command::rerun(answer.record).join(" ")) } }
    }
}

/// Returns notes on accuracy and validity of the numbers.
fn reading(answer: &Answer, model: &Model) -> Vec<String> {
    let goals = answer.record.config.goals();
    let robust = goals.needs(Measure::RobustRange);
    let mut texts: Vec<String> = [
        "The ends of a window lie on a 0.1 mm grid and the next step does not insert, so the true \
         range is up to 0.2 mm wider.",
        "The window search goes outward in steps of 0.5 mm and bisects before the first failure, so it can step over \
         a gap: before you print a design that was not walked, run optimize evaluate --walk.",
    ]
    .map(str::to_owned)
    .into();
    texts.push(stiffness_note(model, robust));
    let draws = "Success rate and robust range hold for the assumed errors, not for your cell; all \
                 designs are evaluated with the same draws.";
    texts.extend(goals.needs_draws().then(|| draws.to_owned()));
    let parameters = &answer.record.config.space.parameters;
    let centre = match parameters.iter().any(|parameter| parameter.key == RCC_KEY) {
        true => {
            "The finger's remote centre is a parameter of the design here; whether a finger with this \
                 infill and this centre can be made was not checked."
        }
        false => {
            "The finger's remote centre is given by the task file, at one distance or along a \
                  straight line over the infill direction. On a printed finger it moves with the infill; how \
                  far was not measured."
        }
    };
    texts.push(centre.to_owned());
    texts
}

fn stiffness_note(model: &Model, robust: bool) -> String {
    let error = |axis| {
        let percent = model.chosen(axis)?.mean_absolute_percent;
        percent.is_finite().then(|| format!("{percent:.1} % in {}", axis.label()))
    };
    let errors: Vec<String> = Axis::ALL.into_iter().filter_map(error).collect();
    let accuracy = match errors.is_empty() {
        true => "the error for other fingers is not known".to_owned(),
        false => format!("the mean leave-one-out error is {}", errors.join(" and ")),
    };
    let ribs = if model.ratios { " and from the ribs of the finger" } else { "" };
    let inclusion = match robust {
        true => "only the robust range includes its error",
        false => "the range does not include its error",
    };
    format!("Stiffness is predicted from {}{ribs}; {accuracy}; {inclusion}.", model.counted())
}

/// Returns the table of the outcomes of all trials.
pub(super) fn outcomes(record: &StudyRecord) -> Markup {
    let searches = || record.evaluations.iter().flat_map(Recorded::tasks);
    let count = |of: &dyn Fn(&Evaluation) -> u32| -> u64 {
        searches().map(|found| u64::from(of(found))).sum()
    };
    let trials = count(&|found| found.trials);
    let failed = count(&|found| found.failure_counts.iter().sum());
    let diverged = count(&|found| found.diverged);
    let row = |outcome: Outcome| {
        let count = match outcome {
            Outcome::Failed(class) => count(&|found| found.failure_counts[class as usize]),
            Outcome::Diverged => diverged,
            Outcome::Inserted => trials.saturating_sub(failed + diverged),
        };
        let share = match trials {
            0 => "–".to_owned(),
            _ => format!("{:.1} %", 100.0 * count as f64 / trials as f64),
        };
        vec![words::outcome(outcome), count.to_string(), share]
    };
    let outcomes = FailureClass::ALL.map(Outcome::Failed).into_iter();
    let rows = outcomes.chain([Outcome::Diverged, Outcome::Inserted]).map(row);
    let at_nominal = searches().filter(|found| found.window.nominal != Outcome::Inserted);
    html! {
        p {
            (trials) " trials in " (searches().count()) " window searches, of which " (at_nominal.count())
            " do not insert at the nominal start. A window search stops at the failures \
            next to the window, so these counts are not probabilities of failure."
        }
        (table(&["outcome", "trials", "share"], rows))
    }
}

fn provenance(record: &StudyRecord) -> Markup {
    let config = &record.config;
    let mut rows: Vec<(String, String)> = Vec::new();
    let mut add = |name: &str, value: String| rows.push((name.to_owned(), value));
    add("study", config.name());
    add("task", config.task_name());
    add("robot", config.robot.clone());
    add("finger model", insertion::value_name(config.finger_model));
    add("optimizer", config.method());
    add("objective", config.objective.to_string());
    add("seed", config.seed.to_string());
    add("evaluations", config.counted(record.evaluations.len()));
    add("designs proposed at a time", config.batch.to_string());
    config.constraints.iter().for_each(|constraint| add("constraint", constraint.to_string()));
    if let Some(aggregate) = &config.aggregate {
        add("objective over the tasks", format!("{aggregate} of unscaled values"));
    }
    config.uncertainty.iter().for_each(|errors| add("drawn errors", errors.clone()));
    for p in &config.space.parameters {
        let name = format!("{}: {}", config.space.name, p.key);
        add(&name, format!("{} to {} in steps of {}", p.low, p.high, p.step));
    }
    let searches = record.evaluations.iter().flat_map(Recorded::tasks);
    let simulated: f64 = searches.map(|found| found.simulated_s).sum();
    let wall: f64 = record.evaluations.iter().map(|r| r.timing.wall_s).sum();
    add("simulated time of the window searches", format!("{simulated:.0} s"));
    add("wall-clock time, summed over evaluations", format!("{wall:.0} s"));
    for (i, segment) in record.segments.iter().enumerate() {
        let of = match record.segments.len() {
            1 => String::new(),
            _ => format!(", segment {} (from evaluation {})", i + 1, segment.first),
        };
        let Provenance { program, source_sha256, input_sha256, engine, .. } = &segment.provenance;
        add(&format!("finger-opt{of}"), format!("{program}, sources {source_sha256}"));
        add(&format!("contact engine{of}"), engine.version.clone());
        let settings = engine.settings.iter().map(|(key, value)| format!("{key} = {value}"));
        add(&format!("engine settings{of}"), settings.collect::<Vec<_>>().join(", "));
        for (role, hash) in input_sha256 {
            add(&format!("SHA-256 of the {role} file{of}"), hash.clone());
        }
    }
    definitions(&rows)
}
