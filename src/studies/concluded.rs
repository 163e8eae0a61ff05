//! Studies run to their end, and their output.

use super::around::Around;
use super::open::{Ended, OpenStudy};
use super::summary::Summary;
use super::text;
use crate::command;
use crate::context::Context;
use crate::failure::Failure;
use report::answer::Answer;
use serde::{Serialize, Serializer};
use std::fmt;
use std::sync::{Mutex, PoisonError};

/// Output of a study.
pub struct Concluded {
    ended: Ended,
    around: Around,
    /// Text that remains to be printed.
    rest: String,
    /// Why levers and maps are missing, if that failed.
    failed: Mutex<Option<Failure>>,
}

/// Runs the study to its end, shows how far it is, and prints its answer before levers and maps are measured.
///
/// # Errors
/// If a design cannot be simulated or a file cannot be written; if it is cancelled meanwhile.
pub fn run(open: OpenStudy, context: &Context<'_>, all: bool) -> Result<Concluded, Failure> {
    context.stop_on_interrupt(open.study().dir())?;
    open.warn(context)?;
    context.begin_study(open.study());
    let ended = open.run(context)?;
    context.end();
    let remarks = ended.record.remarks();
    remarks.iter().for_each(|remark| context.note(&format!("warning: {remark}")));
    context.print(&text::ended(&ended, all))?;
    // The answer stands without them.
    let (around, failed) = match ended.around(context.stop) {
        Ok(around) => (around, None),
        Err(failure) => (Around::default(), Some(failure)),
    };
    let rest = text::around(&around);
    Ok(Concluded { ended, around, rest, failed: Mutex::new(failed) })
}

impl Serialize for Concluded {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let answer = Answer::of(&self.ended.record);
        Summary::new(&self.ended, &answer, &self.around).serialize(serializer)
    }
}

impl fmt::Display for Concluded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.rest)
    }
}

impl command::Response for Concluded {
    fn verdict(&self) -> Result<(), Failure> {
        let failed = self.failed.lock().unwrap_or_else(PoisonError::into_inner).take();
        match (failed, &self.ended.unusable) {
            (Some(failure), _) => Err(failure),
            (None, Some(why)) => Err(Failure::running(why.to_string())),
            (None, None) => Ok(()),
        }
    }
}
