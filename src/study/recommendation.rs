//! Which design of a study is recommended, how firm that is, and how much it matters.

use super::record::{Recorded, StudyRecord};
use super::rule::Rule;
use super::walk::GAIN;
use ask_tell::Grid;
use ask_tell::gp::{Confirmed, Outlook};
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
    /// those of which the repeats found less, or would be expected to; by evaluation.
    pub fn equivalent(&self, index: u64) -> Vec<&Recorded> {
        let goals = self.config.goals();
        let searched = |recorded: &Recorded| goals.gains(recorded.feasible()?).first().copied();
        let current = self.current();
        let Some(own) = current.iter().position(|recorded| recorded.index == index) else {
            return Vec::new();
        };
        let (expected, least) = (self.expected(), searched(&current[own]));
        let as_good = |&at: &usize| {
            let found = searched(&current[at]).zip(least).is_some_and(|(found, own)| found >= own);
            found && expected[at] >= expected[own] && !current[at].raced()
        };
        (0..current.len()).filter(as_good).map(|at| &current[at]).collect()
    }

    /// The firm value that each of the [`current`](Self::current) designs has or may be expected to
    /// have, rounded to the grid of ranges; 0 where none was repeated.
    fn expected(&self) -> Vec<f64> {
        let current = self.current();
        let known = |at: usize| self.firm_values.get(&current[at].index).copied();
        let confirmed = |at| Some(Confirmed { at, value: known(at)?, last: true });
        let confirmed: Vec<Confirmed> = (0..current.len()).filter_map(confirmed).collect();
        if confirmed.is_empty() {
            return vec![0.0; current.len()];
        }
        let (goals, space) = (self.config.goals(), &self.config.space);
        let rule = Rule { goals: &goals, space };
        let observed = rule.observed(current);
        let grid = Grid::new(space.levels());
        let outlook = Outlook::new(&grid, &observed, &confirmed, GAIN);
        let expected = |at| known(at).or_else(|| outlook.median(at)).unwrap_or(0.0);
        (0..current.len()).map(|at| (10.0 * expected(at)).round() / 10.0).collect()
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
