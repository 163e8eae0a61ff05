//! Simulation of tolerance windows at given values of the unmeasured parameters.

use input::units::MM;
use insertion::{
    Design, DesignError, Evaluation, Evaluator, Outcome, Plan, Scenario, Search, Template,
};
use parameters::Parameter;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use study::{Cache, CachedEvaluator};

/// Shifts of the start, mm, tried in turn if the trial from the task's start does not insert: an operator would teach a
/// start that does.
const SHIFTS_MM: [f64; 4] = [1.0, -1.0, 2.0, -2.0];

/// Simulation of one task as a function of some of its parameters.
pub struct Simulation<'a> {
    pub(super) evaluator: &'a Evaluator,
    pub(super) template: &'a Template,
    /// Parameters that are varied, in the given order.
    pub parameters: Vec<&'a Parameter>,
    /// Folder of the cache, if windows are cached.
    cache: Option<PathBuf>,
    /// Cancellation flag; once it is set, windows are invalid and not cached.
    pub stop: &'a AtomicBool,
}

impl<'a> Simulation<'a> {
    /// Creates a simulation; parameters that neither the task nor the robot has are dropped.
    pub fn new(
        evaluator: &'a Evaluator,
        template: &'a Template,
        parameters: impl Iterator<Item = &'a Parameter>,
        cache: Option<PathBuf>,
        stop: &'a AtomicBool,
    ) -> Self {
        let parameters = parameters.filter(|one| evaluator.has(template, one)).collect();
        Simulation { evaluator, template, parameters, cache, stop }
    }

    /// Simulates the window of a design at these levels of the quantiles of the parameters' priors (0 to 1); if there
    /// are none, with the values of the input files.
    pub fn window(&self, design: &Design, levels: &[f64]) -> Result<Evaluation, DesignError> {
        let values = self.parameters.iter().zip(levels).map(|(p, &level)| (*p, p.at(level)));
        let values: Vec<_> = values.collect();
        let scenario = self.evaluator.apply(self.template, (design, None), &values)?;
        let inserts = |found: &Evaluation| found.window.nominal == Outcome::Inserted;
        let own = self.simulate(&scenario)?;
        if inserts(&own) {
            return Ok(own);
        }
        for shift in SHIFTS_MM {
            let mut scenario = scenario.clone();
            scenario.task.strategy.start[1] += shift * MM;
            let evaluation = self.simulate(&scenario)?;
            if inserts(&evaluation) {
                return Ok(evaluation);
            }
        }
        Ok(own)
    }

    /// Simulates the window of a scenario, or returns the cached one.
    fn simulate(&self, scenario: &Scenario) -> Result<Evaluation, DesignError> {
        let evaluator = self.evaluator;
        let new = |dir: &PathBuf| Cache::new(dir, &scenario.robot, &evaluator.engine.record());
        let cache = &self.cache.as_ref().map(new);
        let (search, plan, stop) = (Search::default(), &Plan::WINDOW, self.stop);
        let cached = CachedEvaluator { evaluator, search, plan, cache: cache.as_ref(), stop };
        Ok(cached.evaluate_scenario(scenario, plan)?.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use finray::printed::PrintedFinger;
    use input::shipped::{FINGERS, ROBOTS, STIFFNESS, TASKS};
    use insertion::finger::model::FingerSource;
    use insertion::robot::Robot;
    use insertion::trial::NEVER;
    use insertion::trial::engine::EngineKind;
    use insertion::{stiffness, surrogate};

    /// Studies share the cache, and search about the taught start.
    #[test]
    fn windows_of_a_taught_start_are_those_of_a_study() {
        let measured = stiffness::parse(STIFFNESS[0].text, STIFFNESS[0].file).unwrap();
        let printed = PrintedFinger::parse(FINGERS[0].text, FINGERS[0].file).unwrap();
        let task = TASKS[0].text.replace("[strategy]", "[strategy]\nstart = \"taught\"");
        let evaluator = Evaluator {
            surrogate: surrogate::fit(&measured, &printed).unwrap().into(),
            fingers: FingerSource::Paper,
            templates: vec![Template::parse(&task, TASKS[0].file).unwrap()],
            robot: Robot::parse(ROBOTS[0].text, ROBOTS[0].file).unwrap(),
            engine: EngineKind::Fake,
            cell: None,
        };
        let (template, design) = (&evaluator.templates[0], Design::infill(20.0, 10.0));
        let simulation = Simulation::new(&evaluator, template, [].iter(), None, &NEVER);
        let found = simulation.window(&design, &[]).unwrap();
        let scenario = evaluator.apply(template, (&design, None), &[]).unwrap();
        let own = evaluator.simulate(&scenario, Search::default(), &Plan::WINDOW, &NEVER).unwrap();
        assert!(own.taught.is_some());
        assert_eq!(found, own);
    }
}
