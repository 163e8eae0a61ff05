//! Which design of a study is recommended, how firm that is, and how much it matters.

use super::record::{Recorded, StudyRecord};
use super::rule::Rule;
use super::walk::gain;
use ask_tell::Grid;
use ask_tell::gp::{Confirmed, Outlook};
use insertion::evaluation::objective::Measure;

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

    /// The designs as good as the evaluation `index`, with it, by evaluation, and how much of the
    /// first objective each loses against it: of a range at most the indifference, of what is not in
    /// mm nothing.
    pub fn as_good(&self, index: u64) -> Vec<(&Recorded, f64)> {
        let (current, worth) = (self.current(), self.worth());
        let own = current.iter().position(|recorded| recorded.index == index);
        let Some(own) = own.and_then(|at| worth[at]) else { return Vec::new() };
        let tolerance = if self.config.objective.first().unit() == "mm" {
            self.config.indifference_mm
        } else {
            0.0
        };
        let loss = |(recorded, worth): (_, Option<f64>)| Some((recorded, own - worth?));
        // Tenths of a millimetre are no whole numbers.
        let as_good = |(_, loss): &(&Recorded, f64)| *loss <= tolerance + 1e-9;
        current.iter().zip(worth).filter_map(loss).filter(as_good).collect()
    }

    /// Gain in the first objective of each of the [`current`](Self::current) designs: the firm value
    /// that it has or, in the median, will have, rounded to the grid of ranges; the searched one where
    /// none was repeated. `None` of designs that cannot be recommended.
    fn worth(&self) -> Vec<Option<f64>> {
        let (current, goals) = (self.current(), self.config.goals());
        let searched = |found: &Recorded| {
            let values = found.feasible().filter(|_| !found.raced())?;
            goals.gains(values).first().copied()
        };
        let known = |at: usize| self.firm_values.get(&current[at].index).copied();
        let confirmed = |at| Some(Confirmed { at, value: known(at)?, last: true });
        let confirmed: Vec<Confirmed> = (0..current.len()).filter_map(confirmed).collect();
        if confirmed.is_empty() {
            return current.iter().map(searched).collect();
        }
        let space = &self.config.space;
        let observed = Rule { goals: &goals, space }.observed(current);
        let grid = Grid::new(space.levels());
        let outlook = Outlook::new(&grid, &observed, &confirmed, gain(&self.config));
        let expected = |at: usize| {
            searched(&current[at])?;
            known(at).or_else(|| outlook.median(at)).map(|mm| (10.0 * mm).round() / 10.0)
        };
        (0..current.len()).map(expected).collect()
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
        let mut tasks = 0..self.config.tasks.len();
        let task = tasks.find(|&task| !self.current().iter().any(|r| r.inserts_on(task)))?;
        let margin =
            |recorded: &Recorded| recorded.on(task).map_or(-1.0, |found| found.end_shares[0]);
        // Of equals the first.
        let nearest = self.current().iter().rev().max_by(|a, b| margin(a).total_cmp(&margin(b)));
        nearest.map(|nearest| (task, nearest))
    }
}
