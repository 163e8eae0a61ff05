//! How the trials of a study ended, and what decided its results.

use super::elements::{definitions, table};
use crate::answer::words;
use crate::study::{Provenance, Recorded, StudyRecord};
use insertion::evaluation::Evaluation;
use insertion::outcome::{FailureClass, Outcome};
use maud::{Markup, html};

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
    let rows: Vec<_> = outcomes.chain([Outcome::Diverged, Outcome::Inserted]).map(row).collect();
    let at_nominal = searches().filter(|found| found.window.nominal != Outcome::Inserted);
    html! {
        p {
            (trials) " trials in " (searches().count()) " window searches. " (at_nominal.count())
            " of them do not insert at the nominal start. A window search ends at the failures \
            next to the window, so failures count window ends, not how likely a failure is."
        }
        (table(&["how the trial ended", "trials", "share"], &rows))
    }
}

pub(super) fn provenance(record: &StudyRecord) -> Markup {
    let config = &record.config;
    let mut rows: Vec<(String, String)> = Vec::new();
    let mut add = |name: &str, value: String| rows.push((name.to_owned(), value));
    add("study", config.name());
    add("task", config.task_name());
    add("robot", config.robot.clone());
    add("finger model", config.finger_model.name().to_owned());
    add("optimizer", config.method());
    add("objective", config.objective.to_string());
    add("seed", config.seed.to_string());
    add("evaluations", config.counted(record.evaluations.len()));
    add("designs proposed at a time", config.batch.to_string());
    config.constraints.iter().for_each(|constraint| add("constraint", constraint.to_string()));
    if let Some(aggregate) = &config.aggregate {
        add("objective over the tasks", format!("{aggregate}, of values that are not scaled"));
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
