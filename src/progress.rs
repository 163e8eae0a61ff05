//! Progress on standard error of all phases of a command: a bar on a terminal, a line every few seconds elsewhere.

use crate::studies::best_so_far::BestSoFar;
use crate::terminal::say;
use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use std::io::{IsTerminal, stderr};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use study::{Recorded, Study};

/// Computing time of a part in multiples of one evaluation of the search, measured on the tasks usb and ket8. Used only
/// to estimate the time left.
pub mod cost {
    /// Confirmation of a design by repeated trials at the ends of its window.
    pub const REPEATED: f64 = 4.0;
    /// Confirmation of a design whose window is searched step by step.
    pub const WALKED: f64 = 12.0;
    /// A simulation to fit the emulator of a bench prediction.
    pub const SIMULATION: f64 = 1.2;
    /// A calibration with one finger left out, to validate a bench prediction.
    pub const FOLD: f64 = 4.0;
    /// The one-at-a-time sensitivity analysis (levers) of a finger.
    pub const LEVERS: f64 = 36.0;
    /// A capture map of the largest number of trials.
    pub const MAP: f64 = 18.0;
}

/// Interval between two lines if standard error is not a terminal.
const EVERY: Duration = Duration::from_secs(3);
/// Duration up to which a result counts as read from the cache.
const CACHED: Duration = Duration::from_millis(5);
/// Computed work from which on the time left is shown: the first results of several threads take several times longer
/// than the following ones.
const MIN_COMPUTED: f64 = 5.0;
/// Typical numbers of designs confirmed at a cost of [`cost::REPEATED`] and of [`cost::WALKED`].
const CONFIRMED: [f64; 2] = [5.0, 1.5];

/// Progress of a study or a calibration. Work is in multiples of one evaluation of the search.
pub struct Progress {
    bar: Option<ProgressBar>,
    shown: bool,
    printed: Instant,
    /// End of the last part.
    last: Instant,
    /// Work done.
    done: f64,
    /// Estimated work left.
    left: f64,
    /// Work that was computed, not read from the cache, and its duration.
    computed: (f64, Duration),
    /// Total number of evaluations of a study, `None` if it may stop early, and its best designs so far.
    search: Option<(Option<u64>, BestSoFar)>,
}

impl Progress {
    /// Returns the progress of a study; `shown` makes it visible.
    pub fn of_study(study: &Study, shown: bool) -> Self {
        let config = &study.config;
        let (done, budget) = (study.evaluations.len() as u64, config.expected_evaluations());
        let conclusion = &config.conclusion;
        let confirmed = CONFIRMED[0] * cost::REPEATED + CONFIRMED[1] * cost::WALKED;
        let confirmed = if conclusion.no_confirm { 0.0 } else { confirmed };
        let bench =
            conclusion.bench.map_or(0.0, |effort| f64::from(effort.simulations) * cost::SIMULATION);
        let left = budget.saturating_sub(done) as f64 + confirmed + bench;
        let mut progress = Progress::of(left, shown && done < config.evaluations());
        let total = if config.settles { None } else { Some(budget) };
        progress.search = Some((total, BestSoFar::new(study)));
        progress
    }

    /// Returns the progress of work that costs `left` evaluations; `shown` makes it visible.
    pub fn of(left: f64, shown: bool) -> Self {
        let bar = || ProgressBar::new(left.ceil() as u64);
        let bar = (shown && stderr().is_terminal())
            .then(|| styled(bar(), "{bar:12} {msg}, {elapsed} elapsed"));
        let now = Instant::now();
        let computed = (0.0, Duration::ZERO);
        Progress { bar, shown, printed: now, last: now, done: 0.0, left, computed, search: None }
    }

    /// Shows that a part of a phase is done, which cost this many evaluations; `what` is the phase and its object, for
    /// example a design: `confirming 10 %, 26°`.
    pub fn part(&mut self, what: &str, [done, of]: [usize; 2], cost: f64) {
        self.step(cost, &format!("{what}: {done}/{of}"), done == 0 || done == of);
    }

    /// Shows that a design was evaluated.
    pub fn evaluated(&mut self, recorded: &Recorded) {
        let Some((budget, best_so_far)) = &mut self.search else { return };
        best_so_far.add(recorded);
        let (done, budget) = (recorded.index + 1, *budget);
        let of = budget.map_or(String::new(), |budget| format!("/{budget}"));
        let what = format!("{done}{of} evaluations, {}", best_so_far.best());
        self.step(1.0, &what, Some(done) == budget);
    }

    /// Adds a part of this cost and shows the progress; before the first and after the last part of a phase a line is
    /// written in any case.
    fn step(&mut self, cost: f64, what: &str, last: bool) {
        let left = self.time_left(cost, self.last.elapsed());
        self.last = Instant::now();
        // A study that may stop early can take longer than expected; the time left is then unknown.
        let unknown = self.computed.0 < MIN_COMPUTED || left < Duration::from_secs(1);
        let about = |shown: String| match unknown {
            true => what.to_owned(),
            false => format!("{what}, about {shown} left"),
        };
        if let Some(bar) = &self.bar {
            bar.set_message(about(format!("{:#}", HumanDuration(left))));
            bar.set_length((self.done + self.left).ceil() as u64);
            bar.set_position(self.done as u64);
        } else if self.shown && (last || self.printed.elapsed() >= EVERY) {
            self.printed = Instant::now();
            say(&about(format!("{} s", left.as_secs())));
        }
    }

    /// Adds a part of this cost and duration; returns the time left, extrapolated from the parts that were not cached.
    fn time_left(&mut self, cost: f64, took: Duration) -> Duration {
        self.done += cost;
        self.left = (self.left - cost).max(0.0);
        // The beginning of a phase costs nothing, and the time before it is not of the phase.
        if took > CACHED && cost > 0.0 {
            self.computed = (self.computed.0 + cost, self.computed.1 + took);
        }
        self.computed.1.mul_f64(self.left / self.computed.0.max(1.0))
    }

    /// Writes a line on standard error, above a bar.
    pub fn say(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| say(text)),
            None => say(text),
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.iter().for_each(ProgressBar::finish_and_clear);
    }
}

/// Work of unknown length, shown until it is dropped: a spinner on a terminal, a line every few seconds elsewhere.
pub struct Busy {
    spinner: Option<ProgressBar>,
    lines: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Busy {
    /// Begins to show this work.
    pub fn new(what: &'static str) -> Self {
        if stderr().is_terminal() {
            let spinner = ProgressBar::new_spinner().with_message(what);
            let spinner = styled(spinner, "{spinner} {msg}, {elapsed} elapsed");
            return Busy { spinner: Some(spinner), lines: None };
        }
        let (sender, receiver) = channel();
        let begun = Instant::now();
        let lines = std::thread::spawn(move || {
            while receiver.recv_timeout(EVERY) == Err(RecvTimeoutError::Timeout) {
                say(&format!("{what}: {} s", begun.elapsed().as_secs()));
            }
        });
        Busy { spinner: None, lines: Some((sender, lines)) }
    }
}

impl Drop for Busy {
    fn drop(&mut self) {
        self.spinner.iter().for_each(ProgressBar::finish_and_clear);
        if let Some((sender, lines)) = self.lines.take() {
            drop(sender);
            // A panic of this thread is ignored, since it only writes progress.
            let _ = lines.join();
        }
    }
}

/// Sets the template of a bar or spinner, and redraws it twice a second.
fn styled(bar: ProgressBar, template: &str) -> ProgressBar {
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(500));
    bar
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cached_results_do_not_shorten_the_time_left() {
        let mut progress = Progress::of(10.0, false);
        let second = Duration::from_secs(1);
        (0..5).for_each(|_| assert!(progress.time_left(1.0, CACHED / 2).is_zero()));
        assert!(progress.time_left(0.0, second).is_zero(), "before the first part");
        assert_eq!(progress.time_left(1.0, second), 4 * second);
        assert_eq!(progress.time_left(2.0, 4 * second), 2 * second * 5 / 3);
    }
}
