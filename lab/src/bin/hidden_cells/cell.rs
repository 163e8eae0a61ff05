//! Cells with randomly drawn parameters, and the windows of the measured fingers in them.

use ask_tell::stream::stream;
use finger_opt::failure::Failure;
use input::shipped::PRIORS;
use insertion::evaluation::cell::Priors;
use insertion::evaluation::evaluator::{Evaluator, Scenario};
use insertion::evaluation::taught::{Shifted, TaughtStart, teach};
use insertion::evaluation::template::Template;
use insertion::evaluation::tolerance::{self, Search};
use insertion::evaluation::{Evaluation, OffsetStep, grid_mm};
use insertion::outcome::Outcome;
use insertion::space::Design;
use insertion::stiffness::Measurement;
use insertion::trial::NEVER;
use insertion::trial::engine::EngineKind;
use parameters::Parameter;
use rand::RngExt;
use std::time::Instant;

/// Seed of the streams that cells are drawn from.
const SEED: u64 = 0;
/// Infill, percent and degrees, of the middle finger: a cell in which it inserts from no start is drawn again.
const MIDDLE: [f64; 2] = [20.0, 20.0];
const MAX_DRAWS: u32 = 100;
/// Hidden values: names in the shipped priors, and columns of the tables.
pub const HIDDEN: [(&str, &str); 5] = [
    ("friction plug-socket", "friction_plug_socket"),
    ("stiffness of the flange", "flange_stiffness_factor"),
    ("preload", "preload_mm"),
    ("torsion of the pad", "pad_torsion_mm"),
    ("radius of the edges", "edge_radius_mm"),
];

/// Robot cell with parameter values that the identification does not use.
pub struct HiddenCell<'a> {
    /// Number from 1; odd cells have the first task, even ones the second.
    pub number: u64,
    /// Number of draws until the middle finger inserted.
    draws: u32,
    pub evaluator: &'a Evaluator,
    /// Task with the values of its file.
    pub template: &'a Template,
    /// Priors of [`HIDDEN`] and the drawn values: factors on the nominal ones, and the radius in mm.
    hidden: Vec<(Parameter, f64)>,
}

impl<'a> HiddenCell<'a> {
    pub fn draw(evaluator: &'a Evaluator, number: u64) -> Result<Self, Failure> {
        let template = &evaluator.templates[(number + 1) as usize % evaluator.templates.len()];
        let priors = Priors::parse(PRIORS[0].text, PRIORS[0].file).map_err(Failure::input)?;
        let mut random = stream(SEED, number, "hidden cell");
        for draws in 1..=MAX_DRAWS {
            let named = HIDDEN.iter().filter_map(|(name, _)| {
                priors.parameters.iter().find(|parameter| parameter.name == *name)
            });
            let hidden = named.map(|prior| (prior.clone(), prior.at(random.random()))).collect();
            let cell = HiddenCell { number, draws, evaluator, template, hidden };
            let scenario = cell.setup(&Design::infill(MIDDLE[0], MIDDLE[1]))?;
            if window(&scenario, EngineKind::Direct, None)?.is_some() {
                return Ok(cell);
            }
        }
        Err(Failure::running(format!("cell {number}: nothing inserts in {MAX_DRAWS} draws")))
    }

    /// Returns the finger of a design, with task and robot of the cell.
    pub fn setup(&self, design: &Design) -> Result<Scenario, Failure> {
        let values: Vec<_> = self.hidden.iter().map(|(prior, value)| (prior, *value)).collect();
        self.evaluator.apply(self.template, (design, None), &values).map_err(Failure::input)
    }

    /// Returns the hidden values in the units of the columns; the flange's stiffness as a factor.
    pub fn shown(&self) -> impl Iterator<Item = f64> {
        let nominal = |prior: &Parameter| self.template.numbers.number(&prior.path).unwrap_or(1.0);
        self.hidden.iter().map(move |(prior, value)| nominal(prior) * value)
    }
}

/// Windows of a measured finger in a cell.
pub struct FingerWindows {
    pub finger: Measurement,
    /// Windows in MuJoCo, in the engine `direct`, and in `direct` with the nominal cell, that of the files.
    windows: [Option<TaughtStart>; 3],
    /// Whether the start that was taught in `direct` fails in MuJoCo, where another is then taught.
    taught_again: bool,
    /// Duration of the simulations in MuJoCo.
    elapsed_s: f64,
}

impl FingerWindows {
    pub fn simulate(
        cell: &HiddenCell<'_>,
        finger: &Measurement,
        engine: EngineKind,
    ) -> Result<Self, Failure> {
        let design = Design::infill(finger.density_percent, finger.direction_deg);
        let scenario = cell.setup(&design)?;
        let direct = window(&scenario, EngineKind::Direct, None)?;
        let clock = Instant::now();
        let near = direct.as_ref().map_or(0, |taught| taught.shift);
        let truth = window(&scenario, engine, Some(near))?;
        let elapsed_s = clock.elapsed().as_secs_f64();
        let nominal = cell.evaluator.apply(cell.template, (&design, None), &[]);
        let scenario = nominal.map_err(Failure::input)?;
        let nominal = window(&scenario, EngineKind::Direct, None)?;
        let taught_again = truth.as_ref().is_none_or(|truth| truth.shift != near);
        let windows = [truth, direct, nominal];
        Ok(FingerWindows { finger: *finger, windows, taught_again, elapsed_s })
    }

    /// Returns the tolerable range in a simulation, an index of `SIMULATIONS`, mm; 0 if no start inserts.
    pub fn range_mm(&self, simulation: usize) -> f64 {
        self.windows[simulation].as_ref().map_or(0.0, |taught| taught.evaluation.window.range_mm())
    }

    /// Returns the taught start and both ends in MuJoCo, mm from the task's own start.
    pub fn starts_mm(&self) -> [f64; 3] {
        self.windows[0].as_ref().map_or([0.0; 3], starts_mm)
    }

    /// Returns the line of `truth.csv`.
    pub fn line(&self, cell: &HiddenCell<'_>) -> String {
        let Measurement { design, density_percent, direction_deg, .. } = self.finger;
        let shown = cell.shown().map(|value| format!("{value:.4},")).collect::<String>();
        let windows =
            self.windows.each_ref().map(|taught| taught.as_ref().map_or(",,,0,,".into(), cells));
        format!(
            "{},{design},{},{},{shown}{density_percent},{direction_deg},{},{},{:.1}\n",
            cell.number,
            cell.template.task.name,
            cell.draws,
            windows.join(","),
            u8::from(self.taught_again),
            self.elapsed_s
        )
    }
}

fn starts_mm(taught: &TaughtStart) -> [f64; 3] {
    let TaughtStart { shift, evaluation: Evaluation { window, .. } } = taught;
    [*shift, shift + window.negative_steps, shift + window.positive_steps].map(grid_mm)
}

fn cells(taught: &TaughtStart) -> String {
    let [start, negative, positive] = starts_mm(taught);
    let window = &taught.evaluation.window;
    let [below, above] = [window.end_negative, window.end_positive].map(|end| match end {
        Some(Outcome::Failed(class)) => class.number().to_string(),
        Some(other) => other.word().to_owned(),
        None => String::new(),
    });
    format!("{start},{negative},{positive},{},{below},{above}", window.range_mm())
}

/// Determines the window around the start `near`, in grid steps, or, if that does not insert, around the taught start;
/// `None` if no start inserts.
pub fn window(
    scenario: &Scenario,
    engine: EngineKind,
    near: Option<OffsetStep>,
) -> Result<Option<TaughtStart>, Failure> {
    let Scenario { task, finger, robot, .. } = scenario;
    let rig = engine.rig(task, robot, finger, 1.0).map_err(Failure::input)?;
    if let Some(shift) = near {
        let moved = Shifted { rig: &*rig, shift };
        let evaluation = tolerance::evaluate(&moved, finger, Search::Strides);
        if evaluation.window.nominal == Outcome::Inserted {
            return Ok(Some(TaughtStart { shift, evaluation }));
        }
    }
    Ok(teach(&*rig, finger, &NEVER).ok())
}
