//! Identification tried on cells whose unknowns are drawn and hidden: the truth in the other engine.

pub mod logs;
pub mod tried;
pub mod truth;

use ask_tell::stream::stream;
use finger_opt::failure::Failure;
use input::shipped::PRIORS;
use insertion::evaluation::cell::Priors;
use insertion::evaluation::evaluator::{Evaluator, Specimen};
use insertion::evaluation::taught::teach;
use insertion::evaluation::template::Template;
use insertion::robot::Robot;
use insertion::space::Design;
use insertion::trial::NEVER;
use insertion::trial::engine::EngineKind;
use parameters::Parameter;
use rand::RngExt;

/// Seed of the streams that cells are drawn from.
const SEED: u64 = 0;
/// The finger that has to insert from some start, or the cell is drawn again: percent, degrees.
const MIDDLE: [f64; 2] = [20.0, 20.0];
/// Draws of a cell after which something else is wrong.
const DRAWS: u32 = 100;
/// What is hidden, by the names of the shipped priors, and what a table calls it.
pub const HIDDEN: [(&str, &str); 5] = [
    ("friction plug-socket", "friction_plug_socket"),
    ("stiffness of the flange", "flange_stiffness_factor"),
    ("preload", "preload_mm"),
    ("torsion of the pad", "pad_torsion_mm"),
    ("radius of the edges", "edge_radius_mm"),
];

/// A cell with hidden values.
pub struct HiddenCell<'a> {
    /// Counted from 1; odd ones do the first task.
    pub number: u64,
    /// How often it was drawn until the middle finger inserted.
    pub draws: u32,
    /// Makes the fingers.
    pub evaluator: &'a Evaluator,
    /// Its task as the file has it.
    pub template: &'a Template,
    rows: Vec<Parameter>,
    /// Values of the priors, as of [`HIDDEN`]: factors, and the radius in mm.
    pub values: [f64; 5],
    /// The same as a table has them.
    pub shown: [f64; 5],
}

impl<'a> HiddenCell<'a> {
    /// The cell of that number; the tasks of the evaluator take turns.
    ///
    /// # Errors
    /// If a cell cannot be simulated.
    pub fn draw(evaluator: &'a Evaluator, number: u64) -> Result<Self, Failure> {
        let task = (number + 1) as usize % evaluator.templates.len();
        let template = &evaluator.templates[task];
        let rows = rows()?;
        let mut random = stream(SEED, number, "hidden cell");
        for draws in 1..=DRAWS {
            let [mut values, mut shown] = [[0.0; 5]; 2];
            for (i, row) in rows.iter().enumerate() {
                values[i] = row.at(random.random());
                shown[i] = template.numbers.number(&row.path).unwrap_or(1.0) * values[i];
            }
            let rows = rows.clone();
            let cell = HiddenCell { number, draws, evaluator, template, rows, values, shown };
            let (specimen, robot) = cell.setup(&Design::infill(MIDDLE[0], MIDDLE[1]))?;
            let rig = EngineKind::Direct.rig(&specimen.task, &robot, &specimen.finger, 1.0);
            if teach(&*rig.map_err(Failure::input)?, &specimen.finger, &NEVER).is_ok() {
                return Ok(cell);
            }
        }
        Err(Failure::running(format!("cell {number}: nothing inserts in {DRAWS} draws")))
    }

    /// A finger in the cell, and its robot.
    ///
    /// # Errors
    /// If it cannot be simulated there.
    pub fn setup(&self, design: &Design) -> Result<(Specimen, Robot), Failure> {
        let values: Vec<_> = self.rows.iter().zip(self.values).collect();
        self.evaluator.under(self.template, (design, None), &values).map_err(Failure::input)
    }

    /// The same in the cell as the files have it.
    ///
    /// # Errors
    /// If it cannot be simulated there.
    pub fn nominal(&self, design: &Design) -> Result<(Specimen, Robot), Failure> {
        self.evaluator.under(self.template, (design, None), &[]).map_err(Failure::input)
    }
}

/// The shipped priors of what is hidden.
fn rows() -> Result<Vec<Parameter>, Failure> {
    let file = PRIORS[0];
    let priors = Priors::parse(file.text, file.file).map_err(Failure::input)?;
    let row = |(name, _): &(&str, &str)| {
        let found = priors.parameters.iter().find(|row| row.name == *name).cloned();
        found.ok_or_else(|| Failure::running(format!("{}: has no row `{name}`", file.file)))
    };
    HIDDEN.iter().map(row).collect()
}
