//! Progress of a study on standard error: a bar on a terminal, lines elsewhere.

use super::terminal::{say, simulating};
use crate::session::{Event, Standing};
use crate::study::{Recorded, Study};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

/// Shows how far a study is.
pub struct Progress {
    bar: Option<ProgressBar>,
    /// Where there is no terminal: a line each time this many are done.
    line_every: Option<u64>,
    begun: Instant,
    done_before: u64,
    budget: u64,
    standing: Standing,
    /// Whether nothing is said of what follows the search.
    quiet_after: bool,
}

impl Progress {
    /// Begins; nothing is shown if `quiet`, and no more than that if JSON is printed.
    pub fn new(study: &Study, quiet: bool, json: bool) -> Self {
        let done = study.evaluations.len() as u64;
        let budget = study.config.evaluations();
        let shown = !quiet && done < budget;
        let bar = (shown && stderr().is_terminal()).then(|| bar(done, budget));
        Progress {
            line_every: (shown && bar.is_none()).then_some(study.config.batch),
            bar,
            begun: Instant::now(),
            done_before: done,
            budget,
            standing: Standing::new(study),
            quiet_after: quiet || json,
        }
    }

    pub fn see(&mut self, event: Event<'_>) {
        match event {
            Event::Measured(recorded) => self.measured(recorded),
            Event::Searched { not_kept } => {
                self.bar.iter().for_each(ProgressBar::finish_and_clear);
                if let Some(problem) = not_kept {
                    say(&format!("warning: evaluations are not kept for other studies: {problem}"));
                }
            }
            Event::Simulating { .. } => simulating(self.quiet_after)(event),
        }
    }

    fn measured(&mut self, recorded: &Recorded) {
        self.standing.add(recorded);
        let best = self.standing.best();
        let done = recorded.index + 1;
        if let Some(bar) = &self.bar {
            let left = indicatif::HumanDuration(self.remaining(done));
            bar.set_message(format!("{best}, about {left:#} left"));
            bar.inc(1);
        } else if let Some(every) = self.line_every
            && (done.is_multiple_of(every) || done == self.budget)
        {
            let left = self.remaining(done).as_secs();
            say(&format!("{done}/{} evaluations, {best}, about {left} s left", self.budget));
        }
    }

    fn remaining(&self, done: u64) -> Duration {
        let here = done.saturating_sub(self.done_before).max(1);
        self.begun.elapsed().mul_f64(self.budget.saturating_sub(done) as f64 / here as f64)
    }
}

fn bar(done: u64, budget: u64) -> ProgressBar {
    let bar = ProgressBar::new(budget).with_position(done);
    let style = "{bar:20} {pos}/{len}  {msg}  {elapsed} gone";
    if let Ok(style) = ProgressStyle::with_template(style) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(500));
    bar
}
