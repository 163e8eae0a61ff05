//! Trial along the commanded trajectory of a log, and the friction probe.

use super::{Attempt, Stop};
use crate::Stage;
use crate::trial::motion::{Move, Tcp};
use crate::trial::record::{LOG_STEP_S, Trace};
use input::units::MM;
use nalgebra::Vector3;

/// Commanded trajectory of the TCP, task frame: targets at increasing times, s.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    times: Vec<f64>,
    targets: Vec<Tcp>,
}

/// Shortest continuous descent that counts as the push, m: longer than any in a search.
const MIN_PUSH: f64 = 3.0 * MM;

impl Trajectory {
    /// Creates a trajectory from times, s, and targets; `None` unless there are at least two and the times increase.
    pub fn new(points: impl IntoIterator<Item = (f64, Tcp)>) -> Option<Self> {
        let (times, targets): (Vec<f64>, Vec<Tcp>) = points.into_iter().unzip();
        let increase = times.windows(2).all(|pair| pair[0] < pair[1]);
        (times.len() > 1 && increase).then_some(Trajectory { times, targets })
    }

    /// Returns the duration, s.
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }

    /// Returns the command at a time after the start, s; constant after the end.
    fn at(&self, time: f64) -> Tcp {
        let time = self.times[0] + time;
        let after = self.times.partition_point(|&t| t <= time);
        if after == 0 || after == self.times.len() {
            return self.targets[after.saturating_sub(1)];
        }
        let share = (time - self.times[after - 1]) / (self.times[after] - self.times[after - 1]);
        self.targets[after - 1].towards(&self.targets[after], share)
    }

    /// Returns the time at which the push begins, s from the start: the beginning of the last descent if it is longer
    /// than `MIN_PUSH`, else the end of the trajectory.
    pub fn push_start(&self) -> f64 {
        let heights: Vec<f64> = self.targets.iter().map(|target| target.position.z).collect();
        let last = heights.len() - 1;
        let rises = |i: &usize| heights[*i] <= heights[*i + 1];
        // The command may be at rest at the end.
        let end = (0..last).rev().find(|i| !rises(i)).map_or(0, |i| i + 1);
        let begin = (0..end).rev().find(rises).map_or(0, |i| i + 1);
        let far = heights[begin] - heights[end] > MIN_PUSH;
        self.times[if far { begin } else { last }] - self.times[0]
    }
}

/// Force with which the upright part is pressed on a flat face in a friction probe, N. Under 10 N, a plug 8 mm wide
/// tips over its edge at coefficients of friction from 0.3.
pub const PROBE_FORCE: f64 = 5.0;
/// Length of a slide of the probe along y, m; with 5 mm, the part would not slide in both directions.
pub const PROBE_STROKE: f64 = 8.0 * MM;
/// Speed of a slide of the probe, m/s.
pub const PROBE_SPEED: f64 = 5.0 * MM;
/// Number of slides of the probe, in alternating directions.
pub const PROBE_SLIDES: u32 = 4;

/// Height above the face from which the probe descends, m.
const PROBE_HEIGHT: f64 = 2.0 * MM;
/// Largest descent, m: enough for the softest robot to press.
const MAX_DESCENT: f64 = 20.0 * MM;
/// Rest in the air before the probe and after it, s: reference of the sensor without contact.
const REST_IN_AIR: f64 = 0.2;
/// Admittance of the command, m/s per N: a stiff robot reaches the force within 0.1 s, and the control does not
/// oscillate.
const ADMITTANCE: f64 = 2e-4;
/// Speed at which the part is lifted off, m/s.
const LIFT_SPEED: f64 = 0.02;

impl Attempt<'_> {
    /// Carries the grasped part to the start of the trajectory, follows the trajectory and records samples of it.
    pub fn follow(&mut self, trajectory: &Trajectory) -> Result<(), Stop> {
        self.carry(trajectory.at(0.0))?;
        self.trace = Some(Trace::new(LOG_STEP_S));
        self.stage = Stage::Search;
        let push = trajectory.push_start();
        // The first sample is at the end of the first step, and has the first target.
        for i in 0..=self.steps(trajectory.duration()) {
            let time = i as f64 * self.world.step_s();
            if time > push && self.stage == Stage::Search {
                self.end_phase("search");
                self.enter_stage(Stage::Assembly);
            }
            self.target = trajectory.at(time);
            self.step()?;
        }
        self.end_phase("push");
        Ok(())
    }

    /// Slides the grasped part over the flat face that replaces the socket.
    pub fn probe(&mut self) -> Result<(), Stop> {
        let z = self.task.grip.tcp_z + PROBE_HEIGHT;
        self.carry(Tcp { position: Vector3::new(0.0, -0.5 * PROBE_STROKE, z), tilt: 0.0 })?;
        self.trace = Some(Trace::new(LOG_STEP_S));
        self.stage = Stage::Search;
        self.rest(REST_IN_AIR)?;
        let down = Vector3::new(0.0, 0.0, -PROBE_SPEED);
        for _ in 0..self.steps(MAX_DESCENT / PROBE_SPEED) {
            if self.monitor.force.z >= PROBE_FORCE {
                break;
            }
            self.step_at(down)?;
        }
        let slide = self.steps(PROBE_STROKE / PROBE_SPEED);
        for i in 0..PROBE_SLIDES {
            let along = if i.is_multiple_of(2) { PROBE_SPEED } else { -PROBE_SPEED };
            for _ in 0..slide {
                let lower = ADMITTANCE * (self.monitor.force.z - PROBE_FORCE);
                self.step_at(Vector3::new(0.0, along, lower))?;
            }
        }
        let up = self.target.moved(Vector3::new(0.0, 0.0, 2.0 * PROBE_HEIGHT));
        self.run_move(Move::new(self.target, up, LIFT_SPEED), REST_IN_AIR)?;
        self.end_phase("probe");
        Ok(())
    }

    /// Moves the command at this velocity, m/s, for a step.
    pub(super) fn step_at(&mut self, velocity: Vector3<f64>) -> Result<(), Stop> {
        self.target = self.target.moved(velocity * self.world.step_s());
        self.step()
    }
}
