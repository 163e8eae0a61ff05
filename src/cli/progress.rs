//! Progress of a study on standard error: a bar on a terminal, lines elsewhere.

use super::say;
use crate::study::{Recorded, Study};
use ask_tell::pareto::Archive;
use indicatif::{ProgressBar, ProgressStyle};
use insertion::evaluation::objective::Goals;
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
    goals: Goals,
    /// Front of the designs that keep all constraints, larger is better.
    front: Archive,
}

impl Progress {
    /// Begins; nothing is shown if `quiet`.
    pub fn new(study: &Study, quiet: bool) -> Self {
        let done = study.evaluations.len() as u64;
        let budget = study.config.evaluations();
        let shown = !quiet && done < budget;
        let bar = (shown && stderr().is_terminal()).then(|| bar(done, budget));
        let mut progress = Progress {
            line_every: (shown && bar.is_none()).then_some(study.config.batch),
            bar,
            begun: Instant::now(),
            done_before: done,
            budget,
            goals: study.config.goals(),
            front: Archive::default(),
        };
        study.evaluations.iter().for_each(|recorded| progress.add(recorded));
        progress
    }

    fn add(&mut self, recorded: &Recorded) {
        if let Some(values) = recorded.feasible() {
            self.front.add(self.goals.gains(values));
        }
    }

    /// The best value, or how many designs there are on the front.
    pub fn best(&self) -> String {
        match (self.goals.objectives.single(), self.front.points()) {
            (_, []) if self.goals.constraints.is_empty() => "no value yet".to_owned(),
            (_, []) => "nothing keeps the constraints yet".to_owned(),
            // The sign that makes gains of values makes values of gains.
            (Some(measure), [gains, ..]) => {
                let values = self.goals.gains(gains);
                format!("best {}", values.first().map_or(String::new(), |&v| measure.show(v)))
            }
            (None, front) => format!("front of {}", front.len()),
        }
    }

    /// One more evaluation is written down.
    pub fn measured(&mut self, recorded: &Recorded) {
        self.add(recorded);
        let best = self.best();
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
    let style = "{bar:20} {pos}/{len}  {msg}  {elapsed} gone";
    if let Ok(style) = ProgressStyle::with_template(style) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(500));
    bar
}
