//! `optimize task tune`: a strategy by which a connector inserts.

use super::super::progress::Progress;
use super::super::words::{lines, wrapped};
use super::super::{Failure, print, print_json};
use crate::session::{TuneDone, TuneRequest};
use clap::Args;
use connector::tune::{MOST_WINDOWS, Stage, Step, Tuned, YAW_DEG};
use input::units::{DEG, MM, N_PER_MM};
use insertion::evaluation::Window;
use insertion::finger::Finger;
use insertion::outcome::Outcome;
use insertion::task::Strategy;
use insertion::trial::NEVER;
use serde_json::{Value, json};

/// Find a start and a strategy by which a connector inserts, before fingers are compared
///
/// A start taught with a medium finger; then the strategies of the shipped tasks, carried over to
/// this opening; then a search over tilt, strokes, preload and push speed for the widest least range
/// of a soft, a medium and a stiff finger from one start. Exit code 1 if nothing inserts.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    request: TuneRequest,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
    /// Say nothing while it simulates
    #[arg(long)]
    quiet: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let quiet = arguments.quiet || arguments.json;
    let mut progress = Progress::of_windows(MOST_WINDOWS, quiet);
    let done = arguments.request.run(&NEVER, &mut |event| progress.see(event))?;
    drop(progress);
    match arguments.json {
        true => print_json(&json(&done))?,
        false => print(&wrapped(&text(&done)))?,
    }
    match done.after {
        Some(_) => Ok(()),
        None => Err(nothing(&arguments.request.file, &done.tuned)),
    }
}

/// That nothing inserts, and what was tried.
fn nothing(file: &str, tuned: &Tuned) -> Failure {
    Failure::running(format!("{file}: no strategy inserts; tried: {}", tried(tuned)))
}

/// A line on what was chosen.
pub fn brief(name: &str, tuned: &Tuned) -> String {
    let step = tuned.best();
    let range = outcome(step);
    let text = format!("{}: {range} with a soft, a medium and a stiff finger", step.what);
    lines([(name.to_owned(), text)])
}

/// What was chosen: stage, what it changes, and ranges of a soft, a medium and a stiff finger; null
/// where nothing inserts.
pub fn brief_json(tuned: &Tuned) -> Value {
    match tuned.inserts() {
        true => step_json(tuned.best()),
        false => Value::Null,
    }
}

fn step_json(Step { stage, what, tried, turned_mm }: &Step) -> Value {
    json!({
        "stage": stage,
        "what": what,
        "least_range_mm": tried.inserts().then_some(tried.score),
        "range_mm": tried.windows.iter().map(Window::range_mm).collect::<Vec<_>>(),
        "turned_least_range_mm": turned_mm,
    })
}

/// What was tried, the candidates of the search by their number.
pub fn tried(tuned: &Tuned) -> String {
    let searched = tuned.steps.iter().filter(|step| step.stage == Stage::Search).count();
    let named = tuned.steps.iter().filter(|step| step.stage != Stage::Search);
    let mut all: Vec<_> = named.map(|step| step.what.clone()).collect();
    if searched > 0 {
        all.push(format!("{searched} of tilt, strokes, preload and speed"));
    }
    all.join(", ")
}

/// Output of `--json`.
pub fn json(done: &TuneDone) -> Value {
    let TuneDone { task, tuned, fingers, after, written } = done;
    let best = &tuned.best().tried;
    json!({
        "schema_version": 1,
        "task": task.name,
        "inserts": after.is_some(),
        "windows": tuned.windows,
        "before": state(&task.strategy, &tuned.steps[0].tried.windows, fingers),
        "after": after.as_ref().map(|after| state(&best.strategy, after, fingers)),
        "by": {"stage": tuned.best().stage, "what": tuned.best().what},
        "steps": tuned.steps.iter().map(step_json).collect::<Vec<_>>(),
        "kept": tuned.kept,
        "nearest": tuned.nearest(task),
        "out": written.as_ref().map(|path| path.display().to_string()),
    })
}

fn state(strategy: &Strategy, windows: &[Window], fingers: &[Finger]) -> Value {
    let of = |(finger, window): (&Finger, &Window)| {
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
        "fingers": fingers.iter().zip(windows).map(of).collect::<Vec<_>>(),
    })
}

fn text(done: &TuneDone) -> String {
    let TuneDone { task, tuned, fingers, after, written } = done;
    let line = |name: &str, text: String| (name.to_owned(), text);
    let mut all = vec![
        line("task", task.name.clone()),
        line("fingers", format!("{}: soft, medium, stiff (compliance)", compliances(fingers))),
    ];
    all.extend(steps(tuned));
    match after {
        None => all.extend(tuned.nearest(task).map(|nearest| {
            let met = nearest.met.map_or(String::new(), |[plug, socket]| {
                format!(", where `{plug}` meets `{socket}`")
            });
            let (depth, tilt) = (nearest.depth_mm, nearest.tilt_deg);
            let how = format!("{} in `{}`, {depth:.1} mm deep", nearest.outcome, nearest.phase);
            line("nearest", format!("{how}, {tilt:.1}° off{met}"))
        })),
        Some(after) => {
            let best = tuned.best();
            all.push(line("chosen", format!("{}: {}", best.what, ranges(after))));
            all.extend(tuned.kept.iter().enumerate().map(|(i, kept)| {
                let name = if i == 0 { "other fingers" } else { "" };
                let change = if i == 0 { String::new() } else { format!(", {}", kept.change) };
                line(name, format!("at least {:.1} mm{change}", kept.least_range_mm))
            }));
            let wrote = written.as_ref();
            all.extend(wrote.map(|path| line("written", path.display().to_string())));
        }
    }
    all.push(line("windows", format!("{} measured", tuned.windows)));
    lines(all)
}

/// A line for each stage: its best, and for the families each.
fn steps(tuned: &Tuned) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for (i, step) in tuned.steps.iter().enumerate() {
        if step.stage != Stage::Search {
            let name = if step.stage == Stage::Families && tuned.steps[i - 1].stage == step.stage {
                ""
            } else {
                NAMES[step.stage as usize]
            };
            found.push((name.to_owned(), format!("{}: {}", step.what, outcome(step))));
        }
    }
    let searched = tuned.steps.iter().filter(|step| step.stage == Stage::Search);
    let best = searched.max_by(|a, b| a.tried.score.total_cmp(&b.tried.score));
    found.extend(best.map(|step| {
        (NAMES[Stage::Search as usize].to_owned(), format!("{}: {}", step.what, outcome(step)))
    }));
    found
}

/// Names of the stages.
const NAMES: [&str; 4] = ["before", "start", "families", "search"];

fn outcome(step: &Step) -> String {
    let turned = step.turned_mm.map_or(String::new(), |least_mm| {
        format!(", with the socket turned by {YAW_DEG}° at least {least_mm:.1} mm")
    });
    match step.tried.windows.is_empty() {
        true => "inserts from no start".to_owned(),
        false => ranges(&step.tried.windows) + &turned,
    }
}

/// `3.1, 3.3, 2.9 mm`; how the nominal start fails where it does.
fn ranges(windows: &[Window]) -> String {
    let inserts = |window: &Window| window.nominal == Outcome::Inserted;
    let all = windows.iter().all(inserts);
    let unit = if all { "" } else { " mm" };
    let range = |window: &Window| match inserts(window) {
        true => format!("{:.1}{unit}", window.range_mm()),
        false => window.nominal.short().to_owned(),
    };
    let each: Vec<_> = windows.iter().map(range).collect();
    format!("{}{}", each.join(", "), if all { " mm" } else { "" })
}

fn compliances(fingers: &[Finger]) -> String {
    let each: Vec<_> =
        fingers.iter().map(|finger| format!("{:.1}", finger.compliance / N_PER_MM)).collect();
    format!("{} N/mm", each.join(", "))
}
