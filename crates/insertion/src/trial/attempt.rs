//! One attempt at an insertion: phases, step by step, and their monitoring.

use super::cell::{self, Hand, WorkCell};
use super::classify::{FinalState, Placement, classify};
use super::monitor::{ContactMonitor, LeadingEdge};
use super::motion::{Move, Tcp};
use super::record::{Frame, Recorder, Sample, Trace};
use super::run::RecordedRun;
use super::{Conditions, Grasp, PhaseEnd, Poses, Trial};
use crate::robot::MountedRobot;
use crate::task::duration::{CARRY_S, GRASP_S, TOLERANCE_TIMEOUT_S};
use crate::task::{Hold, TouchDetection};
use crate::{Ending, Outcome, Phase, Stage, Task};
use contact::scene::{BodyId, Pose};
use contact::{ContactForce, ContactPoint, Diverged, Engine, World};
use input::units::{DEG, MM};
use nalgebra::{Point3, Vector3};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

pub mod commanded;
mod descent;
pub mod driven;

/// Shortest rest after a move, s.
const REST: f64 = 0.03;
/// Time step during the grasp and rests, as a multiple of that of the engine.
const COARSE: f64 = 2.0;

/// Reason for the end of an attempt before its last phase is complete.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Stop {
    /// The part left the grasp.
    Lost,
    /// The force limit of the robot was reached.
    ForceLimit,
    /// The simulation diverged.
    Diverged,
    /// Stopped by the study; the result is invalid.
    Interrupted,
}

/// State of an attempt; a clone continues bit for bit as the original does.
#[derive(Clone)]
pub(super) struct Attempt<'a> {
    robot: Arc<MountedRobot>,
    stop: &'a AtomicBool,
    task: Arc<Task>,
    pub cell: WorkCell,
    pub world: Box<dyn World>,
    target: Tcp,
    stage: Stage,
    /// First move of the search and the number of its steps simulated in the shared descent, if any.
    begun: Option<(Move, usize)>,
    conditions: Conditions,
    /// Transform from the world to the task frame: the inverse of the socket's displacement.
    pub socket: Pose,
    /// Simulated time, s.
    time: f64,
    /// Grasp point in each finger's frame right after the grasp.
    grasp: [Vector3<f64>; 2],
    monitor: ContactMonitor,
    edge: LeadingEdge,
    phases: Vec<PhaseEnd>,
    pub trace: Option<Trace>,
    pub recorder: Option<Recorder>,
}

impl<'a> Attempt<'a> {
    /// Creates an attempt right before its grasp.
    pub fn new(
        robot: &Arc<MountedRobot>,
        task: &Task,
        engine: &dyn Engine,
        Grasp { finger, conditions, stop }: Grasp<'a>,
    ) -> Self {
        let task = Arc::new(conditions.task(task));
        let mut cell = cell::build(&task, robot, &finger);
        conditions.displace(&mut cell);
        let world = engine.world(&cell.scene);
        let pose = world.pose(cell.command);
        let edge = LeadingEdge::new(&task);
        Attempt {
            robot: Arc::clone(robot),
            stop,
            task,
            cell,
            world,
            target: Tcp { position: pose.translation.vector, tilt: 0.0 },
            stage: Stage::Approach,
            begun: None,
            conditions,
            socket: Pose::identity(),
            time: 0.0,
            grasp: [Vector3::zeros(); 2],
            monitor: ContactMonitor::default(),
            edge,
            phases: Vec::new(),
            trace: None,
            recorder: None,
        }
    }

    /// Returns a copy with the start shifted by `offset` metres along y, and by the shift of the conditions along x.
    pub fn shifted(&self, offset: f64) -> Attempt<'a> {
        let mut shifted = self.clone();
        // The socket is shifted the other way instead of the start. The part has not
        // touched it yet, so all offsets share grasp and approach.
        let Conditions { yaw, start_across, .. } = self.conditions;
        let socket = Pose::translation(-start_across, -offset, 0.0) * about_z(yaw);
        shifted.socket = about_z(-yaw) * Pose::translation(start_across, offset, 0.0);
        shifted.world.place(shifted.cell.socket, socket);
        // The phases so far ended at the start without a shift.
        let to_task = shifted.socket;
        shifted.phases.iter_mut().for_each(|phase| phase.transform(&to_task));
        shifted
    }

    /// Grasps the part, carries it to the start and runs the phases of the approach.
    pub fn prepare(&mut self) -> Result<(), Stop> {
        self.grasp()?;
        let position = Vector3::from(self.task.strategy.start);
        self.carry(Tcp { position, tilt: self.task.strategy.tilt })?;
        self.run_phases(|stage| stage == Stage::Approach)
    }

    /// Grasps the part.
    pub fn grasp(&mut self) -> Result<(), Stop> {
        self.with_coarse_step(Self::close_jaws)?;
        self.grasp = self.grasp_points();
        if self.task.grip.hold == Hold::Always {
            self.hold_jaws();
        }
        self.end_phase("grasp");
        self.world.place(self.cell.stand, Pose::translation(0.0, 0.0, -1.0));
        Ok(())
    }

    /// Lifts the part, tilts it and carries it to a target.
    fn carry(&mut self, to: Tcp) -> Result<(), Stop> {
        self.run_move(Move::with_duration(self.target, to, CARRY_S), self.rest_time())?;
        self.end_phase("carry");
        Ok(())
    }

    /// Closes the jaws.
    fn close_jaws(&mut self) -> Result<(), Stop> {
        let task = Arc::clone(&self.task);
        for i in 1..=self.steps(GRASP_S) {
            let time = i as f64 * self.world.step_s();
            for (side, hand) in self.cell.hands.iter().enumerate() {
                self.world.set_spring(hand.slide, 1, cell::closing(side, task.grip.force, time));
            }
            self.step()?;
        }
        Ok(())
    }

    /// Runs the phases of the stages that `selects` accepts.
    pub fn run_phases(&mut self, selects: impl Fn(Stage) -> bool) -> Result<(), Stop> {
        let task = Arc::clone(&self.task);
        let mut phases = task.strategy.phases.iter().filter(|phase| selects(phase.stage));
        phases.try_for_each(|phase| self.run_phase(phase))
    }

    /// Runs a phase to its end and records its end state.
    fn run_phase(&mut self, phase: &Phase) -> Result<(), Stop> {
        self.enter_stage(phase.stage);
        let (motion, steps) = self.begun.take().unwrap_or((self.motion(phase), 0));
        let end = match phase.ending {
            Ending::Duration(rest) => self.run_move(motion, rest.max(self.rest_time())),
            Ending::Tolerance(within) => self.reach(motion, within),
            Ending::Touch { preload, detection } => {
                self.touch((motion, steps), preload, detection, phase.speed)
            }
        };
        self.end_phase(&phase.name);
        end
    }

    /// Begins a stage; if the task requires it, the jaws are held from the assembly on.
    fn enter_stage(&mut self, stage: Stage) {
        let assembly = stage == Stage::Assembly && self.stage != stage;
        if assembly && self.task.grip.hold == Hold::Assembly {
            self.hold_jaws();
        }
        self.stage = stage;
    }

    /// Returns the move of a phase; in the assembly it is lengthened by the overtravel of the robot.
    fn motion(&self, phase: &Phase) -> Move {
        let mut displacement = Vector3::from(phase.displacement);
        if phase.stage == Stage::Assembly {
            let along = displacement.try_normalize(0.0).unwrap_or_default();
            displacement += along * self.robot.overtravel(&along);
        }
        Move::new(self.target, self.target.moved(displacement), phase.speed)
    }

    /// Holds the jaws at their position.
    fn hold_jaws(&mut self) {
        let flange = self.world.pose(self.cell.flange);
        for hand in self.cell.hands {
            let y = (flange.inverse() * self.world.pose(hand.jaw)).translation.y;
            self.world.set_spring(hand.slide, 1, cell::holding(y - hand.zero_y));
        }
    }

    /// Runs a move, then rests for a time, s.
    fn run_move(&mut self, motion: Move, rest: f64) -> Result<(), Stop> {
        for i in 1..=self.steps(motion.duration) {
            self.target = motion.at(i as f64 * self.world.step_s());
            self.step()?;
        }
        self.target = motion.at(f64::INFINITY);
        self.rest(rest)
    }

    /// Rests for a time, s.
    pub fn rest(&mut self, time: f64) -> Result<(), Stop> {
        self.with_coarse_step(|attempt| (0..attempt.steps(time)).try_for_each(|_| attempt.step()))
    }

    /// Runs `steps` with a longer time step, for times without commanded motion.
    fn with_coarse_step<T>(&mut self, steps: impl FnOnce(&mut Self) -> T) -> T {
        let fine = self.world.step_s();
        self.world.set_step(fine * COARSE);
        let result = steps(self);
        self.world.set_step(fine);
        result
    }

    /// Runs a move and waits until the TCP is within a tolerance of the target, m, at most for `TOLERANCE_TIMEOUT_S`.
    fn reach(&mut self, motion: Move, within: f64) -> Result<(), Stop> {
        self.run_move(motion, 0.0)?;
        for _ in 0..self.steps(TOLERANCE_TIMEOUT_S) {
            if (self.tcp() - self.target.position).amax() < within {
                break;
            }
            self.step()?;
        }
        Ok(())
    }

    /// Continues a move after `done` steps until the plug touches the socket, then pushes farther by the preload, m, at
    /// this speed, m/s.
    fn touch(
        &mut self,
        (motion, done): (Move, usize),
        preload: f64,
        detection: TouchDetection,
        speed: f64,
    ) -> Result<(), Stop> {
        let (start, end) = (motion.at(0.0), motion.at(f64::INFINITY));
        // A robot that lags its command may touch after the command has ended.
        let steps = self.steps(motion.duration + self.robot.settling_time());
        let mut left = self.steps(detection.latency);
        let mut felt = false;
        for i in done + 1..=steps {
            self.target = motion.at(i as f64 * self.world.step_s());
            self.step()?;
            felt = felt || self.socket_force().normal_sum > detection.force;
            if felt && left == 0 {
                break;
            }
            left -= usize::from(felt);
        }
        let along = (end.position - start.position).normalize();
        // From the actual TCP: otherwise the lag of a soft flange would add to the preload.
        let reached = along.dot(&(self.tcp() - start.position));
        let to = start.moved(along * (reached + preload));
        self.run_move(Move::new(self.target, to, speed), self.rest_time())
    }

    /// Simulates a step towards the target and updates the monitors.
    fn step(&mut self) -> Result<(), Stop> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(Stop::Interrupted);
        }
        self.world.drive(self.cell.command, self.target.pose());
        self.world.step().map_err(|Diverged| Stop::Diverged)?;
        let dt = self.world.step_s();
        self.time += dt;
        let contact = self.socket_force();
        self.monitor.update_force(&contact.net, dt);
        self.record(dt);
        self.check_grasp(dt)?;
        if self.stage == Stage::Search {
            self.monitor.entered = self.edge.inside(&self.pose(self.cell.plug));
        }
        if self.trace.is_some() {
            let sample = self.sample(&contact.net);
            self.trace.iter_mut().for_each(|trace| trace.record(sample));
        }
        if self.robot.stops(&self.monitor.force) { Err(Stop::ForceLimit) } else { Ok(()) }
    }

    /// Returns the state of the trial, with the net force of the socket on the plug, world axes, N.
    fn sample(&self, force: &Vector3<f64>) -> Sample {
        let placement = self.placement();
        let flange = self.pose(self.cell.flange);
        Sample {
            time_s: self.time,
            phase: self.phases.len() as u32,
            tcp_mm: (flange.translation.vector / MM).into(),
            tcp_tilt_deg: flange.rotation.scaled_axis().x / DEG,
            target_mm: ((self.socket * self.target.pose()).translation.vector / MM).into(),
            sensed_n: (self.socket.rotation * self.monitor.force).into(),
            tip_mm: (placement.tip / MM).into(),
            tilt_deg: placement.tilt / DEG,
            force_n: (self.socket.rotation * force).into(),
            slip_mm: self.slip() / MM,
        }
    }

    /// Returns the contact points of a body with the plug or its latch, task frame.
    fn touches(&self, body: BodyId) -> impl Iterator<Item = ContactPoint> {
        let parts = [self.cell.plug].into_iter().chain(self.cell.latch);
        let points = parts.flat_map(move |part| self.world.contact_points(body, part));
        points.map(|point| point.transformed(&self.socket))
    }

    /// Returns the contact force of the socket on the plug and its latch.
    fn socket_force(&self) -> ContactForce {
        let mut sum = self.world.contact(self.cell.socket, self.cell.plug);
        if let Some(latch) = self.cell.latch {
            let more = self.world.contact(self.cell.socket, latch);
            sum.net += more.net;
            sum.normal_sum += more.normal_sum;
        }
        sum
    }

    /// Records a frame if the recorder is due for one.
    fn record(&mut self, dt: f64) {
        let Some(mut taken) = self.recorder.take_if(|recorder| recorder.is_due(dt)) else { return };
        taken.frames.push(Frame {
            time_s: self.time,
            stage: self.stage,
            poses: self.poses(),
            jaws: self.cell.hands.map(|hand| self.pose(hand.jaw)),
            force: self.socket * self.monitor.force,
            slip: if self.phases.is_empty() { 0.0 } else { self.slip() },
            contacts: self.touches(self.cell.socket).collect(),
            grips: self.cell.hands.into_iter().flat_map(|hand| self.touches(hand.finger)).collect(),
        });
        self.recorder = Some(taken);
    }

    fn rest_time(&self) -> f64 {
        REST.max(self.robot.settling_time())
    }

    fn tcp(&self) -> Vector3<f64> {
        self.world.pose(self.cell.flange).translation.vector
    }

    /// Checks that the fingers hold the part and that it has not slipped beyond the limit.
    fn check_grasp(&mut self, dt: f64) -> Result<(), Stop> {
        if self.time < GRASP_S {
            return Ok(());
        }
        let pressed = |hand: Hand| self.world.contact(hand.finger, self.cell.plug).normal_sum;
        self.monitor.update_fingers(self.cell.hands.map(pressed), dt);
        let slipped = !self.phases.is_empty() && self.slip() > self.task.grip.slip_limit;
        if self.monitor.dropped() || slipped { Err(Stop::Lost) } else { Ok(()) }
    }

    /// Returns the pose of a body in the task frame, as if the start and not the socket were shifted and turned.
    fn pose(&self, body: BodyId) -> Pose {
        self.socket * self.world.pose(body)
    }

    fn poses(&self) -> Poses {
        let fingers = self.cell.hands.map(|hand| self.pose(hand.finger));
        let latch = self.cell.latch.map(|latch| self.pose(latch));
        Poses { plug: self.pose(self.cell.plug), latch, fingers }
    }

    fn placement(&self) -> Placement {
        Placement::new(&self.pose(self.cell.plug))
    }

    fn grasp_points(&self) -> [Vector3<f64>; 2] {
        let point = self.world.pose(self.cell.plug) * Point3::new(0.0, 0.0, self.task.grip.tcp_z);
        self.cell.hands.map(|hand| (self.world.pose(hand.finger).inverse() * point).coords)
    }

    /// Returns the slip of the part along the pads since the grasp, m: that at the finger with less slip, since
    /// the slip at a finger without contact is meaningless.
    fn slip(&self) -> f64 {
        let now = self.grasp_points();
        let along = |i: usize| {
            let moved = now[i] - self.grasp[i];
            libm::hypot(moved.x, moved.z)
        };
        along(0).min(along(1))
    }

    fn steps(&self, time: f64) -> usize {
        (time / self.world.step_s()).round() as usize
    }

    fn end_phase(&mut self, name: &str) {
        let placement = self.placement();
        let end = PhaseEnd {
            name: name.to_owned(),
            time_s: self.time,
            tip_mm: (placement.tip / MM).into(),
            tilt_deg: placement.tilt / DEG,
            slip_mm: self.slip() / MM,
            peak_force_n: self.monitor.phase_peak,
            poses: self.poses(),
            contacts: self.touches(self.cell.socket).collect(),
        };
        self.monitor.phase_peak = 0.0;
        self.phases.push(end);
    }

    /// Returns the outcome of an attempt that ended with `end`; `seated` as in [`FinalState`].
    fn outcome(&self, end: Result<(), Stop>, seated: bool) -> Outcome {
        if matches!(end, Err(Stop::Diverged | Stop::Interrupted)) {
            return Outcome::Diverged;
        }
        let lost_in = (end == Err(Stop::Lost)).then_some(self.stage);
        let entered = self.monitor.entered && !self.placement().astray(&self.task);
        classify(FinalState { seated, gripped: self.monitor.gripped(), lost_in, entered })
    }

    /// Returns the result of an attempt that ended with `end`, its samples and its frames.
    pub fn result(self, end: Result<(), Stop>) -> RecordedRun {
        let placement = self.placement();
        // A part in motion may still tip: only one at rest counts, or one that bottomed and stopped the robot.
        let held = matches!(end, Ok(()) | Err(Stop::ForceLimit));
        let seated = held && self.stage == Stage::Assembly && placement.seated(&self.task);
        let outcome = self.outcome(end, seated);
        let trial = Trial {
            outcome,
            margin: placement.margin(&self.task, outcome),
            depth_mm: -placement.tip.z / MM,
            tilt_deg: placement.tilt / DEG,
            peak_force_n: self.monitor.peak_force,
            slip_mm: self.slip() / MM,
            robot_stopped: end == Err(Stop::ForceLimit),
            simulated_s: self.time,
            phases: self.phases,
            retried: false,
        };
        let samples = self.trace.map_or_else(Vec::new, |trace| trace.samples);
        ((trial, samples), self.recorder.map_or_else(Vec::new, |recorder| recorder.frames))
    }
}

/// Returns the rotation about z by an angle, rad.
fn about_z(angle: f64) -> Pose {
    Pose::rotation(Vector3::z() * angle)
}
