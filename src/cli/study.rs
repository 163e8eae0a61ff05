//! `optimize --task T --budget N`: begins or continues a study.

use super::Failure;
use super::session::{self, SessionArguments};
use super::setup::{OptimizerKind, Setup, SetupArguments};
use clap::Args;
use finger_opt::objective::Objective;
use finger_opt::study::{Study, StudyConfig, sha256, study_name};
use std::path::{Path, PathBuf};

/// Largest seed: TOML, in which studies keep theirs, has no larger whole numbers.
const LARGEST_SEED: u64 = i64::MAX as u64;

/// Run a study.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    setup: SetupArguments,
    /// Evaluations in all; run the same command with a larger one to go on
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    budget: u64,
    /// Then up to N evaluations more, by Nelder-Mead from the best design; the budget of
    /// such a study cannot be raised
    #[arg(long, value_name = "N", num_args = 0..=1, default_value_t = 0, default_missing_value = "20",
          allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(..=1_000_000))]
    polish: u64,
    /// Optimizer: gp, cma-es, nelder-mead, random, sobol or grid
    #[arg(long, value_name = "NAME", default_value = "gp")]
    optimizer: OptimizerKind,
    /// What is made large: range, or centred-range
    #[arg(long, value_name = "NAME", default_value = "range")]
    objective: Objective,
    /// Seed; the same seed gives the same study
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 0,
          value_parser = clap::value_parser!(u64).range(..=LARGEST_SEED))]
    seed: u64,
    /// Designs proposed and evaluated at a time; part of the study, unlike --threads
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value_t = 4,
          value_parser = clap::value_parser!(u64).range(1..=10_000))]
    batch: u64,
    /// Folder of the study.
    #[arg(
        long,
        value_name = "DIR",
        help = "Folder of the study [default: results/<task>-<optimizer>-seed<seed>]"
    )]
    out: Option<PathBuf>,
    #[command(flatten)]
    session: SessionArguments,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let setup = Setup::from_arguments(&arguments.setup)?;
    let config = arguments.config(&setup);
    let dir = arguments.out.clone().unwrap_or_else(|| default_folder(&config));
    let study = Study::create_or_continue(&dir, &config, &setup.inputs)?;
    session::run(study, &setup, &arguments.session)
}

impl Arguments {
    fn config(&self, setup: &Setup) -> StudyConfig {
        StudyConfig {
            task: setup.template.task().name.clone(),
            robot: setup.robot.name.clone(),
            engine: setup.engine.name().to_owned(),
            optimizer: self.optimizer.to_string(),
            objective: self.objective.to_string(),
            seed: self.seed,
            budget: self.budget,
            polish: self.polish,
            batch: self.batch,
            versions: setup.engine.versions(),
            input_sha256: sha256(&setup.inputs),
            space: setup.space.clone(),
        }
    }
}

/// `results/<task>-<optimizer>-seed<seed>`; a task of one's own may be named with anything.
fn default_folder(config: &StudyConfig) -> PathBuf {
    let safe = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    let task: String = config.task.chars().map(safe).collect();
    Path::new("results").join(study_name(&task, &config.method(), config.seed))
}
