//! `optimize task tune`: finds a strategy that inserts a connector.

use crate::layout::{lines, wrapped};
use crate::setup::files::{check_is_new, robot};
use crate::setup::task::warn_of_weak_grip;
use crate::setup::tune::{outcome, ranges, step_json, tried, turned_text};
use crate::setup::words::parse_number;
use crate::{Context, Failure, Output, RobotRequest, TaskFile, TaskSource, command, not_stopped};
use connector::check::problems;
use connector::tune::{Candidate, DEFAULT_BUDGET, Effort, Stage, Step, Tuned, Tuner, tune};
use connector::{picture, rewrite};
use input::Place;
use input::shipped::{Source, TASKS};
use input::units::{DEG, MM, N_PER_MM};
use insertion::outcome::stop_words;
use insertion::task::parts_file::without_parts;
use insertion::task::{Limits, is_of_name};
use insertion::{Finger, Robot, Strategy, Task, Window};
use serde_json::{Value, json};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use study::write_file;

/// Find a start and a strategy that insert a connector, before fingers are compared
///
/// First the start is taught with a medium finger; then the strategies of the shipped tasks are tried, scaled to
/// this opening; then tilt, strokes, preload and push speed are optimized for the smallest range of a soft, a
/// medium and a stiff finger. Exit code 1 if nothing inserts. Ctrl-C or SIGTERM writes the best strategy so far.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Example: optimize task tune mine.toml --svg mine.svg")]
pub struct Request {
    /// Task file, which is rewritten; or the name of a shipped task, with --out
    #[arg(value_name = "FILE")]
    pub file: String,
    /// Robot and contact engine.
    #[command(flatten)]
    pub robot: RobotRequest,
    /// Largest number of windows to measure, at least 60; start, shipped strategies and final checks are not shortened
    #[arg(long, value_name = "N", default_value_t = DEFAULT_BUDGET,
          value_parser = clap::value_parser!(u16).range(60..=10_000))]
    pub budget: u16,
    /// Seed of the search
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Largest peak force in the trials that insert, N [default: limits.force_n of the task, or the robot's stop force]
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

/// Parses a finite number above 0.
fn positive(text: &str) -> Result<f64, String> {
    parse_number(text, |value| value > 0.0 && value.is_finite(), "give a number above 0")
}

/// Result of tuning a task.
struct TunedTask<'a> {
    /// The task before tuning, with fingers and limits.
    tuner: Tuner<'a>,
    /// All strategies that were tried.
    tuned: Tuned,
    /// Windows of the fingers on the tuned task; `None` if no strategy inserts.
    after: Option<Candidate>,
    /// The file that was written, if one was.
    written: Option<&'a Path>,
    /// Robot and engine.
    with: &'a RobotRequest,
}

impl command::Request for Request {
    const PROGRESS: bool = true;

    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let stop = context.stop;
        context.cancel_on_interrupt()?;
        context.begin(self.budget.into());
        let file = TaskFile::parse(TaskSource::Named(self.file.clone()).read()?)?;
        let target = self.target()?;
        if let Some(problem) = problems(&file.task).first() {
            let (file, key, text) = (&file.source.file, &problem.key, &problem.problem);
            let more = "`optimize task check` lists the accepted values";
            return Err(Failure::task(Place::file(file).key(key).fault(format!("{text}; {more}"))));
        }
        let robot = robot(&self.robot.name)?;
        if let Some(force_n) = self.max_force_n.filter(|force_n| *force_n > robot.stop_force) {
            context.note(&format!("--max-force-n {force_n}{}", above_stop(&robot, force_n)));
        }
        warn_of_weak_grip(&file.task, &robot, self.robot.engine, context)?;
        let tuner = self.tuner(&file.task, &robot, stop);
        let report = |what: &str, cost: usize, done, of| {
            context.part(what, [done, of], cost as f64);
        };
        let (budget, seed) = (self.budget, self.seed);
        let effort =
            Effort { last: Stage::Search, until_enough: false, budget, seed, progress: &report };
        let tuned = tune(&tuner, &effort)?;
        if context.check().is_err() {
            return Err(self.interrupted(&file, &tuned, target)?);
        }
        let (mut after, mut written) = (None, None);
        if tuned.inserts() {
            after = match self.write(&file, &tuned, &robot, (target, stop)) {
                Err(Failure::Interrupted(_)) => {
                    return Err(self.interrupted(&file, &tuned, target)?);
                }
                found => Some(found?),
            };
            written = target.filter(|_| !self.dry_run);
        }
        let done = TunedTask { tuner, tuned, after, written, with: &self.robot };
        let output = Output::new(wrapped(&text(&done)), json(&done));
        Ok(Output { failure: failure(&self.file, &done), ..output })
    }
}

impl Request {
    /// Returns the tuner of a task, with the limits given on the command line.
    fn tuner<'a>(&self, task: &'a Task, robot: &'a Robot, stop: &'a AtomicBool) -> Tuner<'a> {
        let mut tuner = Tuner::new(task, robot, self.robot.engine, stop);
        let given =
            Limits { force: self.max_force_n, speed: self.max_speed_mm_per_s.map(|v| v * MM) };
        tuner.limits = given.or(tuner.limits);
        tuner
    }

    /// Returns the file to write; a shipped task cannot be overwritten.
    fn target(&self) -> Result<Option<&Path>, Failure> {
        match &self.out {
            Some(out) => check_is_new(out).map(|()| Some(out.as_path())),
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
        tuned: &Tuned,
        robot: &Robot,
        (target, stop): (Option<&Path>, &AtomicBool),
    ) -> Result<Candidate, Failure> {
        let after = self.rewritten(file, tuned)?;
        let found = self.tuner(&after.task, robot, stop).given(&after.task.strategy);
        not_stopped(stop)?;
        let found = found?;
        self.save(file, &after, target)?;
        Ok(found)
    }

    /// Returns the task file with the recommended strategy; a file of another name gives the task that name, unless a
    /// shipped task has it, so that the studies of both have different folders.
    fn rewritten(&self, file: &TaskFile, tuned: &Tuned) -> Result<TaskFile, Failure> {
        let (source, strategy) = (&file.source, &tuned.best().tried.strategy);
        let mut text = rewrite::with_strategy(&source.text, strategy).map_err(Failure::input)?;
        let stem = self.out.as_deref().and_then(Path::file_stem);
        let renamed = stem.filter(|stem| Path::new(&source.file).file_stem() != Some(*stem));
        if let Some(name) = renamed.and_then(OsStr::to_str) {
            let name = name.replace(|c| !is_of_name(c), "_");
            if TASKS.iter().all(|shipped| shipped.name != name) {
                text = rewrite::with_name(&text, &name).map_err(Failure::input)?;
            }
        }
        TaskFile::parse(Source { file: source.file.clone(), text })
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
        self.save(file, &self.rewritten(file, tuned)?, Some(target))?;
        let (best, target) = (outcome(tuned.best()), target.display());
        let command = self.robot.command("task tune", &target);
        let hint = format!(
            "{target} has the best strategy so far ({best}); search on from it with: {command}"
        );
        Ok(Failure::Interrupted(Some(hint)))
    }
}

/// Returns a strategy with the windows of the fingers, simulated when it was tried, as JSON.
fn strategy_json(strategy: &Strategy, tried: &Candidate, fingers: &[Finger]) -> Value {
    let result = |(finger, window): (&Finger, &Window)| {
        json!({
            "compliance_n_per_mm": finger.compliance / N_PER_MM,
            "assembly_n_per_mm": finger.assembly / N_PER_MM,
            "nominal": window.nominal.word(),
            "window_mm": [window.negative_mm(), window.positive_mm()],
            "range_mm": window.range_mm(),
        })
    };
    json!({
        "start_mm": strategy.start.map(|at| (at / MM * 1e4).round() / 1e4),
        "tilt_deg": (strategy.tilt / DEG * 100.0).round() / 100.0,
        "push_speed_mm_per_s": push_speed_mm_per_s(strategy),
        "largest_force_n": tried.force_n,
        "fingers": fingers.iter().zip(&tried.windows).map(result).collect::<Vec<_>>(),
    })
}

/// Returns the speed of the last phase, the push, mm/s.
fn push_speed_mm_per_s(strategy: &Strategy) -> f64 {
    strategy.phases.last().map_or(0.0, |push| (push.speed / MM * 10.0).round() / 10.0)
}

fn json(TunedTask { tuner, tuned, after, written, .. }: &TunedTask<'_>) -> Value {
    let Tuner { task, fingers, limits, .. } = tuner;
    let (best, first) = (tuned.best(), &tuned.steps[0].tried);
    let state = |after: &Candidate| strategy_json(&best.tried.strategy, after, fingers);
    json!({
        "schema_version": 1,
        "task": task.name,
        "inserts": after.is_some(),
        "limits": {
            "force_n": limits.force,
            "speed_mm_per_s": limits.speed.map(|speed| speed / MM),
        },
        "windows": tuned.windows,
        "before": strategy_json(&task.strategy, first, fingers),
        "after": after.as_ref().map(state),
        "by": {"stage": best.stage, "what": best.change},
        "steps": tuned.steps.iter().map(step_json).collect::<Vec<_>>(),
        "kept": tuned.robustness,
        "nearest": tuned.nearest(task),
        "out": written.map(|path| path.display().to_string()),
    })
}

/// Returns the words that follow a force with which the robot stops; empty for another one.
fn above_stop(Robot { name, stop_force, .. }: &Robot, force_n: f64) -> String {
    match force_n > *stop_force {
        true => format!(", but the robot {name} stops at {stop_force} N"),
        false => String::new(),
    }
}

/// Returns the error if no strategy inserts.
fn failure(file: &str, TunedTask { tuner, tuned, after, .. }: &TunedTask<'_>) -> Option<Failure> {
    let within = tuned.least_force_n().zip(tuner.limits.force);
    let (within, accepted) = within.map_or(Default::default(), |(least_n, limit_n)| {
        let accepted = format!("\naccepted: --max-force-n of {:.0} or more", least_n.ceil())
            + &above_stop(tuner.robot, least_n.ceil());
        (format!(" with at most {limit_n:.0} N"), accepted)
    });
    let tried = wrapped(&format!("tried:        {}", tried(tuned)));
    let problem = format!("{file}: no strategy inserts{within}\n{tried}{accepted}");
    after.is_none().then(|| Failure::running(problem))
}

fn text(done: &TunedTask<'_>) -> String {
    let TunedTask { tuner, tuned, after, written, with } = done;
    let Tuner { task, fingers, others, .. } = tuner;
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
            let how = nearest.outcome.to_owned() + stop_words(nearest.robot_stopped);
            let at = format!("in `{}`, {depth:.1} mm deep, {tilt:.1}° off{met}", nearest.phase);
            line("nearest", format!("{how}, {at}"))
        })),
        Some(after) => {
            let best = tuned.best();
            let turned = turned_text(best);
            let ranges = ranges(&after.windows);
            let text = format!("{}: {ranges} about the written start{turned}", best.change);
            all.push(line("chosen", text));
            all.push(line("push", push_text(done, after.force_n)));
            all.extend(tuned.robustness.iter().enumerate().map(|(i, kept)| {
                let least = format!("at least {:.1} mm", kept.least_range_mm);
                match i {
                    0 => line("other fingers", format!("{}: {least}", compliances(others))),
                    _ => line("", format!("{least}, {}", kept.change)),
                }
            }));
            let name = if tuned.best == 0 { "unchanged" } else { "written" };
            all.extend(written.map(|path| line(name, path.display().to_string())));
        }
    }
    all.push(line("windows", format!("{} measured", tuned.windows)));
    all.extend(written.map(|path| line("next", with.command("--task", path.display()))));
    lines(all)
}

/// Returns speed and peak force of the push, before and after tuning, as text.
fn push_text(TunedTask { tuner, tuned, .. }: &TunedTask<'_>, after_n: f64) -> String {
    let Tuner { task, robot, limits, .. } = tuner;
    let [old, new] = [&task.strategy, &tuned.best().tried.strategy].map(push_speed_mm_per_s);
    let before = match tuned.steps[0].tried.force_n {
        0.0 => "none".to_owned(),
        force_n => format!("{force_n:.0}"),
    };
    let limit = limits.force.map_or(String::new(), |limit| format!(" (limit {limit:.0} N)"));
    let limited = limits.speed.map_or(String::new(), |v| format!(" (limit {:.0} mm/s)", v / MM));
    let accepted_n = robot.acceptable_force(task.limits.force);
    let above = format!("; a study accepts at most {accepted_n:.1} N (--max-force-n)");
    let above = if after_n > accepted_n { above } else { String::new() };
    format!(
        "{old:.0} -> {new:.0} mm/s{limited}, peak force {before} -> {after_n:.0} N{limit} \
         in the trials that insert{above}"
    )
}

/// Returns a line for each stage with its best strategy; for the stage of the connector families, one per family.
fn steps(tuned: &Tuned) -> Vec<(String, String)> {
    let (searched, others): (Vec<&Step>, Vec<&Step>) =
        tuned.steps.iter().partition(|step| step.stage == Stage::Search);
    let best = searched.into_iter().max_by(|a, b| a.tried.score.total_cmp(&b.tried.score));
    let none = best.is_none().then(|| {
        let text = "not started: --budget leaves no windows for it";
        (NAMES[Stage::Search as usize].to_owned(), text.to_owned())
    });
    let mut seen = None;
    let line = |step: &Step| {
        let repeated = step.stage == Stage::Families && seen.replace(step.stage).is_some();
        let name = if repeated { "" } else { NAMES[step.stage as usize] };
        (name.to_owned(), format!("{}: {}", step.change, outcome(step)))
    };
    others.into_iter().chain(best).map(line).chain(none).collect()
}

/// Names of the stages.
const NAMES: [&str; 4] = ["before", "start", "families", "search"];

fn compliances(fingers: &[Finger]) -> String {
    let each: Vec<_> =
        fingers.iter().map(|finger| format!("{:.1}", finger.compliance / N_PER_MM)).collect();
    format!("{} N/mm", each.join(", "))
}
