//! `optimize validate --against bench`: our ranges with several finger models, and the
//! published simulation's, beside the experiments.

use super::{Arguments, calibrated, search_name};
use crate::cli::setup;
use crate::cli::{Failure, print, print_json};
use crate::evaluation::tolerance::Search;
use crate::finger::computed::{Kept, Touching};
use crate::finger::model::{ComputedFingers, FingerModelKind, FingerSource};
use crate::input::finger_file::FingerFile;
use crate::input::robot::Robot;
use crate::input::shipped::{AS_SOLD, FINGERS};
use crate::input::task::{PadTorsion, Task};
use crate::report::validation::calibrated_svg;
use crate::study::write_file;
use crate::verify::compare::fingers::Windows;
use crate::verify::compare::published::{Model, ModelTables, TaskTable, models_json, models_text};
use serde_json::json;

/// Models of ours, in the order of the output.
const OURS: [Model; 4] =
    [Model::Paper, Model::ComputedPad, Model::ComputedPadAndRoof, Model::Mechanisms];
/// The robot of `mechanisms`.
const UNDER_POSITION_CONTROL: &str = "ur5e_position";
/// Those that `--variants` adds.
const VARIANTS: [Model; 4] =
    [Model::PadInPlane, Model::PadAndRoofInPlane, Model::PadCoupled, Model::PadAndRoofCoupled];

/// Runs the command.
pub fn run(
    arguments: &Arguments,
    tasks: &[Task],
    robot: &Robot,
    search: Search,
) -> Result<(), Failure> {
    if arguments.finger_model.kind == Some(FingerModelKind::Computed) {
        let problem = "--against bench compares all finger models; leave out --finger-model";
        return Err(Failure::usage(problem));
    }
    let calibrated = match &arguments.calibrated {
        Some(dir) => calibrated::read(dir, tasks)?,
        None => Vec::new(),
    };
    let variants = if arguments.variants { &VARIANTS[..] } else { &[] };
    let real = setup::robot(UNDER_POSITION_CONTROL)?;
    let bench = tasks.iter().map(on_the_bench).collect::<Result<Vec<_>, _>>()?;
    let measured = OURS.iter().chain(variants).map(|&model| {
        let (tasks, robot) = match model {
            Model::Mechanisms => (&bench[..], &real),
            _ => (tasks, robot),
        };
        let phases = if model == Model::Paper { 1 } else { arguments.phases };
        let tables = (0..phases).map(|phase| {
            let share = f64::from(phase) / f64::from(phases);
            let fingers = fingers(model, &arguments.finger_model.finger, share)?;
            let teach = model != Model::Paper;
            let engine = arguments.engine;
            let windows = Windows { fingers: &fingers, robot, engine, search, teach };
            windows.measure(tasks, &arguments.fingers.designs()).map_err(Failure::input)
        });
        Ok((model, tables.collect::<Result<Vec<_>, Failure>>()?))
    });
    let measured = measured.collect::<Result<Vec<_>, Failure>>()?;
    let models: Vec<ModelTables> = (0..tasks.len()).flat_map(|at| of_task(&measured, at)).collect();
    let table = models_text(&models, &calibrated);
    let (robot, engine) = (&robot.name, arguments.engine.name());
    let phases = match arguments.phases {
        1 => String::new(),
        phases => format!("; median (smallest .. largest) of {phases} rib phases"),
    };
    let fitted = match calibrated.is_empty() {
        true => "nothing is fitted to the experiments",
        false => "only calibrated is fitted to experiments, each finger's own left out",
    };
    let text = format!(
        "our ranges and the published simulation's beside the published experiments\n\
         robot {robot}, engine {engine}, {}{phases}\n\
         mechanisms: robot {UNDER_POSITION_CONTROL}, pads by their pressed patch, rj45 and usb as sold\n\
         taught: starts moved to where the finger inserts, since the task's own does not\n\
         {fitted}\n\n{table}",
        search_name(search),
    );
    write_file(&arguments.out.join("against_bench.txt"), &text)?;
    if !calibrated.is_empty() {
        let svg = calibrated_svg(&calibrated);
        let svg = svg.map_err(|error| Failure::running(error.to_string()))?;
        write_file(&arguments.out.join("calibrated_against_bench.svg"), &svg)?;
    }
    let agreement = models_json(&models, &calibrated);
    let json = json!({ "robot": robot, "engine": engine, "agreement": agreement });
    if arguments.json { print_json(&json) } else { print(&text) }
}

/// A task as `mechanisms` has it, under the name by which its experiments are published.
fn on_the_bench(task: &Task) -> Result<Task, Failure> {
    let mut real = match AS_SOLD.iter().find(|sold| sold.name == task.name) {
        Some(sold) => Task::parse(sold.text, sold.file).map_err(Failure::input)?,
        None => task.clone(),
    };
    real.name.clone_from(&task.name);
    real.strategy.rule = task.strategy.rule;
    real.friction.finger_torsion = PadTorsion::Patch;
    Ok(real)
}

/// One entry for each rib phase: the tables of the tasks, and the starts taught for them.
type Phases = Vec<Vec<(TaskTable, usize)>>;

/// All models on one task; the published simulation, which every table holds, first.
fn of_task(measured: &[(Model, Phases)], at: usize) -> Vec<ModelTables> {
    let of = |(model, phases): &(Model, Phases)| ModelTables {
        model: *model,
        tables: phases.iter().map(|tasks| tasks[at].0.clone()).collect(),
        taught: phases.iter().map(|tasks| tasks[at].1).sum(),
    };
    let ours: Vec<ModelTables> = measured.iter().map(of).collect();
    let tables = ours.first().map_or(Vec::new(), |first| first.tables.clone());
    let published = ModelTables { model: Model::Published, tables, taught: 0 };
    std::iter::once(published).chain(ours).collect()
}

/// The fingers of a model, their ribs moved by a share of the pitch.
fn fingers(model: Model, file: &str, phase_share: f64) -> Result<FingerSource, Failure> {
    let kept = |coupling, across| Kept { coupling, across };
    let (touching, kept) = match model {
        Model::Published | Model::Paper => return Ok(FingerSource::Paper),
        Model::ComputedPad => (Touching::Pad, kept(false, true)),
        Model::ComputedPadAndRoof | Model::Mechanisms => (Touching::PadAndRoof, kept(false, true)),
        Model::PadInPlane => (Touching::Pad, kept(false, false)),
        Model::PadAndRoofInPlane => (Touching::PadAndRoof, kept(false, false)),
        Model::PadCoupled => (Touching::Pad, kept(true, true)),
        Model::PadAndRoofCoupled => (Touching::PadAndRoof, kept(true, true)),
    };
    let source = setup::find("finger", FINGERS, file)?;
    let file = FingerFile::parse(&source.text, &source.file).map_err(Failure::input)?;
    let mut fingers = ComputedFingers::new(file, touching);
    fingers.kept = kept;
    fingers.phase_share = phase_share;
    Ok(FingerSource::Computed(Box::new(fingers)))
}
