//! Whether an evaluation or a design that was read is possible.

use insertion::evaluation::{Evaluation, RobustRange, SuccessRate, Window, grid_mm};
use insertion::outcome::Outcome;
use insertion::space::{Design, Space};

/// Farthest end of a window, grid steps: 100 mm, ten times what is looked at.
const FARTHEST_STEPS: u32 = 1000;
/// Largest size of a value in any unit.
pub(super) const LARGEST: f64 = 1e15;
/// Most trials of one kind in an evaluation.
const MOST_TRIALS: u32 = 10_000_000;

/// Placeholder for an evaluation that was refused.
pub(super) const NOTHING: Evaluation = Evaluation {
    window: Window {
        nominal: Outcome::Diverged,
        negative_steps: 0,
        positive_steps: 0,
        end_negative: Some(Outcome::Diverged),
        end_positive: Some(Outcome::Diverged),
    },
    failure_counts: [0; 4],
    diverged: 1,
    trials: 1,
    peak_force_n: f64::NAN,
    slip_mm: f64::NAN,
    simulated_s: 0.0,
    end_shares: [0.0; 2],
    taught: None,
    success: None,
    robust: None,
};

/// Returns what keeps a design off the space, if anything does.
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

/// Reason why an evaluation is impossible, if it is: asked of all that is read or taken in, from
/// journals, the cache and workers.
pub fn implausible(evaluation: &Evaluation) -> Option<&'static str> {
    let Evaluation { window, failure_counts, diverged, trials, .. } = evaluation;
    let farthest = |steps: &i32| steps.unsigned_abs() <= FARTHEST_STEPS;
    let ends = [window.negative_steps, window.positive_steps];
    let failed = failure_counts.iter().fold(*diverged, |sum, &count| sum.saturating_add(count));
    let inserts = window.nominal == Outcome::Inserted;
    // NaN, null in the journal, is not measured: nothing has inserted.
    let size = |number: f64| (0.0..=LARGEST).contains(&number) || (number.is_nan() && !inserts);
    let sizes = [evaluation.peak_force_n, evaluation.slip_mm, evaluation.simulated_s];
    let checks = [
        (ends.iter().chain(&evaluation.taught).all(farthest), "its window lies too far out"),
        (ends[0] <= 0 && ends[1] >= 0, "its window does not hold the nominal start"),
        (inserts || ends == [0, 0], "its nominal start fails, and it has a window"),
        ((1..=MOST_TRIALS).contains(trials) && failed <= *trials, "its trials do not add up"),
        (inserts || failed > 0, "its nominal start failed in no trial"),
        (
            sizes.into_iter().all(size),
            "a force, a slip or a time is not finite, negative or far too large",
        ),
        (
            evaluation.end_shares.iter().all(|share| share.abs() <= 1.0),
            "an end is no share of a step",
        ),
        (evaluation.success.iter().all(possible_rate), "its success rate cannot be one"),
        (evaluation.robust.iter().all(possible_range), "its robust range cannot be one"),
    ];
    checks.into_iter().find_map(|(holds, problem)| (!holds).then_some(problem))
}

fn possible_rate(success: &SuccessRate) -> bool {
    let SuccessRate { inserted, diverged, spared, failed_draws, .. } = success;
    let counts = success.failure_counts.into_iter().chain([*inserted, *diverged, *spared]);
    let draws = counts.map(u64::from).sum::<u64>();
    // Up to version 0.4.0 it is not known which failed.
    let all_failed =
        failed_draws.len() as u64 + u64::from(*inserted) == u64::from(success.counted());
    draws <= u64::from(MOST_TRIALS)
        && (failed_draws.is_empty() || all_failed)
        && failed_draws.windows(2).all(|pair| pair[0] < pair[1])
        && failed_draws.last().is_none_or(|&last| u64::from(last) < draws)
        && (0.0..=1.0).contains(&success.confidence)
}

fn possible_range(robust: &RobustRange) -> bool {
    let widest = 2.0 * grid_mm(FARTHEST_STEPS as i32);
    let mut ranges = robust.ranges_mm.iter().chain(&robust.value_mm);
    ranges.all(|range| (-widest..=widest).contains(range))
        && robust.diverged <= robust.trials
        && robust.trials <= MOST_TRIALS
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use insertion::evaluation::tolerance::{Search, evaluate};
    use insertion::finger::Finger;
    use insertion::trial::fake::FakeRig;

    pub fn sound() -> Evaluation {
        evaluate(&FakeRig::default(), &Finger::new(3e3, 2e4), Search::Strides)
    }

    pub type Change = fn(&mut Evaluation, f64);

    /// Numbers of an evaluation with the least and the largest value they may have.
    pub const BOUNDS: [(&str, Change, [f64; 2]); 19] = [
        ("negative_steps", |e, x| e.window.negative_steps = x as i32, [-1000.0, 0.0]),
        ("positive_steps", |e, x| e.window.positive_steps = x as i32, [0.0, 1000.0]),
        ("taught", |e, x| e.taught = Some(x as i32), [-1000.0, 1000.0]),
        ("trials", |e, x| e.trials = x as u32, [1.0, 1e7]),
        ("failures", |e, x| e.failure_counts = [0, 0, x as u32, 0], [0.0, 20.0]),
        ("diverged", |e, x| e.diverged = x as u32, [0.0, 20.0]),
        ("peak_force_n", |e, x| e.peak_force_n = x, [0.0, LARGEST]),
        ("slip_mm", |e, x| e.slip_mm = x, [0.0, LARGEST]),
        ("simulated_s", |e, x| e.simulated_s = x, [0.0, LARGEST]),
        ("end_shares", |e, x| e.end_shares[1] = x, [-1.0, 1.0]),
        ("confidence", |e, x| rate(e).confidence = x, [0.0, 1.0]),
        ("success inserted", |e, x| rate(e).inserted = x as u32, [0.0, 1e7]),
        ("success failures", |e, x| rate(e).failure_counts[3] = x as u32, [0.0, 1e7]),
        ("success diverged", |e, x| rate(e).diverged = x as u32, [0.0, 1e7]),
        ("success spared", |e, x| rate(e).spared = x as u32, [0.0, 1e7]),
        ("robust ranges", |e, x| robust(e).ranges_mm[0] = x, [-200.0, 200.0]),
        ("robust value", |e, x| robust(e).value_mm = Some(x), [-200.0, 200.0]),
        ("robust diverged", |e, x| robust(e).diverged = x as u32, [0.0, 9.0]),
        ("robust trials", |e, x| robust(e).trials = x as u32, [0.0, 1e7]),
    ];

    fn rate(evaluation: &mut Evaluation) -> &mut SuccessRate {
        let none = SuccessRate { confidence: 0.95, ..SuccessRate::default() };
        evaluation.success.insert(none)
    }

    fn robust(evaluation: &mut Evaluation) -> &mut RobustRange {
        // Nine trials, unless it is their number that is asked for.
        let value_mm = Some(1.0);
        evaluation.robust.insert(RobustRange {
            ranges_mm: vec![1.0],
            diverged: 0,
            value_mm,
            trials: 9,
        })
    }

    #[test]
    fn a_number_is_plausible_up_to_its_bounds_and_not_beyond() {
        for (name, change, [least, most]) in BOUNDS {
            let with = |value: f64| {
                let counts = Evaluation { trials: 20, failure_counts: [0; 4], ..sound() };
                let mut evaluation = Evaluation { diverged: 0, ..counts };
                change(&mut evaluation, value);
                evaluation
            };
            let plausible = |value: f64| implausible(&with(value)).is_none();
            let share = ["end_shares", "confidence"].contains(&name);
            let beyond = |bound: f64| if share { 1e-9 } else { bound.abs() * 1e-3 + 1.0 };
            assert!(plausible(least) && plausible(most), "{name}");
            assert!(!plausible(most + beyond(most)), "{name} above {most}");
            // Counts are not negative: below their bound there is nothing to be refused.
            if with(-1.0) != with(0.0) {
                assert!(!plausible(least - beyond(least)), "{name} below {least}");
            }
        }
    }

    #[test]
    fn what_is_not_measured_is_plausible_and_a_window_needs_its_nominal_start() {
        let with = |change: &dyn Fn(&mut Evaluation)| {
            let mut evaluation = sound();
            change(&mut evaluation);
            implausible(&evaluation)
        };
        assert_eq!(with(&|_| ()), None);
        assert!(with(&|e| e.peak_force_n = f64::NAN).is_some());
        assert_eq!(implausible(&NOTHING), None);
        assert!(with(&|e| e.peak_force_n = f64::INFINITY).is_some());
        assert!(with(&|e| e.end_shares[0] = f64::NAN).is_some());
        assert!(with(&|e| e.window.nominal = Outcome::Diverged).is_some());
        assert!(with(&|e| e.window.negative_steps = i32::MIN).is_some());
    }
}
