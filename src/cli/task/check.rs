//! `optimize task check`: what is wrong with a task file, and whether its nominal start inserts.

use super::super::words::wrapped;
use super::super::{Failure, print, print_json, trial};
use super::tune;
use crate::session::{DEFAULT_ROBOT, TaskCheck, TaskSource};
use clap::Args;
use connector::check::Problem;
use connector::picture;
use connector::tune::Tuned;
use input::units::N_PER_MM;
use insertion::outcome::Outcome;
use insertion::trial::NEVER;
use insertion::trial::engine::EngineKind;
use serde_json::{Value, json};
use std::path::PathBuf;
use study::write_file;

/// Look for what cannot work in a task file, draw it and try its nominal start
#[derive(Debug, Args)]
pub struct Arguments {
    /// Task file, or the name of a shipped task
    #[arg(value_name = "FILE")]
    file: String,
    /// Draw plug, socket, clearances, fingertips and search path
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Robot: see `optimize robots`, or the path of a robot file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT)]
    robot: String,
    /// Contact engine
    #[arg(long, value_enum, default_value_t)]
    engine: EngineKind,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let source = TaskSource::Named(arguments.file.clone()).read()?;
    let checked = TaskCheck::of(source, &arguments.robot, arguments.engine, &NEVER)?;
    let drawn = match (&arguments.svg, &checked.task) {
        (Some(file), Some(task)) => {
            write_file(file, &picture::svg(task))?;
            format!("wrote         {}\n", file.display())
        }
        _ => String::new(),
    };
    let mended = checked.mend(&arguments.robot, arguments.engine, &NEVER)?;
    let file = &checked.source.file;
    if arguments.json {
        print_json(&mended_json(&checked, mended.as_ref()))?;
    } else {
        let remedy = mended.as_ref().map_or(String::new(), |tuned| match tuned.inserts() {
            true => format!(
                "{}next          optimize task tune {file}\n",
                tune::brief("mended by", tuned)
            ),
            false => format!("mended by     nothing that was tried: {}\n", tune::tried(tuned)),
        });
        print(&wrapped(&(text(&checked) + &remedy + &drawn)))?;
    }
    verdict(&checked)
}

/// How a command ends that wrote a new task: well if its nominal start inserts.
pub fn ended(checked: &TaskCheck, tuned: Option<&Tuned>) -> Result<(), Failure> {
    match (verdict(checked), tuned) {
        (Ok(()), _) => Ok(()),
        (Err(_), Some(tuned)) => {
            let file = &checked.source.file;
            let tried = tune::tried(tuned);
            Err(Failure::running(format!(
                "{file}: does not insert; tried: {tried}; `optimize task tune {file}` looks further"
            )))
        }
        (Err(problems), None) => Err(Failure::running(problems.to_string())),
    }
}

/// The same with `mended_by`: output of `--json`.
pub fn mended_json(checked: &TaskCheck, mended: Option<&Tuned>) -> Value {
    let mut fields = json(checked);
    fields["mended_by"] = json!(mended.map(tune::brief_json));
    fields
}

/// `valid`, `problems` and `nominal`.
pub fn json(checked: &TaskCheck) -> Value {
    let nominal = checked.nominal.as_ref().map(|(finger, trial, explanation)| {
        let mut fields = trial::ended(trial);
        fields["compliance_n_per_mm"] = json!(finger.compliance / N_PER_MM);
        fields["assembly_n_per_mm"] = json!(finger.assembly / N_PER_MM);
        fields["explanation"] = json!(explanation);
        fields
    });
    json!({
        "valid": checked.problems.is_empty(),
        "problems": checked.problems,
        "nominal": nominal,
    })
}

/// A line for each problem and one for the nominal start.
pub fn text(checked: &TaskCheck) -> String {
    let mut text = String::new();
    for Problem { key, problem, remedy } in &checked.problems {
        text.push_str(&format!(
            "problem       {key}\n              {problem}\n              right: {remedy}\n"
        ));
    }
    match &checked.nominal {
        None => text.push_str("nominal       not tried: mend the problems first\n"),
        Some((finger, trial, explanation)) => text.push_str(&format!(
            "geometry      no problems\n\
             finger        compliance {} N/mm, assembly {} N/mm: the middle one of the measured\n\
             nominal       {}, peak force {:.1} N, slip {:.2} mm\n              {explanation}\n",
            finger.compliance / N_PER_MM,
            finger.assembly / N_PER_MM,
            trial.outcome.label(),
            trial.peak_force_n,
            trial.slip_mm,
        )),
    }
    text
}

fn verdict(checked: &TaskCheck) -> Result<(), Failure> {
    let file = &checked.source.file;
    let outcome = checked.nominal.as_ref().map(|(_, trial, _)| trial.outcome);
    if outcome == Some(Outcome::Inserted) {
        return Ok(());
    }
    Err(Failure::usage(match checked.problems.len() {
        0 => format!("{file}: the nominal start does not insert"),
        1 => format!("{file}: 1 problem"),
        count => format!("{file}: {count} problems"),
    }))
}
