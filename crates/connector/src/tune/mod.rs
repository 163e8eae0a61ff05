//! Search for a strategy that inserts with a soft, a medium and a stiff finger.

mod bench;
mod knobs;

pub use bench::{Bench, ENOUGH_MM, Measured, Tried};

use crate::body::ConvexBody;
use crate::plan::{Family, has_core};
use ask_tell::{Grid, Observation, OptimizerKind};
use input::InputError;
use input::units::{DEG, MM};
use insertion::evaluation::INDIFFERENCE_MM;
use insertion::evaluation::template::Impossible;
use insertion::finger::Finger;
use insertion::outcome::Outcome;
use insertion::task::{Strategy, Task};
use insertion::trial::Conditions;
use rayon::prelude::*;
use std::ops::Range;

/// Largest number of windows that are measured.
pub const MOST_WINDOWS: usize = 150;
/// Candidates that are proposed at a time: a number of its own, so that threads decide nothing.
const BATCH: usize = 4;
/// Windows of a candidate.
const EACH: usize = 3;
/// Turn of the socket that is checked, degrees, and factors on its friction.
pub const YAW_DEG: f64 = 1.0;
const FRICTION: [f64; 2] = [0.8, 1.2];
/// Changes that are checked, no change among them, and those of them that turn the socket.
const CHANGES: usize = 5;
const TURNED: Range<usize> = 1..3;
/// Most strategies that are checked with a turned socket and one finger, and those of one tilt that may keep
/// nothing there before the others of that tilt are passed over: neighbours in a search fail alike.
const FINALISTS: usize = 12;
const ALIKE: usize = 2;

/// Stage of tuning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// The strategy as the file has it.
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
    /// Name of the change: `like a key`.
    pub what: String,
    /// Result.
    pub tried: Tried,
    /// Smallest range of another finger with the socket turned in either direction, mm, if that was checked.
    pub turned_mm: Option<f64>,
}

/// Robustness of the recommended strategy to a change: smallest range of three other fingers, mm; 0 if
/// one of them fails.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Robustness {
    /// The change: `yaw +1°`.
    pub change: String,
    /// Least range, mm.
    pub least_range_mm: f64,
}

/// A tuned strategy.
#[derive(Debug, Clone, PartialEq)]
pub struct Tuned {
    /// All that was tried, in its order; the first is the strategy as it was.
    pub steps: Vec<Step>,
    /// Index of the recommended step.
    pub best: usize,
    /// Ranges of other fingers under changes; empty unless requested.
    pub kept: Vec<Robustness>,
    /// Windows measured for all this.
    pub windows: usize,
}

/// Effort of tuning.
pub struct Effort<'a> {
    /// The last stage.
    pub last: Stage,
    /// Whether to stop after the first stage that is enough.
    pub until_enough: bool,
    /// Seed of the search.
    pub seed: u64,
    /// Progress callback: what was tried, its windows, windows measured so far, and their maximum.
    pub tell: &'a (dyn Fn(&str, usize, usize, usize) + Sync),
}

/// Tunes the strategy of the bench's task.
///
/// If `bench.stop` is set meanwhile, the result is what was tried until then; nothing else is in `steps`, and `kept` is
/// empty.
///
/// # Errors
/// If the task cannot be simulated as it is.
pub fn tune(bench: &Bench, effort: &Effort) -> Result<Tuned, Impossible> {
    let mut tuned = Tuned { steps: Vec::new(), best: 0, kept: Vec::new(), windows: 0 };
    let given = bench.given(&bench.task.strategy)?;
    tuned.add(Stage::AsItIs, [("as it is".to_owned(), given)], effort);
    for stage in [Stage::Start, Stage::Families, Stage::Search] {
        let tried = stage > Stage::Start && effort.until_enough;
        let enough = tried && tuned.best().tried.is_enough();
        if stage > effort.last || enough || bench.stopped() {
            break;
        }
        match stage {
            Stage::AsItIs => {}
            Stage::Start => tuned.start(bench, effort)?,
            Stage::Families => tuned.families(bench, effort),
            Stage::Search => tuned.search(bench, effort)?,
        }
    }
    if effort.last == Stage::Search && tuned.inserts() {
        tuned.check(bench)?;
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
        let inserts = |tried: &&Tried| tried.windows.iter().all(|w| w.nominal == Outcome::Inserted);
        let tried = self.steps.iter().map(|step| &step.tried).filter(inserts);
        tried.map(|tried| tried.force_n).filter(|force| *force > 0.0).min_by(f64::total_cmp)
    }

    /// Adds strategies that were tried. To become the best, one of a later stage must be better by [`INDIFFERENCE_MM`]; any
    /// improvement is enough within a stage, or if the best one fails.
    fn add(
        &mut self,
        stage: Stage,
        tried: impl IntoIterator<Item = (String, Tried)>,
        effort: &Effort,
    ) {
        for (what, last) in tried {
            self.windows += last.cost;
            (effort.tell)(&what, last.cost, self.windows, MOST_WINDOWS);
            let second = self.steps.len() == 1;
            let better = self.steps.get(self.best).is_some_and(|best| {
                let (own, best) = (best.stage == stage, &best.tried);
                let margin = if best.inserts() && !own { INDIFFERENCE_MM } else { 0.0 };
                // A middle is worth more than a start near the end of as wide a window.
                let centred = second
                    && last.side_mm() >= best.side_mm() + INDIFFERENCE_MM
                    && last.score >= best.score - INDIFFERENCE_MM;
                last.score > best.score + margin || centred
            });
            if better {
                self.best = self.steps.len();
            }
            self.steps.push(Step { stage, what, tried: last, turned_mm: None });
        }
    }

    /// Tries a taught start and, beside an upright sweep, a tilted tip: about one opening it finds the seat from farther
    /// away.
    fn start(&mut self, bench: &Bench, effort: &Effort) -> Result<(), Impossible> {
        let own = &bench.task.strategy;
        let tried = bench.taught(own)?;
        let what =
            format!("start taught, {:+.1} mm in y", (tried.strategy.start[1] - own.start[1]) / MM);
        let slowed = bench.with_slower_push(what, tried);
        if bench.stopped() {
            return Ok(());
        }
        self.add(Stage::Start, slowed, effort);
        let upright = own.tilt == 0.0 && effort.until_enough && !has_core(bench.task);
        if upright && let Some(strategy) = Family::Key.of(bench.task) {
            let slowed = bench.with_slower_push(Family::Key.name(), bench.taught(&strategy)?);
            if !bench.stopped() {
                self.add(Stage::Start, slowed, effort);
            }
        }
        Ok(())
    }

    fn families(&mut self, bench: &Bench, effort: &Effort) {
        let families: Vec<_> = Family::all().collect();
        let tried: Vec<Option<Vec<_>>> = families
            .par_iter()
            .map(|family| {
                let tried = bench.taught(&family.of(bench.task)?).ok()?;
                Some(bench.with_slower_push(family.name(), tried))
            })
            .collect();
        if !bench.stopped() {
            self.add(Stage::Families, tried.into_iter().flatten().flatten(), effort);
        }
    }

    fn search(&mut self, bench: &Bench, effort: &Effort) -> Result<(), InputError> {
        let from = self.best().tried.strategy.clone();
        let task = Task { strategy: from, limits: bench.limits, ..bench.task.clone() };
        let knobs = knobs::knobs(&task.strategy)?;
        let grid = Grid::new(vec![knobs::LEVELS; knobs.len()]);
        let mut optimizer = ask_tell::build(OptimizerKind::Gp, grid.clone(), effort.seed);
        let limit = MOST_WINDOWS - Self::CHECKS - EACH;
        let middle = grid.snap(&vec![0.5; knobs.len()]);
        optimizer.tell(&[Observation::new(middle, Some(self.best().tried.score))]);
        while self.windows + BATCH * EACH <= limit {
            let points = optimizer.ask(BATCH);
            if points.is_empty() {
                break;
            }
            let tried: Vec<_> = points
                .par_iter()
                .map(|point| {
                    let (strategy, what) = knobs::turned(&task, &knobs, &grid.unit(point));
                    (what, bench.taught(&strategy).ok())
                })
                .collect();
            if bench.stopped() {
                break;
            }
            let score = |tried: &Option<Tried>| tried.as_ref().map(|tried| tried.score);
            let told: Vec<_> = points
                .into_iter()
                .zip(&tried)
                .map(|(point, (_, tried))| Observation::new(point, score(tried)))
                .collect();
            optimizer.tell(&told);
            let tried = tried.into_iter().filter_map(|(what, tried)| Some((what, tried?)));
            self.add(Stage::Search, tried, effort);
        }
        Ok(())
    }

    /// Windows of the check.
    const CHECKS: usize = CHANGES * EACH + TURNED.end * FINALISTS - TURNED.start * FINALISTS;

    /// Recommends the strategy with the widest range under a turned socket, and measures it under all changes.
    fn check(&mut self, bench: &Bench) -> Result<(), Impossible> {
        let inserts = |place: &usize| self.steps[*place].tried.inserts();
        let mut order: Vec<_> = (0..self.steps.len()).filter(inserts).collect();
        let score: Vec<_> = self.steps.iter().map(|step| step.tried.score).collect();
        order.sort_by(|&a, &b| score[b].total_cmp(&score[a]));
        // First the best that was not searched for: what is no wider when turned does not replace it.
        let plain = order.iter().position(|&place| self.steps[place].stage < Stage::Search);
        plain.iter().for_each(|&at| order[..=at].rotate_right(1));
        let mut most = (self.best, f64::NEG_INFINITY);
        let (mut checked, mut failed) = (0, Vec::new());
        for place in order {
            let strategy = &self.steps[place].tried.strategy;
            let alike = failed.iter().filter(|&&tilt| tilt == strategy.tilt).count();
            if checked == FINALISTS || score[place] <= most.1 + INDIFFERENCE_MM {
                break;
            }
            if alike == ALIKE {
                continue;
            }
            checked += 1;
            let kept = self.kept(bench, strategy, &bench.others[1..2], TURNED)?;
            if bench.stopped() {
                return Ok(());
            }
            self.windows += kept.len();
            let turned = kept.iter().map(|kept| kept.least_range_mm).fold(f64::INFINITY, f64::min);
            if turned <= 0.0 {
                failed.push(strategy.tilt);
            }
            self.steps[place].turned_mm = Some(turned);
            let least = turned.min(score[place]);
            if least > most.1 + INDIFFERENCE_MM {
                most = (place, least);
            }
        }
        self.best = most.0;
        let kept = self.kept(bench, &self.best().tried.strategy, &bench.others, 0..CHANGES)?;
        if !bench.stopped() {
            self.windows += kept.len() * bench.others.len();
            self.kept = kept;
        }
        Ok(())
    }

    /// Measures the smallest range of fingers under turned sockets and other friction.
    fn kept(
        &self,
        bench: &Bench,
        strategy: &Strategy,
        fingers: &[Finger],
        which: Range<usize>,
    ) -> Result<Vec<Robustness>, Impossible> {
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
            let windows = bench.windows(strategy, fingers, *conditions)?;
            let ranges = windows.iter().map(|found| found.window.range_mm());
            let least_range_mm = ranges.fold(f64::INFINITY, f64::min);
            Ok(Robustness { change: change.clone(), least_range_mm })
        };
        changes[which].par_iter().map(under).collect()
    }

    /// Returns where the start that failed least clearly came to its end, of strategies without any that
    /// inserts.
    pub fn nearest(&self, task: &Task) -> Option<Stopped> {
        let failed = self.steps.iter().filter_map(|step| step.tried.nearest.as_ref());
        let trial = failed.max_by(|a, b| a.margin.total_cmp(&b.margin))?;
        let phase = trial.phases.last()?;
        let strongest =
            phase.contacts.iter().max_by(|a, b| a.force.norm().total_cmp(&b.force.norm()));
        let met = strongest.map(|contact| {
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
            phase: phase.name.clone(),
            depth_mm: trial.depth_mm,
            tilt_deg: trial.tilt_deg,
            met,
        })
    }
}

/// Distance within which a part is at a contact point, m.
const TOUCHING: f64 = 0.05 * MM;

/// End of the trial with the largest margin, if all failed.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Stopped {
    /// Kind of failure.
    pub outcome: &'static str,
    /// Phase in which the trial ended.
    pub phase: String,
    /// Depth of the tip below the socket's top, mm.
    pub depth_mm: f64,
    /// Angle between the plug's axis and z, degrees.
    pub tilt_deg: f64,
    /// The parts of plug and socket between which the largest force acts.
    #[serde(rename = "plug_and_socket_part")]
    pub met: Option<[String; 2]>,
}
