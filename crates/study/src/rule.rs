//! The rule by which one design is recommended before another.
//!
//! 1. The larger value of the objective: of the firm window where that was measured, else of
//!    the window that the search found.
//! 2. Of equals the better centred one: the larger smaller side of that window.
//! 3. Then the smaller contact force; forces that round to the same newton are equal.
//! 4. Then the one nearer to, or inside, the hull of the measured designs.
//! 5. Then the one farther from the edge of the space, the least distance over all parameters
//!    counting, as a share of each one's span.
//! 6. Then the earlier one.

use super::record::Recorded;
use ask_tell::Observation;
use insertion::evaluation::objective::{Goals, Measure};
use insertion::evaluation::{Evaluation, Window};
use insertion::space::{Design, Space};
use std::cmp::Ordering;

/// Goals of a study, and the space of its designs.
pub(super) struct Rule<'a> {
    pub goals: &'a Goals,
    pub space: &'a Space,
}

/// Criteria by which a design is compared.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Standing {
    /// Values of the objectives; `None` if it breaks a constraint or has none.
    values: Option<Vec<f64>>,
    /// Twice the smaller side of the window, mm.
    centred_mm: f64,
    /// N, rounded.
    force_n: f64,
    hull_distance: f64,
    edge_distance: f64,
    index: u64,
}

impl Rule<'_> {
    /// Whether windows decide, so that they are worth measuring again.
    pub fn by_windows(&self) -> bool {
        matches!(self.goals.objectives.single(), Some(Measure::Range | Measure::CentredRange))
    }

    /// How a design stands with these windows, one for each task, in place of its own.
    pub fn standing(&self, recorded: &Recorded, windows: &[Window]) -> Standing {
        let in_window = |(task, window): (&Evaluation, &Window)| Evaluation {
            window: window.clone(),
            ..task.clone()
        };
        let tasks: Vec<Evaluation> = recorded.tasks.iter().zip(windows).map(in_window).collect();
        let tasks: Vec<&Evaluation> = tasks.iter().collect();
        let of = |measure: Measure| {
            let values: Option<Vec<f64>> = tasks.iter().map(|task| measure.value(task)).collect();
            values.map(|values| self.goals.aggregate.of(measure.sense(), &values))
        };
        let feasible = recorded.feasible().and_then(|_| self.goals.score(&tasks));
        Standing {
            values: feasible.map(|score| score.values),
            centred_mm: of(Measure::CentredRange).unwrap_or(0.0),
            force_n: of(Measure::PeakForce).unwrap_or(f64::INFINITY).round(),
            hull_distance: recorded.stiffness.hull_distance,
            edge_distance: self.edge_distance(&recorded.design),
            index: recorded.index,
        }
    }

    /// How a design stands with the windows that it was recorded with.
    pub fn as_recorded(&self, recorded: &Recorded) -> Standing {
        let windows: Vec<Window> = recorded.tasks.iter().map(|task| task.window.clone()).collect();
        self.standing(recorded, &windows)
    }

    /// Returns the evaluations by the first objective; designs that cannot be recommended have no value.
    pub fn observed(&self, found: &[Recorded]) -> Vec<Observation> {
        let of = |recorded: &Recorded| {
            let value = self.as_recorded(recorded).value();
            Observation::new(self.space.point(&recorded.design), value)
        };
        found.iter().map(of).collect()
    }

    /// Less if `a` is recommended before `b`.
    pub fn order(&self, a: &Standing, b: &Standing) -> Ordering {
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

    /// Distance from the nearest bound of a parameter, as a share of its span; 0 to 0.5. A
    /// parameter of one value has no bounds to be near to.
    fn edge_distance(&self, design: &Design) -> f64 {
        let of = |parameter: &insertion::space::Variable| {
            let (value, span) = (design.get(&parameter.key)?, parameter.high - parameter.low);
            (span > 0.0).then(|| (value - parameter.low).min(parameter.high - value) / span)
        };
        self.space.parameters.iter().filter_map(of).fold(0.5, f64::min)
    }
}

impl Standing {
    /// The value of the first objective; `None` if the design cannot be recommended.
    pub fn value(&self) -> Option<f64> {
        self.values.as_ref()?.first().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plausible::tests::sound;
    use input::shipped::SPACES;
    use insertion::evaluation::objective::Constraint;
    use insertion::surrogate::Prediction;

    /// A design with a window, mm, and a force, N.
    fn recorded(index: u64, density: f64, window: [i32; 2], force_n: f64) -> Recorded {
        let mut task = sound();
        (task.window.negative_steps, task.window.positive_steps) = (window[0], window[1]);
        task.peak_force_n = force_n;
        Recorded {
            index,
            proposal: None,
            design: Design::infill(density, 20.0),
            score: goals().score(&[&task]),
            stiffness: Prediction::exact(3e3, 2e4),
            tasks: vec![task],
            timing: Default::default(),
            refused: None,
        }
    }

    fn goals() -> Goals {
        let force: Constraint = "peak-force<=200".parse().unwrap();
        Goals { constraints: vec![force], ..Goals::of(Measure::Range) }
    }

    /// The indices in the order of the rule.
    fn ranked(designs: &[Recorded]) -> Vec<u64> {
        let space = Space::parse(SPACES[0].text, SPACES[0].file).unwrap();
        let goals = goals();
        let rule = Rule { goals: &goals, space: &space };
        let mut standings: Vec<Standing> =
            designs.iter().map(|design| rule.as_recorded(design)).collect();
        standings.sort_by(|a, b| rule.order(a, b));
        standings.iter().map(|standing| standing.index).collect()
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
    fn a_constraint_is_asked_of_the_window_found_not_of_its_firm_part() {
        let space = Space::parse(SPACES[0].text, SPACES[0].file).unwrap();
        let goals =
            Goals { constraints: vec!["range>=3".parse().unwrap()], ..Goals::of(Measure::Range) };
        let rule = Rule { goals: &goals, space: &space };
        let mut wide = recorded(0, 20.0, [-20, 20], 50.0);
        wide.score = goals.score(&wide.tasks());
        let firm = Window { negative_steps: -5, ..wide.tasks[0].window.clone() };
        assert_eq!(rule.standing(&wide, &[firm]).value(), Some(2.5));
    }
}
