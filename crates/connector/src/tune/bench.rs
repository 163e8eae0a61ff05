//! Windows of a few measured fingers from one start.

use insertion::evaluation::tolerance::{self, Search, offset};
use insertion::evaluation::{Window, taught::teach};
use insertion::finger::Finger;
use insertion::outcome::Outcome;
use insertion::robot::Robot;
use insertion::stiffness::designs;
use insertion::task::{StartRule, Strategy, Task};
use insertion::trial::engine::EngineKind;
use insertion::trial::run::RigError;
use insertion::trial::{Conditions, Grasp, Trial};
use rayon::prelude::*;
use std::sync::atomic::AtomicBool;

/// Least window to either side of the start that counts as enough, mm.
pub const ENOUGH_MM: f64 = 0.5;

/// Where strategies for a task are tried.
pub struct Bench<'a> {
    /// The task, whose strategy is replaced.
    pub task: &'a Task,
    /// Robot that carries the fingers.
    pub robot: &'a Robot,
    /// Contact engine.
    pub engine: EngineKind,
    /// A soft, a medium and a stiff finger.
    pub fingers: [Finger; 3],
    /// Three others, between them.
    pub others: [Finger; 3],
    /// Set when all results are to be thrown away.
    pub stop: &'a AtomicBool,
}

/// Result of a strategy.
#[derive(Debug, Clone, PartialEq)]
pub struct Tried {
    /// The strategy, its start where it was taught.
    pub strategy: Strategy,
    /// Windows of the soft, the medium and the stiff finger; of none where the medium one
    /// inserts from no start.
    pub windows: Vec<Window>,
    /// The least of their ranges, mm, if all insert; otherwise below 0, by how clearly they fail.
    pub score: f64,
    /// Of starts that all fail the one that fails least clearly, by the medium finger.
    pub nearest: Option<Box<Trial>>,
    /// Windows that were measured for this.
    pub cost: usize,
}

/// The measured fingers at six places between the softest and the stiffest.
pub fn fingers() -> Option<[Finger; 6]> {
    let mut designs = designs();
    designs.sort_by(|a, b| a.compliance.total_cmp(&b.compliance));
    let last = designs.len().checked_sub(1)?;
    let at = |fifths: usize| {
        let design = &designs[last * fifths / 10];
        Finger::new(design.compliance, design.assembly)
    };
    Some([0, 5, 10, 2, 4, 8].map(at))
}

impl<'a> Bench<'a> {
    /// The bench of a task; `None` if no measured fingers are shipped.
    pub fn new(
        task: &'a Task,
        robot: &'a Robot,
        engine: EngineKind,
        stop: &'a AtomicBool,
    ) -> Option<Self> {
        let [soft, medium, stiff, others @ ..] =
            fingers()?.map(|finger| finger.shaped(&task.finger, 0.0));
        Some(Bench { task, robot, engine, fingers: [soft, medium, stiff], others, stop })
    }

    /// The window of a finger and how clearly its nominal start fails, 0 if it inserts.
    fn window(
        &self,
        strategy: &Strategy,
        finger: &Finger,
        conditions: Conditions,
    ) -> Result<(Window, f64), RigError> {
        let task = Task { strategy: strategy.clone(), ..self.task.clone() };
        let rig = self.engine.rig(&task, self.robot, finger, 1.0)?;
        let grasp = Grasp { finger: *finger, conditions, stop: self.stop };
        let found = tolerance::evaluate_in(&*rig, grasp, Search::Strides);
        let inserts = found.window.nominal == Outcome::Inserted;
        Ok((found.window, if inserts { 0.0 } else { found.end_shares[0].min(0.0) }))
    }

    /// The windows of fingers under some conditions, from the strategy's own start.
    pub fn windows(
        &self,
        strategy: &Strategy,
        fingers: &[Finger],
        conditions: Conditions,
    ) -> Result<Vec<(Window, f64)>, RigError> {
        fingers.par_iter().map(|finger| self.window(strategy, finger, conditions)).collect()
    }

    /// The strategy from its own start.
    pub fn given(&self, strategy: &Strategy) -> Result<Tried, RigError> {
        let found = self.windows(strategy, &self.fingers, Conditions::NOMINAL)?;
        Ok(Tried::of(strategy.clone(), found))
    }

    /// The strategy with its start moved to the middle of the medium finger's window.
    pub fn taught(&self, strategy: &Strategy) -> Result<Tried, RigError> {
        let mut strategy = Strategy { rule: StartRule::Given, ..strategy.clone() };
        let task = Task { strategy: strategy.clone(), ..self.task.clone() };
        let [soft, medium, stiff] = self.fingers;
        let rig = self.engine.rig(&task, self.robot, &medium, 1.0)?;
        match teach(&*rig, &medium, self.stop) {
            Ok(taught) => {
                strategy.start[1] += offset(taught.by);
                let others = self.windows(&strategy, &[soft, stiff], Conditions::NOMINAL)?;
                let mut found = others;
                found.insert(1, (taught.window, 0.0));
                Ok(Tried::of(strategy, found))
            }
            Err(nearest) => {
                strategy.start[1] += offset(nearest.by);
                // Below whatever inserts with the medium finger.
                let score = nearest.trial.margin.min(0.0) - 1.0;
                let nearest = Some(Box::new(nearest.trial));
                Ok(Tried { strategy, windows: Vec::new(), score, nearest, cost: 1 })
            }
        }
    }
}

impl Tried {
    fn of(strategy: Strategy, found: Vec<(Window, f64)>) -> Self {
        let worst = found.iter().map(|(_, margin)| *margin).fold(0.0, f64::min);
        let inserts = found.iter().all(|(window, _)| window.nominal == Outcome::Inserted);
        let windows: Vec<_> = found.into_iter().map(|(window, _)| window).collect();
        let least = windows.iter().map(Window::range_mm).fold(f64::INFINITY, f64::min);
        // A nominal start that fails by nothing is no success.
        let score = if inserts { least } else { worst - f64::EPSILON };
        Tried { strategy, cost: windows.len(), windows, score, nearest: None }
    }

    /// Whether all three fingers insert.
    pub fn inserts(&self) -> bool {
        self.score >= 0.0
    }

    /// The medium finger's smaller side, mm.
    pub fn side_mm(&self) -> f64 {
        let side = |window: &Window| window.positive_mm().min(-window.negative_mm());
        self.windows.get(1).map_or(0.0, side)
    }

    /// Whether all three insert, and the medium one far enough to either side.
    pub fn is_enough(&self) -> bool {
        self.inserts() && self.side_mm() >= ENOUGH_MM
    }
}
