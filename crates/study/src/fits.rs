//! Whether what was read can be of this study: a line may be whole and yet make no sense, if it
//! was written by hand.

use super::config::StudyConfig;
use super::error::LineError;
use super::plausible::{LARGEST, NOTHING, implausible, off_the_space};
use super::record::{Recorded, Refused, Timing};
use insertion::evaluation::objective::{Goals, Score};
use insertion::surrogate::Prediction;

/// Largest violation: a share of a limit, which may be small.
const LARGEST_VIOLATION: f64 = 1e30;

/// Fault of an evaluation, if it cannot be of this study.
pub fn fits(recorded: &Recorded, config: &StudyConfig) -> Result<(), LineError> {
    let wrong = |what: String| Err(LineError::Format(what));
    if let Some(problem) = off_the_space(&recorded.design, &config.space) {
        return wrong(problem);
    }
    if recorded.tasks.len() != config.tasks.len() {
        let (found, all) = (recorded.tasks.len(), config.tasks.len());
        return wrong(format!("it has {found} tasks, the study {all}"));
    }
    if let Some(score) = &recorded.score {
        let counts = [score.values.len(), score.violations.len()];
        let expected = [config.objective.measures().len(), config.constraints.len()];
        if counts != expected {
            return wrong(format!(
                "it has {} values and {} constraints, the study {} and {}",
                counts[0], counts[1], expected[0], expected[1]
            ));
        }
    }
    Ok(())
}

/// Report to the optimizer on an evaluation: values and violations, if it has any.
pub fn told(recorded: &Recorded, goals: &Goals) -> Option<[Vec<f64>; 2]> {
    let score = recorded.score.as_ref()?;
    Some([goals.told(&recorded.tasks())?, score.violations.clone()])
}

/// An evaluation that cannot be one counts as diverged from now on: it costs itself, and not those
/// after it. What the optimizer was told of it is kept, so that what it proposed next repeats.
pub fn refuse_doubtful(recorded: &mut Recorded, goals: &Goals) {
    let doubtful = recorded.tasks.iter().find_map(implausible);
    let problem = match &recorded.score {
        Some(score) if !sound(score) => Some("a value is not a number, or far too large"),
        _ if !known(&recorded.stiffness) => Some("its stiffness is not a finite number"),
        _ => doubtful.or_else(|| recorded.timing.implausible()),
    };
    if let Some(problem) = problem {
        recorded.refused = Some(Refused { problem, told: told(recorded, goals) });
        recorded.tasks.fill(NOTHING);
        recorded.score = None;
        recorded.timing = Timing::default();
        if !known(&recorded.stiffness) {
            recorded.stiffness = Prediction::exact(1.0, 1.0);
        }
    }
}

/// Whether all values are numbers of a size that plots and sums can take.
pub fn sound(score: &Score) -> bool {
    score.values.iter().all(|value| value.abs() <= LARGEST)
        && score.violations.iter().all(|share| share.abs() <= LARGEST_VIOLATION)
}

/// Whether a stiffness is one: finite, and its error not negative.
fn known(stiffness: &Prediction) -> bool {
    let each = [stiffness.compliance, stiffness.assembly];
    let sound = |number: f64| (0.0..=LARGEST).contains(&number);
    each.iter().all(|k| sound(k.mean) && sound(k.sd)) && sound(stiffness.hull_distance)
}
