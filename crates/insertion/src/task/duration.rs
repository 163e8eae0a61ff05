//! Largest duration of a trial, in simulated time.

use super::{Ending, Phase, Strategy};
use input::units::MM;

/// Largest accepted duration of a trial, s.
pub const MAX_TRIAL_S: f64 = 60.0;
/// Shortest duration of a move, s; it bounds the acceleration of a tiny displacement.
pub const MIN_MOVE_S: f64 = 0.02;
/// Longest wait for the TCP to come within the tolerance of a target once the commanded motion has ended, s.
pub const TOLERANCE_TIMEOUT_S: f64 = 1.0;
/// Time to close the jaws and for the fingers to come to rest, s.
pub const GRASP_S: f64 = 0.3;
/// Time to lift, tilt and carry the part to the start, s.
pub const CARRY_S: f64 = 0.2;

impl Phase {
    /// Returns the largest duration of the phase, s, if its move is lengthened by `extra`, m, and the robot settles
    /// within `settling` seconds.
    fn longest_s(&self, extra: f64, settling: f64) -> f64 {
        let [x, y, z] = self.displacement;
        let length = libm::hypot(libm::hypot(x, y), z) + extra;
        let after = match self.ending {
            Ending::Duration(rest) => rest.max(settling),
            Ending::Tolerance(_) => TOLERANCE_TIMEOUT_S,
            Ending::Touch { preload, detection } => {
                (preload / self.speed).max(MIN_MOVE_S) + detection.latency + 2.0 * settling
            }
        };
        (length / self.speed).max(MIN_MOVE_S) + after
    }
}

impl Strategy {
    /// Checks that no trial can take longer than `MAX_TRIAL_S` on a robot that follows a command within
    /// `settling` seconds and lengthens the move of a phase by `extra`, m.
    ///
    /// # Errors
    /// If a trial can take longer; the message states its largest duration and its longest phase.
    pub fn check_time(&self, extra: impl Fn(&Phase) -> f64, settling: f64) -> Result<(), String> {
        let seconds = |phase: &Phase| phase.longest_s(extra(phase), settling);
        let total = GRASP_S + CARRY_S + settling + self.phases.iter().map(seconds).sum::<f64>();
        // NaN fails the comparison.
        if total <= MAX_TRIAL_S {
            return Ok(());
        }
        let longest = self.phases.iter().max_by(|a, b| seconds(a).total_cmp(&seconds(b)));
        let longest = longest.map_or(String::new(), |phase| {
            let (name, longest, speed) = (&phase.name, seconds(phase), phase.speed / MM);
            format!(", of which \"{name}\" takes {longest:.1} s at {speed:.3} mm/s")
        });
        Err(format!("a trial takes {total:.1} s{longest}; at most {MAX_TRIAL_S} s is accepted"))
    }
}

#[cfg(test)]
mod tests {
    use crate::task::Task;
    use crate::tests::fixtures::{refused, task_file};

    #[test]
    fn a_trial_that_takes_too_long_is_refused_with_its_longest_phase() {
        let usb = task_file("usb").text;
        // Parses the task with another value in the first line of a key.
        let with = |key: &str, value: &str| {
            let line = usb.lines().find(|line| line.starts_with(key)).unwrap();
            Task::parse(&usb.replacen(line, &format!("{key} = {value}"), 1), "usb.toml")
        };
        for (key, value) in
            [("speed_mm_per_s", "0.001"), ("settle_s", "999.0"), ("settle_s", "59.9")]
        {
            let parts = ["usb.toml", "strategy.phase", "a trial takes", "at most 60 s", "\""];
            refused(with(key, value), &parts);
        }
        let far = with("move_mm", "[0.0, 0.0, -1e9]");
        refused(far, &["move_mm: is -1000000000; it must lie in -1000"]);
        assert!(with("settle_s", "40.0").is_ok());
    }
}
