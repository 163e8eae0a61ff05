//! Parts of the command line for callers of the library from elsewhere: `--executor`'s words as
//! requests, and the printed text.

use super::study::{Arguments, ResumeArguments};
use super::{Failure, recommended, summary};
use crate::session::{AnyStudy, Around, Ended};
use clap::{Args, Parser};
use report::answer::Answer;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::Path;
use study::StudyRecord;

pub use super::calibrate::written as calibration;
pub use super::compare::compared;
pub use super::export::finger as export_finger;
pub use super::finger::drawn as finger;
pub use super::measure::{add, check as measured};
pub use super::next::json as advice;
pub use super::robots::json as robots;
pub use super::study::{Shown, warned};
pub use super::task::{check as task_check, new as task_new, tune as task_tune};
pub use super::tasks::listed as shipped;
pub use calibration::experiments::{COLUMNS, NOT_MEASURABLE};

#[derive(Parser)]
#[command(no_binary_name = true)]
struct Words<T: Args> {
    #[command(flatten)]
    arguments: T,
}

/// Request made by the words of a study.
pub struct Asked {
    /// Which study.
    pub study: AnyStudy,
    /// Where it is measured.
    pub executor: Option<String>,
    /// What is shown of it.
    pub shown: Shown,
}

/// Reads the words of `optimize` or `optimize resume`; the text of a failure is clap's.
pub fn asked(words: &[OsString]) -> Result<Asked, Failure> {
    let (study, executor, shown) = match words {
        [first, rest @ ..] if first == "resume" => {
            let ResumeArguments { request, shown } = read(rest)?;
            let executor = request.run.executor.clone();
            (AnyStudy::Resumed(request), executor, shown)
        }
        words => {
            let Arguments { request, shown } = read(words)?;
            let executor = request.run.executor.clone();
            (AnyStudy::Asked(Box::new(request)), executor, shown)
        }
    };
    Ok(Asked { study, executor, shown })
}

fn read<T: Args>(words: &[OsString]) -> Result<T, Failure> {
    let read = Words::<T>::try_parse_from(words).map_err(|error| {
        let text = error.render().to_string();
        Failure::usage(text.strip_prefix("error: ").unwrap_or(&text).trim_end())
    })?;
    Ok(read.arguments)
}

/// Output of the command for a study that has ended.
pub fn text(ended: &Ended, around: &Around, shown: Shown) -> String {
    match shown.json {
        true => summary::json(ended, around),
        false => summary::text(ended, shown) + &summary::around(around),
    }
}

/// The `answer` of `--json` for the study in a folder.
pub fn answer(record: &StudyRecord, dir: &Path) -> Value {
    recommended::answer(&Answer::of(record), dir)
}

/// The `recommended` design of `--json`; of several objectives the first of the front. Null
/// while there is none.
pub fn best(record: &StudyRecord) -> Value {
    let recommended = recommended::json(&Answer::of(record))["recommended"].take();
    match (recommended.is_null(), record.front().first()) {
        (true, Some(first)) if record.config.objective.single().is_none() => {
            let score = first.score.iter().flat_map(|score| score.values.clone());
            let objectives = record.config.objective.keys().into_iter().zip(score);
            let objectives: BTreeMap<_, _> = objectives.collect();
            json!({"values": first.design, "evaluation": first.index, "objectives": objectives})
        }
        _ => recommended,
    }
}
