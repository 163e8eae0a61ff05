//! Shorter push, with which the robot does not stop after the plug is seated.

use input::units::MM;
use insertion::outcome::STOP_REMEDY;
use insertion::{Ending, Evaluation, Outcome, Phase, Robot, Stage, Task};
use serde::Serialize;

/// Shorter push that inserts from the whole window within the acceptable force.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShorterPush {
    /// Path of its number in the task file, `strategy.phase.assembly.move_mm.z`.
    pub key: String,
    /// Value, mm.
    pub value_mm: f64,
    /// Value that it replaces, mm.
    pub instead_of_mm: f64,
    /// Range with it, mm.
    pub range_mm: f64,
    /// Largest contact force of the insertions with it, N.
    pub peak_force_n: f64,
}

/// Finds the longest push with which no insertion stops the robot or exceeds the acceptable force, by bisection, for a
/// task whose own push does; `evaluate` returns the window of a changed task. `None` if that push does not insert.
///
/// # Errors
/// If a task cannot be simulated.
pub fn shorter_push<E>(
    task: &Task,
    robot: &Robot,
    evaluate: impl Fn(&Task) -> Result<Evaluation, E>,
) -> Result<Option<ShorterPush>, E> {
    let pushes =
        |p: &Phase| p.stage == Stage::Assembly && !matches!(p.ending, Ending::Touch { .. });
    let Some(at) = task.strategy.phases.iter().rposition(pushes) else { return Ok(None) };
    let whole = task.strategy.phases[at].displacement[2];
    let acceptable = robot.acceptable_force(task.limits.force);
    let too_hard =
        |found: &Evaluation| found.stopped_insertions()[0] > 0 || found.peak_force_n > acceptable;
    // In steps of 0.1 mm, converted as numbers of a task file are.
    let value_mm = |steps: u32| -f64::from(steps) / 10.0;
    let (mut gentle, mut hard) = (0, (-10.0 * whole / MM).ceil() as u32);
    let mut longest = None;
    while hard - gentle > 1 {
        let middle = gentle.midpoint(hard);
        let mut shorter = task.clone();
        shorter.strategy.phases[at].displacement[2] = value_mm(middle) * MM;
        let found = evaluate(&shorter)?;
        match too_hard(&found) {
            true => hard = middle,
            false => (gentle, longest) = (middle, Some(found)),
        }
    }
    let inserts = longest.filter(|found| found.window.nominal == Outcome::Inserted);
    Ok(inserts.map(|found| ShorterPush {
        key: format!("strategy.phase.{}.move_mm.z", task.strategy.phases[at].name),
        value_mm: value_mm(gentle),
        instead_of_mm: (whole / MM * 1e4).round() / 1e4,
        range_mm: found.window.range_mm(),
        peak_force_n: found.peak_force_n,
    }))
}

/// Returns advice on robot stops after the plug is seated: a shorter push, if one is known.
pub fn remedy(push: Option<&ShorterPush>) -> String {
    push.map_or(STOP_REMEDY.to_owned(), |push| {
        let ShorterPush { key, value_mm, instead_of_mm, range_mm, peak_force_n } = push;
        format!(
            "Set `{key}` to {value_mm} in place of {instead_of_mm}: range {range_mm:.1} mm, at most \
             {peak_force_n:.0} N"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::{ROBOTS, TASKS};
    use insertion::{FailureClass, Window};
    use std::convert::Infallible;

    /// Window of a push with 10 N per mm beyond 12 mm, which inserts from 14 mm on.
    fn evaluation(push_mm: f64, stop_force: f64) -> Evaluation {
        let inserts = push_mm >= 14.0;
        let jammed = Outcome::Failed(FailureClass::Jammed);
        let peak_force_n = (10.0 * (push_mm - 12.0)).min(stop_force);
        Evaluation {
            window: Window {
                nominal: if inserts { Outcome::Inserted } else { jammed },
                negative_steps: -20,
                positive_steps: 30,
                end_negative: Some(jammed),
                end_positive: Some(jammed),
            },
            failure_counts: [0, 0, 2, 0],
            diverged: 0,
            robot_stops: if peak_force_n < stop_force { 2 } else { 12 },
            peak_force_n: if inserts { peak_force_n } else { f64::NAN },
            slip_mm: 0.0,
            trials: 14,
            simulated_s: 14.0,
            end_shares: [0.5; 2],
            taught: None,
            success: None,
            robust: None,
        }
    }

    #[test]
    fn the_longest_push_within_the_acceptable_force_is_found() {
        let usb = TASKS.iter().find(|file| file.name == "usb").unwrap();
        let task = Task::parse(usb.text, usb.file).unwrap();
        let servo = ROBOTS.iter().find(|file| file.name == "servo").unwrap();
        let servo = Robot::parse(servo.text, servo.file).unwrap();
        let found = |stop_force: f64| {
            let evaluate = |task: &Task| {
                let push_mm = -task.strategy.phases.last().unwrap().displacement[2] / MM;
                Ok::<_, Infallible>(evaluation(push_mm, stop_force))
            };
            shorter_push(&task, &Robot { stop_force, ..servo.clone() }, evaluate).unwrap()
        };
        // 90 % of 50.5 N are reached with 16.545 mm.
        let push = found(50.5).unwrap();
        assert_eq!(push.key, "strategy.phase.assembly.move_mm.z");
        assert_eq!((push.value_mm, push.instead_of_mm, push.range_mm), (-16.5, -20.0, 5.0));
        assert!((push.peak_force_n - 45.0).abs() < 1e-9, "{push:?}");
        assert_eq!(found(20.0), None, "the push of 18 N does not insert");
        let advice =
            "Set `strategy.phase.assembly.move_mm.z` to -16.5 in place of -20: range 5.0 mm";
        assert!(remedy(Some(&push)).starts_with(advice), "{}", remedy(Some(&push)));
        assert_eq!(remedy(None), STOP_REMEDY);
    }
}
