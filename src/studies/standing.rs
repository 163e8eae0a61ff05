//! The best of a study so far.

use ask_tell::pareto::Archive;
use insertion::evaluation::objective::Goals;
use study::{Recorded, Study};

/// The front of the designs that keep all constraints.
pub struct Standing {
    goals: Goals,
    /// Gains: larger is better.
    front: Archive,
}

impl Standing {
    /// Of what a study has measured.
    pub fn new(study: &Study) -> Self {
        let mut standing = Standing { goals: study.config.goals(), front: Archive::default() };
        study.evaluations.iter().for_each(|recorded| standing.add(recorded));
        standing
    }

    /// With one more design.
    pub fn add(&mut self, recorded: &Recorded) {
        if let Some(values) = recorded.feasible().filter(|_| !recorded.raced()) {
            self.front.add(self.goals.gains(values));
        }
    }

    /// The best value, or how many designs there are on the front, in words.
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
}
