//! Trial with moves commanded by the caller, for learning a search strategy.

use super::{Attempt, REST, Stop};
use crate::{Outcome, Stage};
use input::units::{DEG, MM};
use nalgebra::Vector3;

/// Duration of a command, s.
pub const CONTROL_S: f64 = 1e-3;

/// Trial from the start of the search on, moved by commands of the caller.
pub struct Driven {
    /// State right before the search; each start is a copy.
    ready: Attempt<'static>,
    /// Result of grasp and approach.
    prepared: Result<(), Stop>,
    attempt: Attempt<'static>,
    end: Result<(), Stop>,
    /// Time for which the part has been seated and held, s.
    seated_s: f64,
}

/// State of the trial after a command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Simulated time since the start of the search, s.
    pub time_s: f64,
    /// TCP as measured by the robot, relative to the assumed middle of the opening, mm.
    pub tcp_mm: [f64; 3],
    /// Rotation of the flange about x, y and z, degrees; it includes the tilt of the search.
    pub turn_deg: [f64; 3],
    /// Net force of the socket on the plug filtered like that of a wrist sensor, N.
    pub force_n: [f64; 3],
    /// Tip of the plug relative to the middle of the opening, mm; not observable by a robot.
    pub tip_mm: [f64; 3],
    /// Angle between the plug's axis and that of the opening, degrees.
    pub tilt_deg: f64,
    /// Slip of the part along the pads since the grasp, mm.
    pub slip_mm: f64,
    /// Distance of the tip from the depth at which it counts as inserted, mm.
    pub distance_mm: f64,
    /// Outcome, once the trial has ended.
    pub outcome: Option<Outcome>,
}

impl Driven {
    pub(in crate::trial) fn new(ready: Attempt<'static>, prepared: Result<(), Stop>) -> Self {
        let attempt = ready.clone();
        let mut driven = Driven { ready, prepared, attempt, end: Ok(()), seated_s: 0.0 };
        driven.start(0.0);
        driven
    }

    /// Restarts the trial with the start shifted by `offset` metres along y.
    pub fn start(&mut self, offset: f64) -> State {
        self.attempt = self.ready.shifted(offset);
        self.end = self.prepared;
        self.seated_s = 0.0;
        if self.end.is_ok() {
            self.attempt.stage = Stage::Search;
        }
        self.state()
    }

    /// Commands a velocity of the TCP, m/s, for `CONTROL_S`. Nothing moves once the trial has ended.
    pub fn step(&mut self, velocity: Vector3<f64>) -> State {
        let dt = self.attempt.world.step_s();
        for _ in 0..self.attempt.steps(CONTROL_S) {
            if self.outcome().is_none() {
                self.end = self.attempt.step_at(velocity);
                self.update_stage(dt);
            }
        }
        self.state()
    }

    /// Detects the start of the push and the part seated at rest, which the phases of a strategy define otherwise.
    fn update_stage(&mut self, dt: f64) {
        let attempt = &mut self.attempt;
        if attempt.monitor.entered && attempt.stage == Stage::Search {
            attempt.enter_stage(Stage::Assembly);
        }
        let seated = attempt.placement().seated(&attempt.task) && attempt.monitor.gripped();
        self.seated_s = if seated { self.seated_s + dt } else { 0.0 };
    }

    fn outcome(&self) -> Option<Outcome> {
        if self.end.is_ok() {
            return (self.seated_s >= REST).then_some(Outcome::Inserted);
        }
        let seated = self.end == Err(Stop::ForceLimit) && self.seated_s > 0.0;
        Some(self.attempt.outcome(self.end, seated))
    }

    fn state(&self) -> State {
        let attempt = &self.attempt;
        let flange = attempt.world.pose(attempt.cell.flange);
        let placement = attempt.placement();
        let seat = placement.tip + Vector3::z() * attempt.task.success.depth;
        // Additional depth does not count as distance.
        let away = Vector3::new(seat.x, seat.y, seat.z.max(0.0));
        State {
            time_s: attempt.time - self.ready.time,
            tcp_mm: (flange.translation.vector / MM).into(),
            turn_deg: (flange.rotation.scaled_axis() / DEG).into(),
            force_n: attempt.monitor.force.into(),
            tip_mm: (placement.tip / MM).into(),
            tilt_deg: placement.tilt / DEG,
            slip_mm: attempt.slip() / MM,
            distance_mm: away.norm() / MM,
            outcome: self.outcome(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::FailureClass;
    use crate::tests::fixtures::{finger, rig, task};
    use crate::trial::Rig;

    fn driven() -> Driven {
        rig(task("ket8")).driven(&finger(2.6, 45.0)).unwrap()
    }

    #[test]
    fn a_start_repeats_bit_for_bit_and_without_a_command_the_part_rests() {
        let mut driven = driven();
        let start = driven.start(1e-3);
        let run = |driven: &mut Driven| {
            let down = Vector3::new(0.0, 0.0, -0.02);
            (0..100).map(|_| driven.step(down)).collect::<Vec<State>>()
        };
        let first = run(&mut driven);
        assert_eq!(driven.start(1e-3), start);
        assert_eq!(run(&mut driven), first);
        assert!((first[99].time_s - 0.1).abs() < 1e-9);
        driven.start(1e-3);
        let rest = (0..100).map(|_| driven.step(Vector3::zeros())).last().unwrap();
        assert_eq!((rest.force_n, rest.outcome), ([0.0; 3], None));
        let moved = [0, 1, 2].map(|axis| (rest.tip_mm[axis] - start.tip_mm[axis]).abs());
        // The compliant flange is still settling.
        assert!(moved.iter().all(|&mm| mm < 0.1), "{moved:?}");
    }

    #[test]
    fn the_robot_does_not_measure_the_shift_and_a_crushed_plug_is_a_failure() {
        let mut driven = driven();
        let [here, there] = [0.0, 2e-3].map(|offset| driven.start(offset));
        assert_eq!((here.tcp_mm, here.turn_deg), (there.tcp_mm, there.turn_deg));
        assert!((there.tip_mm[1] - here.tip_mm[1] - 2.0).abs() < 1e-9);
        driven.start(30e-3);
        let down = Vector3::new(0.0, 0.0, -0.1);
        let end = (0..2000).map(|_| driven.step(down)).find(|state| state.outcome.is_some());
        let end = end.unwrap();
        let failed = end.outcome.unwrap().failure();
        assert!(failed.is_some_and(|class| class >= FailureClass::PlugMissed.number()), "{end:?}");
        assert_eq!(driven.step(down), end, "nothing moves once the trial has ended");
    }
}
