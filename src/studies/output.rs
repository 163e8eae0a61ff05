//! Run of a study to its end, and its output.

use super::open::OpenStudy;
use super::summary::summary;
use super::text;
use crate::command;
use crate::context::Context;
use crate::failure::Failure;
use report::PostAnalysis;
use report::answer::Answer;
use serde::Serialize;
use serde_json::Value;
use std::fmt;

/// Output of a study.
#[derive(Serialize)]
#[serde(transparent)]
pub struct StudyOutput {
    summary: Value,
    /// Text that follows the answer.
    #[serde(skip)]
    rest: String,
    /// Error of the analyses, or reason for which the study has no result.
    #[serde(skip)]
    failure: Option<Failure>,
}

/// Runs the study to its end, shows its progress, and prints its answer before the analyses of the
/// recommended finger.
///
/// # Errors
/// If a design cannot be simulated or a file cannot be written; if it is cancelled meanwhile.
pub fn run(open: OpenStudy, context: &Context<'_>, all: bool) -> Result<StudyOutput, Failure> {
    context.stop_on_interrupt(open.study.dir())?;
    open.warn(context)?;
    context.begin_study(&open.study);
    let mut ended = open.run(context)?;
    context.end();
    let remarks = ended.record.remarks();
    remarks.iter().for_each(|remark| context.note(&format!("warning: {remark}")));
    let answer = Answer::of(&ended.record);
    context.print(&text::ended(&ended, &answer, all))?;
    // The answer does not depend on the analyses.
    let busy = context.busy("levers and maps of the finger");
    let analysed = ended.analyse(&answer, context.stop);
    drop(busy);
    let (found, failure) = match analysed {
        Ok(found) => (found, None),
        Err(failure) => (PostAnalysis::default(), Some(failure)),
    };
    let (summary, rest) = (summary(&ended, &answer, &found), text::analyses(&found));
    let failure = failure.or_else(|| ended.unusable.take());
    Ok(StudyOutput { summary, rest, failure })
}

impl fmt::Display for StudyOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.rest)
    }
}

impl command::Response for StudyOutput {
    fn verdict(self) -> Result<(), Failure> {
        self.failure.map_or(Ok(()), Err)
    }
}
