//! Order in which designs are recommended, by
//!
//! 1. the larger value of the objective: of the firm window if it was determined, else of the window found by
//!    the search;
//! 2. the better centred window: the one whose smaller side is larger;
//! 3. the smaller contact force, rounded to a newton;
//! 4. the smaller distance from the hull of the measured designs;
//! 5. the larger distance from the edge of the space: the smallest over all parameters, as a share of the
//!    span of each;
//! 6. the earlier evaluation.

use super::{Recorded, StudyConfig};
use ask_tell::Observation;
use insertion::{Design, Evaluation, Goals, Measure, Space, Variable};
use std::cmp::Ordering;

/// Recommendation rule of a study.
pub(super) struct Rule<'a> {
    pub goals: Goals,
    pub space: &'a Space,
}

/// Values of a design for the criteria of the rule, in their order.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rank {
    /// Values of the objectives; `None` if a constraint is violated or there are none.
    values: Option<Vec<f64>>,
    /// Twice the smaller side of the window, mm.
    centred_mm: f64,
    /// Largest contact force, N, rounded.
    force_n: f64,
    /// Distance from the hull of the measured designs, in units of the measured spans; 0 inside.
    hull_distance: f64,
    /// Distance from the edge of the space, as a share of the span, 0 to 0.5.
    edge_distance: f64,
    index: u64,
}

impl<'a> Rule<'a> {
    /// Returns the rule for a study of this configuration.
    pub fn of(config: &'a StudyConfig) -> Self {
        Rule { goals: config.goals(), space: &config.space }
    }

    /// Returns the rank of a design with its evaluation on each task, whose windows may differ from the recorded ones.
    pub fn rank(&self, recorded: &Recorded, tasks: &[&Evaluation]) -> Rank {
        let of = |measure| self.goals.value(measure, tasks);
        let feasible = recorded.feasible().and_then(|_| self.goals.score(tasks));
        Rank {
            values: feasible.map(|score| score.values),
            centred_mm: of(Measure::CentredRange).unwrap_or(0.0),
            force_n: of(Measure::PeakForce).unwrap_or(f64::INFINITY).round(),
            hull_distance: recorded.stiffness.hull_distance,
            edge_distance: self.edge_distance(&recorded.design),
            index: recorded.index,
        }
    }

    /// Returns the rank of a design with its recorded windows.
    pub fn recorded_rank(&self, recorded: &Recorded) -> Rank {
        self.rank(recorded, &recorded.tasks())
    }

    /// Returns an observation of the first objective for each design; designs that cannot be recommended have no value.
    pub fn observed(&self, found: &[Recorded]) -> Vec<Observation> {
        let of = |recorded: &Recorded| {
            let value = self.recorded_rank(recorded).value();
            Observation::new(self.space.point(&recorded.design), value)
        };
        found.iter().map(of).collect()
    }

    /// Compares two ranks; less if `a` is recommended before `b`.
    pub fn order(&self, a: &Rank, b: &Rank) -> Ordering {
        let values = match (&a.values, &b.values) {
            (Some(a), Some(b)) => self.goals.order(b, a),
            (a, b) => b.is_some().cmp(&a.is_some()),
        };
        values
            .then(b.centred_mm.total_cmp(&a.centred_mm))
            .then(a.force_n.total_cmp(&b.force_n))
            .then(a.hull_distance.total_cmp(&b.hull_distance))
            .then(b.edge_distance.total_cmp(&a.edge_distance))
            .then(a.index.cmp(&b.index))
    }

    /// Returns the distance from the nearest bound of any parameter, as a share of its span, 0 to 0.5.
    /// Parameters with one value are ignored.
    fn edge_distance(&self, design: &Design) -> f64 {
        let of = |parameter: &Variable| {
            let (value, span) = (design.get(&parameter.key)?, parameter.high - parameter.low);
            (span > 0.0).then(|| (value - parameter.low).min(parameter.high - value) / span)
        };
        self.space.parameters.iter().filter_map(of).fold(0.5, f64::min)
    }
}

impl Rank {
    /// Returns the value of the first objective; `None` if the design cannot be recommended.
    pub fn value(&self) -> Option<f64> {
        self.values.as_ref()?.first().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cache::tests::sound;
    use input::shipped::SPACES;
    use insertion::evaluation::objective::{Aggregate, Objectives};
    use insertion::surrogate::Prediction;

    /// Returns a design with a window, mm, and a force, N.
    fn recorded(index: u64, density: f64, window: [i32; 2], force_n: f64) -> Recorded {
        let mut task = sound();
        (task.window.negative_steps, task.window.positive_steps) = (window[0], window[1]);
        task.peak_force_n = force_n;
        Recorded {
            index,
            proposal: None,
            design: Design::infill(density, 20.0),
            score: goals("peak-force<=200").score(&[&task]),
            stiffness: Prediction::exact(3e3, 2e4),
            tasks: vec![task],
            timing: Default::default(),
        }
    }

    fn goals(constraint: &str) -> Goals {
        let constraints = vec![constraint.parse().unwrap()];
        let objectives = Objectives::of(Measure::Range);
        Goals { objectives, constraints, aggregate: Aggregate::Min }
    }

    /// Returns the indices in the order of the rule.
    fn ranked(designs: &[Recorded]) -> Vec<u64> {
        let space = Space::parse(SPACES[0].text, SPACES[0].file).unwrap();
        let rule = Rule { goals: goals("peak-force<=200"), space: &space };
        let mut ranks: Vec<Rank> = designs.iter().map(|found| rule.recorded_rank(found)).collect();
        ranks.sort_by(|a, b| rule.order(a, b));
        ranks.iter().map(|rank| rank.index).collect()
    }

    #[test]
    fn each_line_of_the_rule_decides_where_those_before_it_tie() {
        let [low, high] = [-20, 20];
        let mut outside = recorded(5, 20.0, [low, high], 100.2);
        outside.stiffness.hull_distance = 0.1;
        let designs = [
            recorded(0, 20.0, [low, high], 201.0), // breaks the constraint
            recorded(1, 20.0, [-10, 29], 50.0),    // 3.9 mm
            recorded(2, 20.0, [-19, 21], 50.0),    // 4.0 mm, less centred
            recorded(3, 20.0, [low, high], 101.0), // a newton more
            outside,
            recorded(6, 10.0, [low, high], 100.4), // at the edge of the space
            recorded(7, 19.0, [low, high], 99.6),  // inside it
            recorded(8, 19.0, [low, high], 100.0), // the same, later
        ];
        assert_eq!(ranked(&designs), [7, 8, 6, 5, 3, 2, 1, 0]);
        let mut reversed = designs.to_vec();
        reversed.reverse();
        assert_eq!(ranked(&reversed), ranked(&designs));
    }

    #[test]
    fn constraints_apply_to_the_searched_window_not_to_its_firm_part() {
        let space = Space::parse(SPACES[0].text, SPACES[0].file).unwrap();
        let rule = Rule { goals: goals("range>=3"), space: &space };
        let mut wide = recorded(0, 20.0, [-20, 20], 50.0);
        wide.score = rule.goals.score(&wide.tasks());
        let mut firm = wide.tasks[0].clone();
        firm.window.negative_steps = -5;
        assert_eq!(rule.rank(&wide, &[&firm]).value(), Some(2.5));
    }
}
