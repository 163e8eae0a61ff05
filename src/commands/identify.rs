//! `optimize identify`: identifies the parameters of a cell (friction, robot stiffness and more) from the robot's logs.

use crate::setup::bag::log_text;
use crate::setup::bench::DEFAULT_PRIORS;
use crate::setup::files::find;
use crate::{Context, Failure, Output, Setup, SetupRequest, command, layout, not_stopped};
use calibration::identify::check::Remark;
use calibration::identify::frame::Frame;
use calibration::identify::mount;
use calibration::identify::question::{Identification, IdentificationResult, Identified};
use calibration::identify::runs;
use input::shipped::{PRIORS, Source};
use input::units::N_PER_MM;
use insertion::robot::Drive;
use insertion::{Priors, Robot};
use report::identify::{self as shown, html};
use std::path::PathBuf;
use study::write_file;

/// Largest number of remarks in the text of an error.
const MAX_REMARKS: usize = 5;

/// Identify the parameters of a cell from the robot's logs: friction, stiffness, preload, pads, edges
///
/// The attempts are simulated along their commanded paths. Some parameters follow from force and pose by
/// formulas, others are fitted to the curves; parameters that the logs do not determine are listed and unchanged.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(
    after_help = "Example: optimize identify --task usb --runs runs.csv --out cell.toml --report identify.html"
)]
pub struct Request {
    /// One task, the finger model and the initial robot.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// Table of the logs: log, infill_density_percent, infill_direction_deg, offset_mm, outcome
    #[arg(long, value_name = "FILE.csv")]
    pub runs: PathBuf,
    /// Task's frame in the robot's base: origin_mm, axis_angle_rad (as a pendant shows them), force_sign = 1
    /// or -1, tool_mass_kg; optional: upright_axis_angle_rad of the TCP, gravity_compensated = false
    #[arg(long, value_name = "FILE.toml")]
    pub frame: Option<PathBuf>,
    /// Write the cell, for --cell, --priors and --uncertainty
    #[arg(long, value_name = "FILE.toml")]
    pub out: Option<PathBuf>,
    /// Write a page with the curves, measured and simulated, and the table of numbers
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
    /// Priors of the parameters: bench, or the path of a file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_PRIORS)]
    pub priors: String,
    /// Seed of the fit
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
}

impl command::Request for Request {
    const PROGRESS: bool = true;

    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let result = self.identify(context)?;
        let written = layout::wrote(self.out.iter().chain(&self.report));
        let text = layout::wrapped(&shown::text(&result)) + &written;
        Output::new(text, shown::json(&result)).drawn(html(&result), self.report.as_ref())
    }
}

impl Request {
    /// Identifies the cell and writes its file.
    ///
    /// # Errors
    /// If an input cannot be used, the logs determine no parameter, or the run is cancelled.
    pub fn identify(&self, context: &Context<'_>) -> Result<IdentificationResult, Failure> {
        let stop = context.stop;
        let _busy = context.busy("fitting the cell to the logs");
        let setup = self.setup.setup()?;
        let template = setup.only_task()?;
        let source = find("priors", PRIORS, &self.priors)?;
        let priors = Priors::parse(&source.text, &source.file)?;
        setup.evaluator.check_paths(&priors, &source.file)?;
        let frame = self.frame.as_deref().map(|path| -> Result<Frame, Failure> {
            let source = Source::read("frame", path).map_err(Failure::input)?;
            Frame::parse(&source.text, &source.file).map_err(Failure::input)
        });
        let frame = frame.transpose()?;
        let mut assumed = Vec::new();
        let runs = runs::read(&self.runs, frame.as_ref(), |path| {
            let (text, remarks) = log_text(path)?;
            assumed.extend(remarks);
            Ok(text)
        });
        let runs = runs.map_err(Failure::input)?;
        let identification = Identification {
            evaluator: &setup.evaluator,
            template,
            priors: &priors,
            runs: &runs,
            tool_mass: frame.as_ref().map_or(0.0, |frame| frame.tool_mass),
            seed: self.seed,
            stop,
        };
        let file = self.runs.to_string_lossy();
        let mut remarks = identification.remarks(&file)?;
        remarks.extend(assumed);
        let found = identification.identify()?;
        not_stopped(stop)?;
        // Measured and simulated curves are shown even if no parameter is identified, but no cell is written.
        if !found.is_informative() && (self.out.is_some() || found.compared.is_empty()) {
            return Err(undetermined(&remarks));
        }
        remarks.extend(mount::remark(&file, &found.compared));
        let cell = cell(&setup, &found, runs.len()).checked("the cell")?;
        let (task, runs) = (template.task.name.clone(), file.into_owned());
        let result = IdentificationResult { task, runs, remarks, found, cell };
        if let Some(path) = &self.out {
            let text = toml::to_string(&result.cell).map_err(|error| Failure::Run(error.into()))?;
            write_file(path, &text)?;
        }
        Ok(result)
    }
}

/// Returns the error for logs that determine no parameter of their cell, with their serious remarks.
fn undetermined(remarks: &[Remark]) -> Failure {
    let serious = remarks.iter().filter(|remark| remark.serious).take(MAX_REMARKS);
    let lines: String = serious.map(|remark| format!("\n{remark}")).collect();
    Failure::running(format!(
        "these logs determine no parameter of the cell; no cell is written{lines}"
    ))
}

/// Returns the identified cell as a cell file.
fn cell(setup: &Setup, found: &Identified, logs: usize) -> Priors {
    let task = setup.task_names().concat();
    let description = format!("identified from {logs} logs on {task}");
    let robot = robot_file(setup, &found.robot);
    let parameters = found.unknowns.iter().map(|one| one.posterior.clone()).collect();
    Priors { name: "cell".to_owned(), description, task: Some(task), robot, parameters }
}

/// Returns the identified robot as a robot file: a compliant flange, or the input file if it is unchanged.
fn robot_file(setup: &Setup, robot: &Robot) -> Option<toml::Table> {
    let (Drive::Servo(servo), true) = (&robot.drive, *robot != setup.evaluator.robot) else {
        return setup.inputs.get("robot")?.parse().ok();
    };
    let list = |values: [f64; 3]| toml::Value::from(values.to_vec());
    let fields: [(&str, toml::Value); 9] = [
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
    Some(fields.into_iter().map(|(key, value)| (key.to_owned(), value)).collect())
}
