//! Optimizer of a study: its search space and prior knowledge.

use crate::failure::bad_config;
use crate::{Failure, Setup};
use ask_tell::{Grid, GridPoint, Optimizer, OptimizerKind, Polished, SeededOptimizer};
use insertion::finger::file::is_shape;
use insertion::{Design, FingerSource, Measurement, Variable};
use study::StudyConfig;

/// Returns the optimizer of a study.
pub(crate) fn optimizer(
    setup: &Setup,
    config: &StudyConfig,
) -> Result<Box<dyn Optimizer + Send>, Failure> {
    let kind: OptimizerKind = config.optimizer.parse().map_err(bad_config)?;
    let grid = Grid::new(setup.space.levels());
    let trials = setup.uncertainty.as_ref().map_or(1, |errors| errors.success.trials);
    let measures = config.objective.measures().iter();
    let floors: Vec<f64> = measures.map(|measure| measure.rounding(trials)).collect();
    let mut search = ask_tell::build_for(kind, grid.clone(), config.seed, &floors);
    let points: Vec<GridPoint> =
        task_point(setup).into_iter().chain(measured_points(setup)).collect();
    if kind == OptimizerKind::Gp && !points.is_empty() {
        search = Box::new(SeededOptimizer::new(search, setup.space.parameters.len() + 1, points));
    }
    Ok(match config.polish {
        0 => search,
        polish => Box::new(Polished::new(search, grid, config.budget, polish)),
    })
}

/// Returns the grid point nearest to the (first) task file, whose strategy is to be improved, as an initial point;
/// parameters that are not in the file are at the middle of their range. `None` if the space does not change the task.
fn task_point(setup: &Setup) -> Option<GridPoint> {
    let (parameters, template) = (&setup.space.parameters, setup.evaluator.templates.first()?);
    if !setup.space.changes_task() {
        return None;
    }
    let of_task = |p: &Variable| setup.evaluator.number(template, &p.key);
    let value = |p: &Variable| of_task(p).unwrap_or((p.low + p.high) / 2.0);
    Some(GridPoint(parameters.iter().map(|p| p.nearest(value(p))).collect()))
}

/// Returns the grid points nearest to the measured fingers, as initial points in a space with shape parameters; the
/// measured fingers have the shape of the finger file.
fn measured_points(setup: &Setup) -> Vec<GridPoint> {
    let parameters = &setup.space.parameters;
    let FingerSource::Computed(fingers) = &setup.evaluator.fingers else { return Vec::new() };
    if !parameters.iter().any(|parameter| is_shape(&parameter.key)) {
        return Vec::new();
    }
    let point = |measured: &Measurement| {
        let infill = Design::infill(measured.density_percent, measured.direction_deg);
        let value =
            |p: &Variable| infill.get(&p.key).or_else(|| fingers.file.numbers.number(&p.key));
        parameters.iter().map(|p| Some(p.nearest(value(p)?))).collect::<Option<_>>().map(GridPoint)
    };
    setup.evaluator.surrogate.measurements.iter().filter_map(point).collect()
}
