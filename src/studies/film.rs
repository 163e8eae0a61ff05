//! Films at the ends of the recommended design's window: the last trial that inserts and the first that fails.

use crate::setup::film::start_label;
use crate::{Failure, Setup};
use insertion::evaluation::tolerance::offset;
use insertion::trial::picture;
use insertion::{Design, Evaluation, Grasp, OffsetStep, Outcome, Template, grid_mm};
use rayon::ThreadPool;
use report::answer::Answer;
use report::replay::{self, ENDS, Film, pair_file, poster_file};
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use study::write_own_file;

/// Records the pair of trials at each end of the recommended design's windows into the study's folder; replaces or
/// removes the files of an earlier run. Ends early once `stop` is set.
pub(crate) fn boundary(
    dir: &Path,
    answer: &Answer,
    setup: &Setup,
    pool: &ThreadPool,
    stop: &AtomicBool,
) -> Result<(), Failure> {
    // A Pareto front has no single finger to show.
    let found =
        answer.record.config.objective.single().and_then(|_| answer.finger_and_evaluations());
    for (at, template) in setup.evaluator.templates.iter().enumerate() {
        for (end, outward) in ENDS {
            let files = [pair_file(at, end), poster_file(at, end)].map(|file| dir.join(file));
            let on_task = found.as_ref().and_then(|(design, tasks)| Some((design, tasks.get(at)?)));
            let texts = on_task.map(|(design, measured)| {
                pair(setup, (template, design), measured, (end, outward), (pool, stop))
            });
            let texts = texts.transpose()?.flatten();
            // After cancellation trials may have been skipped.
            if stop.load(Ordering::SeqCst) {
                return Ok(());
            }
            for (i, file) in files.iter().enumerate() {
                let Some(texts) = &texts else {
                    // The file may not exist.
                    drop(fs::remove_file(file));
                    continue;
                };
                let folder = file.parent().unwrap_or(dir);
                fs::create_dir_all(folder)
                    .map_err(|error| Failure::running(format!("{}: {error}", folder.display())))?;
                write_own_file(file, &texts[i])?;
            }
        }
    }
    Ok(())
}

/// Returns a page that plays both trials, and a picture of the final state of the second; `None` if no trial failed at
/// this end, or the engine does not record trials. `end` is its name, and `outward` the grid step (-1 or 1) towards it.
fn pair(
    setup: &Setup,
    (template, design): (&Template, &Design),
    measured: &Evaluation,
    (end, outward): (&str, OffsetStep),
    (pool, stop): (&ThreadPool, &AtomicBool),
) -> Result<Option<[String; 2]>, Failure> {
    let window = &measured.window;
    let (last, failed) = match outward {
        -1 => (window.negative_steps, window.end_negative),
        _ => (window.positive_steps, window.end_positive),
    };
    if window.nominal != Outcome::Inserted || failed.is_none() {
        return Ok(None);
    }
    let evaluator = &setup.evaluator;
    let scenario = &evaluator.scenario(template, design, evaluator.predict(design)?)?;
    let rig = evaluator.rig(scenario, measured.taught, 1.0)?;
    let grasp = Grasp { stop, ..Grasp::of(&scenario.finger) };
    let record = |step| rig.record(grasp, offset(step));
    let (inside, outside) =
        pool.install(|| rayon::join(|| record(last), || record(last + outward)));
    let Some((inside, outside)) = inside.zip(outside) else { return Ok(None) };
    let labels = [last, last + outward].map(|step| start_label(grid_mm(step)));
    let (task, pad) = (&scenario.task, &scenario.finger.pad);
    let film = |label, recording| Film { label, task, pad, recording };
    let films = [film(&*labels[0], &inside), film(&*labels[1], &outside)];
    let title = format!("{}: the {end} end of the window", scenario.task.name);
    let poster = picture::final_state(task, pad, &outside.trial);
    Ok(Some([replay::page(&title, &films), poster]))
}
