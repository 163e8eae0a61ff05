//! Search for a strategy that inserts with a soft, a medium and a stiff finger.

mod choice;
mod tuner;
mod variables;

pub use tuner::{Candidate, ENOUGH_MM, Tuner};

use crate::body::ConvexBody;
use crate::plan::{Family, has_core};
use ask_tell::{Grid, GridPoint, Observation, OptimizerKind};
use input::InputError;
use input::units::{DEG, MM};
use insertion::trial::Conditions;
use insertion::{DesignError, Finger, Outcome, Strategy, Task};
use rayon::prelude::*;
use std::ops::Range;

/// Default of [`Effort::budget`].
pub const DEFAULT_BUDGET: u16 = 150;
/// Number of candidates proposed at a time; fixed, so that results do not depend on the number of threads.
const BATCH: usize = 4;
/// Number of windows measured for a candidate: one for each finger.
const EACH: usize = 3;
/// Turn of the socket about z under which strategies are checked, degrees.
pub const YAW_DEG: f64 = 1.0;
/// Factors on the friction of the socket under which the recommended strategy is checked.
const FRICTION: [f64; 2] = [0.8, 1.2];
/// Number of checked changes, including the unchanged setup.
const CHANGES: usize = 5;
/// Indices of the changes that turn the socket.
const TURNED: Range<usize> = 1..3;
/// Largest number of strategies checked with a turned socket and one finger.
const FINALISTS: usize = 12;
/// Number of failures at one tilt after which other strategies with that tilt are skipped, since similar
/// ones fail alike.
const MAX_FAILED: usize = 2;

/// Stage of tuning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// The strategy of the file.
    AsItIs,
    /// A start taught with the medium finger.
    Start,
    /// Strategies of families of connectors, each with a taught start.
    Families,
    /// A search over tilt, strokes, preload and push speed.
    Search,
}

/// One strategy that was tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// The stage that tried it.
    pub stage: Stage,
    /// Change to the strategy: `like a key`.
    pub change: String,
    /// Result.
    pub tried: Candidate,
    /// Smallest range of another finger with the socket turned in either direction, mm, if it was checked.
    pub turned_mm: Option<f64>,
}

/// Robustness of the recommended strategy to a change: smallest range of the start offsets at which it inserts, of
/// three other fingers.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Robustness {
    /// The change: `yaw +1°`.
    pub change: String,
    /// Smallest range, mm; 0 if one of the fingers fails.
    pub least_range_mm: f64,
}

/// A tuned strategy.
#[derive(Debug, Clone, PartialEq)]
pub struct Tuned {
    /// Strategies tried, in order; the first is the unchanged one.
    pub steps: Vec<Step>,
    /// Index of the recommended step.
    pub best: usize,
    /// Ranges of other fingers under changes; empty unless checked.
    pub robustness: Vec<Robustness>,
    /// Number of windows measured.
    pub windows: usize,
}

/// Effort of tuning.
pub struct Effort<'a> {
    /// The last stage.
    pub last: Stage,
    /// Whether to stop after the first stage with a sufficient window ([`ENOUGH_MM`]).
    pub until_enough: bool,
    /// Largest number of windows that are measured; the search ends early enough for the checks, the stages before it
    /// are completed.
    pub budget: u16,
    /// Seed of the search.
    pub seed: u64,
    /// Progress callback: the change tried, its number of windows, windows measured so far, and their maximum.
    pub progress: &'a (dyn Fn(&str, usize, usize, usize) + Sync),
}

/// Tunes the strategy of the tuner's task.
///
/// If `tuner.stop` is set meanwhile, `steps` contains only the strategies tried before, and `robustness` is empty.
///
/// # Errors
/// If the task cannot be simulated as it is.
pub fn tune(tuner: &Tuner, effort: &Effort) -> Result<Tuned, DesignError> {
    let mut tuned = Tuned { steps: Vec::new(), best: 0, robustness: Vec::new(), windows: 0 };
    let given = tuner.given(&tuner.task.strategy)?;
    tuned.add(Stage::AsItIs, vec![("initial strategy".to_owned(), given)], effort);
    for stage in [Stage::Start, Stage::Families, Stage::Search] {
        let can_end = stage > Stage::Start && effort.until_enough;
        let best = &tuned.best().tried;
        let enough = can_end && best.inserts() && best.side_mm() >= ENOUGH_MM;
        if stage > effort.last || enough || tuner.stopped() {
            break;
        }
        match stage {
            Stage::AsItIs => {}
            Stage::Start => tuned.start(tuner, effort)?,
            Stage::Families => tuned.families(tuner, effort),
            Stage::Search => tuned.search(tuner, effort)?,
        }
    }
    if effort.last == Stage::Search && tuned.inserts() {
        tuned.check(tuner)?;
    }
    Ok(tuned)
}

impl Tuned {
    /// Returns the recommended step.
    pub fn best(&self) -> &Step {
        &self.steps[self.best]
    }

    /// Returns whether the recommended strategy inserts with all three fingers within the limit of force.
    pub fn inserts(&self) -> bool {
        self.best().tried.inserts()
    }

    /// Returns the least force of the strategies that insert with all three fingers, N.
    pub fn least_force_n(&self) -> Option<f64> {
        let inserts = |c: &&Candidate| c.windows.iter().all(|w| w.nominal == Outcome::Inserted);
        let tried = self.steps.iter().map(|step| &step.tried).filter(inserts);
        tried.map(|tried| tried.force_n).filter(|force| *force > 0.0).min_by(f64::total_cmp)
    }

    /// Adds strategies that were tried, and recommends one of all.
    fn add(&mut self, stage: Stage, tried: Vec<(String, Candidate)>, effort: &Effort) {
        for (change, last) in tried {
            self.windows += last.cost;
            let best = self.steps.get(self.best).map_or(last.score, |best| best.tried.score);
            let text = format!("{:.1} mm so far; {change}", best.max(last.score).max(0.0));
            (effort.progress)(&text, last.cost, self.windows, effort.budget.into());
            let nearest = if last.score > best { self.steps.len() } else { self.best };
            self.steps.push(Step { stage, change, tried: last, turned_mm: None });
            self.best = self.recommended(&self.inserting()).unwrap_or(nearest);
        }
    }

    /// Tries a taught start and, if the sweep is upright, also a tilted tip, which finds a single opening from farther
    /// away.
    fn start(&mut self, tuner: &Tuner, effort: &Effort) -> Result<(), DesignError> {
        let own = &tuner.task.strategy;
        let tried = tuner.taught(own)?;
        let change =
            format!("start taught, {:+.1} mm in y", (tried.strategy.start[1] - own.start[1]) / MM);
        let slowed = tuner.with_slower_push(change, tried);
        if tuner.stopped() {
            return Ok(());
        }
        self.add(Stage::Start, slowed, effort);
        let upright = own.tilt == 0.0 && effort.until_enough && !has_core(tuner.task);
        if upright && let Some(strategy) = Family::Key.strategy_for(tuner.task) {
            let slowed = tuner.with_slower_push(Family::Key.name(), tuner.taught(&strategy)?);
            if !tuner.stopped() {
                self.add(Stage::Start, slowed, effort);
            }
        }
        Ok(())
    }

    fn families(&mut self, tuner: &Tuner, effort: &Effort) {
        let tried = |family: &Family| {
            let tried = tuner.taught(&family.strategy_for(tuner.task)?).ok()?;
            Some(tuner.with_slower_push(family.name(), tried))
        };
        let families: Vec<_> = Family::all().collect();
        let tried: Vec<_> = families.par_iter().filter_map(tried).flatten_iter().collect();
        if !tuner.stopped() {
            self.add(Stage::Families, tried, effort);
        }
    }

    fn search(&mut self, tuner: &Tuner, effort: &Effort) -> Result<(), InputError> {
        let from = self.best().tried.strategy.clone();
        let task = Task { strategy: from, limits: tuner.limits, ..tuner.task.clone() };
        let free = variables::variables(&task.strategy)?;
        let grid = Grid::new(vec![variables::LEVELS; free.len()]);
        let mut optimizer = ask_tell::build(OptimizerKind::Gp, grid.clone(), effort.seed);
        let limit = usize::from(effort.budget).saturating_sub(Self::CHECKS + EACH);
        let middle = grid.snap(&vec![0.5; free.len()]);
        optimizer.tell(&[Observation::new(middle, Some(self.best().tried.score))]);
        while self.windows + BATCH * EACH <= limit {
            let points = optimizer.ask(BATCH);
            if points.is_empty() {
                break;
            }
            let taught = |point: &GridPoint| {
                let (strategy, change) = variables::strategy_at(&task, &free, &grid.unit(point));
                (change, tuner.taught(&strategy).ok())
            };
            let tried: Vec<_> = points.par_iter().map(taught).collect();
            if tuner.stopped() {
                break;
            }
            let scores = tried.iter().map(|(_, tried)| tried.as_ref().map(|tried| tried.score));
            let told = points.into_iter().zip(scores);
            let told: Vec<_> = told.map(|(point, score)| Observation::new(point, score)).collect();
            optimizer.tell(&told);
            let tried = tried.into_iter().filter_map(|(change, tried)| Some((change, tried?)));
            self.add(Stage::Search, tried.collect(), effort);
        }
        Ok(())
    }

    /// Largest number of windows measured by [`Tuned::check`].
    const CHECKS: usize = CHANGES * EACH + (TURNED.end - TURNED.start) * FINALISTS;

    /// Recommends a strategy by its range under a turned socket, and measures it under all changes.
    fn check(&mut self, tuner: &Tuner) -> Result<(), DesignError> {
        let mut order = self.inserting();
        // The best strategy of the earlier stages comes first.
        let earlier = order.iter().filter(|(at, _)| self.steps[*at].stage < Stage::Search);
        let earlier = self.recommended(&earlier.copied().collect::<Vec<_>>());
        order.sort_by(|a, b| b.1.total_cmp(&a.1));
        order.sort_by_key(|(place, _)| Some(*place) != earlier);
        let (mut checked, mut failed) = (Vec::new(), Vec::new());
        for (place, range_mm) in order {
            let strategy = &self.steps[place].tried.strategy;
            let with_tilt = failed.iter().filter(|&&tilt| tilt == strategy.tilt).count();
            let with = [&checked[..], &[(place, range_mm)]].concat();
            let full = checked.len() + failed.len() == FINALISTS || with_tilt == MAX_FAILED;
            if full || self.recommended(&with) == self.recommended(&checked) {
                continue;
            }
            let turned = robustness(tuner, strategy, &tuner.others[1..2], TURNED)?;
            if tuner.stopped() {
                return Ok(());
            }
            self.windows += turned.len();
            let turned = turned.iter().map(|one| one.least_range_mm).fold(f64::INFINITY, f64::min);
            match turned > 0.0 {
                true => checked.push((place, turned.min(range_mm))),
                false => failed.push(strategy.tilt),
            }
            self.steps[place].turned_mm = Some(turned);
        }
        self.best = self.recommended(&checked).or(earlier).unwrap_or(self.best);
        let kept = robustness(tuner, &self.best().tried.strategy, &tuner.others, 0..CHANGES)?;
        if !tuner.stopped() {
            self.windows += kept.len() * tuner.others.len();
            self.robustness = kept;
        }
        Ok(())
    }

    /// Returns the end of the failed trial that came closest to insertion (largest margin), of the strategies with
    /// which no start inserts; `None` without such strategies.
    pub fn nearest(&self, task: &Task) -> Option<Stopped> {
        let failed = self.steps.iter().filter_map(|step| step.tried.nearest.as_ref());
        let trial = failed.max_by(|a, b| a.margin.total_cmp(&b.margin))?;
        let phase = trial.phases.last()?;
        let strongest =
            phase.contacts.iter().max_by(|a, b| a.force.norm().total_cmp(&b.force.norm()));
        let parts = strongest.map(|contact| {
            let (plug, socket) = (ConvexBody::plug(&task.plug), ConvexBody::new(&task.socket));
            let here = phase.poses.plug.inverse() * contact.point;
            let name = |body: &ConvexBody, point| {
                let at = body.near(point, TOUCHING).min();
                at.map_or(String::new(), |i| body.parts[i].name.clone())
            };
            [name(&plug, &here), name(&socket, &contact.point)]
        });
        Some(Stopped {
            outcome: trial.outcome.label(),
            robot_stopped: trial.robot_stopped,
            phase: phase.name.clone(),
            depth_mm: trial.depth_mm,
            tilt_deg: trial.tilt_deg,
            parts,
        })
    }
}

/// Measures the smallest range of fingers under each of a range of changes.
fn robustness(
    tuner: &Tuner,
    strategy: &Strategy,
    fingers: &[Finger],
    which: Range<usize>,
) -> Result<Vec<Robustness>, DesignError> {
    let nominal = Conditions::NOMINAL;
    let yaw = |degrees: f64| Conditions { yaw: degrees * DEG, ..nominal };
    let friction = |factor| Conditions { friction_socket: factor, ..nominal };
    let [less, more] = FRICTION;
    let changes: [_; CHANGES] = [
        ("none".to_owned(), nominal),
        (format!("socket turned by {YAW_DEG}°"), yaw(YAW_DEG)),
        (format!("socket turned by -{YAW_DEG}°"), yaw(-YAW_DEG)),
        (format!("friction plug-socket times {less}"), friction(less)),
        (format!("friction plug-socket times {more}"), friction(more)),
    ];
    let under = |(change, conditions): &(String, Conditions)| {
        let windows = tuner.windows(strategy, fingers, *conditions)?;
        let ranges = windows.iter().map(|found| found.window.range_mm());
        let least_range_mm = ranges.fold(f64::INFINITY, f64::min);
        Ok(Robustness { change: change.clone(), least_range_mm })
    };
    changes[which].par_iter().map(under).collect()
}

/// Largest distance of a part from a contact point on it, m.
const TOUCHING: f64 = 0.05 * MM;

/// End of a failed trial.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Stopped {
    /// Kind of failure.
    pub outcome: &'static str,
    /// Whether the robot stopped.
    pub robot_stopped: bool,
    /// Phase in which the trial ended.
    pub phase: String,
    /// Depth of the tip below the socket's top, mm.
    pub depth_mm: f64,
    /// Angle between the plug's axis and z, degrees.
    pub tilt_deg: f64,
    /// The parts of plug and socket between which the largest force acts.
    #[serde(rename = "plug_and_socket_part")]
    pub parts: Option<[String; 2]>,
}
