//! From the logs of attempts to the numbers of their cell.

use super::check::Remark;
use super::curves::Curves;
use super::flange;
use super::formulas::{self, Flange, Friction};
use super::log::{Ended, Run};
use super::replay::{Logged, Replay};
use super::smoother::{Datum, Predicted, Settings, Smoothed, smooth};
use super::touch::bias;
use super::unknown::{From, Unknown, advice, fit, not_fitted, told, untold, values, with};
use ask_tell::statistics::{Moments, mean};
use input::units::MM;
use insertion::evaluation::cell::Priors;
use insertion::evaluation::evaluator::Evaluator;
use insertion::evaluation::template::{Impossible, Template};
use insertion::outcome::Outcome;
use insertion::robot::Robot;
use insertion::surrogate::Estimate;
use parameters::numbers::{FLANGE, FRICTION, Kind};
use parameters::{Parameter, Scale, Transform};
use std::sync::atomic::{AtomicBool, Ordering};

/// Ten members to each unknown; four rounds; neighbours over 0.1 s err together.
pub const SETTINGS: Settings = Settings { members: 10, rounds: 4, alike: 10.0, seed: 0 };
/// Most attempts of a finger that are replayed: more of them tell little more.
const EACH: usize = 5;
/// Least standard deviation of a preload, mm: a touch is felt some ms late.
const PRELOAD_MM: f64 = 0.02;
const STRATEGY: &str = "task.strategy.";

/// Logs, unknowns and settings of an identification.
pub struct Question<'a> {
    /// Knows the fingers; its robot is the start, of which the logs may tell more.
    pub evaluator: &'a Evaluator,
    pub template: &'a Template,
    pub priors: &'a Priors,
    pub runs: &'a [Run],
    /// Mass that the force sensor carries, kg.
    pub tool_mass: f64,
    pub seed: u64,
    pub stop: &'a AtomicBool,
}

/// An attempt, measured and simulated.
pub struct Compared {
    pub logged: Logged,
    /// Under the numbers of the files, and under what was identified.
    pub before: (Curves, Outcome),
    pub after: (Curves, Outcome),
}

/// Result of an identification.
pub struct Identified {
    pub robot: Robot,
    /// The robot's axes x, y and z as far as the logs tell them.
    pub flange: [Option<Flange>; 3],
    pub preload: Option<Estimate>,
    /// Of each probe, by its file.
    pub probes: Vec<(String, Friction)>,
    pub unknowns: Vec<Unknown>,
    pub smoothed: Smoothed,
    pub compared: Vec<Compared>,
}

/// The logs of one cell, what was noticed in them, and what they say.
pub struct IdentifyDone {
    /// Name of the task.
    pub task: String,
    /// Remarks on the logs, each a sentence.
    pub remarks: Vec<Remark>,
    /// Numbers of the cell, and the curves they come from.
    pub found: Identified,
    /// The cell, for `--cell`, `--priors` and `--uncertainty`.
    pub cell: Priors,
}

impl Question<'_> {
    /// Reads what formulas tell, and fits the rest.
    ///
    /// # Errors
    /// If a prior sets what cannot be.
    pub fn answer(&self) -> Result<Identified, Impossible> {
        let attempts = chosen(self.runs.iter().filter_map(Logged::new).collect());
        let curves: Vec<Curves> = attempts.iter().map(|one| one.curves.clone()).collect();
        let flange = [0, 1, 2].map(|axis| formulas::flange(&curves, axis));
        let probes = self.probes();
        let preload = formulas::preload(&curves);
        let (robot, flange_sd) = flange::told(&self.evaluator.robot, &flange);
        let (mut fitted, mut rest) = (Vec::new(), Vec::new());
        for prior in self.rows() {
            let known = self.known(&prior, flange_sd, preload, &probes, &attempts);
            let read = prior.path.starts_with(STRATEGY) || prior.path == FLANGE;
            match (known, read) {
                (Some(known), true) => rest.push(told(prior, known, From::Formula)),
                (None, true) => rest.push(untold(prior, None)),
                _ if not_fitted(&prior) => rest.push(self.assumed(prior)),
                (known, false) => fitted.push((prior, known)),
            }
        }
        let replay = Replay {
            evaluator: self.evaluator,
            robot: &robot,
            template: self.template,
            tool_mass: self.tool_mass,
            stop: self.stop,
        };
        let rows: Vec<&Parameter> =
            fitted.iter().map(|(prior, known)| known.as_ref().unwrap_or(prior)).collect();
        let smoothed = self.smoothed(&replay, &attempts, &rows)?;
        let unknowns: Vec<Unknown> = fitted
            .iter()
            .enumerate()
            .map(|(i, (prior, known))| fit(prior, known.as_ref(), &smoothed, i))
            .chain(rest)
            .collect();
        let compared = self.compared(&replay, attempts, &unknowns)?;
        Ok(Identified { robot, flange, preload, probes, unknowns, smoothed, compared })
    }

    /// A row that is not fitted, at the number of the files, with the deviation of its prior.
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
        Unknown { prior, posterior, left: None, from: From::Files, advice }
    }

    fn probes(&self) -> Vec<(String, Friction)> {
        let probes = self.runs.iter().filter(|run| run.ended == Ended::Probe);
        let friction = |run: &Run| {
            let found = formulas::friction(&Curves::of_log(&run.log, bias(&run.log)))?;
            Some((run.log.file.clone(), found))
        };
        probes.filter_map(friction).collect()
    }

    /// The rows of the prior that the task has; of a friction as values.
    fn rows(&self) -> Vec<Parameter> {
        let Question { evaluator, template, .. } = self;
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
                // The opening has no width of its own that could be set.
                transform: if added { Transform::Shift } else { Transform::Value },
                // A stroke towards -y is a factor on a negative number.
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

    /// A row as formulas tell it, if they do.
    fn known(
        &self,
        prior: &Parameter,
        flange: Option<f64>,
        preload: Option<Estimate>,
        probes: &[(String, Friction)],
        attempts: &[Logged],
    ) -> Option<Parameter> {
        let path = &prior.path;
        if *path == FLANGE {
            let source = "force over how far the TCP is behind its target; [robot] has the values";
            let factor =
                Parameter { transform: Transform::Factor, low: 0.5, high: 2.0, ..prior.clone() };
            return flange.map(|sd| with(&factor, 1.0, sd, source));
        }
        if path.ends_with("preload_mm") {
            let Estimate { mean, sd } = preload?;
            let sd = (sd / MM).max(PRELOAD_MM);
            return Some(with(
                prior,
                mean / MM,
                sd,
                "where the target stopped, and where it was sent",
            ));
        }
        if path.starts_with(STRATEGY) && path.ends_with("move_mm.y") {
            let stroke = |one: &Logged| {
                let (target, from) = (one.curves.target.as_ref()?, one.curves.stopped()?);
                let to = one.push.min(target.len() - 1);
                Some((target[to].y - target[from].y) / MM)
            };
            let mean = mean(attempts.iter().filter_map(stroke))?;
            return Some(with(prior, mean, 0.01, "commanded from the touch to the push"));
        }
        if *path == FRICTION {
            let said: Vec<Estimate> =
                probes.iter().filter_map(|(_, found)| found.coefficient).collect();
            let sd = mean(said.iter().map(|one| one.sd))?;
            let means = Moments::of(said.iter().map(|one| one.mean));
            return Some(with(
                prior,
                means.mean,
                libm::hypot(sd, means.deviation()),
                "probe: slides both ways",
            ));
        }
        None
    }

    fn smoothed(
        &self,
        replay: &Replay<'_>,
        attempts: &[Logged],
        rows: &[&Parameter],
    ) -> Result<Smoothed, Impossible> {
        let data: Vec<Datum> = attempts.iter().flat_map(Logged::data).collect();
        let predict = |z: &[f64]| -> Result<Predicted, Impossible> {
            if self.stop.load(Ordering::SeqCst) {
                // Whoever has set it does not look at what comes of this.
                return Ok(vec![None; data.len()]);
            }
            let replayed = replay.curves(attempts, &values(rows, z))?;
            let each = attempts.iter().zip(&replayed);
            Ok(each.flat_map(|(logged, (curves, _))| logged.predicted(curves)).collect())
        };
        smooth(rows.len(), &data, Settings { seed: self.seed, ..SETTINGS }, predict)
    }

    fn compared(
        &self,
        replay: &Replay<'_>,
        attempts: Vec<Logged>,
        unknowns: &[Unknown],
    ) -> Result<Vec<Compared>, Impossible> {
        let now: Vec<(&Parameter, f64)> =
            unknowns.iter().map(|one| (&one.posterior, one.posterior.middle())).collect();
        let now: Vec<_> = now.into_iter().filter(|(row, _)| row.path != FLANGE).collect();
        let files = Replay { robot: &self.evaluator.robot, ..*replay };
        let before = files.curves(&attempts, &[])?;
        let after = replay.curves(&attempts, &now)?;
        let each = attempts.into_iter().zip(before).zip(after);
        let compared = each.map(|((logged, before), after)| Compared { logged, before, after });
        Ok(compared.collect())
    }
}

/// At most [`EACH`] attempts of each finger, from starts that are spread evenly; fingers together.
fn chosen(mut all: Vec<Logged>) -> Vec<Logged> {
    let key = |one: &Logged| one.design.labelled();
    all.sort_by(|a, b| key(a).cmp(&key(b)).then(a.offset.total_cmp(&b.offset)));
    let fingers = all.chunk_by(|a, b| a.design == b.design);
    let of = |alike: &[Logged]| -> Vec<Logged> {
        let count = alike.len().min(EACH);
        let place = |i: usize| if count > 1 { i * (alike.len() - 1) / (count - 1) } else { 0 };
        (0..count).map(|i| alike[place(i)].clone()).collect()
    };
    fingers.flat_map(of).collect()
}
