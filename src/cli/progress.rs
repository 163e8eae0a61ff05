//! Progress of a study on standard error: a bar on a terminal, lines elsewhere.

use finger_opt::study::{Recorded, Study};
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
    best: Option<f64>,
}

impl Progress {
    /// Begins; nothing is shown if `quiet`.
    pub fn new(study: &Study, quiet: bool) -> Self {
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
            best: finger_opt::study::best(&study.evaluations).and_then(|best| best.value),
        }
    }

    /// One more evaluation is written down.
    pub fn measured(&mut self, recorded: &Recorded) {
        self.best = [self.best, recorded.value].into_iter().flatten().reduce(f64::max);
        let best = self.best.map_or("no value yet".to_owned(), |best| format!("best {best:.1} mm"));
        let done = recorded.index + 1;
        if let Some(bar) = &self.bar {
            bar.set_message(best);
            bar.inc(1);
        } else if let Some(every) = self.line_every
            && (done.is_multiple_of(every) || done == self.budget)
        {
            let left = self.remaining(done).as_secs();
            eprintln!("{done}/{} evaluations, {best}, about {left} s left", self.budget);
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    fn remaining(&self, done: u64) -> Duration {
        let here = done.saturating_sub(self.done_before).max(1);
        self.begun.elapsed().mul_f64(self.budget.saturating_sub(done) as f64 / here as f64)
    }
}

fn bar(done: u64, budget: u64) -> ProgressBar {
    let bar = ProgressBar::new(budget).with_position(done);
    let style = "{bar:30} {pos}/{len}  {msg}  {elapsed} gone, {eta} left";
    if let Ok(style) = ProgressStyle::with_template(style) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(500));
    // What an earlier run measured says nothing of this one's speed.
    bar.reset_eta();
    bar
}
