//! Do the accelerated window search and the production settings find the windows
//! that the plain outward scan and the finest settings find?
//!
//! ```text
//! cargo run --release --example window_search -- searches > results/reference/window_search.csv
//! cargo run --release --example window_search -- settings > results/reference/window_settings.csv
//! cargo run --release --example window_search -- maps > results/reference/window_maps.csv
//! ```
//!
//! Both run the 11 measured designs of `data/measured_stiffness.csv`, at their
//! measured stiffness, on the 4 tasks with the robot `servo`. `searches` compares
//! the default search with the scan, `settings` the production settings with steps
//! of 25 us. A summary goes to standard error. `maps` prints the outcome
//! of every offset from 0.5 mm below to 0.5 mm above the window of the default search,
//! `steps` the window of one design at several steps.

use finger_opt::evaluation::tolerance::{self, Search};
use finger_opt::evaluation::{Evaluation, Window, grid_mm};
use finger_opt::finger::Finger;
use finger_opt::input::robot::Robot;
use finger_opt::input::shipped::{ROBOTS, STIFFNESS, TASKS};
use finger_opt::input::stiffness;
use finger_opt::input::stiffness::Measurement;
use finger_opt::input::task::Task;
use finger_opt::outcome::Outcome;
use finger_opt::physics::direct::Direct;
use finger_opt::trial::run::EngineRig;
use finger_opt::trial::{Conditions, Grasped, Rig, Trial};
use finger_opt::verify::agreement;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::error::Error;
use std::sync::Mutex;

/// Step of the reference settings, s.
const REFERENCE_STEP_S: f64 = 2.5e-5;

/// Steps whose windows are compared with each other, s.
const STEPS_S: [f64; 6] = [5e-4, 3.5e-4, 2.5e-4, 1e-4, 5e-5, REFERENCE_STEP_S];

type Fallible<T> = Result<T, Box<dyn Error>>;

fn main() -> Fallible<()> {
    let mode = std::env::args().nth(1).unwrap_or_default();
    let robot = shipped_robot("servo")?;
    let only = std::env::args().nth(2);
    let tasks = TASKS
        .iter()
        .filter(|file| only.as_ref().is_none_or(|name| name == file.name))
        .map(|file| Ok(Task::parse(file.text, file.file)?))
        .collect::<Fallible<Vec<Task>>>()?;
    let measured = STIFFNESS.first().ok_or("no measurements are shipped")?;
    let designs = stiffness::parse(measured.text, measured.file)?;
    let cases: Vec<(&Task, &Measurement)> =
        tasks.iter().flat_map(|task| designs.iter().map(move |design| (task, design))).collect();
    let compare = match mode.as_str() {
        "searches" => searches as fn(&Task, &Robot, &Finger) -> Pair,
        "settings" => settings,
        "maps" => {
            print_maps(&cases, &robot);
            return Ok(());
        }
        "steps" => {
            print_steps(&cases, &robot);
            return Ok(());
        }
        _ => return Err("give `searches`, `settings`, `maps` or `steps`".into()),
    };
    let pairs: Vec<Pair> = cases
        .par_iter()
        .map(|(task, design)| {
            let pair = compare(task, &robot, &agreement::finger(&task.finger, design));
            eprintln!("{} {}: {}", task.name, design.design, pair.csv());
            pair
        })
        .collect();
    println!("task,design,{HEADER}");
    for ((task, design), pair) in cases.iter().zip(&pairs) {
        println!("{},{},{}", task.name, design.design, pair.csv());
    }
    summarise(&pairs);
    Ok(())
}

fn shipped_robot(name: &str) -> Fallible<Robot> {
    let file = ROBOTS.iter().find(|file| file.name == name).ok_or("no such robot")?;
    Ok(Robot::parse(file.text, file.file)?)
}

/// One design measured in two ways, the second being the one to trust.
struct Pair {
    tried: Evaluation,
    trusted: Evaluation,
}

const HEADER: &str = "negative_mm,positive_mm,end_negative,end_positive,trials,\
    trusted_negative_mm,trusted_positive_mm,trusted_end_negative,trusted_end_positive,\
    trusted_trials,range_difference_mm";

impl Pair {
    fn csv(&self) -> String {
        let side = |evaluation: &Evaluation| {
            let window = &evaluation.window;
            format!(
                "{:.1},{:.1},{},{},{}",
                window.negative_mm(),
                window.positive_mm(),
                label(window.end_negative),
                label(window.end_positive),
                evaluation.trials
            )
        };
        let difference = self.difference_mm();
        format!("{},{},{difference:.1}", side(&self.tried), side(&self.trusted))
    }

    fn difference_mm(&self) -> f64 {
        self.tried.window.range_mm() - self.trusted.window.range_mm()
    }
}

/// `0` nothing, `1` to `4` a failure class, `diverged`.
fn label(end: Option<Outcome>) -> String {
    match end {
        Some(Outcome::Failed(class)) => class.number().to_string(),
        Some(Outcome::Diverged) => "diverged".to_owned(),
        Some(Outcome::Inserted) | None => "0".to_owned(),
    }
}

fn summarise(pairs: &[Pair]) {
    let ends = |w: &Window| (w.negative_steps, w.positive_steps);
    let same = |pair: &&Pair| ends(&pair.tried.window) == ends(&pair.trusted.window);
    let differences: Vec<f64> = pairs.iter().map(|pair| pair.difference_mm().abs()).collect();
    let total = |of: fn(&Pair) -> u32| pairs.iter().map(of).sum::<u32>();
    eprintln!(
        "{} pairs: both ends identical in {}; range differs by {:.3} mm in the mean, {:.1} mm at \
         most; {} trials against {}",
        pairs.len(),
        pairs.iter().filter(same).count(),
        differences.iter().sum::<f64>() / pairs.len() as f64,
        differences.iter().copied().fold(0.0, f64::max),
        total(|pair| pair.tried.trials),
        total(|pair| pair.trusted.trials),
    );
}

/// The default search and the scan, on the same trials.
fn searches(task: &Task, robot: &Robot, finger: &Finger) -> Pair {
    let rig = rig(task, robot, None);
    let remembering = Remembering { rig: &rig, known: Mutex::default() };
    Pair {
        tried: tolerance::evaluate(&remembering, finger, Search::default()),
        trusted: tolerance::evaluate(&remembering, finger, Search::Walk),
    }
}

/// The production settings, and the same search at fine steps: the searches agree.
fn settings(task: &Task, robot: &Robot, finger: &Finger) -> Pair {
    let (tried, trusted) = (rig(task, robot, None), rig(task, robot, Some(REFERENCE_STEP_S)));
    Pair {
        tried: tolerance::evaluate(&tried, finger, Search::default()),
        trusted: tolerance::evaluate(&trusted, finger, Search::default()),
    }
}

/// One row for each pair: the first offset, and a character for each offset.
fn print_maps(cases: &[(&Task, &Measurement)], robot: &Robot) {
    let rows: Vec<String> = cases
        .par_iter()
        .map(|(task, design)| {
            let (rig, finger) = (rig(task, robot, None), agreement::finger(&task.finger, design));
            let window = tolerance::evaluate(&rig, &finger, Search::default()).window;
            let grasped = rig.grasp(&finger);
            let from = window.negative_steps - 5;
            let outcomes: String = (from..=window.positive_steps + 5)
                .map(|step| match grasped.trial(tolerance::offset(step)).outcome {
                    Outcome::Inserted => ".".to_owned(),
                    failure => label(Some(failure)),
                })
                .collect();
            format!("{},{},{:.1},{outcomes}", task.name, design.design, grid_mm(from))
        })
        .collect();
    println!("task,design,from_mm,outcomes\n{}", rows.join("\n"));
}

/// The default search's window at several steps, for the fifth measured design.
fn print_steps(cases: &[(&Task, &Measurement)], robot: &Robot) {
    println!("task,design,step_s,negative_mm,positive_mm,end_negative,end_positive");
    for (task, design) in cases.iter().filter(|(_, design)| design.design == 5) {
        let rows: Vec<String> = STEPS_S
            .par_iter()
            .map(|&step_s| {
                let rig = rig(task, robot, Some(step_s));
                let window = tolerance::evaluate(
                    &rig,
                    &agreement::finger(&task.finger, design),
                    Search::default(),
                )
                .window;
                let (from, to) = (window.negative_mm(), window.positive_mm());
                let ends = [window.end_negative, window.end_positive].map(label);
                format!("{step_s},{from:.1},{to:.1},{},{}", ends[0], ends[1])
            })
            .collect();
        for row in rows {
            println!("{},{},{row}", task.name, design.design);
        }
    }
}

fn rig(task: &Task, robot: &Robot, step_s: Option<f64>) -> EngineRig {
    let mut engine = Direct::default();
    engine.settings.step_s = step_s.unwrap_or(engine.settings.step_s);
    EngineRig::new(task.clone(), robot, Box::new(engine)).expect("a shipped robot")
}

/// A rig that runs no trial of its one finger twice.
struct Remembering<'a> {
    rig: &'a EngineRig,
    /// By the bits of the offset.
    known: Mutex<BTreeMap<u64, Trial>>,
}

impl Rig for Remembering<'_> {
    fn grasp_in(&self, finger: &Finger, conditions: &Conditions) -> Box<dyn Grasped + '_> {
        let grasped = self.rig.grasp_in(finger, conditions);
        Box::new(RememberingGrasp { grasped, known: &self.known })
    }
}

struct RememberingGrasp<'a> {
    grasped: Box<dyn Grasped + 'a>,
    known: &'a Mutex<BTreeMap<u64, Trial>>,
}

impl Grasped for RememberingGrasp<'_> {
    fn trial(&self, offset: f64) -> Trial {
        let lookup = |trial: Option<Trial>| match self.known.lock() {
            Ok(mut known) => match trial {
                Some(trial) => known.insert(offset.to_bits(), trial),
                None => known.get(&offset.to_bits()).cloned(),
            },
            Err(_) => None,
        };
        lookup(None).unwrap_or_else(|| {
            let trial = self.grasped.trial(offset);
            lookup(Some(trial.clone()));
            trial
        })
    }
}
