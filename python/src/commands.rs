//! The commands that neither measure a window nor run a study.

use crate::errors::{InputError, raise};
use crate::keywords::{Keywords, Name, TaskWord, wrong};
use crate::measure::{interruptible, released};
use finger_opt::cli::call;
use finger_opt::session::{
    self, Among, BenchRequest, CalibrateRequest, HowCalibrated, NextRequest, PrintRequest,
    RibsRequest, SceneRequest, SensitivityRequest, SheetRequest, TaskCheck, TuneRequest,
};
use insertion::evaluation::objective::Measure;
use insertion::space::{DENSITY_KEY, DIRECTION_KEY};
use insertion::trial::engine::EngineKind;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;
use std::path::PathBuf;
use study::write_file;

type Settings<'a, 'py> = &'a Bound<'py, PyDict>;

/// Stiffness of a finger by its ribs, as JSON, and its drawing.
#[pyfunction]
#[pyo3(signature = (**settings))]
pub fn finger<'py>(
    py: Python<'py>,
    settings: Option<Settings<'_, 'py>>,
) -> PyResult<(String, String)> {
    let words = Keywords::new(py, settings)?;
    let request = RibsRequest {
        density: words.need("density")?,
        direction: words.need("direction")?,
        finger: words.text("finger")?.unwrap_or_else(|| "finray9".to_owned()),
        phase_mm: words.take("phase_mm")?,
        set: words.set()?,
    };
    let load_n = words.take("load_n")?.unwrap_or([-5.0, 0.0]);
    words.finish()?;
    let (json, svg) = released(py, || call::finger(&request, load_n))?.map_err(raise)?;
    Ok((json.to_string(), svg))
}

/// Writes a task; file, strategy and check of it as JSON.
#[pyfunction]
#[pyo3(signature = (name, /, **settings))]
pub fn new_task<'py>(
    py: Python<'py>,
    name: String,
    settings: Option<Settings<'_, 'py>>,
) -> PyResult<String> {
    let words = Keywords::new(py, settings)?;
    let size = |name: &str| Ok::<_, PyErr>(words.parsed(name)?.into_iter().next());
    let round = words.text("round")?.map(|text| connector::draft::Size::round(&text));
    let request = call::task_new::Arguments {
        name,
        plug: size("plug")?,
        round: round.transpose().map_err(|problem| wrong("round", problem))?,
        clearance: words.take("clearance")?,
        body: size("body")?,
        like: words.text("like")?,
        out: words.take("out")?,
        engine: words.choice("engine")?.unwrap_or_default(),
    };
    words.finish()?;
    let made = interruptible(py, |stop| call::task_new::written(&request, stop))?;
    let (checked, tuned) = made.map_err(raise)?;
    Ok(call::task_new::json(&checked, tuned.as_ref()).to_string())
}

/// What is wrong with a task and whether its nominal start inserts, as JSON, and its drawing, empty if
/// the file cannot be read.
#[pyfunction]
#[pyo3(signature = (task, /, **settings))]
pub fn check_task<'py>(
    py: Python<'py>,
    task: TaskWord,
    settings: Option<Settings<'_, 'py>>,
) -> PyResult<(String, String)> {
    let words = Keywords::new(py, settings)?;
    let robot = words.text("robot")?.unwrap_or_else(|| session::DEFAULT_ROBOT.to_owned());
    let engine: EngineKind = words.choice("engine")?.unwrap_or_default();
    words.finish()?;
    let task = task.one()?;
    let checked = interruptible(py, |stop| {
        let checked = TaskCheck::of(task.read()?, &robot, engine, stop)?;
        let mended = checked.mend(&robot, engine, stop)?;
        let json = call::task_check::mended_json(&checked, mended.as_ref()).to_string();
        Ok((json, checked.task.as_ref().map(connector::picture::svg).unwrap_or_default()))
    })?;
    checked.map_err(raise)
}

/// Tunes the start and the strategy of a task; all that was tried, as JSON.
#[pyfunction]
#[pyo3(signature = (task, /, **settings))]
pub fn tune_task<'py>(
    py: Python<'py>,
    task: Name,
    settings: Option<Settings<'_, 'py>>,
) -> PyResult<String> {
    let words = Keywords::new(py, settings)?;
    let request = TuneRequest {
        file: task.0,
        robot: words.text("robot")?.unwrap_or_else(|| session::DEFAULT_ROBOT.to_owned()),
        engine: words.choice("engine")?.unwrap_or_default(),
        seed: words.take("seed")?.unwrap_or(0),
        out: words.take("out")?,
        dry_run: words.flag("dry_run")?,
        svg: words.take("svg")?,
    };
    words.finish()?;
    let done = interruptible(py, |stop| request.run(stop, &mut |_| ()))?.map_err(raise)?;
    Ok(call::task_tune::json(&done).to_string())
}

/// Studies side by side, as JSON and as a picture.
#[pyfunction]
#[pyo3(signature = (folders, /, **settings))]
pub fn compare<'py>(
    py: Python<'py>,
    folders: Vec<PathBuf>,
    settings: Option<Settings<'_, 'py>>,
) -> PyResult<(String, String)> {
    let words = Keywords::new(py, settings)?;
    let html: Option<PathBuf> = words.take("html")?;
    words.finish()?;
    let found = released(py, || {
        let found = call::compared(&folders)?;
        if let Some(file) = html {
            write_file(&file, &report::compare::page(&found)?)?;
        }
        Ok((json!(found).to_string(), report::compare::svg(&found)?))
    })?;
    found.map_err(raise)
}

/// Tasks, measurements and effort of a calibration.
fn bench(words: &Keywords<'_>, tasks: Vec<TaskWord>) -> PyResult<(BenchRequest, HowCalibrated)> {
    let run = words.run()?;
    let how = HowCalibrated {
        priors: words.text("priors")?.unwrap_or_else(|| "bench".to_owned()),
        effort: run.effort,
        seed: words.take("seed")?.unwrap_or(0),
        cache: run.cache,
    };
    let Name(measurements) = words.need("measurements")?;
    Ok((BenchRequest { setup: words.setup(tasks)?, measurements }, how))
}

/// What every finger does on the bench, as JSON; tables are written to `out`.
#[pyfunction]
#[pyo3(signature = (tasks, /, **settings))]
pub fn calibrate<'py>(
    py: Python<'py>,
    tasks: Vec<TaskWord>,
    settings: Option<Settings<'_, 'py>>,
) -> PyResult<String> {
    let words = Keywords::new(py, settings)?;
    let (bench, how) = bench(&words, tasks)?;
    let out: Option<PathBuf> = words.take("out")?;
    words.finish()?;
    let request = CalibrateRequest { bench, how };
    let done = interruptible(py, |stop| request.run(stop, &mut |_| ()))?.map_err(raise)?;
    Ok(call::calibration(&done, out.as_deref()).map_err(raise)?.to_string())
}

/// Which fingers to print next, as JSON.
#[pyfunction]
#[pyo3(signature = (tasks, /, **settings))]
pub fn next_print<'py>(
    py: Python<'py>,
    tasks: Vec<TaskWord>,
    settings: Option<Settings<'_, 'py>>,
) -> PyResult<String> {
    let words = Keywords::new(py, settings)?;
    let (bench, how) = bench(&words, tasks)?;
    let request = NextRequest {
        bench,
        count: words.take("count")?.unwrap_or(1),
        among: words.choice("among")?.unwrap_or(Among::Space),
        print_cost_mm: words.take("print_cost_mm")?.unwrap_or(0.1),
        how,
    };
    words.finish()?;
    if !(1..=100).contains(&request.count) {
        return Err(wrong("count", "must lie between 1 and 100"));
    }
    if !(request.print_cost_mm.is_finite() && request.print_cost_mm >= 0.0) {
        return Err(wrong("print_cost_mm", "must be 0 or above, in mm of range"));
    }
    let done = interruptible(py, |stop| request.run(stop, &mut |_| ()))?.map_err(raise)?;
    Ok(call::advice(&done).to_string())
}

/// Which input matters, as JSON and as a picture.
#[pyfunction]
#[pyo3(signature = (tasks, /, **settings))]
pub fn sensitivity<'py>(
    py: Python<'py>,
    tasks: Vec<TaskWord>,
    settings: Option<Settings<'_, 'py>>,
) -> PyResult<(String, String)> {
    let words = Keywords::new(py, settings)?;
    let request = SensitivityRequest {
        setup: words.setup(tasks)?,
        objective: words.listed("objective")?.unwrap_or(Measure::Range),
        uncertainty: words.text("uncertainty")?.unwrap_or_else(|| "typical".to_owned()),
        samples: words.take("samples")?.unwrap_or(64),
        seed: words.take("seed")?.unwrap_or(0),
    };
    words.finish()?;
    let found = interruptible(py, |stop| request.run(stop))?.map_err(raise)?;
    let picture = report::sensitivity::svg(&found).map_err(|error| raise(error.into()))?;
    Ok((report::sensitivity::json(&found).to_string(), picture))
}

/// Writes a finger for the printer; its title and the files as JSON.
#[pyfunction]
#[pyo3(signature = (**settings))]
pub fn export_finger<'py>(
    py: Python<'py>,
    settings: Option<Settings<'_, 'py>>,
) -> PyResult<String> {
    let words = Keywords::new(py, settings)?;
    let request = PrintRequest {
        dir: words.take("dir")?,
        density: words.take("density")?,
        direction: words.take("direction")?,
        finger: words.text("finger")?,
        phase_mm: words.take("phase_mm")?,
    };
    let format = words.choice("format")?;
    let format = format.ok_or_else(|| wrong("format", "is missing"))?;
    let out = words.need("out")?;
    words.finish()?;
    let request = call::export_finger::Arguments { request, format, out };
    let written = released(py, || call::export_finger::written(&request))?;
    let (title, files) = written.map_err(raise)?;
    let beside = files.get(1..).unwrap_or_default();
    Ok(json!({"out": files.first(), "title": title, "beside": beside}).to_string())
}

/// Writes the scene of a trial for MuJoCo; file and task as JSON.
#[pyfunction]
#[pyo3(signature = (tasks, /, **settings))]
pub fn export_mjcf<'py>(
    py: Python<'py>,
    tasks: Vec<TaskWord>,
    settings: Option<Settings<'_, 'py>>,
) -> PyResult<String> {
    let words = Keywords::new(py, settings)?;
    let request = SceneRequest { setup: words.setup(tasks)?, finger: words.finger()? };
    let out: PathBuf = words.need("out")?;
    words.finish()?;
    let task = released(py, || {
        let (task, text) = request.mjcf()?;
        write_file(&out, &text)?;
        Ok(task)
    })?;
    Ok(json!({"out": out, "task": task.map_err(raise)?}).to_string())
}

/// The checked lines of a measurement file or of the shipped one, as JSON; `tasks` are files of tasks
/// of one's own.
#[pyfunction]
#[pyo3(signature = (name, tasks=vec![]))]
pub fn measurements(name: Name, tasks: Vec<Name>) -> PyResult<String> {
    let tasks: Vec<String> = tasks.into_iter().map(|Name(task)| task).collect();
    let lines = call::measured::read(&name.0, &tasks).map_err(raise)?;
    Ok(json!({"file": name.0, "lines": call::measured::json(&lines)}).to_string())
}

/// Adds a line to a measurement file; how many it has then.
#[pyfunction]
#[pyo3(signature = (file, /, **columns))]
pub fn add_measurement<'py>(
    py: Python<'py>,
    file: Name,
    columns: Option<Settings<'_, 'py>>,
) -> PyResult<usize> {
    let words = Keywords::new(py, columns)?;
    let not_measurable = words.flag("not_measurable")?.then(|| call::NOT_MEASURABLE.to_owned());
    let mut cells = Vec::new();
    for column in call::COLUMNS {
        let cell = match column {
            DENSITY_KEY => words.written("density")?,
            DIRECTION_KEY => words.written("direction")?,
            "range_mm" => not_measurable.clone().or(words.written(column)?),
            _ => words.written(column)?,
        };
        cells.extend(cell.map(|cell| (column, cell)));
    }
    let set = words.set()?;
    cells.extend(set.iter().map(|(key, number)| (&**key, number.to_string())));
    words.finish()?;
    if cells.is_empty() {
        return Err(InputError::new_err("nothing was given"));
    }
    Ok(call::add::added(&file.0, cells).map_err(raise)?.len())
}

/// Writes a sheet to measure windows of fingers by hand.
#[pyfunction]
pub fn measuring_sheet(
    py: Python<'_>,
    task: Name,
    fingers: Vec<(f64, f64)>,
    out: PathBuf,
) -> PyResult<()> {
    let request = SheetRequest { task: task.0, fingers, out };
    interruptible(py, |stop| request.run(stop))?.map_err(raise)
}

/// Writes tables, plots and page of a study again; the page and remarks as JSON.
#[pyfunction]
#[pyo3(name = "report")]
pub fn report_of(py: Python<'_>, folder: PathBuf) -> PyResult<String> {
    let record = released(py, || session::rewrite(&folder))?.map_err(raise)?;
    let page = folder.join(session::PAGE);
    let (count, remarks) = (record.evaluations.len(), record.remarks());
    Ok(json!({"page": page, "evaluations": count, "warnings": remarks}).to_string())
}

/// The shipped robots by the cells that they stand for, as JSON.
#[pyfunction]
pub fn robots() -> PyResult<String> {
    Ok(call::robots(&session::robots().map_err(raise)?).to_string())
}

/// What is shipped, as JSON.
#[pyfunction]
pub fn tasks() -> PyResult<String> {
    Ok(call::shipped().map_err(raise)?.0.to_string())
}
