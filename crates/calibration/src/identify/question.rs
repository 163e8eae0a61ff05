//! Identification of the parameters of a cell from logs of attempts: closed-form estimates, then a fit of the others.

use super::axes::{slides, springs};
use super::check::{self, Remark};
use super::curves::Curves;
use super::flange;
use super::formulas::{self, Flange, Friction};
use super::log::Run;
use super::replay::Logged;
use super::smoother::{Datum, Predicted, Settings, Smoothed, smooth};
use super::touch::bias;
use super::unknown::{
    Unknown, ValueOrigin, advice, fit, identified, not_fitted, unidentified, values, with_value,
};
use ask_tell::statistics::{Moments, mean, median};
use input::units::MM;
use insertion::robot::Drive;
use insertion::{DesignError, Estimate, Evaluator, Outcome, Priors, Robot, Template};
use parameters::numbers::{FLANGE, FRICTION, Kind};
use parameters::{Parameter, Scale, Transform};
use std::sync::atomic::{AtomicBool, Ordering};

/// Settings of the ensemble smoother: ten members per unknown, four iterations; errors are correlated over ten bins,
/// 0.1 s.
pub const SETTINGS: Settings = Settings { members: 10, rounds: 4, correlated: 10.0, seed: 0 };
/// Largest number of fitted attempts of a finger; more add little information.
const MAX_ATTEMPTS: usize = 5;
/// Factor on the time step of the simulations of the fit; the coarser step changes identified values by less than half
/// their standard deviation.
const COARSE: f64 = 4.0;
/// Smallest standard deviation of a preload, mm, since a touch is detected a few ms late.
const PRELOAD_MM: f64 = 0.02;
/// Prefix of the paths of the strategy's parameters.
const STRATEGY: &str = "task.strategy.";

/// Inputs of an identification: logs, priors and settings.
pub struct Identification<'a> {
    /// Evaluator of the fingers, with the initial robot.
    pub evaluator: &'a Evaluator,
    pub template: &'a Template,
    pub priors: &'a Priors,
    pub runs: &'a [Run],
    /// Mass below the force sensor, kg.
    pub tool_mass: f64,
    pub seed: u64,
    pub stop: &'a AtomicBool,
}

/// Measured attempt with its simulations: curves and outcome of each.
pub struct Compared {
    pub logged: Logged,
    /// Simulation with the values of the input files.
    pub before: (Curves, Outcome),
    /// Simulation with the identified values.
    pub after: (Curves, Outcome),
}

/// Result of an identification.
pub struct Identified {
    pub robot: Robot,
    /// Flange along x, y and z; `None` for an axis that is not identified.
    pub flange: [Option<Flange>; 3],
    /// Preload, m: travel of the commanded position beyond the touch.
    pub preload: Option<Estimate>,
    /// Friction from each probe, with the file of its log.
    pub probes: Vec<(String, Friction)>,
    pub unknowns: Vec<Unknown>,
    pub smoothed: Smoothed,
    pub compared: Vec<Compared>,
    /// Attempt held out for validation, if some were not fitted.
    pub held_out: Option<Compared>,
}

impl Identified {
    /// Returns whether any parameter of the cell was identified.
    pub fn is_informative(&self) -> bool {
        let identified =
            |one: &Unknown| matches!(one.from, ValueOrigin::Formula | ValueOrigin::Fit);
        self.unknowns.iter().any(identified) || self.flange.iter().any(Option::is_some)
    }
}

/// Identified cell, with remarks on the logs.
pub struct IdentificationResult {
    /// Name of the task.
    pub task: String,
    /// File with the table of the logs, to which the remarks on all logs refer.
    pub runs: String,
    /// Remarks on the logs.
    pub remarks: Vec<Remark>,
    /// Identified parameters of the cell, and the curves from which they are identified.
    pub found: Identified,
    /// The cell, for `--cell`, `--priors` and `--uncertainty`.
    pub cell: Priors,
}

impl Identification<'_> {
    /// Returns remarks on the logs, individually and together; `file` is the table of the runs.
    ///
    /// # Errors
    /// If a log's finger cannot be simulated.
    pub fn remarks(&self, file: &str) -> Result<Vec<Remark>, DesignError> {
        let mut found = check::remarks(file, self.runs, &self.template.task);
        found.extend(self.probes().iter().filter_map(slides));
        let attempts = self.attempts();
        let of_all = |remark: &Remark| remark.file == file;
        let wrong =
            |one: &Logged| found.iter().any(|remark| remark.serious && remark.file == one.file);
        // Faulty logs are not compared with the others.
        if !found.iter().any(of_all) && !attempts.iter().any(wrong) {
            let curves: Vec<Curves> = attempts.iter().map(|one| one.curves.clone()).collect();
            found.extend(springs(file, &curves));
            let ratio = self.force_scale(&attempts)?;
            found.extend(ratio.and_then(|ratio| check::force_scale(file, ratio)));
        }
        Ok(found)
    }

    /// Returns the attempts to fit: at most [`MAX_ATTEMPTS`] of each finger with evenly spread starts, grouped by finger.
    fn attempts(&self) -> Vec<Logged> {
        let mut all: Vec<Logged> = self.runs.iter().filter_map(Logged::new).collect();
        let key = |one: &Logged| one.design.labelled();
        all.sort_by(|a, b| key(a).cmp(&key(b)).then(a.offset.total_cmp(&b.offset)));
        let fingers = all.chunk_by(|a, b| a.design == b.design);
        let of = |alike: &[Logged]| -> Vec<Logged> {
            let count = alike.len().min(MAX_ATTEMPTS);
            let place = |i: usize| if count > 1 { i * (alike.len() - 1) / (count - 1) } else { 0 };
            (0..count).map(|i| alike[place(i)].clone()).collect()
        };
        fingers.flat_map(of).collect()
    }

    /// Returns the attempt to hold out for validation: of those not fitted, the one whose start is farthest from the
    /// nearest fitted start of the same finger.
    fn held_out(&self, fitted: &[Logged]) -> Option<Logged> {
        let apart = |one: &Logged| {
            let alike = fitted.iter().filter(|other| other.design == one.design);
            alike.map(|other| (other.offset - one.offset).abs()).fold(f64::INFINITY, f64::min)
        };
        let used = |one: &Logged| fitted.iter().any(|other| other.file == one.file);
        let rest = self.runs.iter().filter_map(Logged::new).filter(|one| !used(one));
        rest.max_by(|a, b| apart(a).total_cmp(&apart(b)))
    }

    /// Returns the ratio of measured to simulated forces, root mean squares from the touch on, as the median over the
    /// attempts. An ideal robot follows the measured path, so that its stiffness cannot compensate for a wrong unit.
    fn force_scale(&self, attempts: &[Logged]) -> Result<Option<f64>, DesignError> {
        let own = &self.evaluator.robot;
        let rigid = Robot { drive: Drive::Ideal, stop_force: f64::MAX, ..own.clone() };
        let along: Vec<Logged> = attempts.iter().filter_map(Logged::along_measured).collect();
        let replayed = self.replayed((&rigid, 1.0), &along, &[])?;
        let ratio = |(logged, (curves, _)): (&Logged, &(Curves, Outcome))| {
            let [measured, simulated] = [&logged.curves.force, &curves.force].map(|forces| {
                let both = logged.curves.force.len().min(curves.force.len());
                let touched = forces.get(logged.touch..both).unwrap_or_default();
                touched.iter().map(|force| force.norm_squared()).sum::<f64>()
            });
            (measured / simulated).sqrt()
        };
        Ok(median(along.iter().zip(&replayed).map(ratio).filter(|ratio| ratio.is_normal())))
    }

    /// Estimates parameters in closed form where possible, and fits the others.
    ///
    /// # Errors
    /// If a value of a prior is invalid.
    pub fn identify(&self) -> Result<Identified, DesignError> {
        let attempts = self.attempts();
        let curves: Vec<Curves> = attempts.iter().map(|one| one.curves.clone()).collect();
        let flange = [0, 1, 2].map(|axis| formulas::flange(&curves, axis));
        let probes = self.probes();
        let preload = formulas::preload(&curves);
        let (robot, flange_sd) = flange::identified_robot(&self.evaluator.robot, &flange);
        let (mut fitted, mut rest) = (Vec::new(), Vec::new());
        for prior in self.rows() {
            let known = self.by_formula(&prior, flange_sd, preload, &probes, &attempts);
            let read = prior.path.starts_with(STRATEGY) || prior.path == FLANGE;
            match (known, read) {
                (Some(known), true) => rest.push(identified(prior, known, ValueOrigin::Formula)),
                (None, true) => rest.push(unidentified(prior, None)),
                _ if not_fitted(&prior) => rest.push(self.assumed(prior)),
                (known, false) => fitted.push((prior, known)),
            }
        }
        let rows: Vec<&Parameter> =
            fitted.iter().map(|(prior, known)| known.as_ref().unwrap_or(prior)).collect();
        let smoothed = self.smoothed(&robot, &attempts, &rows)?;
        let fits = fitted.iter().enumerate();
        let fits = fits.map(|(i, (prior, known))| fit(prior, known.as_ref(), &smoothed, i));
        let unknowns: Vec<Unknown> = fits.chain(rest).collect();
        let held_out = self.held_out(&attempts).into_iter().collect();
        let compared = self.compared(&robot, attempts, &unknowns)?;
        let held_out = self.compared(&robot, held_out, &unknowns)?.pop();
        Ok(Identified { robot, flange, preload, probes, unknowns, smoothed, compared, held_out })
    }

    /// Creates an unknown that is not fitted: the value of the input files with the standard deviation of its prior.
    fn assumed(&self, prior: Parameter) -> Unknown {
        let own = match prior.path.kind() {
            Kind::File => self.evaluator.number(self.template, &prior.path),
            _ => Some(1.0),
        };
        let value = prior.value.or(own).unwrap_or_else(|| prior.middle());
        let value = value.clamp(prior.low, prior.high);
        let width = match prior.scale {
            Scale::Log => value * libm::log(prior.high / prior.low),
            Scale::Linear => prior.high - prior.low,
        };
        let sd = prior.sd.unwrap_or(width / 12.0_f64.sqrt());
        let source = "not fitted: as in the files, with the width of its prior".to_owned();
        let posterior = Parameter { value: Some(value), sd: Some(sd), source, ..prior.clone() };
        let advice = Some(advice(&prior));
        Unknown { prior, posterior, remaining_sd: None, from: ValueOrigin::Files, advice }
    }

    /// Returns the friction from each probe, with the file of its log.
    fn probes(&self) -> Vec<(String, Friction)> {
        let probes = self.runs.iter().filter(|run| run.outcome.is_none());
        let friction = |run: &Run| {
            let found = formulas::friction(&Curves::of_log(&run.log, bias(&run.log)))?;
            Some((run.log.file.clone(), found))
        };
        probes.filter_map(friction).collect()
    }

    /// Returns the priors that apply to the task, as values instead of factors and shifts.
    fn rows(&self) -> Vec<Parameter> {
        let Identification { evaluator, template, .. } = self;
        let of_file = |row: &Parameter| row.path.kind() == Kind::File;
        let as_value = |row: &Parameter| {
            let added = row.path.kind() == Kind::Added;
            let own = match of_file(row) {
                true => evaluator.number(template, &row.path),
                false => added.then_some(0.0),
            };
            let Some(own) = own else { return row.clone() };
            let [low, high] = [row.low, row.high].map(|bound| row.applied(own, bound));
            let value = row.value.map(|value| row.applied(own, value));
            let factor = if row.transform == Transform::Factor { own.abs() } else { 1.0 };
            Parameter {
                // A change of a shape has no value of its own in the task file.
                transform: if added { Transform::Shift } else { Transform::Value },
                // A factor on a negative value, as of a stroke towards -y, swaps the bounds.
                low: low.min(high),
                high: low.max(high),
                scale: if low < 0.0 { Scale::Linear } else { row.scale },
                value,
                sd: row.sd.map(|sd| sd * factor),
                ..row.clone()
            }
        };
        let has = |row: &&Parameter| !of_file(row) || evaluator.has(template, row);
        self.priors.of(&template.task.name).filter(has).map(as_value).collect()
    }

    /// Returns the parameter as estimated in closed form; `None` if no formula applies. `flange` is the relative
    /// standard deviation of its stiffness.
    fn by_formula(
        &self,
        prior: &Parameter,
        flange: Option<f64>,
        preload: Option<Estimate>,
        probes: &[(String, Friction)],
        attempts: &[Logged],
    ) -> Option<Parameter> {
        let path = &prior.path;
        let (mean, sd, source) = if *path == FLANGE {
            let source =
                "force divided by the lag of the TCP behind its target; [robot] has the values";
            let factor =
                Parameter { transform: Transform::Factor, low: 0.5, high: 2.0, ..prior.clone() };
            return flange.map(|sd| with_value(&factor, 1.0, sd, source));
        } else if path.ends_with("preload_mm") {
            let Estimate { mean, sd } = preload?;
            let source = "distance from the point where the target stopped to the commanded point";
            (mean / MM, (sd / MM).max(PRELOAD_MM), source)
        } else if path.starts_with(STRATEGY) && path.ends_with("move_mm.y") {
            let stroke = |one: &Logged| {
                let (target, from) = (one.curves.target.as_ref()?, one.curves.stopped()?);
                let to = one.push.min(target.len() - 1);
                Some((target[to].y - target[from].y) / MM)
            };
            let mean = mean(attempts.iter().filter_map(stroke))?;
            (mean, 0.01, "commanded displacement from the touch to the push")
        } else if *path == FRICTION {
            let estimates: Vec<Estimate> =
                probes.iter().filter_map(|(_, found)| found.coefficient).collect();
            let sd = mean(estimates.iter().map(|one| one.sd))?;
            let means = Moments::of(estimates.iter().map(|one| one.mean));
            if means.mean <= 0.0 {
                return None;
            }
            (means.mean, libm::hypot(sd, means.deviation()), "probe: slides in both directions")
        } else {
            return None;
        };
        Some(with_value(prior, mean, sd, source))
    }

    /// Fits parameters to the curves of the attempts by the ensemble smoother.
    fn smoothed(
        &self,
        robot: &Robot,
        attempts: &[Logged],
        rows: &[&Parameter],
    ) -> Result<Smoothed, DesignError> {
        let data: Vec<Datum> = attempts.iter().flat_map(Logged::data).collect();
        let predict = |z: &[f64]| -> Result<Predicted, DesignError> {
            if self.stop.load(Ordering::SeqCst) {
                // The result is not used after cancellation.
                return Ok(vec![None; data.len()]);
            }
            let replayed = self.replayed((robot, COARSE), attempts, &values(rows, z))?;
            let each = attempts.iter().zip(&replayed);
            Ok(each.flat_map(|(logged, (curves, _))| logged.predicted(curves)).collect())
        };
        smooth(rows.len(), &data, Settings { seed: self.seed, ..SETTINGS }, predict)
    }

    /// Simulates attempts with the values of the input files and with the identified ones.
    fn compared(
        &self,
        robot: &Robot,
        attempts: Vec<Logged>,
        unknowns: &[Unknown],
    ) -> Result<Vec<Compared>, DesignError> {
        let rows = unknowns.iter().map(|one| &one.posterior).filter(|row| row.path != FLANGE);
        let now: Vec<_> = rows.map(|row| (row, row.middle())).collect();
        let before = self.replayed((&self.evaluator.robot, 1.0), &attempts, &[])?;
        let after = self.replayed((robot, 1.0), &attempts, &now)?;
        let each = attempts.into_iter().zip(before).zip(after);
        Ok(each.map(|((logged, before), after)| Compared { logged, before, after }).collect())
    }
}
