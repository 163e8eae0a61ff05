//! A strategy by which a connector inserts.

use super::failure::not_stopped;
use super::files::robot;
use super::{DEFAULT_ROBOT, Failure, Part, TaskFile, TaskSource, Watch, tell};
use connector::check::problems;
use connector::tune::{Bench, Effort, Stage, Tuned, tune};
use connector::{picture, rewrite};
use input::Place;
use input::shipped::Source;
use insertion::evaluation::Window;
use insertion::finger::Finger;
use insertion::robot::Robot;
use insertion::task::{Strategy, Task};
use insertion::trial::Conditions;
use insertion::trial::engine::EngineKind;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use study::write_file;

/// Which task to tune, and where the result goes.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct TuneRequest {
    /// Task file, which is written anew; or the name of a shipped task, with --out
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
    /// Write this new file in place of FILE
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Write no task file
    #[arg(long)]
    pub dry_run: bool,
    /// Draw the search before and after
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
}

/// A tuned task.
pub struct TuneDone {
    /// The task as it was.
    pub task: Task,
    /// All that was tried.
    pub tuned: Tuned,
    /// The soft, the medium and the stiff finger.
    pub fingers: [Finger; 3],
    /// Their windows on the task as it is written; `None` if no strategy inserts.
    pub after: Option<Vec<Window>>,
    /// The file that was written, if one was.
    pub written: Option<PathBuf>,
}

impl TuneRequest {
    /// Tunes the task and writes what was asked for.
    pub fn run(&self, stop: &AtomicBool, watch: &mut Watch<'_>) -> Result<TuneDone, Failure> {
        let file = TaskFile::parse(TaskSource::Named(self.file.clone()).read()?)?;
        let target = self.target()?;
        if let Some(problem) = problems(&file.task).first() {
            let (file, key, text) = (&file.source.file, &problem.key, &problem.problem);
            let more = "`optimize task check` says what would be right";
            let problem = format!("{text}; {more}");
            return Err(Failure::task(Place::file(file).key(key).fault(problem)));
        }
        let robot = robot(&self.robot)?;
        let bench = bench(&file.task, &robot, self.engine, stop)?;
        let watch = Mutex::new(watch);
        let said = |what: &str, cost: usize, done, of| {
            tell(&watch, Part { what: what.to_owned(), done, of, cost: cost as f64 });
        };
        let effort =
            Effort { last: Stage::Search, until_enough: false, seed: self.seed, tell: &said };
        let tuned = tune(&bench, &effort).map_err(Failure::input)?;
        not_stopped(stop)?;
        let fingers = bench.fingers;
        let mut done =
            TuneDone { task: file.task.clone(), tuned, fingers, after: None, written: None };
        if done.tuned.inserts() {
            done.after = Some(self.write(&file, &done, &robot, (target, stop))?);
            done.written = target.filter(|_| !self.dry_run).map(Path::to_path_buf);
        }
        Ok(done)
    }

    /// The file to write; a shipped task is not one.
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

    /// Writes the task with its best strategy, and the picture; and measures what was written.
    fn write(
        &self,
        file: &TaskFile,
        done: &TuneDone,
        robot: &Robot,
        (target, stop): (Option<&Path>, &AtomicBool),
    ) -> Result<Vec<Window>, Failure> {
        let strategy = &done.tuned.best().tried.strategy;
        let after = TaskFile::parse(rewritten(&file.source, &file.task, strategy)?)?;
        let bench = bench(&after.task, robot, self.engine, stop)?;
        let found = bench.windows(&after.task.strategy, &bench.fingers, Conditions::NOMINAL);
        not_stopped(stop)?;
        let windows =
            found.map_err(Failure::input)?.into_iter().map(|(window, _)| window).collect();
        if let Some(svg) = &self.svg {
            write_file(svg, &picture::both(&file.task, &after.task))?;
        }
        if let (Some(target), false) = (target, self.dry_run) {
            write_file(target, &after.source.text)?;
        }
        Ok(windows)
    }
}

fn rewritten(source: &Source, task: &Task, strategy: &Strategy) -> Result<Source, Failure> {
    let text = rewrite::strategy(&source.text, task, strategy).map_err(Failure::input)?;
    Ok(Source { file: source.file.clone(), text })
}

fn bench<'a>(
    task: &'a Task,
    robot: &'a Robot,
    engine: EngineKind,
    stop: &'a AtomicBool,
) -> Result<Bench<'a>, Failure> {
    Bench::new(task, robot, engine, stop)
        .ok_or_else(|| Failure::running("no measured fingers are shipped"))
}

/// A new task with its start taught and, where that is not enough, the strategy of a family; nothing
/// was tried of one that has problems.
pub fn begun(
    task: Task,
    engine: EngineKind,
    stop: &AtomicBool,
) -> Result<(Task, Option<Tuned>), Failure> {
    if !problems(&task).is_empty() {
        return Ok((task, None));
    }
    let tuned = mended(&task, (DEFAULT_ROBOT, engine), Stage::Families, stop)?;
    let best = tuned.best();
    let strategy = if tuned.inserts() { best.tried.strategy.clone() } else { task.strategy };
    Ok((Task { strategy, ..task }, Some(tuned)))
}

/// Stages up to `last` until one of them is enough.
pub(super) fn mended(
    task: &Task,
    (robot_name, engine): (&str, EngineKind),
    last: Stage,
    stop: &AtomicBool,
) -> Result<Tuned, Failure> {
    let robot = robot(robot_name)?;
    let effort = Effort { last, until_enough: true, seed: 0, tell: &|_, _, _, _| () };
    let tuned = tune(&bench(task, &robot, engine, stop)?, &effort).map_err(Failure::input)?;
    not_stopped(stop)?;
    Ok(tuned)
}
