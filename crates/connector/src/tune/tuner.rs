//! Evaluation of a strategy by the windows of a few measured fingers: the ranges of start offsets at which they insert.

use input::units::MM;
use insertion::evaluation::taught::teach;
use insertion::evaluation::tolerance::{self, offset};
use insertion::stiffness::designs_by_rank;
use insertion::task::Limits;
use insertion::trial::Conditions;
use insertion::trial::run::RigError;
use insertion::{
    EngineKind, Evaluation, Finger, Grasp, Measurement, Outcome, Robot, Search, StartRule,
    Strategy, Task, Trial, Window,
};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Smallest sufficient window on either side of the start, mm.
pub const ENOUGH_MM: f64 = 0.5;

/// Target force of a slower push, as a share of the limit.
const SLOWER: f64 = 0.9;

/// Task, robot and fingers with which strategies are tried.
pub struct Tuner<'a> {
    /// The task, whose strategy is replaced.
    pub task: &'a Task,
    /// Robot that carries the fingers.
    pub robot: &'a Robot,
    /// Contact engine.
    pub engine: EngineKind,
    /// A soft, a medium and a stiff finger.
    pub fingers: [Finger; 3],
    /// Three fingers between these, for checks of the recommended strategy.
    pub others: [Finger; 3],
    /// Largest peak force, N, and largest speed of a phase, m/s, of a recommended strategy.
    pub limits: Limits,
    /// Stop flag; once it is set, results are invalid.
    pub stop: &'a AtomicBool,
}

/// Tried strategy with its result.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// The strategy, with its taught start.
    pub strategy: Strategy,
    /// Windows of the soft, the medium and the stiff finger; empty if the medium one inserts from no start.
    pub windows: Vec<Window>,
    /// Largest force of their insertions, N.
    pub force_n: f64,
    /// Smallest of their ranges, mm, if all insert within the limit of force. Otherwise below 0: the smallest margin,
    /// minus 1 if the medium finger inserts from no start; or minus the excess of force, as a share of the limit.
    pub score: f64,
    /// Trial of the medium finger with the largest margin, if all starts fail.
    pub nearest: Option<Box<Trial>>,
    /// Number of windows measured.
    pub cost: usize,
}

impl<'a> Tuner<'a> {
    /// Creates the tuner of a task with its limits of force and speed, and with the robot's stop force unless the
    /// task limits the force.
    pub fn new(task: &'a Task, robot: &'a Robot, engine: EngineKind, stop: &'a AtomicBool) -> Self {
        let finger = |design: Measurement| {
            Finger::new(design.compliance, design.assembly).with_model(&task.finger, 0.0)
        };
        let fingers = designs_by_rank([0, 5, 10]).map(finger);
        let others = designs_by_rank([2, 4, 8]).map(finger);
        let force = task.limits.force.or(Some(robot.stop_force));
        let limits = Limits { force, ..task.limits };
        Tuner { task, robot, engine, fingers, others, limits, stop }
    }

    /// Returns whether tuning was stopped; the last result is then invalid.
    pub(super) fn stopped(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }

    /// Measures the windows of fingers about the strategy's own start, under these conditions.
    pub fn windows(
        &self,
        strategy: &Strategy,
        fingers: &[Finger],
        conditions: Conditions,
    ) -> Result<Vec<Evaluation>, RigError> {
        let task = Task { strategy: strategy.clone(), ..self.task.clone() };
        let measured = |finger: &Finger| {
            let rig = self.engine.rig(&task, self.robot, finger, 1.0)?;
            let grasp = Grasp { finger: *finger, conditions, stop: self.stop };
            Ok(tolerance::evaluate_grasp(&*rig, grasp, Search::Strides))
        };
        fingers.par_iter().map(measured).collect()
    }

    /// Evaluates a strategy from its own start.
    pub fn given(&self, strategy: &Strategy) -> Result<Candidate, RigError> {
        let found = self.windows(strategy, &self.fingers, Conditions::NOMINAL)?;
        Ok(self.tried(strategy.clone(), found))
    }

    /// Evaluates a strategy with its start moved to the middle of the medium finger's window.
    pub fn taught(&self, strategy: &Strategy) -> Result<Candidate, RigError> {
        let mut strategy = Strategy { rule: StartRule::Given, ..strategy.clone() };
        let most = self.limits.speed.unwrap_or(f64::INFINITY);
        strategy.phases.iter_mut().for_each(|phase| phase.speed = phase.speed.min(most));
        let task = Task { strategy: strategy.clone(), ..self.task.clone() };
        let [soft, medium, stiff] = self.fingers;
        let rig = self.engine.rig(&task, self.robot, &medium, 1.0)?;
        match teach(&*rig, &medium, self.stop) {
            Ok(taught) => {
                strategy.start[1] += offset(taught.shift);
                let mut found = self.windows(&strategy, &[soft, stiff], Conditions::NOMINAL)?;
                found.insert(1, taught.evaluation);
                Ok(self.tried(strategy, found))
            }
            Err(nearest) => {
                strategy.start[1] += offset(nearest.shift);
                // Below the score of any strategy that inserts with the medium finger.
                let score = nearest.trial.margin.min(0.0) - 1.0;
                let (windows, nearest) = (Vec::new(), Some(Box::new(nearest.trial)));
                Ok(Candidate { strategy, windows, force_n: 0.0, score, nearest, cost: 1 })
            }
        }
    }

    /// Returns a tried strategy and, if its force is above the limit, that strategy with a slower push: the force is
    /// roughly proportional to the speed.
    pub fn with_slower_push(&self, change: String, tried: Candidate) -> Vec<(String, Candidate)> {
        let limit = self.limits.force.unwrap_or(f64::INFINITY);
        let mut all = vec![(change, tried)];
        let (change, tried) = &all[0];
        let mut strategy = tried.strategy.clone();
        let Some(push) = strategy.phases.last_mut().filter(|_| tried.force_n > limit) else {
            return all;
        };
        push.speed = (push.speed * SLOWER * limit / tried.force_n / MM).floor() * MM;
        let change = format!("{change}, push slowed to {:.0} mm/s", push.speed / MM);
        if push.speed > 0.0 {
            all.extend(self.taught(&strategy).ok().map(|tried| (change, tried)));
        }
        all
    }

    /// Scores a strategy by the windows of the three fingers.
    fn tried(&self, strategy: Strategy, found: Vec<Evaluation>) -> Candidate {
        let failed = found.iter().filter(|found| found.window.nominal != Outcome::Inserted);
        // If the nominal start fails, the share is its margin; that of a trial without a depth is not a number.
        let worst = failed.map(|found| found.end_shares[0].max(-1.0)).reduce(f64::min);
        let force_n = found.iter().map(|found| found.peak_force_n).fold(0.0, f64::max);
        let windows: Vec<_> = found.into_iter().map(|found| found.window).collect();
        let least = windows.iter().map(Window::range_mm).fold(f64::INFINITY, f64::min);
        let score = match (worst, self.limits.force) {
            // A nominal start that fails with a margin of 0 is not a success, either.
            (Some(worst), _) => worst.min(0.0) - f64::EPSILON,
            (None, Some(limit)) if force_n > limit => 1.0 - force_n / limit,
            _ => least,
        };
        Candidate { strategy, cost: windows.len(), windows, force_n, score, nearest: None }
    }
}

impl Candidate {
    /// Returns whether all three fingers insert within the limit of force.
    pub fn inserts(&self) -> bool {
        self.score >= 0.0
    }

    /// Returns the smaller side of the medium finger's window, mm.
    pub fn side_mm(&self) -> f64 {
        let side = |window: &Window| window.positive_mm().min(-window.negative_mm());
        self.windows.get(1).map_or(0.0, side)
    }
}
