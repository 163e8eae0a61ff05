//! Time of the same trial in both engines.

use crate::compare::{Subject, TaskWays, subject_json};
use insertion::outcome::Outcome;
use insertion::stiffness::Measurement;
use serde_json::{Value, json};
use std::time::Instant;

/// Runs of each trial, of which the median counts.
const RUNS: usize = 5;

/// Times of a finger's nominal trial, from the grasp to the end, in both engines.
#[derive(Debug, Clone, PartialEq)]
pub struct Timing {
    pub subject: Subject,
    pub outcomes: [Outcome; 2],
    pub simulated_s: [f64; 2],
    /// Wall time, s: median of 5.
    pub wall_s: [f64; 2],
}

impl Timing {
    /// Wall time per simulated time of the first engine over that of the second.
    pub fn ratio(&self) -> f64 {
        let [first, second] = [0, 1].map(|i| self.wall_s[i] / self.simulated_s[i]);
        first / second
    }
}

/// Times of every design on every task in the first two ways, one after the other on this thread.
pub fn time(tasks: &[TaskWays], designs: &[Measurement]) -> Vec<Timing> {
    let timing = |on: &TaskWays, design: &Measurement| {
        let subject = Subject::new(&on.task.name, &on.task.finger, *design);
        let mut walls = [Vec::new(), Vec::new()];
        let mut ends = [(Outcome::Diverged, 0.0); 2];
        for _ in 0..RUNS {
            for (i, way) in on.ways.iter().take(2).enumerate() {
                let clock = Instant::now();
                let trial = way.rig.grasp(&subject.finger).trial(0.0);
                walls[i].push(clock.elapsed().as_secs_f64());
                ends[i] = (trial.outcome, trial.simulated_s);
            }
        }
        let median = |mut walls: Vec<f64>| {
            walls.sort_by(f64::total_cmp);
            walls[RUNS / 2]
        };
        Timing {
            subject,
            outcomes: ends.map(|end| end.0),
            simulated_s: ends.map(|end| end.1),
            wall_s: walls.map(median),
        }
    };
    tasks.iter().flat_map(|task| designs.iter().map(move |design| timing(task, design))).collect()
}

pub fn time_text(rows: &[Timing], [first, second]: [&str; 2]) -> String {
    let unit = "wall s (simulated)";
    let mut text = format!(
        "one nominal trial from the grasp to the end, one thread, medians of {RUNS}\n\n\
         task   finger       {first:>20}{second:>20}   ratio\n{:20}{unit:>20}{unit:>20}{:8}\n",
        "", ""
    );
    for row in rows {
        let [a, b] = [0, 1].map(|i| format!("{:.3} ({:.2})", row.wall_s[i], row.simulated_s[i]));
        let same = (row.outcomes[0] == Outcome::Inserted) == (row.outcomes[1] == Outcome::Inserted);
        text += &format!(
            "{:<7}{:<13}{a:>20}{b:>20}{:>8.3}{}\n",
            row.subject.task,
            row.subject.infill(),
            row.ratio(),
            if same { "" } else { "  another outcome" }
        );
    }
    text + &format!("mean ratio of wall to simulated time: {:.3}\n", mean_ratio(rows))
}

pub fn time_json(rows: &[Timing], names: [&str; 2]) -> Value {
    json!({
        "engines": names,
        "runs": RUNS,
        "mean_ratio": mean_ratio(rows),
        "trials": rows.iter().map(|row| {
            let measured = json!({
                "finger": row.subject.infill(),
                "simulated_s": row.simulated_s,
                "wall_s": row.wall_s,
                "ratio": row.ratio(),
            });
            subject_json(&row.subject.task, &row.subject.design, measured)
        }).collect::<Vec<_>>(),
    })
}

fn mean_ratio(rows: &[Timing]) -> f64 {
    rows.iter().map(Timing::ratio).sum::<f64>() / rows.len() as f64
}
