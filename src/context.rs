//! The surroundings of a running command: what may cancel it, and who sees how far it is.

use crate::failure::Failure;
use crate::progress::Progress;
use crate::terminal::{self, say};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use study::{Recorded, Study};

/// A part of a long phase.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The phase and what was done: `confirming 10 %, 26°`.
    pub what: String,
    /// Parts of the phase that are done.
    pub done: usize,
    /// Parts of the phase.
    pub of: usize,
    /// Cost of such a part, in evaluations of the search, roughly.
    pub cost: f64,
}

/// Costs of the parts, in evaluations of the search. Measured on usb and ket8; they decide nothing but the
/// time that is said to be left.
pub mod cost {
    /// A design that is repeated at its ends.
    pub const REPEATED: f64 = 4.0;
    /// A design that is walked.
    pub const WALKED: f64 = 12.0;
    /// A simulation for an emulator.
    pub const SIMULATION: f64 = 1.2;
    /// A calibration with fingers left out.
    pub const FOLD: f64 = 4.0;
}

/// Time that a study has to end by itself once it is cancelled.
const GRACE: Duration = Duration::from_millis(400);
/// Set by Ctrl-C or a polite kill.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// What may cancel a command, and who sees how far it is.
pub struct Context<'a> {
    /// Cancels the command once it is set.
    pub stop: &'a AtomicBool,
    shown: Option<Shown>,
}

struct Shown {
    json: bool,
    quiet: bool,
    progress: Mutex<Option<Progress>>,
}

impl<'a> Context<'a> {
    /// Returns a context that shows nothing.
    pub fn silent(stop: &'a AtomicBool) -> Self {
        Context { stop, shown: None }
    }

    /// Lets Ctrl-C or a polite kill cancel a command that was typed. What has not ended in time is given up:
    /// the journal of the study in `dir` survives that.
    ///
    /// # Errors
    /// If signals cannot be watched.
    pub fn stop_on_interrupt(&self, dir: &Path) -> Result<(), Failure> {
        if self.shown.is_none() {
            return Ok(());
        }
        let dir = dir.display().to_string();
        let handler = move || {
            INTERRUPTED.store(true, Ordering::SeqCst);
            std::thread::sleep(GRACE);
            say(&format!("stopped; continue with: optimize resume {dir}"));
            std::process::exit(1);
        };
        ctrlc::set_handler(handler)
            .map_err(|error| Failure::running(format!("cannot watch for Ctrl-C: {error}")))
    }

    /// Checks that the command has not been cancelled.
    ///
    /// # Errors
    /// If it was: what was computed meanwhile is worthless.
    pub fn check(&self) -> Result<(), Failure> {
        not_stopped(self.stop)
    }

    /// Begins to show progress through so many evaluations' worth of work.
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

    /// Ends the progress that is shown.
    pub fn end(&self) {
        if let Some(shown) = &self.shown {
            drop(shown.progress().take());
        }
    }

    /// Shows that a part is done, from whichever thread did it.
    pub fn part(&self, part: &Part) {
        self.see(|progress| progress.part(part));
    }

    /// Shows that a design was evaluated and is written down.
    pub fn evaluated(&self, recorded: &Recorded) {
        self.see(|progress| progress.evaluated(recorded));
    }

    fn see(&self, see: impl FnOnce(&mut Progress)) {
        let Some(shown) = &self.shown else { return };
        if let Some(progress) = &mut *shown.progress() {
            see(progress);
        }
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
    /// Returns the context of a command that was typed.
    pub fn terminal(json: bool, quiet: bool) -> Self {
        let progress = Mutex::new(None);
        Context { stop: &INTERRUPTED, shown: Some(Shown { json, quiet, progress }) }
    }
}

impl Shown {
    fn progress(&self) -> MutexGuard<'_, Option<Progress>> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Checks that a run has not been cancelled.
///
/// # Errors
/// If `stop` is set: what was computed meanwhile is worthless.
pub fn not_stopped(stop: &AtomicBool) -> Result<(), Failure> {
    match stop.load(Ordering::SeqCst) {
        true => Err(Failure::Interrupted(None)),
        false => Ok(()),
    }
}
