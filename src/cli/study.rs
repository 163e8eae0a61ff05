//! `optimize --task T --budget N`: begins or continues a study.

use super::arguments::RunArguments;
use super::progress::Progress;
use super::{Failure, print, say, summary};
use crate::session::{Ended, OpenStudy, ResumeRequest, StudyRequest};
use clap::Args;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

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
    let mut progress = Progress::new(open.study(), arguments.quiet);
    let Ended { dir, record, ending, known, unusable } =
        open.run(&stop, &mut |event| progress.see(event))?;
    drop(progress);
    record.remarks().iter().for_each(|remark| say(&format!("warning: {remark}")));
    print(&summary::printed(&dir, &record, ending, known, arguments.json))?;
    unusable.map_or(Ok(()), Err)
}

/// How long a study may take to end by itself once it is told to stop.
const GRACE: Duration = Duration::from_millis(400);

/// A flag that Ctrl-C (or a polite kill) sets. What has not looked at it in time is given up: the
/// journal survives that.
fn stop_on_interrupt(dir: &Path) -> Result<Arc<AtomicBool>, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    let (flag, dir) = (Arc::clone(&stop), dir.display().to_string());
    let handler = move || {
        flag.store(true, Ordering::SeqCst);
        std::thread::sleep(GRACE);
        say(&format!("stopped; continue with: optimize resume {dir}"));
        std::process::exit(1);
    };
    ctrlc::set_handler(handler)
        .map_err(|error| Failure::running(format!("cannot watch for Ctrl-C: {error}")))?;
    Ok(stop)
}
