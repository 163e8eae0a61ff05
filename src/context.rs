//! Context of a running command: cancellation and progress.

use crate::failure::Failure;
use crate::progress::{Busy, Part, Progress};
use crate::terminal::{self, say};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use study::{Recorded, Study};

/// Time for a study to end by itself after it is cancelled.
const GRACE: Duration = Duration::from_millis(400);
/// Set by Ctrl-C or SIGTERM.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Cancellation and progress of a command.
pub struct Context<'a> {
    /// Cancels the command once it is set.
    pub stop: &'a AtomicBool,
    shown: Option<Shown>,
}

/// Constructor of the command line of the program.
pub type Program = fn() -> clap::Command;

struct Shown {
    program: Program,
    json: bool,
    quiet: bool,
    progress: Mutex<Option<Progress>>,
}

impl<'a> Context<'a> {
    /// Returns a context that shows nothing.
    pub fn silent(stop: &'a AtomicBool) -> Self {
        Context { stop, shown: None }
    }

    /// Lets Ctrl-C or SIGTERM cancel a command of the terminal. After the grace period the process exits, which the
    /// journal of the study in `dir` survives.
    ///
    /// # Errors
    /// If signals cannot be watched.
    pub fn stop_on_interrupt(&self, dir: &Path) -> Result<(), Failure> {
        if self.shown.is_none() {
            return Ok(());
        }
        let dir = dir.display().to_string();
        watch(move || {
            INTERRUPTED.store(true, Ordering::SeqCst);
            std::thread::sleep(GRACE);
            say(&format!("stopped; continue with: optimize resume {dir}"));
            std::process::exit(1);
        })
    }

    /// Lets Ctrl-C or SIGTERM cancel a command of the terminal, which then keeps what it has; a second one ends the
    /// process.
    ///
    /// # Errors
    /// If signals cannot be watched.
    pub fn cancel_on_interrupt(&self) -> Result<(), Failure> {
        if self.shown.is_none() {
            return Ok(());
        }
        watch(|| {
            if INTERRUPTED.swap(true, Ordering::SeqCst) {
                std::process::exit(1);
            }
        })
    }

    /// Checks that the command has not been cancelled.
    ///
    /// # Errors
    /// If it was cancelled.
    pub fn check(&self) -> Result<(), Failure> {
        not_stopped(self.stop)
    }

    /// Begins to show the progress of work that costs this many evaluations.
    pub fn begin(&self, cost: f64) {
        if let Some(shown) = &self.shown {
            *shown.progress() = Some(Progress::of(cost, !shown.quiet && !shown.json));
        }
    }

    /// Begins to show the progress of a study.
    pub fn begin_study(&self, study: &Study) {
        if let Some(shown) = &self.shown {
            *shown.progress() = Some(Progress::of_study(study, !shown.quiet));
        }
    }

    /// Begins to show work of unknown length, until the result is dropped.
    pub fn busy(&self, what: &'static str) -> Option<Busy> {
        self.shown.as_ref().filter(|shown| !shown.quiet && !shown.json).map(|_| Busy::new(what))
    }

    /// Ends the progress that is shown.
    pub fn end(&self) {
        if let Some(shown) = &self.shown {
            drop(shown.progress().take());
        }
    }

    /// Shows that a part is done, from any thread.
    pub fn part(&self, part: &Part) {
        self.see(|progress| progress.part(part));
    }

    /// Shows that a design was evaluated and recorded.
    pub fn evaluated(&self, recorded: &Recorded) {
        self.see(|progress| progress.evaluated(recorded));
    }

    fn see(&self, see: impl FnOnce(&mut Progress)) {
        let Some(shown) = &self.shown else { return };
        if let Some(progress) = &mut *shown.progress() {
            see(progress);
        }
    }

    /// Returns the command line of the program.
    ///
    /// # Errors
    /// If the command was not started from a terminal.
    pub fn program(&self) -> Result<clap::Command, Failure> {
        let shown = self.shown.as_ref();
        let shown = shown.ok_or_else(|| {
            Failure::usage("this command describes the command line; run it as `optimize`")
        })?;
        Ok((shown.program)())
    }

    /// Writes a line on standard error.
    pub fn note(&self, text: &str) {
        let Some(shown) = &self.shown else { return };
        match &*shown.progress() {
            Some(progress) => progress.say(text),
            None => say(text),
        }
    }

    /// Prints a first part of the result at once, unless it is printed as JSON.
    ///
    /// # Errors
    /// If standard output cannot be written.
    pub fn print(&self, text: &str) -> Result<(), Failure> {
        match &self.shown {
            Some(shown) if !shown.json => terminal::print(text),
            _ => Ok(()),
        }
    }
}

impl Context<'static> {
    /// Returns the context of a command that was started from a terminal.
    pub fn terminal(json: bool, quiet: bool, program: Program) -> Self {
        let progress = Mutex::new(None);
        Context { stop: &INTERRUPTED, shown: Some(Shown { program, json, quiet, progress }) }
    }
}

impl Shown {
    fn progress(&self) -> MutexGuard<'_, Option<Progress>> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn watch(handler: impl FnMut() + 'static + Send) -> Result<(), Failure> {
    ctrlc::set_handler(handler)
        .map_err(|error| Failure::running(format!("cannot watch for Ctrl-C: {error}")))
}

/// Checks that a run has not been cancelled.
///
/// # Errors
/// If `stop` is set.
pub fn not_stopped(stop: &AtomicBool) -> Result<(), Failure> {
    match stop.load(Ordering::SeqCst) {
        true => Err(Failure::Interrupted(None)),
        false => Ok(()),
    }
}
