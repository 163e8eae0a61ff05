//! Which design of a study is recommended, how firm that is, and how much it matters.

use super::record::{Recorded, StudyRecord};
use super::rule::Rule;
use insertion::evaluation::objective::Measure;
use insertion::outcome::Outcome;

impl StudyRecord {
    /// The recommended design of a study with one objective: the first by the rule of
    /// `study/rule.rs` of those that were walked, else of all. Where windows do not decide, the
    /// [`best`](Self::best). None of a front is.
    pub fn recommendation(&self) -> Option<&Recorded> {
        self.config.objective.single()?;
        let goals = self.config.goals();
        let rule = Rule { goals: &goals, space: &self.config.space };
        let searched = || match rule.by_windows() {
            true => rule.candidates(self.current(), 1).first().copied(),
            false => None,
        };
        let walked = self.walked.first().map(|walked| &walked.recorded);
        walked.or_else(searched).or_else(|| self.best())
    }

    /// The recommended design, or of a front its first.
    pub fn recommended(&self) -> Option<&Recorded> {
        self.recommendation().or_else(|| self.best())
    }

    /// The designs whose search found as much as that of the evaluation `index`, with it, but for
    /// those whose repeats found less; by evaluation.
    pub fn equivalent(&self, index: u64) -> Vec<&Recorded> {
        let goals = self.config.goals();
        let searched =
            |recorded: &Recorded| Some(goals.gains(recorded.feasible()?).first().copied());
        let own = self.current().iter().find(|recorded| recorded.index == index).and_then(searched);
        let firm = |index| self.firm_values.get(&index);
        let refuted =
            |other: u64| firm(other).zip(firm(index)).is_some_and(|(other, own)| other < own);
        let as_good = |other: &&Recorded| {
            searched(other).zip(own).is_some_and(|(other, own)| other >= own)
                && !refuted(other.index)
                && !other.raced()
        };
        self.current().iter().filter(as_good).collect()
    }

    /// The smallest and the largest range of the evaluations, mm, aggregated over the tasks: how much
    /// the finger matters. `None` if none has a range.
    pub fn spread_mm(&self) -> Option<[f64; 2]> {
        let ranges =
            self.current().iter().filter_map(|recorded| self.measure(recorded, Measure::Range));
        ranges.fold(None, |span, range| {
            let [low, high] = span.unwrap_or([range; 2]);
            Some([range.min(low), range.max(high)])
        })
    }

    /// A measure of a design, aggregated over the tasks.
    pub fn measure(&self, recorded: &Recorded, measure: Measure) -> Option<f64> {
        let values: Option<Vec<f64>> =
            recorded.tasks.iter().map(|task| measure.value(task)).collect();
        values.map(|values| self.aggregated(measure, &values))
    }

    /// Values of a measure on each task, made one.
    pub fn aggregated(&self, measure: Measure, values: &[f64]) -> f64 {
        self.config.goals().aggregate.of(measure.sense(), values)
    }

    /// The task, by its place, on which no design inserts at the nominal start, and the design
    /// that comes nearest to it.
    pub fn unusable(&self) -> Option<(usize, &Recorded)> {
        let inserts = |recorded: &Recorded, task: usize| {
            recorded.on(task).is_some_and(|found| found.window.nominal == Outcome::Inserted)
        };
        let tasks = 0..self.config.tasks.len();
        let task =
            tasks.into_iter().find(|&task| !self.current().iter().any(|r| inserts(r, task)))?;
        let margin =
            |recorded: &Recorded| recorded.on(task).map_or(-1.0, |found| found.end_shares[0]);
        // Of equals the first.
        let nearest = self.current().iter().rev().max_by(|a, b| margin(a).total_cmp(&margin(b)));
        nearest.map(|nearest| (task, nearest))
    }
}
