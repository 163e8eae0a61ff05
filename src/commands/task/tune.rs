//! `optimize task tune`: finds a strategy that inserts a connector.

use crate::command;
use crate::context::{Context, not_stopped};
use crate::failure::Failure;
use crate::layout::{lines, wrapped};
use crate::progress::Part;
use crate::setup::files::robot;
use crate::setup::request::{DEFAULT_ROBOT, TaskSource};
use crate::setup::task::TaskFile;
use crate::setup::tune::{Tried, outcome, ranges, tried, turned_text};
use connector::check::problems;
use connector::tune::{Effort, MOST_WINDOWS, Robustness, Stage, Step, Stopped, Tuned, Tuner, tune};
use connector::{picture, rewrite};
use input::Place;
use input::shipped::Source;
use input::units::{DEG, MM, N_PER_MM};
use insertion::evaluation::{INDIFFERENCE_MM, Window};
use insertion::finger::Finger;
use insertion::robot::Robot;
use insertion::task::parts_file::without_parts;
use insertion::task::{Limits, Strategy, Task};
use insertion::trial::Conditions;
use insertion::trial::engine::EngineKind;
use serde::{Serialize, Serializer};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use study::write_file;

/// Find a start and a strategy that insert a connector, before fingers are compared
///
/// First the start is taught with a medium finger; then the strategies of the shipped tasks are tried, scaled to
/// this opening; then tilt, strokes, preload and push speed are optimized for the smallest range of a soft, a
/// medium and a stiff finger. Exit code 1 if nothing inserts. Ctrl-C writes the best strategy so far.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(display_order = 5, after_help = "Example: optimize task tune mine.toml --svg mine.svg")]
pub struct Request {
    /// Task file, which is rewritten; or the name of a shipped task, with --out
    #[arg(value_name = "FILE")]
    pub file: String,
    /// Robot: see `optimize robots`, or the path of a robot file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_ROBOT)]
    pub robot: String,
    /// Contact engine
    #[arg(long, value_enum, default_value_t)]
    pub engine: EngineKind,
    /// Seed of the search
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Largest force between plug and socket, N [default: limits.force_n of the task, or the robot's stop force]
    #[arg(long, value_name = "N", value_parser = positive)]
    pub max_force_n: Option<f64>,
    /// Largest speed of a phase, mm/s [default: limits.speed_mm_per_s of the task]
    #[arg(long, value_name = "MM/S", value_parser = positive)]
    pub max_speed_mm_per_s: Option<f64>,
    /// Write this new file instead of FILE
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Write no task file
    #[arg(long)]
    pub dry_run: bool,
    /// Draw the search before and after
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
}

/// Windows of the fingers on the tuned task.
pub struct TunedWindows {
    /// The windows.
    pub windows: Vec<Window>,
    /// Largest force of the insertions, N.
    pub force_n: f64,
}

/// Parses a finite number above 0.
fn positive(text: &str) -> Result<f64, String> {
    let value = text.parse().unwrap_or(f64::NAN);
    let accepted = value > 0.0 && f64::is_finite(value);
    if accepted { Ok(value) } else { Err("give a number above 0".to_owned()) }
}

/// Result of tuning a task.
pub struct TunedTask {
    /// Task file, as given on the command line.
    file: String,
    /// The task before tuning.
    pub task: Task,
    /// All strategies that were tried.
    pub tuned: Tuned,
    /// The soft, the medium and the stiff finger.
    pub fingers: [Finger; 3],
    /// Three others, between them, with which the chosen strategy is checked.
    pub others: [Finger; 3],
    /// Limits of force and speed.
    pub limits: Limits,
    /// Windows of the fingers on the tuned task; `None` if no strategy inserts.
    pub after: Option<TunedWindows>,
    /// The file that was written, if one was.
    pub written: Option<PathBuf>,
}

impl command::Request for Request {
    type Response = TunedTask;
    const PROGRESS: bool = true;

    fn run(&self, context: &Context<'_>) -> Result<TunedTask, Failure> {
        let stop = context.stop;
        context.cancel_on_interrupt()?;
        context.begin(MOST_WINDOWS as f64);
        let file = TaskFile::parse(TaskSource::Named(self.file.clone()).read()?)?;
        let target = self.target()?;
        if let Some(problem) = problems(&file.task).first() {
            let (file, key, text) = (&file.source.file, &problem.key, &problem.problem);
            let more = "`optimize task check` lists the accepted values";
            let problem = format!("{text}; {more}");
            return Err(Failure::task(Place::file(file).key(key).fault(problem)));
        }
        let robot = robot(&self.robot)?;
        let tuner = self.tuner(&file.task, &robot, stop);
        let report = |what: &str, cost: usize, done, of| {
            context.part(&Part { what: what.to_owned(), done, of, cost: cost as f64 });
        };
        let effort =
            Effort { last: Stage::Search, until_enough: false, seed: self.seed, progress: &report };
        let tuned = tune(&tuner, &effort).map_err(Failure::input)?;
        if context.check().is_err() {
            return Err(self.interrupted(&file, &tuned, target)?);
        }
        let Tuner { fingers, others, limits, .. } = tuner;
        let mut done = TunedTask {
            file: self.file.clone(),
            task: file.task.clone(),
            tuned,
            fingers,
            others,
            limits,
            after: None,
            written: None,
        };
        if done.tuned.inserts() {
            done.after = match self.write(&file, &done, &robot, (target, stop)) {
                Err(Failure::Interrupted(_)) => {
                    return Err(self.interrupted(&file, &done.tuned, target)?);
                }
                found => Some(found?),
            };
            done.written = target.filter(|_| !self.dry_run).map(Path::to_path_buf);
        }
        Ok(done)
    }
}

impl Request {
    /// Returns the tuner of a task, with the limits given on the command line.
    fn tuner<'a>(&self, task: &'a Task, robot: &'a Robot, stop: &'a AtomicBool) -> Tuner<'a> {
        let mut tuner = Tuner::new(task, robot, self.engine, stop);
        let given =
            Limits { force: self.max_force_n, speed: self.max_speed_mm_per_s.map(|v| v * MM) };
        tuner.limits = given.or(tuner.limits);
        tuner
    }

    /// Returns the file to write; a shipped task cannot be overwritten.
    fn target(&self) -> Result<Option<&Path>, Failure> {
        match &self.out {
            Some(out) if out.exists() => {
                let out = out.display();
                Err(Failure::usage(format!("{out} exists; name another file with --out")))
            }
            Some(out) => Ok(Some(out)),
            None if Path::new(&self.file).is_file() => Ok(Some(Path::new(&self.file))),
            None if self.dry_run => Ok(None),
            None => Err(Failure::usage(format!(
                "{} is a shipped task: name the file to write with --out",
                self.file
            ))),
        }
    }

    /// Writes the task with its best strategy, and the drawing; returns the windows of that task.
    fn write(
        &self,
        file: &TaskFile,
        done: &TunedTask,
        robot: &Robot,
        (target, stop): (Option<&Path>, &AtomicBool),
    ) -> Result<TunedWindows, Failure> {
        let after = rewritten(file, &done.tuned)?;
        let tuner = self.tuner(&after.task, robot, stop);
        let found = tuner.windows(&after.task.strategy, &tuner.fingers, Conditions::NOMINAL);
        not_stopped(stop)?;
        let found = found.map_err(Failure::input)?;
        let force_n = found.iter().map(|found| found.force_n).fold(0.0, f64::max);
        let windows = found.into_iter().map(|found| found.window).collect();
        self.save(file, &after, target)?;
        Ok(TunedWindows { windows, force_n })
    }

    /// Writes the drawing and, unless it is a dry run, the task.
    fn save(
        &self,
        file: &TaskFile,
        after: &TaskFile,
        target: Option<&Path>,
    ) -> Result<(), Failure> {
        if let Some(svg) = &self.svg {
            let tasks = [("before: ", &file.task), ("after: ", &after.task)];
            write_file(svg, &picture::stacked(&tasks))?;
        }
        if let (Some(target), false) = (target, self.dry_run) {
            // In the same folder the file refers to its parts file; elsewhere it contains the parts.
            let beside = target.parent() == Path::new(&file.source.file).parent();
            let text = &after.source.text;
            write_file(target, if beside { without_parts(text) } else { text })?;
        }
        Ok(())
    }

    /// Writes the best strategy so far, if it differs from the initial one; returns the error of the interruption.
    fn interrupted(
        &self,
        file: &TaskFile,
        tuned: &Tuned,
        target: Option<&Path>,
    ) -> Result<Failure, Failure> {
        let Some(target) = target.filter(|_| tuned.best > 0 && tuned.inserts() && !self.dry_run)
        else {
            let hint = format!("no better strategy was found yet; {} is unchanged", self.file);
            return Ok(Failure::Interrupted(Some(hint)));
        };
        self.save(file, &rewritten(file, tuned)?, Some(target))?;
        let (best, target) = (outcome(tuned.best()), target.display());
        let hint = format!(
            "{target} has the best strategy so far ({best}); search on from it with: optimize task tune {target}"
        );
        Ok(Failure::Interrupted(Some(hint)))
    }
}

/// Returns the task file with the recommended strategy.
fn rewritten(file: &TaskFile, tuned: &Tuned) -> Result<TaskFile, Failure> {
    let (source, strategy) = (&file.source, &tuned.best().tried.strategy);
    let text = rewrite::with_strategy(&source.text, strategy).map_err(Failure::input)?;
    TaskFile::parse(Source { file: source.file.clone(), text })
}

/// Strategy with the windows of the fingers, as in the output of `--json`.
#[derive(Serialize)]
struct StrategyWindows<'a> {
    start_mm: [f64; 3],
    tilt_deg: f64,
    push_speed_mm_per_s: f64,
    largest_force_n: f64,
    fingers: Vec<FingerWindow<'a>>,
}

#[derive(Serialize)]
struct FingerWindow<'a> {
    compliance_n_per_mm: f64,
    assembly_n_per_mm: f64,
    nominal: &'a str,
    window_mm: [f64; 2],
    range_mm: f64,
}

impl<'a> StrategyWindows<'a> {
    fn new(strategy: &Strategy, windows: &[Window], force_n: f64, fingers: &[Finger]) -> Self {
        let result = |(finger, window): (&Finger, &Window)| FingerWindow {
            compliance_n_per_mm: finger.compliance / N_PER_MM,
            assembly_n_per_mm: finger.assembly / N_PER_MM,
            nominal: window.nominal.word(),
            window_mm: [window.negative_mm(), window.positive_mm()],
            range_mm: window.range_mm(),
        };
        StrategyWindows {
            start_mm: strategy.start.map(|at| (at / MM * 1e4).round() / 1e4),
            tilt_deg: (strategy.tilt / DEG * 100.0).round() / 100.0,
            push_speed_mm_per_s: push_speed_mm_per_s(strategy),
            largest_force_n: force_n,
            fingers: fingers.iter().zip(windows).map(result).collect(),
        }
    }
}

/// Returns the speed of the last phase, mm/s.
fn push_speed_mm_per_s(strategy: &Strategy) -> f64 {
    strategy.phases.last().map_or(0.0, |push| (push.speed / MM * 10.0).round() / 10.0)
}

impl Serialize for TunedTask {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct By<'a> {
            stage: Stage,
            what: &'a str,
        }
        #[derive(Serialize)]
        struct LimitsOutput {
            force_n: Option<f64>,
            speed_mm_per_s: Option<f64>,
        }
        #[derive(Serialize)]
        struct Fields<'a> {
            schema_version: u32,
            task: &'a str,
            inserts: bool,
            limits: LimitsOutput,
            windows: usize,
            before: StrategyWindows<'a>,
            after: Option<StrategyWindows<'a>>,
            by: By<'a>,
            steps: Vec<Tried<'a>>,
            kept: &'a [Robustness],
            nearest: Option<Stopped>,
            out: Option<String>,
        }
        let TunedTask { task, tuned, fingers, limits, after, written, .. } = self;
        let speed_mm_per_s = limits.speed.map(|speed| speed / MM);
        let limits = LimitsOutput { force_n: limits.force, speed_mm_per_s };
        let best = tuned.best();
        let state = |after: &TunedWindows| {
            StrategyWindows::new(&best.tried.strategy, &after.windows, after.force_n, fingers)
        };
        let first = &tuned.steps[0].tried;
        let fields = Fields {
            schema_version: 1,
            task: &task.name,
            inserts: after.is_some(),
            limits,
            windows: tuned.windows,
            before: StrategyWindows::new(&task.strategy, &first.windows, first.force_n, fingers),
            after: after.as_ref().map(state),
            by: By { stage: best.stage, what: &best.change },
            steps: tuned.steps.iter().map(Tried::from).collect(),
            kept: &tuned.robustness,
            nearest: tuned.nearest(task),
            out: written.as_ref().map(|path| path.display().to_string()),
        };
        fields.serialize(serializer)
    }
}

impl command::Response for TunedTask {
    fn verdict(self) -> Result<(), Failure> {
        if self.after.is_some() {
            return Ok(());
        }
        let within = self.tuned.least_force_n().zip(self.limits.force);
        let within = within.map_or(String::new(), |(least, limit)| {
            format!(" with at most {limit:.0} N (at least {least:.0} N; see --max-force-n)")
        });
        let (file, tried) = (&self.file, tried(&self.tuned));
        Err(Failure::running(format!("{file}: no strategy inserts{within}; tried: {tried}")))
    }
}

impl fmt::Display for TunedTask {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&wrapped(&text(self)))
    }
}

fn text(done: &TunedTask) -> String {
    let TunedTask { task, tuned, fingers, others, after, written, .. } = done;
    let line = |name: &str, text: String| (name.to_owned(), text);
    let mut all = vec![
        line("task", task.name.clone()),
        line("fingers", format!("{}: soft, medium, stiff (compliance)", compliances(fingers))),
    ];
    all.extend(steps(tuned));
    match after {
        None => all.extend(tuned.nearest(task).map(|nearest| {
            let met = nearest.parts.map_or(String::new(), |[plug, socket]| {
                format!(", where `{plug}` meets `{socket}`")
            });
            let (depth, tilt) = (nearest.depth_mm, nearest.tilt_deg);
            let how = format!("{} in `{}`, {depth:.1} mm deep", nearest.outcome, nearest.phase);
            line("nearest", format!("{how}, {tilt:.1}° off{met}"))
        })),
        Some(after) => {
            let best = tuned.best();
            let turned = turned_text(best);
            let text = format!("{}: {}{turned}", best.change, ranges(&after.windows));
            all.push(line("chosen", text));
            let wider = |step: &Step| step.tried.score > best.tried.score;
            if tuned.steps.iter().any(wider) {
                let why = format!(
                    "no other strategy checked has {INDIFFERENCE_MM} mm more with the socket turned, too"
                );
                all.push(line("", why));
            }
            all.push(line("push", push_text(done, after.force_n)));
            all.extend(tuned.robustness.iter().enumerate().map(|(i, kept)| {
                let least = format!("at least {:.1} mm", kept.least_range_mm);
                match i {
                    0 => line("other fingers", format!("{}: {least}", compliances(others))),
                    _ => line("", format!("{least}, {}", kept.change)),
                }
            }));
            let name = if tuned.best == 0 { "unchanged" } else { "written" };
            let wrote = written.as_ref();
            all.extend(wrote.map(|path| line(name, path.display().to_string())));
        }
    }
    all.push(line("windows", format!("{} measured", tuned.windows)));
    let next = written.as_ref();
    all.extend(next.map(|path| line("next", format!("optimize --task {}", path.display()))));
    lines(all)
}

/// Returns speed and largest force of the push, before and after tuning, as text.
fn push_text(TunedTask { task, tuned, limits, .. }: &TunedTask, after_n: f64) -> String {
    let [old, new] = [&task.strategy, &tuned.best().tried.strategy].map(push_speed_mm_per_s);
    let before = match tuned.steps[0].tried.force_n {
        0.0 => "none".to_owned(),
        force_n => format!("{force_n:.0}"),
    };
    let limit = limits.force.map_or(String::new(), |limit| format!(" (limit {limit:.0} N)"));
    let limited = limits.speed.map_or(String::new(), |v| format!(" (limit {:.0} mm/s)", v / MM));
    format!("{old:.0} -> {new:.0} mm/s{limited}, largest force {before} -> {after_n:.0} N{limit}")
}

/// Returns a line for each stage with its best strategy; for the families stage one per family.
fn steps(tuned: &Tuned) -> Vec<(String, String)> {
    let (searched, others): (Vec<&Step>, Vec<&Step>) =
        tuned.steps.iter().partition(|step| step.stage == Stage::Search);
    let best = searched.into_iter().max_by(|a, b| a.tried.score.total_cmp(&b.tried.score));
    let mut seen = None;
    let line = |step: &Step| {
        let repeated = step.stage == Stage::Families && seen.replace(step.stage).is_some();
        let name = if repeated { "" } else { NAMES[step.stage as usize] };
        (name.to_owned(), format!("{}: {}", step.change, outcome(step)))
    };
    others.into_iter().chain(best).map(line).collect()
}

/// Names of the stages.
const NAMES: [&str; 4] = ["before", "start", "families", "search"];

fn compliances(fingers: &[Finger]) -> String {
    let each: Vec<_> =
        fingers.iter().map(|finger| format!("{:.1}", finger.compliance / N_PER_MM)).collect();
    format!("{} N/mm", each.join(", "))
}
