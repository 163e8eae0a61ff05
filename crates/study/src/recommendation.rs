//! Recommended design of a study, equivalent designs, and aggregated measures.

use super::rule::Rule;
use super::{Recorded, StudyRecord};
use ask_tell::Grid;
use ask_tell::gp::{Confirmed, StoppingCriterion};
use insertion::Measure;

impl StudyRecord {
    /// Returns the recommended design of a study with one objective: the first by the rule (`rule.rs`) among
    /// the walked designs, else among all. If the objective does not depend on windows, it is the
    /// [`best`](Self::best).
    pub fn recommendation(&self) -> Option<&Recorded> {
        self.config.objective.single()?;
        let rule = Rule::of(&self.config);
        let searched =
            || self.config.optimizes_windows().then(|| rule.first(self.current())).flatten();
        let walked = self.walked.first().map(|walked| &walked.recorded);
        walked.or_else(searched).or_else(|| self.best())
    }

    /// Returns the recommended design, or the first design of the Pareto front.
    pub fn recommended(&self) -> Option<&Recorded> {
        self.recommendation().or_else(|| self.best())
    }

    /// Returns the designs that can be recommended, each with its loss in the first objective against the evaluation
    /// `index`, which is among them; none if that cannot be recommended.
    pub fn losses(&self, index: u64) -> Vec<(&Recorded, f64)> {
        let (current, gains) = (self.current(), self.first_gains());
        let own = current.iter().position(|recorded| recorded.index == index);
        let Some(own) = own.and_then(|at| gains[at]) else { return Vec::new() };
        let loss = |(recorded, gain): (_, Option<f64>)| Some((recorded, own - gain?));
        current.iter().zip(gains).filter_map(loss).collect()
    }

    /// Returns whether a design of this loss is equivalent to the one without a loss: it loses at most the indifference
    /// for objectives in mm, nothing for others.
    pub fn is_equivalent(&self, loss: f64) -> bool {
        let in_mm = self.config.objective.first().unit() == "mm";
        let tolerance = if in_mm { self.config.indifference_mm } else { 0.0 };
        // Multiples of 0.1 mm are rounded in binary.
        loss <= tolerance + 1e-9
    }

    /// Returns the gain in the first objective of each of the [`current`](Self::current) designs: its firm
    /// value or the median of the predicted firm value, rounded to the grid of ranges; if no design has a firm
    /// value, that of the search. `None` for designs that cannot be recommended.
    fn first_gains(&self) -> Vec<Option<f64>> {
        let (current, rule) = (self.current(), Rule::of(&self.config));
        let searched = |found: &Recorded| {
            rule.goals.gains(found.feasible().filter(|_| !found.raced())?).first().copied()
        };
        let known = |at: usize| self.firm_values.get(&current[at].index).copied();
        let confirmed = |index| Some(Confirmed { index, value: known(index)?, is_final: true });
        let confirmed: Vec<Confirmed> = (0..current.len()).filter_map(confirmed).collect();
        if confirmed.is_empty() {
            return current.iter().map(searched).collect();
        }
        let (grid, observed) = (Grid::new(rule.space.levels()), rule.observed(current));
        let criterion =
            StoppingCriterion::new(&grid, &observed, &confirmed, self.config.indifference_mm);
        let expected = |at: usize| {
            searched(&current[at])?;
            known(at).or_else(|| criterion.median(at)).map(|mm| (10.0 * mm).round() / 10.0)
        };
        (0..current.len()).map(expected).collect()
    }

    /// Returns the smallest and the largest range, mm, aggregated over the tasks, of the designs that insert at every
    /// nominal start; `None` if there are none. Others have a range of 0, which says nothing about their window.
    pub fn spread_mm(&self) -> Option<[f64; 2]> {
        let inserting = || self.current().iter().filter(|recorded| recorded.inserts_on_all());
        let ranges = || inserting().filter_map(|recorded| self.measure(recorded, Measure::Range));
        Some([ranges().reduce(f64::min)?, ranges().reduce(f64::max)?])
    }

    /// Returns a measure of a design, aggregated over the tasks.
    pub fn measure(&self, recorded: &Recorded, measure: Measure) -> Option<f64> {
        self.config.goals().value(measure, &recorded.tasks())
    }

    /// Returns the index of the first task on which no design inserts at the nominal start, and the design
    /// that is nearest to an insertion.
    pub fn unusable(&self) -> Option<(usize, &Recorded)> {
        let mut tasks = 0..self.config.tasks.len();
        let task = tasks.find(|&task| !self.current().iter().any(|r| r.inserts_on(task)))?;
        let margin =
            |recorded: &Recorded| recorded.on(task).map_or(-1.0, |found| found.end_shares[0]);
        // The first in a tie.
        let nearest = self.current().iter().rev().max_by(|a, b| margin(a).total_cmp(&margin(b)));
        nearest.map(|nearest| (task, nearest))
    }
}
