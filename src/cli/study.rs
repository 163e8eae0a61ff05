//! `optimize --task T --budget N`: begins or continues a study.

use super::progress::Progress;
use super::{Failure, print, say, summary};
use crate::session::{Around, OpenStudy, ResumeRequest, StudyRequest};
use clap::Args;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Run a study.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    pub request: StudyRequest,
    #[command(flatten)]
    pub shown: Shown,
}

/// Continue a study.
#[derive(Debug, Args)]
pub struct ResumeArguments {
    #[command(flatten)]
    pub request: ResumeRequest,
    #[command(flatten)]
    pub shown: Shown,
}

/// What is shown of a study.
#[derive(Debug, Clone, Copy, Default, Args)]
pub struct Shown {
    /// Print the result as JSON
    #[arg(long)]
    pub json: bool,
    /// Print all numbers behind the answer, too
    #[arg(long, conflicts_with = "json")]
    pub verbose: bool,
    /// Show no progress
    #[arg(long)]
    pub quiet: bool,
}

/// Runs an open study until its budget is spent, shows how far it is, and prints its result.
pub fn to_its_end(open: OpenStudy, shown: Shown) -> Result<(), Failure> {
    let stop = stop_on_interrupt(open.study().dir())?;
    let open = warned(open)?;
    let mut progress = Progress::new(open.study(), shown.quiet);
    let ended = open.run(&stop, &mut |event| progress.see(event))?;
    drop(progress);
    ended.record.remarks().iter().for_each(|remark| say(&format!("warning: {remark}")));
    if shown.json {
        // The answer stands without them.
        let (around, failed) = match ended.around(&stop) {
            Ok(around) => (around, None),
            Err(failure) => (Around::default(), Some(failure)),
        };
        print(&summary::json(&ended, &around))?;
        failed.map_or(Ok(()), Err)?;
    } else {
        print(&summary::text(&ended, shown))?;
        print(&summary::around(&ended.around(&stop)?))?;
    }
    ended.unusable.map_or(Ok(()), Err)
}

/// The study, what is to be known before it starts said.
pub fn warned(open: OpenStudy) -> Result<OpenStudy, Failure> {
    if open.new_measurements > 0 {
        let plural = if open.new_measurements == 1 { "" } else { "s" };
        say(&format!("{} new measurement{plural}", open.new_measurements));
    }
    open.warnings()?.iter().for_each(|warning| say(&format!("warning: {warning}")));
    Ok(open)
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
