//! Keyword arguments on their way into requests.

use crate::errors::{InputError, placed};
use clap::ValueEnum;
use finger_opt::session::{
    CacheRequest, EffortRequest, FilmRequest, FingerModelRequest, FingerRequest, RepeatRequest,
    RunRequest, SetupRequest, TaskSource,
};
use input::Place;
use input::shipped::Source;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyString};
use std::path::PathBuf;
use std::str::FromStr;

/// A name, or a path of any kind that Python knows.
pub struct Name(pub String);

impl FromPyObject<'_> for Name {
    fn extract_bound(value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let text = value.extract::<PathBuf>()?.into_os_string().into_string();
        text.map(Name).map_err(|name| {
            InputError::new_err(format!("{}: its name has to be UTF-8", name.display()))
        })
    }
}

/// Tasks: names by commas, a path, or what to call a task file in messages, and its text.
pub struct TaskWord(Vec<TaskSource>);

impl FromPyObject<'_> for TaskWord {
    fn extract_bound(value: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok((file, text)) = value.extract() {
            return Ok(TaskWord(vec![TaskSource::Given(Source { file, text })]));
        }
        let Name(name) = value.extract()?;
        Ok(TaskWord(match value.is_instance_of::<PyString>() {
            true => TaskSource::list(&name),
            // A path may have a comma in it.
            false => vec![TaskSource::Named(name)],
        }))
    }
}

impl TaskWord {
    /// The one task.
    pub fn one(self) -> PyResult<TaskSource> {
        let Ok([task]) = <[TaskSource; 1]>::try_from(self.0) else {
            return Err(wrong("task", "give one task"));
        };
        Ok(task)
    }
}

/// The keywords of a call: each is taken by whoever knows it, and what is left is unknown. `None` and
/// `False` are as good as nothing.
pub struct Keywords<'py>(Bound<'py, PyDict>);

impl<'py> Keywords<'py> {
    /// By their names on the command line with underscores; one behind keeps clear of Python's words.
    pub fn new(py: Python<'py>, given: Option<&Bound<'py, PyDict>>) -> PyResult<Self> {
        let found = PyDict::new(py);
        for (name, value) in given.into_iter().flatten() {
            let name: String = name.extract()?;
            let plain = name.trim_end_matches('_').replace('-', "_");
            found.set_item(if name.contains('.') { &name } else { &plain }, value)?;
        }
        Ok(Keywords(found))
    }

    /// Whether nothing is left.
    pub fn finish(self) -> PyResult<()> {
        match self.0.keys().iter().next() {
            None => Ok(()),
            Some(name) => {
                Err(PyTypeError::new_err(format!("unexpected keyword argument '{name}'")))
            }
        }
    }

    fn value(&self, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let value = self.0.get_item(name)?;
        if value.is_some() {
            self.0.del_item(name)?;
        }
        let left_out = |value: &Bound<'_, PyAny>| {
            value.is_none() || value.is(&*PyBool::new(value.py(), false))
        };
        Ok(value.filter(|value| !left_out(value)))
    }

    /// A value, if it is given.
    pub fn take<T: FromPyObject<'py>>(&self, name: &str) -> PyResult<Option<T>> {
        self.value(name)?.map(|value| extracted(name, &value)).transpose()
    }

    /// A value that has to be given.
    pub fn need<T: FromPyObject<'py>>(&self, name: &str) -> PyResult<T> {
        self.take(name)?.ok_or_else(|| wrong(name, "is missing"))
    }

    /// A value as a file has it.
    pub fn written(&self, name: &str) -> PyResult<Option<String>> {
        Ok(self.words(name)?.pop())
    }

    /// A number, if it is given; `True` is the usual one.
    pub fn number_or(&self, name: &str, usual: u64) -> PyResult<Option<u64>> {
        let value = self.value(name)?;
        let number = |value: Bound<'py, PyAny>| match value.is_instance_of::<PyBool>() {
            true => Ok(usual),
            false => extracted(name, &value),
        };
        value.map(number).transpose()
    }

    /// Whether a keyword is `True`.
    pub fn flag(&self, name: &str) -> PyResult<bool> {
        let value = self.value(name)?;
        value.map_or(Ok(false), |value| value.extract().map_err(|error| wrong(name, error)))
    }

    /// A name or a path.
    pub fn text(&self, name: &str) -> PyResult<Option<String>> {
        Ok(self.take(name)?.map(|Name(text)| text))
    }

    /// One of the words that there are.
    pub fn choice<T: ValueEnum>(&self, name: &str) -> PyResult<Option<T>> {
        let Some(word) = self.take::<String>(name)? else { return Ok(None) };
        T::from_str(&word, false).map(Some).map_err(|_| {
            let words = T::value_variants().iter().filter_map(T::to_possible_value);
            let words = words.filter(|word| !word.is_hide_set());
            let words: Vec<String> = words.map(|word| word.get_name().to_owned()).collect();
            wrong(name, format!("`{word}` is none of {}", words.join(", ")))
        })
    }

    /// Words: one, or several in an iterable.
    fn words(&self, name: &str) -> PyResult<Vec<String>> {
        let Some(value) = self.value(name)? else { return Ok(Vec::new()) };
        if value.is_instance_of::<PyString>() {
            return Ok(vec![extracted(name, &value)?]);
        }
        match value.try_iter() {
            Ok(words) => words.map(|word| Ok(word?.str()?.to_string())).collect(),
            Err(_) => Ok(vec![value.str()?.to_string()]),
        }
    }

    /// Values written as text, each of several by itself.
    pub fn parsed<T: FromStr<Err: ToString>>(&self, name: &str) -> PyResult<Vec<T>> {
        let parse =
            |word: String| word.parse().map_err(|error: T::Err| wrong(name, error.to_string()));
        self.words(name)?.into_iter().map(parse).collect()
    }

    /// Value written as text, the parts by commas.
    pub fn listed<T: FromStr<Err: ToString>>(&self, name: &str) -> PyResult<Option<T>> {
        let words = self.words(name)?;
        let parse =
            || words.join(",").parse().map_err(|error: T::Err| wrong(name, error.to_string()));
        (!words.is_empty()).then(parse).transpose()
    }

    /// Numbers by commas or in an iterable.
    pub fn numbers(&self, name: &str) -> PyResult<Vec<f64>> {
        let words = self.words(name)?.join(",");
        let number = |word: &str| {
            word.trim().parse().map_err(|_| wrong(name, format!("`{word}` is no number")))
        };
        words.split(',').filter(|_| !words.is_empty()).map(number).collect()
    }

    /// Tasks, space, robot and finger model.
    pub fn setup(&self, tasks: Vec<TaskWord>) -> PyResult<SetupRequest> {
        let usual = SetupRequest::default();
        Ok(SetupRequest {
            tasks: tasks.into_iter().flat_map(|TaskWord(sources)| sources).collect(),
            space: self.text("space")?.unwrap_or(usual.space),
            robot: self.text("robot")?,
            cell: self.text("cell")?,
            stiffness_data: self.text("stiffness_data")?,
            engine: self.choice("engine")?.unwrap_or(usual.engine),
            finger_model: FingerModelRequest {
                kind: self.choice("finger_model")?,
                finger: self.text("finger")?.unwrap_or(usual.finger_model.finger),
            },
            start: self.choice("start")?,
        })
    }

    /// Numbers of task and finger: they stand in `set`, or under their own keys, which have a dot.
    pub fn set(&self) -> PyResult<Vec<(String, f64)>> {
        let mut set = Vec::new();
        for name in self.0.keys().iter().filter_map(|name| name.extract::<String>().ok()) {
            if name.contains('.') {
                set.extend(self.take(&name)?.map(|number: f64| (name, number)));
            }
        }
        for (name, number) in self.take::<Bound<'py, PyDict>>("set")?.into_iter().flatten() {
            let name: String = extracted("set", &name)?;
            let number = extracted(&name, &number)?;
            set.push((name, number));
        }
        Ok(set)
    }

    /// The finger.
    pub fn finger(&self) -> PyResult<FingerRequest> {
        Ok(FingerRequest {
            density: self.take("density")?,
            direction: self.take("direction")?,
            stiffness_compliance: self.take("stiffness_compliance")?,
            stiffness_assembly: self.take("stiffness_assembly")?,
            set: self.set()?,
        })
    }

    /// The repeats, if they are asked for.
    pub fn repeat(&self) -> PyResult<Option<RepeatRequest>> {
        let (count, seed) = (self.take("repeat")?, self.take("repeat_seed")?);
        if count.is_none() && seed.is_some() {
            return Err(wrong("repeat_seed", "goes with repeat"));
        }
        Ok(count.map(|count| RepeatRequest { count, seed: seed.unwrap_or(0) }))
    }

    /// Recordings asked for of a trial.
    pub fn film(&self) -> PyResult<FilmRequest> {
        Ok(FilmRequest {
            record: self.take("record")?,
            plot: self.take("plot")?,
            page: self.flag("film")?,
        })
    }

    /// How a study is run.
    pub fn run(&self) -> PyResult<RunRequest> {
        Ok(RunRequest {
            threads: self.take("threads")?,
            cache: CacheRequest { dir: self.take("cache")?, off: self.flag("no_cache")? },
            no_confirm: self.flag("no_confirm")?,
            no_levers: self.flag("no_levers")?,
            no_map: self.flag("no_map")?,
            accept_changed: self.flag("accept_changed")?,
            executor: None,
            effort: EffortRequest {
                simulations: self.take("simulations")?,
                samples: self.take("samples")?,
            },
        })
    }
}

/// Error for a wrong value of a keyword.
pub fn wrong(name: &str, problem: impl ToString) -> PyErr {
    let error = InputError::new_err(format!("{name}: {}", problem.to_string()));
    placed(Place::default().key(name), error)
}

fn extracted<'py, T: FromPyObject<'py>>(name: &str, value: &Bound<'py, PyAny>) -> PyResult<T> {
    if value.is_instance_of::<PyBool>() {
        return Err(wrong(name, "needs a value"));
    }
    value.extract().map_err(|error| wrong(name, error.value(value.py())))
}
