//! Contact force of a finger compared with the limits of its connector and of the robot.

use insertion::robot::STOP_SHARE;
use insertion::{Evaluation, Measure, Robot};
use serde::Serialize;
use study::{ForceLimits, StudyRecord};

/// Contact force above the limit of a connector, or above the acceptable share of the force at which the robot stops.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExcessForce {
    /// Task on which it occurs.
    pub task: String,
    /// Largest contact force in the trials that insert, N.
    pub peak_force_n: f64,
    /// Limit, N: that of the connector, or the force at which the robot stops.
    pub limit_n: f64,
    /// Whether the limit is that of the connector.
    pub of_connector: bool,
}

impl ExcessForce {
    /// Returns the excess on the first task of a study whose contact force is not acceptable; `None` if there is none.
    pub fn of(record: &StudyRecord, tasks: &[&Evaluation]) -> Option<Self> {
        let ForceLimits { connectors, robot, .. } = &record.limits;
        let on = |(place, (task, evaluation)): (usize, (&str, &&Evaluation))| {
            Self::on(task, evaluation, (connectors.get(place).copied().flatten(), robot.as_ref()))
        };
        record.config.tasks().zip(tasks).enumerate().find_map(on)
    }

    /// Returns the excess of an evaluation on a task; `None` if connector (limit in N) and robot withstand its force.
    pub fn on(
        task: &str,
        evaluation: &Evaluation,
        (connector, robot): (Option<f64>, Option<&Robot>),
    ) -> Option<Self> {
        let peak_force_n = Measure::PeakForce.value(evaluation)?;
        let connector = connector.filter(|&limit| peak_force_n > limit);
        let robot = robot.filter(|robot| peak_force_n > robot.acceptable_force(None));
        let limit_n = connector.or(robot.map(|robot| robot.stop_force))?;
        let (task, of_connector) = (task.to_owned(), connector.is_some());
        Some(ExcessForce { task, peak_force_n, limit_n, of_connector })
    }

    /// Returns the force and the limit in words: `up to 149 N on ket8 in the trials that insert: more
    /// than 90 % of the 150 N at which the robot ur5e stops`.
    pub fn words(&self, robot: &str) -> String {
        let ExcessForce { task, peak_force_n, limit_n, of_connector } = self;
        // Rounded to newtons, the force may equal the limit.
        let digits = usize::from(peak_force_n.round() == limit_n.round());
        let [peak, limit] = [peak_force_n, limit_n].map(|newtons| format!("{newtons:.digits$} N"));
        let stop = format!("the {limit} at which the robot {robot} stops");
        let limit = match (of_connector, peak_force_n > limit_n) {
            (true, _) => format!("its connector withstands {limit} (limits.force_n)"),
            (false, true) => format!("above {stop}"),
            (false, false) => format!("more than {:.0} % of {stop}", 100.0 * STOP_SHARE),
        };
        format!("up to {peak} on {task} in the trials that insert: {limit}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_is_above_the_limit_or_near_it() {
        let words = |peak_force_n| {
            let task = "usb".to_owned();
            ExcessForce { task, peak_force_n, limit_n: 150.0, of_connector: false }.words("servo")
        };
        assert!(words(149.0).contains("149 N on usb in the trials that insert: more than 90 %"));
        assert!(
            words(150.4).contains("150.4 N on usb in the trials that insert: above the 150.0 N")
        );
        assert!(words(155.4).contains("above the 150 N at which the robot servo stops"));
    }
}
