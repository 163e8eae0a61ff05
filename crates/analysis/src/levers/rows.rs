//! Which levers a task and a robot have, and between what values.

use super::measure::Question;
use connector::body::{ConvexBody, width};
use connector::seat::section;
use input::shipped::{LEVERS, PRIORS};
use input::units::{MM, N_PER_MM};
use insertion::evaluation::cell::{Parameter, Priors, Target, Way};
use insertion::evaluation::evaluator::Specimen;
use insertion::evaluation::template::Impossible;
use insertion::robot::{Drive, Robot};
use insertion::task::Task;

/// Rows of `priors/bench.toml` that a user can change; the others are what fingers and pads are.
const OF_BENCH: [&str; 5] = [
    "friction plug-socket",
    "preload",
    "stroke to the side",
    "clearance",
    "stiffness of the flange",
];
/// Rows of `priors/levers.toml` that come after all others.
const LAST: [&str; 2] = ["stroke to the front", "stroke to the back"];
/// Steps between the present value and a bound, of which the farthest that can be is taken.
const STEPS: u32 = 100;

/// A row with the present value, in the unit of what it sets.
pub struct Row {
    pub parameter: Parameter,
    pub value: f64,
}

/// A cell with one number changed.
pub struct Changed {
    /// The number, in its unit.
    pub value: f64,
    pub specimen: Specimen,
    pub robot: Robot,
}

/// The rows that question's task, finger and robot have; a key of the space keeps to its bounds there.
pub fn rows(question: &Question<'_>, task: &Task) -> Result<Vec<Row>, Impossible> {
    let own = Priors::parse(LEVERS.text, LEVERS.file)?.parameters;
    let bench = Priors::parse(PRIORS[0].text, PRIORS[0].file)?.parameters;
    let bench = bench.into_iter().filter(|row| OF_BENCH.contains(&&*row.name));
    let (last, first): (Vec<_>, Vec<_>) =
        own.into_iter().partition(|row| LAST.contains(&&*row.name));
    let row = |mut parameter: Parameter| {
        let value = present(question, task, &parameter.sets)?;
        let key = parameter.sets.key();
        if let Some(of) = question.space.parameters.iter().find(|of| of.key == key) {
            let source = format!("the space `{}`: {}", question.space.name, of.source);
            let (low, high) = (of.low, of.high);
            parameter = Parameter { way: Way::Value, low, high, source, ..parameter };
        }
        Some(Row { parameter, value })
    };
    Ok(first.into_iter().chain(bench).chain(last).filter_map(row).collect())
}

/// The present value of what a lever sets; `None` if there is no such thing here.
fn present(question: &Question<'_>, task: &Task, sets: &Target) -> Option<f64> {
    let Question { evaluator, template, design, .. } = question;
    match sets {
        Target::Number(key) => design.get(key).or_else(|| evaluator.number(template, key)),
        Target::Clearance => Some(clearance(task) / MM),
        Target::Chamfer => Some(0.0),
        Target::Flange => match &evaluator.robot.drive {
            Drive::Servo(servo) => Some(servo.stiffness[0] / N_PER_MM),
            Drive::Ideal | Drive::Arm(_) => None,
        },
        Target::Edges | Target::Stiffness | Target::Tilting | Target::Centre => None,
    }
}

/// Width of the opening less that of the plug that goes in, the smaller of x and y, m.
fn clearance(task: &Task) -> f64 {
    let plug = section(&ConvexBody::plug(&task.plug), task.success.depth);
    let free = |axis: usize| width(task.opening[axis]) - width(plug[axis]);
    free(0).min(free(1))
}

impl Row {
    /// The cell at the lower (0) or upper (1) bound, or as far on the way to it as can be.
    pub fn at(&self, question: &Question<'_>, end: usize) -> Option<Changed> {
        let Parameter { way, low, high, .. } = self.parameter;
        let neutral = match way {
            Way::Factor => 1.0,
            Way::Shift => 0.0,
            Way::Value => self.value,
        };
        let bound = if end == 0 { low.min(neutral) } else { high.max(neutral) };
        let part = |steps: u32| {
            let to = neutral + f64::from(steps) / f64::from(STEPS) * (bound - neutral);
            self.changed(question, to)
        };
        if let Some(whole) = part(STEPS) {
            return Some(whole);
        }
        // Possible at `can`, impossible at `cannot`.
        let (mut can, mut cannot) = (0, STEPS);
        while cannot - can > 1 {
            let middle = (can + cannot) / 2;
            if part(middle).is_some() { can = middle } else { cannot = middle }
        }
        part(can)
    }

    fn changed(&self, question: &Question<'_>, to: f64) -> Option<Changed> {
        let Question { evaluator, template, design, given, .. } = question;
        let value = self.parameter.applied(self.value, to);
        if self.parameter.sets == Target::Clearance && value < self.value.min(0.0) {
            return None;
        }
        let set = [(&self.parameter, to)];
        let (specimen, robot) = evaluator.under(template, (design, *given), &set).ok()?;
        evaluator.engine.rig(&specimen.task, &robot, &specimen.finger, 1.0).ok()?;
        Some(Changed { value, specimen, robot })
    }
}
