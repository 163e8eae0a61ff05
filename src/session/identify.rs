//! What the logs of attempts say of the cell.

use super::calibration::DEFAULT_PRIORS;
use super::failure::not_stopped;
use super::files::find;
use super::request::SetupRequest;
use super::{Failure, Setup};
use calibration::identify::check::{Remark, remarks};
use calibration::identify::frame::Frame;
use calibration::identify::question::{Identified, IdentifyDone, Question};
use calibration::identify::runs;
use input::files::{self, LARGEST_INPUT};
use input::shipped::PRIORS;
use input::units::N_PER_MM;
use insertion::evaluation::cell::Priors;
use insertion::robot::{Drive, Robot};
use report::identify::html;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use study::write_file;

/// Which logs to read, and what was known of the cell before.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct IdentifyRequest {
    /// Task, finger model, and the robot to begin with; one task.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// Table of the logs: log, infill_density_percent, infill_direction_deg, offset_mm, outcome
    #[arg(long, value_name = "FILE.csv")]
    pub runs: PathBuf,
    /// Task's frame in the robot's base: origin_mm and axis_angle_rad, as a pendant shows them; force_sign = 1
    /// or -1, tool_mass_kg; and upright_axis_angle_rad of the TCP, gravity_compensated = false if need be
    #[arg(long, value_name = "FILE.toml")]
    pub frame: Option<PathBuf>,
    /// Write the cell, for --cell, --priors and --uncertainty
    #[arg(long, value_name = "FILE.toml")]
    pub out: Option<PathBuf>,
    /// Write a page with the curves, measured and simulated, and the table of numbers
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
    /// Bounds of what the logs may not tell: bench, or the path of a file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_PRIORS)]
    pub priors: String,
    /// Seed of the fit
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
}

impl IdentifyRequest {
    /// Reads the logs, and identifies their cell.
    pub fn run(&self, stop: &AtomicBool) -> Result<IdentifyDone, Failure> {
        let setup = self.setup.setup()?;
        let template = setup.only_task()?;
        let priors = find("priors", PRIORS, &self.priors)?;
        let priors = Priors::parse(&priors.text, &priors.file).map_err(Failure::input)?;
        let frame = self.frame.as_deref().map(|path| -> Result<Frame, Failure> {
            let file = path.to_string_lossy();
            let text = files::read_named(path, LARGEST_INPUT);
            let text = text.map_err(|error| Failure::in_file(&file, error))?;
            Frame::parse(&text, &file).map_err(Failure::input)
        });
        let frame = frame.transpose()?;
        let runs = runs::read(&self.runs, frame.as_ref()).map_err(Failure::input)?;
        let remarks: Vec<Remark> =
            runs.iter().flat_map(|run| remarks(run, &template.task)).collect();
        let question = Question {
            evaluator: &setup.evaluator,
            template,
            priors: &priors,
            runs: &runs,
            tool_mass: frame.as_ref().map_or(0.0, |frame| frame.tool_mass),
            seed: self.seed,
            stop,
        };
        let found = question.answer().map_err(Failure::input)?;
        not_stopped(stop)?;
        let cell = cell(&setup, &found, runs.len()).checked("the cell").map_err(Failure::input)?;
        let done = IdentifyDone { task: template.task.name.clone(), remarks, found, cell };
        if let Some(path) = &self.out {
            let text = toml::to_string(&done.cell).map_err(|error| Failure::Run(error.into()))?;
            write_file(path, &text)?;
        }
        if let Some(path) = &self.report {
            write_file(path, &html(&done))?;
        }
        Ok(done)
    }

    /// Files that it writes.
    pub fn written(&self) -> impl Iterator<Item = &PathBuf> {
        self.out.iter().chain(&self.report)
    }
}

/// What was identified, as a cell file.
fn cell(setup: &Setup, found: &Identified, logs: usize) -> Priors {
    let task = setup.task_names().concat();
    Priors {
        name: "cell".to_owned(),
        description: format!("identified from {logs} logs on {task}"),
        task: Some(task),
        robot: robot_table(setup, &found.robot),
        parameters: found.unknowns.iter().map(|one| one.posterior.clone()).collect(),
    }
}

/// A robot file of this robot: a soft flange, or the file that it was read from.
fn robot_table(setup: &Setup, robot: &Robot) -> Option<toml::Table> {
    let (Drive::Servo(servo), true) = (&robot.drive, *robot != setup.evaluator.robot) else {
        return setup.inputs.get("robot")?.parse().ok();
    };
    let list = |values: [f64; 3]| toml::Value::from(values.to_vec());
    let rows: [(&str, toml::Value); 9] = [
        ("name", robot.name.clone().into()),
        ("description", "a spring and a damper per axis, from the logs".into()),
        ("kind", "servo".into()),
        ("stop_force_n", robot.stop_force.into()),
        ("stiffness_n_per_mm", list(servo.stiffness.map(|k| k / N_PER_MM))),
        ("rotational_stiffness_nm_per_rad", list(servo.rotational_stiffness)),
        ("mass_kg", servo.mass.into()),
        ("inertia_kg_m2", servo.inertia.into()),
        ("damping_ratio", servo.damping_ratio.into()),
    ];
    Some(rows.into_iter().map(|(key, value)| (key.to_owned(), value)).collect())
}
