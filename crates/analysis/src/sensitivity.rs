//! Inputs of a variance-based sensitivity analysis (parameters of the search space and random errors of the cell), and
//! the evaluation at given inputs.

use insertion::evaluation::tolerance;
use insertion::evaluation::uncertainty::{Draw, Uncertainty};
use insertion::{
    DENSITY_KEY, DIRECTION_KEY, Design, DesignError, Evaluation, Evaluator, Grasp, Search, Space,
    Template, Variable,
};
use parameters::Parameter;
use parameters::numbers::Kind;
use std::sync::atomic::AtomicBool;

/// Returns the inputs that are varied together, in the order of the axes of the unit cube: the parameters of the space
/// whose bounds differ, then the nonzero errors of the cell.
///
/// # Errors
/// If the space has no infill density or direction.
pub fn inputs(space: &Space, errors: Option<&Uncertainty>) -> Result<Vec<Parameter>, String> {
    for key in [DENSITY_KEY, DIRECTION_KEY] {
        if !space.parameters.iter().any(|variable| variable.key == key) {
            return Err(format!("the space `{}` has no {key}", space.name));
        }
    }
    let of_space = space.parameters.iter().map(Variable::parameter);
    let of_space = of_space.filter(|variable| variable.low < variable.high);
    Ok(of_space.chain(errors.map(Uncertainty::parameters).unwrap_or_default()).collect())
}

/// Measures the tolerance window at `unit`, a point of the unit cube of the inputs, by strides and bisection. The
/// result is invalid once `stop` is set.
///
/// # Errors
/// If the point's design, scenario or rig cannot be built.
pub fn evaluate(
    inputs: &[Parameter],
    (evaluator, template): (&Evaluator, &Template),
    unit: &[f64],
    stop: &AtomicBool,
) -> Result<Evaluation, DesignError> {
    let values = inputs.iter().zip(unit).map(|(input, at)| (input, input.at(at.clamp(0.0, 1.0))));
    let (errors, numbers): (Vec<_>, Vec<_>) =
        values.partition(|(input, _)| input.path.kind() == Kind::Error);
    let design =
        Design(numbers.iter().map(|(one, value)| (one.path.to_string(), *value)).collect());
    let scenario = evaluator.apply(template, (&design, None), &[])?;
    let rig = evaluator.rig(&scenario, evaluator.taught(&scenario, stop)?, 1.0)?;
    let draw = Draw::with(errors.iter().map(|(one, value)| (&*one.path, *value)));
    let finger = draw.finger(&scenario.finger, &scenario.stiffness);
    let grasp = Grasp { finger, conditions: draw.conditions, stop };
    Ok(tolerance::evaluate_grasp(&*rig, grasp, Search::Strides))
}
