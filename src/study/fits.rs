//! Whether what was read can be of this study: a line may be whole and yet make no sense, if it
//! was written by hand.

use super::config::StudyConfig;
use super::error::LineError;
use super::record::Recorded;
use insertion::evaluation::Evaluation;
use insertion::evaluation::objective::Score;
use insertion::space::{Design, Space};
use insertion::surrogate::Prediction;

/// Farthest end of a window, grid steps: 100 mm, ten times what is looked at.
const FARTHEST_STEPS: u32 = 1000;
/// Largest size of a value in any unit.
const LARGEST: f64 = 1e15;
/// Largest violation: a share of a limit, which may be small.
const LARGEST_VIOLATION: f64 = 1e30;
/// Most trials of one kind in an evaluation.
const MOST_TRIALS: u32 = 10_000_000;

/// What is wrong with an evaluation, if it cannot be of this study.
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
        if !sound(score) {
            return wrong("a value is no number, or far too large".to_owned());
        }
    }
    if !known(&recorded.stiffness) {
        return wrong("its stiffness is no finite number".to_owned());
    }
    match recorded.tasks.iter().all(plausible) {
        true => Ok(()),
        false => wrong("its numbers cannot be those of an evaluation".to_owned()),
    }
}

/// Whether all values are numbers of a size that plots and sums can take.
pub fn sound(score: &Score) -> bool {
    score.values.iter().all(|value| value.abs() <= LARGEST)
        && score.violations.iter().all(|share| share.abs() <= LARGEST_VIOLATION)
}

pub(super) fn off_the_space(design: &Design, space: &Space) -> Option<String> {
    if design.0.len() != space.parameters.len() {
        return Some(format!("{design} has not the parameters of the space"));
    }
    let off = space.parameters.iter().find(|parameter| {
        let value = design.get(&parameter.key).unwrap_or(f64::NAN);
        parameter.value(parameter.nearest(value)) != value
    });
    off.map(|parameter| format!("{design}: {} is no value of the space", parameter.key))
}

/// Whether a stiffness is one: finite, and its error not negative.
fn known(stiffness: &Prediction) -> bool {
    let each = [stiffness.compliance, stiffness.assembly];
    let sound = |number: f64| (0.0..=LARGEST).contains(&number);
    each.iter().all(|k| sound(k.mean) && sound(k.sd)) && sound(stiffness.hull_distance)
}

/// Whether the numbers of an evaluation are such as a simulation can give.
pub fn plausible(evaluation: &Evaluation) -> bool {
    let window = &evaluation.window;
    let ends = [window.negative_steps, window.positive_steps];
    let ends = ends.iter().all(|end| end.unsigned_abs() <= FARTHEST_STEPS)
        && window.negative_steps <= 0
        && window.positive_steps >= 0;
    let mut counts = evaluation.failure_counts.to_vec();
    counts.extend([evaluation.diverged, evaluation.trials]);
    let mut numbers = evaluation.end_shares.to_vec();
    if let Some(success) = &evaluation.success {
        counts.extend(success.failure_counts);
        counts.extend([success.inserted, success.diverged]);
        numbers.push(success.confidence);
    }
    if let Some(robust) = &evaluation.robust {
        counts.extend([robust.diverged, robust.trials]);
        numbers.extend(robust.ranges_mm.iter().chain(&robust.value_mm));
    }
    // Force, slip and time may be NaN: null in the journal, not measured.
    let infinite = [evaluation.peak_force_n, evaluation.slip_mm, evaluation.simulated_s];
    ends && counts.iter().all(|&count| count <= MOST_TRIALS)
        && numbers.iter().all(|number| number.abs() <= LARGEST)
        && !infinite.iter().any(|number| number.is_infinite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use insertion::evaluation::tolerance::{Search, evaluate};
    use insertion::finger::Finger;
    use insertion::trial::fake::FakeRig;

    #[test]
    fn an_evaluation_is_plausible_until_a_number_is_none() {
        let sound = evaluate(&FakeRig::default(), &Finger::new(3e3, 2e4), Search::Strides);
        assert!(plausible(&sound));
        let changed = |change: &dyn Fn(&mut Evaluation)| {
            let mut evaluation = sound.clone();
            change(&mut evaluation);
            plausible(&evaluation)
        };
        assert!(changed(&|e| e.peak_force_n = f64::NAN), "no trial inserted");
        assert!(!changed(&|e| e.peak_force_n = f64::INFINITY));
        assert!(!changed(&|e| e.window.positive_steps = i32::MAX));
        assert!(!changed(&|e| e.window.negative_steps = i32::MIN));
        assert!(!changed(&|e| e.failure_counts[2] = u32::MAX));
        assert!(!changed(&|e| e.end_shares[0] = f64::NAN));
    }
}
