//! Run of a study to its end, and its output.

use super::open::OpenStudy;
use super::summary::summary;
use super::text;
use crate::{Context, Failure, Output};
use report::PostAnalysis;
use report::answer::Answer;

/// Runs the study to its end, shows its progress, and prints its answer before the analyses of the
/// recommended finger; then follow the results of these, the next command and the folder.
///
/// # Errors
/// If a design cannot be simulated or a file cannot be written; if it is cancelled meanwhile.
pub fn run(open: OpenStudy, context: &Context<'_>, all: bool) -> Result<Output, Failure> {
    context.stop_on_interrupt(open.study.dir())?;
    open.warn(context)?;
    context.begin_study(&open.study);
    let mut ended = open.run(context)?;
    context.end();
    let answer = Answer::of(&ended.record);
    context.print(&text::ended(&ended, &answer, all))?;
    // The answer does not depend on the analyses.
    let (found, failure) = match ended.analyse(&answer, context) {
        Ok(found) => (found, None),
        Err(failure) => (PostAnalysis::default(), Some(failure)),
    };
    let value = summary(&ended, &answer, &found);
    let failure = failure.or_else(|| ended.unusable.take());
    // The answer is already printed.
    let text = text::analyses(&found) + &text::next(&answer, &ended.dir);
    Ok(Output { failure, ..Output::new(text, value) })
}
