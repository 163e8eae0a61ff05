//! Simulated windows under values of what nobody measured.

use super::prior::{Parameter, Priors, Target};
use crate::study::Cache;
use input::numbers::DESIGN;
use input::shipped::PRIORS;
use input::units::MM;
use input::{Check, InputError};
use insertion::evaluation::Evaluation;
use insertion::evaluation::evaluator::{Evaluator, Specimen};
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::template::{Impossible, Template};
use insertion::evaluation::tolerance::{self, Search};
use insertion::finger::Finger;
use insertion::finger::model::FingerSource;
use insertion::outcome::Outcome;
use insertion::robot::{Drive, Robot};
use insertion::space::Design;
use insertion::surrogate::Prediction;
use insertion::trial::{Conditions, Grasp};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

/// Starts tried where the task's own does not insert, mm from it: a person teaches one that does.
const TAUGHT_MM: [f64; 4] = [1.0, -1.0, 2.0, -2.0];

pub struct Simulation<'a> {
    evaluator: &'a Evaluator,
    template: &'a Template,
    /// The parameters that the task and the robot have, in order.
    pub parameters: Vec<&'a Parameter>,
    /// Where windows are kept, if they are.
    cache: Option<PathBuf>,
    /// Set when it is to end: windows are then worthless, and none is kept.
    pub stop: &'a AtomicBool,
}

impl<'a> Simulation<'a> {
    /// With those of the parameters that this task and robot have.
    pub fn new(
        evaluator: &'a Evaluator,
        template: &'a Template,
        parameters: &'a [Parameter],
        cache: Option<PathBuf>,
        stop: &'a AtomicBool,
    ) -> Self {
        let has = |parameter: &&Parameter| match &parameter.sets {
            Target::Number(path) => number(evaluator, template, path).is_some(),
            Target::Flange => matches!(evaluator.robot.drive, Drive::Servo(_)),
            _ => true,
        };
        let parameters = parameters.iter().filter(has).collect();
        Simulation { evaluator, template, parameters, cache, stop }
    }

    /// The window of a design at these shares of the priors; without shares as in the files.
    pub fn window(&self, design: &Design, shares: &[f64]) -> Result<Evaluation, Impossible> {
        let values = self.parameters.iter().zip(shares).map(|(p, &share)| (*p, p.at(share)));
        let values: Vec<_> = values.collect();
        let (specimen, robot) = under(self.evaluator, self.template, (design, None), &values)?;
        let inserts = |found: &Evaluation| found.window.nominal == Outcome::Inserted;
        let own = self.measure(&specimen, &robot)?;
        if inserts(&own) {
            return Ok(own);
        }
        for shift in TAUGHT_MM {
            let mut specimen = specimen.clone();
            specimen.task.strategy.start[1] += shift * MM;
            let evaluation = self.measure(&specimen, &robot)?;
            if inserts(&evaluation) {
                return Ok(evaluation);
            }
        }
        Ok(own)
    }

    fn measure(&self, specimen: &Specimen, robot: &Robot) -> Result<Evaluation, Impossible> {
        let engine = self.evaluator.engine;
        let cache = self.cache.as_ref().map(|dir| Cache::new(dir, robot, &engine.record()));
        let search = Search::default();
        let keep =
            cache.as_ref().map(|cache| (cache, cache.key(&(specimen, search, &Plan::WINDOW))));
        if let Some(found) = keep.as_ref().and_then(|(cache, key)| cache.get(key)) {
            return Ok(found);
        }
        let rig = engine.rig(&specimen.task, robot, &specimen.finger, 1.0)?;
        let grasp = Grasp { stop: self.stop, ..Grasp::of(&specimen.finger) };
        let evaluation = tolerance::evaluate_in(&*rig, grasp, search);
        if let Some((cache, key)) = keep
            && !self.stop.load(Ordering::SeqCst)
        {
            cache.put(&key, &evaluation);
        }
        Ok(evaluation)
    }
}

/// The number of that key in the task file, or in the finger file of computed fingers.
pub fn number(evaluator: &Evaluator, template: &Template, key: &str) -> Option<f64> {
    template.numbers.number(key).or_else(|| match &evaluator.fingers {
        FingerSource::Paper => None,
        FingerSource::Computed(fingers) => fingers.file.numbers.number(key),
    })
}

/// A design under these values of parameters, and the robot; its stiffness is predicted unless given.
pub fn under(
    evaluator: &Evaluator,
    template: &Template,
    (design, given): (&Design, Option<Prediction>),
    values: &[(&Parameter, f64)],
) -> Result<(Specimen, Robot), Impossible> {
    let mut set = design.clone();
    for (parameter, value) in values {
        if let Target::Number(key) = &parameter.sets
            && let Some(own) = design.get(key).or_else(|| number(evaluator, template, key))
        {
            set.0.insert(key.clone(), parameter.applied(own, *value));
        }
    }
    let stiffness = given.map_or_else(|| evaluator.predict(&set), Ok)?;
    let mut specimen = evaluator.specimen(template, &set, stiffness)?;
    let mut robot = evaluator.robot.clone();
    for (parameter, value) in values {
        change(parameter, *value, &mut specimen, &mut robot);
    }
    Ok((specimen, robot))
}

/// Changes what a parameter sets beside the numbers of the task file.
fn change(parameter: &Parameter, value: f64, specimen: &mut Specimen, robot: &mut Robot) {
    let Finger { compliance, assembly, rotation, rcc, .. } = &mut specimen.finger;
    match parameter.sets {
        Target::Number(_) => (),
        Target::Clearance => {
            let clearance = parameter.applied(0.0, value) * MM;
            specimen.task = Conditions { clearance, ..Conditions::NOMINAL }.task(&specimen.task);
        }
        Target::Edges => {
            specimen.task = specimen.task.rounded(parameter.applied(0.0, value) * MM);
        }
        Target::Chamfer => {
            specimen.task = specimen.task.chamfered(parameter.applied(0.0, value) * MM);
        }
        Target::Stiffness => {
            *compliance = parameter.applied(*compliance, value);
            *assembly = parameter.applied(*assembly, value);
        }
        Target::Tilting => rotation[0] = parameter.applied(rotation[0], value),
        Target::Centre => *rcc = parameter.applied(*rcc / MM, value) * MM,
        Target::Flange => {
            if let Drive::Servo(servo) = &mut robot.drive {
                let all = servo.stiffness.iter_mut().chain(&mut servo.rotational_stiffness);
                all.for_each(|stiffness| *stiffness = parameter.applied(*stiffness, value));
            }
        }
    }
}

/// The shipped prior of that name: the key that it sets, and its value at this share.
///
/// # Errors
/// If there is none.
pub fn prior_at(name: &str, share: f64) -> Result<(String, f64), InputError> {
    let parameter = shipped(name)?;
    Ok((parameter.sets.key().to_owned(), parameter.at(share)))
}

/// A design in a cell in which the shipped priors of these names have these values, and its robot.
///
/// # Errors
/// If there is no such prior, or the design cannot be simulated.
pub fn in_cell(
    evaluator: &Evaluator,
    template: &Template,
    design: &Design,
    values: &[(&str, f64)],
) -> Result<(Specimen, Robot), Impossible> {
    let parameters: Vec<Parameter> =
        values.iter().map(|(name, _)| shipped(name)).collect::<Result<_, _>>()?;
    let values: Vec<_> = parameters.iter().zip(values.iter().map(|(_, value)| *value)).collect();
    under(evaluator, template, (design, None), &values)
}

fn shipped(name: &str) -> Result<Parameter, InputError> {
    let [file, ..] = PRIORS else { return DESIGN.fail(name, "no priors are shipped") };
    let priors = Priors::parse(file.text, file.file)?;
    match priors.parameters.into_iter().find(|parameter| parameter.name == name) {
        Some(parameter) => Ok(parameter),
        None => Check { file: file.file }.fail(name, "is no parameter of it"),
    }
}
