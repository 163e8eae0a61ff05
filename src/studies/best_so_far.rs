//! Best designs of a study so far, for its progress.

use ask_tell::pareto::Archive;
use insertion::Goals;
use study::{Recorded, Study};

/// Pareto front of the feasible designs so far; with a single objective, its best design.
pub struct BestSoFar {
    goals: Goals,
    /// Objective values with their sign chosen so that larger is better.
    front: Archive,
}

impl BestSoFar {
    /// Returns the front of a study.
    pub fn new(study: &Study) -> Self {
        let mut best_so_far = BestSoFar { goals: study.config.goals(), front: Archive::default() };
        study.evaluations.iter().for_each(|recorded| best_so_far.add(recorded));
        best_so_far
    }

    /// Adds a design, unless it is infeasible or its success rate is only an upper bound (see [`Recorded::raced`]).
    pub fn add(&mut self, recorded: &Recorded) {
        if let Some(values) = recorded.feasible().filter(|_| !recorded.raced()) {
            self.front.add(self.goals.gains(values));
        }
    }

    /// Returns the best value, or the size of the front, as text.
    pub fn best(&self) -> String {
        match (self.goals.objectives.single(), self.front.points()) {
            (_, []) if self.goals.constraints.is_empty() => "no value yet".to_owned(),
            (_, []) => "no feasible design yet".to_owned(),
            // `gains` only changes signs; applied again, it returns the values.
            (Some(measure), [gains, ..]) => {
                let values = self.goals.gains(gains);
                format!("best {}", values.first().map_or(String::new(), |&v| measure.show(v)))
            }
            (None, front) => format!("front of {}", front.len()),
        }
    }
}
