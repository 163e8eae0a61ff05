//! `optimize --task T --budget N`: begins or continues a study.

use super::arguments::RunArguments;
use super::progress::Progress;
use super::{Failure, print, say, summary};
use crate::session::{Ended, OpenStudy, ResumeRequest, StudyRequest};
use clap::Args;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Run a study.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    request: StudyRequest,
    #[command(flatten)]
    pub run: RunArguments,
}

impl Arguments {
    pub fn request(&self) -> StudyRequest {
        StudyRequest { run: self.run.request(), ..self.request.clone() }
    }
}

/// Continue a study.
#[derive(Debug, Args)]
pub struct ResumeArguments {
    #[command(flatten)]
    request: ResumeRequest,
    #[command(flatten)]
    pub run: RunArguments,
}

impl ResumeArguments {
    pub fn request(&self) -> ResumeRequest {
        ResumeRequest { run: self.run.request(), ..self.request.clone() }
    }
}

/// Runs an open study until its budget is spent, shows how far it is, and prints its result.
pub fn to_its_end(open: OpenStudy, arguments: &RunArguments) -> Result<(), Failure> {
    let stop = stop_on_interrupt(open.study().dir())?;
    let mut progress = Progress::new(open.study(), arguments.quiet, arguments.json);
    let Ended { dir, record, ending, known, unusable } =
        open.run(&stop, &mut |event| progress.see(event))?;
    print(&summary::printed(&dir, &record, ending, known, arguments.json))?;
    unusable.map_or(Ok(()), Err)
}

/// A flag that Ctrl-C (or a polite kill) sets; a second one ends the process
/// at once, which the journal survives as well.
fn stop_on_interrupt(dir: &Path) -> Result<Arc<AtomicBool>, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    let (flag, dir) = (Arc::clone(&stop), dir.display().to_string());
    let handler = move || {
        if flag.swap(true, Ordering::SeqCst) {
            say(&format!("stopped; continue with: optimize resume {dir}"));
            std::process::exit(1);
        }
        say("stopping; once more to stop at once");
    };
    ctrlc::set_handler(handler)
        .map_err(|error| Failure::running(format!("cannot watch for Ctrl-C: {error}")))?;
    Ok(stop)
}
