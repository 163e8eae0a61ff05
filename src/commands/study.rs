//! `optimize --task T`: starts or continues a study.

use crate::failure::within;
use crate::setup::bench::DEFAULT_PRIORS;
use crate::setup::files::{DEFAULT_FINGER, find};
use crate::setup::measured;
use crate::setup::request::{DEFAULT_ROBOT, DEFAULT_SPACE, several};
use crate::setup::words::WordParser;
use crate::studies::on_bench;
use crate::studies::open::OpenStudy;
use crate::studies::output;
use crate::{Context, Failure, Output, RunRequest, Setup, SetupRequest, command};
use ask_tell::OptimizerKind;
use input::shipped::PRIORS;
use insertion::evaluation::INDIFFERENCE_MM;
use insertion::evaluation::objective::{AggregateKind, Bound};
use insertion::{Aggregate, Constraint, Measure, Objectives, Priors};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use study::{
    Confirmation, INDIFFERENCES_MM, LARGEST_BATCH, LARGEST_BUDGET, Study, StudyConfig, has_begun,
    read_config, study_name,
};

const DEFAULT_BATCH: u64 = 4;
/// Default budget of a study that cannot stop early.
const DEFAULT_BUDGET: u64 = 200;
/// Default budget of a study that can stop early.
const EARLY_STOPPING_BUDGET: u64 = 500;
const DEFAULT_UNCERTAINTY: &str = "typical";

/// Find the finger that tolerates the largest shift of the start
///
/// Running the same command again continues the study. The name may be left out.
#[derive(Debug, Clone, clap::Args)]
#[command(
    mut_arg("tasks", several),
    after_help = "Example: optimize study --task usb --budget 200"
)]
pub struct Request {
    /// Tasks, robot, space, finger model.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// Total number of evaluations; to continue, run the same command with a larger one [default: until no
    /// design is expected to gain 0.3 mm, at most 500; 200 for other optimizers and objectives]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=LARGEST_BUDGET))]
    pub budget: Option<u64>,
    /// Up to N further evaluations by Nelder-Mead from the best design; the budget of such a study cannot be
    /// raised
    #[arg(long, value_name = "N", num_args = 0..=1, default_value_t = 0, default_missing_value = "20",
          value_parser = clap::value_parser!(u64).range(0..=LARGEST_BUDGET))]
    pub polish: u64,
    /// Smallest relevant difference of ranges, mm: designs that lose less count as ties
    #[arg(long, value_name = "MM", default_value_t = INDIFFERENCE_MM)]
    pub indifference_mm: f64,
    /// Optimizer
    #[arg(long, value_name = "NAME", default_value = "gp",
          value_parser = WordParser::<OptimizerKind>::new(OptimizerKind::all().map(OptimizerKind::name)))]
    pub optimizer: OptimizerKind,
    /// Measure to optimize; two or three, separated by commas, give a Pareto front
    #[arg(long, value_name = "NAME", default_value = "range",
          value_parser = WordParser::<Objectives>::new(Measure::all().map(Measure::name)))]
    pub objective: Objectives,
    /// Constraint, for example 'peak-force<=30' or 'success-rate>=0.9'; may be given several times
    #[arg(long = "constraint", value_name = "LIMIT", hide_possible_values = true,
          value_parser = WordParser::<Constraint>::new(Measure::all().map(Measure::name)))]
    pub constraints: Vec<Constraint>,
    /// Errors for success-rate and robust-range: typical, or the path of a file [default: typical]
    #[arg(long, value_name = "NAME")]
    pub uncertainty: Option<String>,
    /// Measurements from the bench: published, or the path of a file. The study then recommends the finger
    /// that is predicted to be the best on the bench, from simulations and measurements
    #[arg(long, value_name = "FILE")]
    pub measurements: Option<String>,
    /// Priors of the parameters that were not measured, for --measurements: bench, or the path of a file
    /// [default: bench]
    #[arg(long, value_name = "NAME")]
    pub priors: Option<String>,
    /// Aggregation over several tasks [default: min]
    #[arg(long, value_enum)]
    pub aggregate: Option<AggregateKind>,
    /// Weights of the tasks, separated by commas, for --aggregate weighted
    #[arg(long, value_name = "W,W..", value_delimiter = ',')]
    pub weights: Vec<f64>,
    /// Seed; the same seed gives the same study
    // TOML has signed 64-bit integers.
    #[arg(long, value_name = "N", default_value_t = 0,
          value_parser = clap::value_parser!(u64).range(0..=i64::MAX as u64))]
    pub seed: u64,
    /// Number of designs per batch; part of the study, unlike --threads [default: unchanged if the study
    /// continues; otherwise 4, or with --executor the number of its workers]
    #[arg(long, value_name = "N",
          value_parser = clap::value_parser!(u64).range(1..=LARGEST_BATCH))]
    pub batch: Option<u64>,
    /// Propose a new design after each result, so that no worker waits for the slowest of a batch; the
    /// journal then depends on the order of the results
    #[arg(long = "async")]
    pub asynchronous: bool,
    /// Folder of the study.
    #[arg(
        long,
        value_name = "DIR",
        help = "Folder of the study [default: results/<task>-<optimizer>-seed<seed>, extended by further settings]"
    )]
    pub out: Option<PathBuf>,
    /// Options of the run.
    #[command(flatten)]
    pub run: RunRequest,
    /// Also print all numbers on which the answer is based
    #[arg(long, conflicts_with = "json")]
    pub verbose: bool,
}

impl command::Request for Request {
    const PROGRESS: bool = true;

    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        output::run(self.open(None)?, context, self.verbose)
    }
}

impl Request {
    /// Starts or continues the study; `workers` is the default batch size of a new study.
    pub fn open(&self, workers: Option<u64>) -> Result<OpenStudy, Failure> {
        let (setup, config, dir) = self.planned(workers)?;
        let added = measured::new_measurements(&dir, &setup);
        let accept_changed = self.run.accept_changed || added.is_some();
        let study = Study::create_or_continue(&dir, &config, &setup.inputs, accept_changed)?;
        let open = OpenStudy::new(study, setup, self.run.clone())?;
        Ok(OpenStudy { new_measurements: added.unwrap_or(0), ..open })
    }

    /// Writes the study without evaluating designs and returns its folder; an existing study is not changed.
    pub(crate) fn create(&self) -> Result<PathBuf, Failure> {
        let (setup, config, dir) = self.planned(None)?;
        Study::create(&dir, &config, &setup.inputs)?;
        Ok(dir)
    }

    /// Returns the checked setup, configuration and folder of the study without writing anything; `workers` is the
    /// default batch size of a new study.
    fn planned(&self, workers: Option<u64>) -> Result<(Setup, StudyConfig, PathBuf), Failure> {
        within("--indifference-mm", self.indifference_mm, &INDIFFERENCES_MM)?;
        if self.priors.is_some() && self.measurements.is_none() {
            return Err(Failure::usage("--priors needs --measurements"));
        }
        let priors = self.priors.as_deref().unwrap_or(DEFAULT_PRIORS);
        let source = find("file of priors", PRIORS, priors)?;
        let priors = Priors::parse(&source.text, &source.file)?;
        let mut setup = self.setup.setup_with(Some(&priors))?;
        let constrained = self.constraints.iter().map(|constraint| constraint.measure);
        let mut measures = self.objective.measures().iter().copied().chain(constrained);
        if measures.any(Measure::needs_draws) {
            let name = self.uncertainty.as_deref().unwrap_or(DEFAULT_UNCERTAINTY);
            setup = setup.with_named_uncertainty(name)?;
        } else if self.uncertainty.is_some() {
            return Err(Failure::usage(
                "--uncertainty needs success-rate or robust-range as an --objective or in a \
                 --constraint",
            ));
        }
        if let Some(name) = &self.measurements {
            setup = setup.with_measurements(measured::file(name)?, source)?;
        }
        let mut config = self.config(&setup)?;
        if self.budget.is_none() && config.can_settle() {
            (config.settles, config.budget) = (true, EARLY_STOPPING_BUDGET);
        }
        if config.asynchronous && (self.optimizer == OptimizerKind::CmaEs || config.polish > 0) {
            return Err(Failure::usage(
                "--async: cma-es and --polish need whole batches; leave it out, or choose another \
                 --optimizer without --polish",
            ));
        }
        config.check().map_err(|problem| Failure::usage(format!("--{problem}")))?;
        if setup.measured.is_some() {
            on_bench::check(&config)?;
        }
        let dir = self.out.clone().unwrap_or_else(|| self.default_folder(&config));
        if self.batch.is_none() {
            // A resumed study keeps its batch size.
            let resumed = workers.is_none() || has_begun(&dir);
            let old = read_config(&dir).ok().filter(|_| resumed).map(|config| config.batch);
            config.batch = old.or(workers).unwrap_or(DEFAULT_BATCH).clamp(1, LARGEST_BATCH);
        }
        Ok((setup, config, dir))
    }

    /// Returns `results/<task>-<optimizer>-seed<seed>`; the other options that define the study follow the task, so
    /// that different studies have different folders.
    fn default_folder(&self, config: &StudyConfig) -> PathBuf {
        let setup = &self.setup;
        let safe = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' };
        let word = |name: &str| -> String {
            let stem = Path::new(name).file_stem().and_then(OsStr::to_str).unwrap_or(name);
            stem.chars().map(safe).collect()
        };
        // In the name of the folder a plus sign separates the tasks.
        let tasks = config.tasks().map(|name| name.chars().map(safe).collect::<String>());
        let custom = |name: &str, default: &str| (name != default).then(|| word(name));
        let given = |name: &Option<String>| name.as_deref().map(word);
        let other =
            |name: &Option<String>, default| name.as_deref().and_then(|name| custom(name, default));
        let words = [
            Some(tasks.collect::<Vec<_>>().join("+")),
            custom(&setup.space, DEFAULT_SPACE),
            custom(&self.objective.to_string(), "range"),
            other(&setup.robot, DEFAULT_ROBOT),
            given(&setup.cell),
            given(&setup.stiffness_data),
            setup.finger_model.kind.and_then(|kind| custom(&insertion::value_name(kind), "paper")),
            custom(&setup.finger_model.finger, DEFAULT_FINGER),
            other(&self.uncertainty, DEFAULT_UNCERTAINTY),
            given(&self.measurements),
        ];
        let limits =
            self.constraints.iter().map(|limit| limit.to_string().chars().map(safe).collect());
        let task = words.into_iter().flatten().chain(limits).collect::<Vec<_>>().join("-");
        Path::new("results").join(study_name(&task, &config.method(), config.seed))
    }

    /// Returns the aggregation over several tasks; `None` for one task.
    fn aggregate(&self, tasks: usize) -> Result<Option<Aggregate>, Failure> {
        let given = self.aggregate.unwrap_or(AggregateKind::Min);
        if tasks == 1 && (self.aggregate.is_some() || !self.weights.is_empty()) {
            let problem =
                "--aggregate and --weights need several tasks, for example --task usb,rj45";
            return Err(Failure::usage(problem));
        }
        if given != AggregateKind::Weighted && !self.weights.is_empty() {
            return Err(Failure::usage("--weights needs --aggregate weighted"));
        }
        let aggregate = match given {
            AggregateKind::Min => Aggregate::Min,
            AggregateKind::Mean => Aggregate::Mean,
            AggregateKind::Weighted => Aggregate::weighted(self.weights.clone(), tasks)
                .map_err(|problem| Failure::usage(format!("--weights: {problem}")))?,
        };
        Ok((tasks > 1).then_some(aggregate))
    }

    /// Returns the constraints; if the space changes the task, also the force limit of the connectors.
    fn constraints(&self, setup: &Setup) -> Vec<Constraint> {
        let mut constraints = self.constraints.clone();
        let bounded = constraints.iter().any(|constraint| constraint.measure == Measure::PeakForce);
        // A bench prediction contains no forces.
        if setup.space.changes_task() && !bounded && setup.measured.is_none() {
            let templates = setup.evaluator.templates.iter();
            let forces = templates.filter_map(|template| template.task.limits.force);
            let limit = forces.reduce(f64::min);
            let at_most =
                |limit| Constraint { measure: Measure::PeakForce, bound: Bound::AtMost, limit };
            constraints.extend(limit.map(at_most));
        }
        constraints
    }

    fn config(&self, setup: &Setup) -> Result<StudyConfig, Failure> {
        let evaluator = &setup.evaluator;
        let names = evaluator.templates.iter().map(|template| template.task.name.clone());
        let tasks: Vec<String> = names.collect();
        let mut config = StudyConfig {
            aggregate: self.aggregate(tasks.len())?,
            tasks,
            robot: evaluator.robot.name.clone(),
            finger_model: evaluator.fingers.kind(),
            optimizer: self.optimizer.to_string(),
            objective: self.objective.clone(),
            constraints: self.constraints(setup),
            uncertainty: setup.uncertainty.as_ref().map(|errors| errors.name.clone()),
            race: false,
            seed: self.seed,
            indifference_mm: self.indifference_mm,
            budget: self.budget.unwrap_or(DEFAULT_BUDGET),
            settles: false,
            confirmation: Confirmation::Expected,
            polish: self.polish,
            batch: self.batch.unwrap_or(DEFAULT_BATCH),
            asynchronous: self.asynchronous,
            conclusion: self.run.analyses(setup, None),
            provenance: setup.provenance(),
            space: setup.space.clone(),
        };
        config.race = config.can_race();
        Ok(config)
    }
}
