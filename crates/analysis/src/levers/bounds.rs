//! Levers of a task and a robot, with their bounds.

use super::measure::LeverAnalysis;
use connector::body::{ConvexBody, width};
use connector::seat::section;
use input::shipped::{LEVERS, PRIORS};
use input::units::MM;
use insertion::{DesignError, Priors, Scenario, Task};
use parameters::numbers::{CLEARANCE, Kind};
use parameters::plan::one_at_a_time::farthest;
use parameters::{Parameter, Path, Transform};

/// Names of the parameters of `priors/bench.toml` that a user can change; the others belong to fingers and pads.
const OF_BENCH: [&str; 5] = [
    "friction plug-socket",
    "preload",
    "stroke to the side",
    "clearance",
    "stiffness of the flange",
];
/// Names of the parameters of `priors/levers.toml` that come last, and are the first to be left out at the limit on
/// windows.
const LAST: [&str; 2] = ["stroke to the front", "stroke to the back"];

/// Parameter of a lever, with its current value in the unit of its path.
pub struct LeverParameter {
    pub parameter: Parameter,
    pub value: f64,
}

/// Returns the parameters of the levers that task, finger and robot have. Bounds of the space take precedence over
/// those of the shipped files.
pub fn lever_parameters(
    analysis: &LeverAnalysis<'_>,
    scenario: &Scenario,
) -> Result<Vec<LeverParameter>, DesignError> {
    let own = Priors::parse(LEVERS[0].text, LEVERS[0].file)?.parameters;
    let bench = Priors::parse(PRIORS[0].text, PRIORS[0].file)?.parameters;
    let bench = bench.into_iter().filter(|row| OF_BENCH.contains(&&*row.name));
    let (last, first): (Vec<_>, Vec<_>) =
        own.into_iter().partition(|row| LAST.contains(&&*row.name));
    let with_value = |mut parameter: Parameter| {
        let value = current_value(analysis, scenario, &parameter.path)?;
        if let Some(of) = analysis.space.parameters.iter().find(|of| of.key == parameter.path) {
            let source = format!("the space `{}`: {}", analysis.space.name, of.source);
            let source = source.trim_end_matches(": ").to_owned();
            let (low, high) = (of.low, of.high);
            parameter = Parameter { transform: Transform::Value, low, high, source, ..parameter };
        }
        Some(LeverParameter { parameter, value })
    };
    Ok(first.into_iter().chain(bench).chain(last).filter_map(with_value).collect())
}

/// Returns the current value of the parameter with a path; `None` if task, finger and robot do not have it.
fn current_value(analysis: &LeverAnalysis<'_>, scenario: &Scenario, path: &Path) -> Option<f64> {
    let LeverAnalysis { evaluator, template, design, .. } = analysis;
    match path.kind() {
        Kind::File => design.get(path).or_else(|| evaluator.number(template, path)),
        Kind::Added if *path == CLEARANCE => Some(clearance(&scenario.task) / MM),
        Kind::Added => Some(0.0),
        Kind::Robot => evaluator.robot.number(path),
        Kind::Finger => {
            let mut finger = scenario.finger;
            finger.number(path).map(|(number, unit)| *number / unit)
        }
        Kind::Infill | Kind::Springs | Kind::Error | Kind::Fixed => None,
    }
}

/// Returns the clearance, m: width of the opening minus that of the plug at the depth of success, the smaller of x and
/// y.
fn clearance(task: &Task) -> f64 {
    let plug = section(&ConvexBody::plug(&task.plug), task.success.depth);
    let free = |axis: usize| width(task.opening[axis]) - width(plug[axis]);
    free(0).min(free(1))
}

impl LeverParameter {
    /// Returns value and scenario at a bound (the upper one if `upper`), or at the feasible value nearest to it.
    pub fn at(&self, analysis: &LeverAnalysis<'_>, upper: bool) -> Option<(f64, Scenario)> {
        let LeverAnalysis { evaluator, template, design, given, .. } = analysis;
        let changed = |to: f64| {
            let value = self.parameter.applied(self.value, to);
            // A negative clearance (interference) is infeasible unless the task has it already.
            if self.parameter.path == CLEARANCE && value < self.value.min(0.0) {
                return None;
            }
            let set = [(&self.parameter, to)];
            let scenario = evaluator.apply(template, (design, *given), &set).ok()?;
            evaluator.rig(&scenario, None, 1.0).ok()?;
            Some((value, scenario))
        };
        farthest(&self.parameter, self.value, upper, changed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use finray::printed::PrintedFinger;
    use input::shipped::{FINGERS, ROBOTS, SPACES, STIFFNESS, TASKS};
    use insertion::evaluation::{evaluator::Evaluator, template::Template};
    use insertion::finger::model::FingerSource;
    use insertion::space::{Design, Space};
    use insertion::{robot::Robot, stiffness, surrogate, trial::engine::EngineKind};
    use parameters::numbers::{RCC_KEY, TILTING_KEY};

    #[test]
    fn a_spring_of_the_finger_has_a_current_value() {
        let measured = stiffness::parse(STIFFNESS[0].text, STIFFNESS[0].file).unwrap();
        let printed = PrintedFinger::parse(FINGERS[0].text, FINGERS[0].file).unwrap();
        let evaluator = Evaluator {
            surrogate: surrogate::fit(&measured, &printed).unwrap().into(),
            fingers: FingerSource::Paper,
            templates: vec![Template::parse(TASKS[0].text, TASKS[0].file).unwrap()],
            robot: Robot::parse(ROBOTS[0].text, ROBOTS[0].file).unwrap(),
            engine: EngineKind::Direct,
            cell: None,
        };
        let (template, design) = (&evaluator.templates[0], Design::infill(20.0, 10.0));
        let stiffness = evaluator.predict(&design).unwrap();
        let scenario = evaluator.scenario(template, &design, stiffness).unwrap();
        let space = Space::parse(SPACES[0].text, SPACES[0].file).unwrap();
        let analysis = LeverAnalysis {
            evaluator: &evaluator,
            template,
            space: &space,
            design: &design,
            given: None,
            done: &|_| (),
        };
        let value = |path| current_value(&analysis, &scenario, &Path::new(path).unwrap());
        assert_eq!(value(TILTING_KEY), Some(scenario.finger.rotation[0]));
        assert_eq!(value(RCC_KEY), Some(scenario.finger.rcc / MM));
        assert_eq!(value("finger.stiffness"), None);
    }
}
