//! `optimize evaluate`: the tolerance window of one finger.

use super::terminal::merge;
use super::words;
use super::{Failure, chosen, print, print_json, repeat};
use crate::session::{EvaluateRequest, Evaluated};
use clap::Args;
use insertion::trial::NEVER;
use report::answer::lines;
use report::answer::words::{mm, number};
use serde_json::{Value, json};
use study::ByRibs;

/// Measure one finger.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    request: EvaluateRequest,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let found = arguments.request.run(&NEVER)?;
    if arguments.json { print_json(&json(&found)) } else { print(&words::wrapped(&text(&found))) }
}

/// Output of `--json`.
pub fn json(found: &Evaluated) -> Value {
    let mut fields = chosen::json(&found.chosen);
    merge(&mut fields, json!(found.evaluation));
    fields["wall_s"] = json!(found.wall_s);
    if let Some(bands) = &found.bands {
        fields["bands"] = repeat::bands_json(bands);
    }
    match &found.by_ribs {
        None => (),
        Some(ByRibs::Measured(tasks)) => fields["computed"] = json!(tasks.first()),
        Some(ByRibs::Refused(why)) => fields["computed"] = json!({"refused": why}),
    }
    fields
}

fn text(found: &Evaluated) -> String {
    let Evaluated { chosen, evaluation, .. } = found;
    let [c1, c2, c3, c4] = evaluation.failure_counts;
    let mut rest = vec![("range".to_owned(), mm(evaluation.window.range_mm()))];
    rest.extend(lines::window(evaluation));
    let failures = format!(
        "{c1} of class 1, {c2} of 2, {c3} of 3, {c4} of 4, {} diverged in {} trials",
        evaluation.diverged, evaluation.trials
    );
    rest.push(("failures".to_owned(), failures));
    rest.push(("peak force".to_owned(), number(evaluation.peak_force_n, 1, "N")));
    rest.extend(lines::taught(evaluation.taught));
    rest.extend(lines::drawn(evaluation));
    rest.extend(found.by_ribs.iter().flat_map(lines::by_ribs));
    format!(
        "task          {}\n{}{}{}time          {:.1} s\n",
        chosen.specimen.task.name,
        chosen::text(chosen),
        words::lines(rest),
        found.bands.as_ref().map(repeat::bands_text).unwrap_or_default(),
        found.wall_s
    )
}
