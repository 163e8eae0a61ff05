//! `lab prints`: post hoc choice of prints on the published experiments.

use super::{Failure, print, print_json};
use crate::prints::{self, Replayed, TOLD};
use clap::Args;
use finger_opt::calibration::sampler::{Effort, Settings};
use finger_opt::cli::arguments::CalibrationArguments;
use finger_opt::cli::terminal::simulating;
use finger_opt::session::{DEFAULT_ROBOT, FingerModelRequest, Prepared, SetupRequest, TaskSource};
use insertion::trial::NEVER;
use insertion::trial::engine::EngineKind;
use serde_json::json;

/// Sampling effort at each of the many prints.
const EFFORT: Effort = Effort { warm_up: 200, samples: 150, thin: 3 };

/// Ways of choosing prints, in the order of the table.
const METHODS: [&str; 4] = ["ours", "random", "gp", "simulation"];

/// Replay the choice of prints on the published experiments: ours, random, a Gaussian process
/// without simulation, and the order of simulation alone.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Tasks, by commas
    #[arg(long, value_name = "NAME", default_value = "ket8,ket12,rj45,usb")]
    task: String,
    /// Robot: see `optimize tasks`, or the path of a robot file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT)]
    robot: String,
    /// Contact engine
    #[arg(long, value_enum, default_value_t)]
    engine: EngineKind,
    #[command(flatten)]
    finger_model: FingerModelRequest,
    /// Seeds that ours is averaged over
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u64).range(1..=1000))]
    seeds: u64,
    #[command(flatten)]
    calibration: CalibrationArguments,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Results of each method on a task.
struct TaskReplay {
    task: String,
    fingers: usize,
    methods: Vec<Replayed>,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let setup = SetupRequest {
        tasks: TaskSource::list(&arguments.task),
        robot: arguments.robot.clone(),
        engine: arguments.engine,
        finger_model: arguments.finger_model.clone(),
        ..SetupRequest::default()
    };
    let request = arguments.calibration.request(setup, "published");
    let mut watch = simulating(arguments.json);
    let prepared = request.prepare(&[], &NEVER, &mut watch)?;
    let tasks = (0..prepared.subjects.len())
        .map(|task| arguments.replay(&prepared, task))
        .collect::<Result<Vec<_>, Failure>>()?;
    let means: Vec<Option<Replayed>> = (0..METHODS.len())
        .map(|i| Replayed::averaged(&tasks.iter().map(|task| task.methods[i]).collect::<Vec<_>>()))
        .collect();
    if arguments.json { print_json(&to_json(&tasks, &means)) } else { print(&text(&tasks, &means)) }
}

impl Arguments {
    /// Results on one task alone: a shared parameter must not carry the answer to another task.
    fn replay(&self, prepared: &Prepared, task: usize) -> Result<TaskReplay, Failure> {
        let subject = &prepared.subjects[task];
        let nothing = || Failure::usage(format!("{}: nothing is published of it", subject.task));
        let whole = subject
            .experiments
            .iter()
            .filter_map(|(number, line)| Some((*number, line.range_mm()?)));
        let (fingers, ranges): (Vec<usize>, Vec<f64>) = whole.unzip();
        let bench = prepared.layout.benches(&prepared.subjects).swap_remove(task);
        let settings = Settings { effort: EFFORT, seed: self.calibration.seed };
        let dimension = prepared.layout.dimension();
        let simulated = prepared.simulate(task, &fingers)?;
        let methods = [
            prints::advised(&bench, dimension, &fingers, &ranges, &settings, self.seeds),
            (!ranges.is_empty()).then(|| prints::random(&ranges)),
            prints::without_simulation(&bench, &fingers, &ranges, &settings),
            prints::by_simulation(&simulated, &ranges),
        ];
        let methods = methods.into_iter().collect::<Option<Vec<_>>>().ok_or_else(nothing)?;
        Ok(TaskReplay { task: subject.task.clone(), fingers: fingers.len(), methods })
    }
}

fn to_json(tasks: &[TaskReplay], means: &[Option<Replayed>]) -> serde_json::Value {
    let method = |(name, replayed): (&&str, &Replayed)| {
        let Replayed { prints_to_best, regret_percent_after } = replayed;
        json!({
            "method": name,
            "prints_to_best": prints_to_best,
            "regret_percent_after": regret_percent_after,
        })
    };
    let task = |TaskReplay { task, fingers, methods }: &TaskReplay| {
        let methods: Vec<_> = METHODS.iter().zip(methods).map(method).collect();
        json!({ "task": task, "designs": fingers, "methods": methods })
    };
    let means: Vec<_> = METHODS.iter().zip(means.iter().flatten()).map(method).collect();
    json!({ "tasks": tasks.iter().map(task).collect::<Vec<_>>(), "mean": means })
}

fn text(tasks: &[TaskReplay], means: &[Option<Replayed>]) -> String {
    let mut text = format!(
        "what the best printed finger lacks to the best measured one, percent, after 1 to {TOLD} prints\n\
         task     chosen by    prints to the best       1       2       3       4\n"
    );
    let of_tasks = tasks.iter().flat_map(|of| {
        METHODS.iter().zip(&of.methods).map(|(method, replayed)| (&*of.task, method, replayed))
    });
    let means = METHODS.iter().zip(means.iter().flatten());
    let means = means.map(|(method, replayed)| ("mean", method, replayed));
    for (task, method, Replayed { prints_to_best, regret_percent_after }) in of_tasks.chain(means) {
        let regrets = regret_percent_after.map(|regret| format!("{regret:>8.1}")).concat();
        text += &format!("{task:<8} {method:<12} {prints_to_best:>18.1}{regrets}\n");
    }
    text
}
