//! `optimize task check`: what is wrong with a task file, and whether its nominal start inserts.

use super::super::setup::{DEFAULT_ENGINE, DEFAULT_ROBOT, EngineKind, find, rig, robot};
use super::super::{Failure, print, print_json};
use super::middling;
use crate::connector::check::{Problem, problems};
use crate::connector::{nominal, picture};
use crate::study::write_file;
use clap::Args;
use input::shipped::{Source, TASKS};
use input::units::N_PER_MM;
use insertion::finger::Finger;
use insertion::outcome::Outcome;
use insertion::task::Task;
use insertion::trial::Trial;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Look for what cannot work in a task file, draw it and try its nominal start
#[derive(Debug, Args)]
pub struct Arguments {
    /// Task file, or the name of a shipped task
    #[arg(value_name = "FILE")]
    file: String,
    /// Draw plug, socket, clearances, fingertips and search path
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Robot: see `optimize tasks`, or the path of a robot file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT)]
    robot: String,
    /// Contact engine
    #[arg(long, value_enum, default_value = DEFAULT_ENGINE)]
    engine: EngineKind,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// What a check found.
pub struct Checked {
    problems: Vec<Problem>,
    /// The nominal trial, unless a problem forbids it.
    nominal: Option<Nominal>,
}

struct Nominal {
    finger: Finger,
    trial: Trial,
    explanation: String,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let source = find("task", TASKS, &arguments.file)?;
    let checked = check(&source, &arguments.robot, arguments.engine, arguments.svg.as_ref())?;
    match arguments.json {
        true => print_json(&checked.json())?,
        false => print(&(checked.text() + &drawn(arguments, &source)))?,
    }
    checked.verdict(&source.file)
}

/// That the picture was written, as it is of every file that can be read.
fn drawn(arguments: &Arguments, source: &Source) -> String {
    let file = arguments.svg.as_ref().filter(|_| Task::parse(&source.text, &source.file).is_ok());
    file.map_or(String::new(), |file| format!("wrote         {}\n", file.display()))
}

/// Checks a task file; draws it if it can be read.
pub fn check(
    source: &Source,
    robot_name: &str,
    engine: EngineKind,
    svg: Option<&PathBuf>,
) -> Result<Checked, Failure> {
    let task = match Task::parse(&source.text, &source.file) {
        Ok(task) => task,
        Err(error) => return Ok(Checked { problems: vec![Problem::from(&error)], nominal: None }),
    };
    if let Some(file) = svg {
        write_file(file, &picture::svg(&task))?;
    }
    let problems = problems(&task);
    if !problems.is_empty() {
        return Ok(Checked { problems, nominal: None });
    }
    let finger = middling()?;
    let shaped = finger.shaped(&task.finger, 0.0);
    let rig = rig(engine, &task, &robot(robot_name)?, &shaped).map_err(Failure::input)?;
    let trial = rig.grasp(&shaped).trial(0.0);
    let explanation = nominal::explain(&task, &trial);
    Ok(Checked { problems, nominal: Some(Nominal { finger, trial, explanation }) })
}

impl Checked {
    /// Whether nothing is wrong and the plug goes in.
    pub fn inserts(&self) -> bool {
        self.nominal.as_ref().is_some_and(|nominal| nominal.trial.outcome == Outcome::Inserted)
    }

    /// `valid`, `problems` and `nominal`.
    pub fn json(&self) -> Value {
        let nominal = self.nominal.as_ref().map(|nominal| {
            let trial = &nominal.trial;
            json!({
                "outcome": trial.outcome.word(),
                "failure": trial.outcome.failure(),
                "depth_mm": trial.depth_mm,
                "tilt_deg": trial.tilt_deg,
                "peak_force_n": trial.peak_force_n,
                "slip_mm": trial.slip_mm,
                "compliance_n_per_mm": nominal.finger.compliance / N_PER_MM,
                "assembly_n_per_mm": nominal.finger.assembly / N_PER_MM,
                "explanation": nominal.explanation,
            })
        });
        json!({
            "valid": self.problems.is_empty(),
            "problems": self.problems,
            "nominal": nominal,
        })
    }

    /// A line for each problem and one for the nominal start.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for Problem { key, problem, remedy } in &self.problems {
            text.push_str(&format!(
                "problem       {key}\n              {problem}\n              right: {remedy}\n"
            ));
        }
        match &self.nominal {
            None => text.push_str("nominal       not tried: mend the problems first\n"),
            Some(Nominal { finger, trial, explanation }) => text.push_str(&format!(
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

    fn verdict(&self, file: &str) -> Result<(), Failure> {
        if self.inserts() {
            return Ok(());
        }
        Err(Failure::usage(match self.problems.len() {
            0 => format!("{file}: the nominal start does not insert"),
            1 => format!("{file}: 1 problem"),
            count => format!("{file}: {count} problems"),
        }))
    }
}
