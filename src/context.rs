//! Context of a running command: cancellation and progress.

use crate::Failure;
use crate::progress::{Busy, Progress};
use crate::terminal::{print, say};
use input::files::shell_word;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use study::{Recorded, Study};

/// Grace period: time for a study to end by itself after it is cancelled.
const GRACE: Duration = Duration::from_millis(400);
/// Set by Ctrl-C or SIGTERM.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Cancellation and progress of a command.
pub struct Context<'a> {
    /// Cancels the command once it is set.
    pub stop: &'a AtomicBool,
    terminal: Option<Terminal>,
}

/// Constructor of the clap definition of the whole command line.
pub type Program = fn() -> clap::Command;

/// Terminal on which a command was started.
struct Terminal {
    program: Program,
    json: bool,
    quiet: bool,
    progress: Mutex<Option<Progress>>,
}

impl<'a> Context<'a> {
    /// Returns a context that shows nothing.
    pub fn silent(stop: &'a AtomicBool) -> Self {
        Context { stop, terminal: None }
    }

    /// Lets Ctrl-C or SIGTERM cancel a command of the terminal. After the grace period the process exits; the journal
    /// of the study in `dir` remains valid.
    ///
    /// # Errors
    /// If signals cannot be watched.
    pub fn stop_on_interrupt(&self, dir: &Path) -> Result<(), Failure> {
        let dir = shell_word(dir.display());
        self.watch(move || {
            INTERRUPTED.store(true, Ordering::SeqCst);
            std::thread::sleep(GRACE);
            say(&format!("stopped; continue with: optimize resume {dir}"));
            std::process::exit(1);
        })
    }

    /// Lets Ctrl-C or SIGTERM cancel a command of the terminal, which then keeps its results so far; a second one ends
    /// the process.
    ///
    /// # Errors
    /// If signals cannot be watched.
    pub fn cancel_on_interrupt(&self) -> Result<(), Failure> {
        self.watch(|| {
            if INTERRUPTED.swap(true, Ordering::SeqCst) {
                std::process::exit(1);
            }
        })
    }

    /// Sets the handler of Ctrl-C and SIGTERM for a command of the terminal.
    fn watch(&self, handler: impl FnMut() + 'static + Send) -> Result<(), Failure> {
        if self.is_terminal() { watch(handler) } else { Ok(()) }
    }

    /// Returns whether the command was started from a terminal.
    pub fn is_terminal(&self) -> bool {
        self.terminal.is_some()
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
        if let Some(terminal) = &self.terminal {
            *terminal.progress() = Some(Progress::of(cost, !terminal.quiet && !terminal.json));
        }
    }

    /// Begins to show the progress of a study.
    pub fn begin_study(&self, study: &Study) {
        if let Some(terminal) = &self.terminal {
            *terminal.progress() = Some(Progress::of_study(study, !terminal.quiet));
        }
    }

    /// Begins to show work of unknown length, until the result is dropped.
    pub fn busy(&self, what: &'static str) -> Option<Busy> {
        self.terminal
            .as_ref()
            .filter(|terminal| !terminal.quiet && !terminal.json)
            .map(|_| Busy::new(what))
    }

    /// Ends the progress that is shown.
    pub fn end(&self) {
        drop(self.terminal.as_ref().map(|terminal| terminal.progress().take()));
    }

    /// Shows that a part of a phase is done, from any thread; see [`Progress::part`].
    pub fn part(&self, what: &str, done_of: [usize; 2], cost: f64) {
        self.update(|progress| progress.part(what, done_of, cost));
    }

    /// Shows that a design was evaluated and recorded.
    pub fn evaluated(&self, recorded: &Recorded) {
        self.update(|progress| progress.evaluated(recorded));
    }

    fn update(&self, update: impl FnOnce(&mut Progress)) {
        let Some(terminal) = &self.terminal else { return };
        if let Some(progress) = &mut *terminal.progress() {
            update(progress);
        }
    }

    /// Returns the clap definition of the whole command line.
    ///
    /// # Errors
    /// If the command was not started from a terminal.
    pub fn program(&self) -> Result<clap::Command, Failure> {
        let terminal = self.terminal.as_ref().ok_or_else(|| {
            Failure::usage("this command describes the command line; run it as `optimize`")
        })?;
        Ok((terminal.program)())
    }

    /// Writes a line on standard error.
    pub fn note(&self, text: &str) {
        let Some(terminal) = &self.terminal else { return };
        match &*terminal.progress() {
            Some(progress) => progress.say(text),
            None => say(text),
        }
    }

    /// Prints a first part of the result at once, unless it is printed as JSON.
    ///
    /// # Errors
    /// If standard output cannot be written.
    pub fn print(&self, text: &str) -> Result<(), Failure> {
        match &self.terminal {
            Some(terminal) if !terminal.json => print(text),
            _ => Ok(()),
        }
    }
}

impl Context<'static> {
    /// Returns the context of a command that was started from a terminal.
    pub fn terminal(json: bool, quiet: bool, program: Program) -> Self {
        let progress = Mutex::new(None);
        Context { stop: &INTERRUPTED, terminal: Some(Terminal { program, json, quiet, progress }) }
    }
}

impl Terminal {
    fn progress(&self) -> MutexGuard<'_, Option<Progress>> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Sets the handler of Ctrl-C and SIGTERM.
pub(crate) fn watch(handler: impl FnMut() + 'static + Send) -> Result<(), Failure> {
    ctrlc::set_handler(handler)
        .map_err(|error| Failure::running(format!("cannot watch for Ctrl-C: {error}")))
}

/// Checks that a run has not been cancelled.
///
/// # Errors
/// If `stop` is set.
pub fn not_stopped(stop: &AtomicBool) -> Result<(), Failure> {
    if stop.load(Ordering::SeqCst) { Err(Failure::Interrupted(None)) } else { Ok(()) }
}
