//! One attempt at an insertion: the phases, step by step, and what is watched on the way.

use super::cell::{self, Cell};
use super::classify::{Facts, classify};
use super::motion::{Move, Tcp};
use super::{PhaseEnd, Poses, Trial};
use crate::input::robot::Mounted;
use crate::input::task::{Ending, Hold, Phase, Stage, Task};
use crate::outcome::{FailureClass, Outcome};
use crate::physics::{Diverged, World};
use crate::scene::{BodyId, Pose};
use crate::units::{DEG, MM};
use nalgebra::{Point3, Vector3};
use std::sync::Arc;

/// Time for the jaws to close and the fingers to come to rest, s.
const GRASP_TIME: f64 = 0.3;
/// Time to lift, tilt and carry the part to the start, s.
const CARRY_TIME: f64 = 0.2;
/// A finger that is off for this long has let go, s: longer than a bounce.
const LOSS_TIME: f64 = 0.02;
/// A finger that presses with less is off, N.
const LOSS_FORCE: f64 = 0.01;
/// Time constant of the force filter, s, as of a wrist sensor: a single step's
/// impact is numerics, not a force that a part feels.
const FORCE_FILTER: f64 = 0.005;
/// A tolerance-based move that is not there by then is stuck, s after its command ended.
const TOLERANCE_TIMEOUT: f64 = 1.0;
/// The leading edge is inside when it is this far below the socket's top, m:
/// more than contacts sink, less than any preload.
const ENTERED_DEPTH: f64 = 0.15 * MM;
/// Rest after a move that has no settling time of its own, s.
const SETTLE: f64 = 0.03;
/// First contact, N.
const TOUCH_FORCE: f64 = 0.05;

/// Why a run ends early.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Stop {
    Lost,
    ForceLimit,
    Diverged,
}

impl From<Diverged> for Stop {
    fn from(_: Diverged) -> Self {
        Stop::Diverged
    }
}

pub(super) struct Run<'a> {
    robot: &'a Mounted,
    /// The task under the conditions of this run.
    task: Arc<Task>,
    pub cell: Cell,
    pub world: Box<dyn World>,
    target: Tcp,
    stage: Stage,
    /// Turn of the socket, rad.
    pub yaw: f64,
    /// From the world to the socket.
    pub socket: Pose,
    time: f64,
    /// Grasp point in each finger's frame right after the grasp.
    grasp: [Vector3<f64>; 2],
    /// Filtered net force plug-socket, N.
    force: Vector3<f64>,
    peak_force: f64,
    phase_peak: f64,
    /// For how long each finger has been off, s.
    loose_for: [f64; 2],
    entered: bool,
    corners: Vec<Point3<f64>>,
    phases: Vec<PhaseEnd>,
}

impl<'a> Run<'a> {
    pub fn new(robot: &'a Mounted, task: Arc<Task>, cell: Cell, world: Box<dyn World>) -> Self {
        let pose = world.pose(cell.command);
        let corners = task.plug.parts.iter().flat_map(|part| part.solid.corners()).collect();
        Run {
            robot,
            task,
            cell,
            world,
            target: Tcp { position: pose.translation.vector, tilt: 0.0 },
            stage: Stage::Approach,
            yaw: 0.0,
            socket: Pose::identity(),
            time: 0.0,
            grasp: [Vector3::zeros(); 2],
            force: Vector3::zeros(),
            peak_force: 0.0,
            phase_peak: 0.0,
            loose_for: [0.0; 2],
            entered: false,
            corners,
            phases: Vec::new(),
        }
    }

    pub fn copy(&self) -> Run<'a> {
        Run {
            robot: self.robot,
            task: Arc::clone(&self.task),
            cell: self.cell.clone(),
            world: self.world.snapshot(),
            corners: self.corners.clone(),
            phases: self.phases.clone(),
            ..*self
        }
    }

    /// Grasp, lift, tilt, carry to the start, and the approach through the air.
    pub fn prepare(&mut self) -> Result<(), Stop> {
        let task = Arc::clone(&self.task);
        for i in 1..=self.steps(GRASP_TIME) {
            let time = i as f64 * self.world.step_s();
            for (side, hand) in self.cell.hands.iter().enumerate() {
                self.world.set_spring(hand.slide, 1, cell::closing(side, task.grip.force, time));
            }
            self.step()?;
        }
        self.grasp = self.grasp_points();
        if task.grip.hold == Hold::Always {
            self.hold();
        }
        self.end_phase("grasp");
        self.world.place(self.cell.stand, Pose::translation(0.0, 0.0, -1.0));
        let [x, y, z] = task.strategy.start;
        let start = Tcp { position: Vector3::new(x, y, z), tilt: task.strategy.tilt };
        self.follow(Move::lasting(self.target, start, CARRY_TIME), self.settle())?;
        self.end_phase("carry");
        for phase in task.strategy.phases.iter().filter(|phase| phase.stage == Stage::Approach) {
            self.phase(phase)?;
        }
        Ok(())
    }

    pub fn search_and_assemble(&mut self) -> Result<(), Stop> {
        let task = Arc::clone(&self.task);
        for phase in task.strategy.phases.iter().filter(|p| p.stage != Stage::Approach) {
            self.phase(phase)?;
        }
        Ok(())
    }

    fn phase(&mut self, phase: &Phase) -> Result<(), Stop> {
        if phase.stage == Stage::Assembly
            && self.stage != Stage::Assembly
            && self.task.grip.hold == Hold::Assembly
        {
            self.hold();
        }
        self.stage = phase.stage;
        let mut displacement = Vector3::from(phase.displacement);
        if phase.stage == Stage::Assembly {
            let along = displacement.try_normalize(0.0).unwrap_or_default();
            displacement += along * self.robot.lead(&along);
        }
        let to = self.target.moved(displacement);
        let motion = Move::new(self.target, to, phase.speed);
        let end = match phase.ending {
            Ending::Duration(settle) => self.follow(motion, settle.max(self.settle())),
            Ending::Tolerance(within) => self.reach(motion, within),
            Ending::Touch { preload } => self.touch(motion, preload),
        };
        self.end_phase(&phase.name);
        end
    }

    /// The jaws stay where they are from now on.
    fn hold(&mut self) {
        let flange = self.world.pose(self.cell.flange);
        for hand in self.cell.hands {
            let y = (flange.inverse() * self.world.pose(hand.jaw)).translation.y;
            self.world.set_spring(hand.slide, 1, cell::holding(y - hand.zero_y));
        }
    }

    /// Commands a move and then waits.
    fn follow(&mut self, motion: Move, settle: f64) -> Result<(), Stop> {
        let steps = self.steps(motion.duration() + settle);
        for i in 1..=steps {
            self.target = motion.at(i as f64 * self.world.step_s());
            self.step()?;
        }
        Ok(())
    }

    /// Commands a move and waits until the TCP is there, as near as asked.
    fn reach(&mut self, motion: Move, within: f64) -> Result<(), Stop> {
        self.follow(motion, 0.0)?;
        for _ in 0..self.steps(TOLERANCE_TIMEOUT) {
            if (self.tcp() - self.target.position).amax() < within {
                break;
            }
            self.step()?;
        }
        Ok(())
    }

    /// Moves until the plug touches the socket, then on by the preload.
    fn touch(&mut self, motion: Move, preload: f64) -> Result<(), Stop> {
        let (start, end) = (motion.at(0.0), motion.at(f64::INFINITY));
        // A robot that trails its command touches after it has ended.
        let steps = self.steps(motion.duration() + self.robot.settling());
        for i in 1..=steps {
            self.target = motion.at(i as f64 * self.world.step_s());
            self.step()?;
            if self.contact_force() > TOUCH_FORCE {
                break;
            }
        }
        let along = (end.position - start.position).normalize();
        let speed = (end.position - start.position).norm() / motion.duration();
        // From where the TCP is, not from its command: a soft flange lags behind,
        // and the lag would come on top of the preload.
        let reached = along.dot(&(self.tcp() - start.position));
        let to = start.moved(along * (reached + preload));
        self.follow(Move::new(self.target, to, speed), self.settle())
    }

    /// One step of the command, the engine and the monitors.
    fn step(&mut self) -> Result<(), Stop> {
        self.world.drive(self.cell.command, self.target.pose());
        self.world.step()?;
        let dt = self.world.step_s();
        self.time += dt;
        let contact = self.world.contact(self.cell.socket, self.cell.plug);
        self.force += (contact.net - self.force) * (dt / FORCE_FILTER);
        self.peak_force = self.peak_force.max(self.force.norm());
        self.phase_peak = self.phase_peak.max(self.force.norm());
        self.watch_grasp(dt)?;
        self.watch_entry();
        if self.robot.stops(&self.force) { Err(Stop::ForceLimit) } else { Ok(()) }
    }

    /// Shortest rest after a move, s.
    fn settle(&self) -> f64 {
        SETTLE.max(self.robot.settling())
    }

    fn tcp(&self) -> Vector3<f64> {
        self.world.pose(self.cell.flange).translation.vector
    }

    fn contact_force(&self) -> f64 {
        self.world.contact(self.cell.socket, self.cell.plug).normal_sum
    }

    fn watch_grasp(&mut self, dt: f64) -> Result<(), Stop> {
        if self.time < GRASP_TIME {
            return Ok(());
        }
        for (hand, loose_for) in self.cell.hands.iter().zip(&mut self.loose_for) {
            let pressed = self.world.contact(hand.finger, self.cell.plug).normal_sum;
            *loose_for = if pressed < LOSS_FORCE { *loose_for + dt } else { 0.0 };
        }
        let dropped = self.loose_for.iter().all(|&time| time > LOSS_TIME);
        let slipped = !self.phases.is_empty() && self.slip() > self.task.grip.slip_limit;
        if dropped || slipped { Err(Stop::Lost) } else { Ok(()) }
    }

    fn watch_entry(&mut self) {
        if self.stage == Stage::Search {
            self.entered = self.entered || self.leading_edge_inside();
        }
    }

    /// Whether the part lies where it belongs now.
    fn seated(&self) -> bool {
        let success = self.task.success;
        let tip = self.tip();
        // Deep beside the socket is not inserted.
        let inside = within(tip.x, self.task.opening[0]) && within(tip.y, self.task.opening[1]);
        inside && -tip.z >= success.depth && self.tilt() <= success.tilt
    }

    /// How clearly it ended so; see [`Trial::margin`].
    fn margin(&self, outcome: Outcome) -> f64 {
        let success = self.task.success;
        let deep = (-self.tip().z - success.depth) / success.depth;
        let upright = (success.tilt - self.tilt()) / success.tilt;
        let margin = deep.min(upright).clamp(-1.0, 1.0);
        match outcome {
            Outcome::Inserted => margin.max(0.0),
            // Lost before it came to the socket: nothing is nearer to success for being deeper.
            Outcome::Failed(FailureClass::ContactLossBeforeSearch) => -1.0,
            Outcome::Failed(_) => margin.min(0.0),
            Outcome::Diverged => 0.0,
        }
    }

    /// A body in the task frame: as if the start, not the socket, were shifted and turned.
    fn pose(&self, body: BodyId) -> Pose {
        self.socket * self.world.pose(body)
    }

    fn plug(&self) -> Pose {
        self.pose(self.cell.plug)
    }

    fn poses(&self) -> Poses {
        let fingers = self.cell.hands.map(|hand| self.pose(hand.finger));
        Poses { plug: self.plug(), fingers }
    }

    fn tip(&self) -> Vector3<f64> {
        self.plug().translation.vector
    }

    fn tilt(&self) -> f64 {
        (self.plug() * Vector3::z()).z.clamp(-1.0, 1.0).acos()
    }

    fn leading_edge_inside(&self) -> bool {
        let plug = self.plug();
        let lowest = self.corners.iter().map(|p| plug * p).min_by(|a, b| a.z.total_cmp(&b.z));
        let [x, y] = self.task.opening;
        lowest.is_some_and(|p| p.z < -ENTERED_DEPTH && within(p.x, x) && within(p.y, y))
    }

    fn grasp_points(&self) -> [Vector3<f64>; 2] {
        let point = self.world.pose(self.cell.plug) * Point3::new(0.0, 0.0, self.task.grip.tcp_z);
        self.cell.hands.map(|hand| (self.world.pose(hand.finger).inverse() * point).coords)
    }

    /// How far the part has moved along the pads since the grasp, m: along the
    /// pad of the finger it moved less on, since a finger that is off says nothing.
    fn slip(&self) -> f64 {
        let now = self.grasp_points();
        let along = |i: usize| {
            let moved = now[i] - self.grasp[i];
            moved.x.hypot(moved.z)
        };
        along(0).min(along(1))
    }

    fn steps(&self, time: f64) -> usize {
        (time / self.world.step_s()).round() as usize
    }

    fn end_phase(&mut self, name: &str) {
        let end = PhaseEnd {
            name: name.to_owned(),
            time_s: self.time,
            tip_mm: (self.tip() / MM).into(),
            tilt_deg: self.tilt() / DEG,
            slip_mm: self.slip() / MM,
            peak_force_n: self.phase_peak,
            poses: self.poses(),
        };
        self.phase_peak = 0.0;
        self.phases.push(end);
    }

    pub fn result(self, end: Result<(), Stop>) -> Trial {
        // Judged at rest after the push, or where a bottomed part stopped the robot:
        // a part that only passes through a good pose may tip on.
        let held = matches!(end, Ok(()) | Err(Stop::ForceLimit));
        let facts = Facts {
            seated: held && self.stage == Stage::Assembly && self.seated(),
            gripped: self.loose_for.iter().all(|&time| time <= LOSS_TIME),
            lost_in: (end == Err(Stop::Lost)).then_some(self.stage),
            entered: self.entered,
        };
        let diverged = end == Err(Stop::Diverged);
        let outcome = if diverged { Outcome::Diverged } else { classify(facts) };
        Trial {
            outcome,
            margin: self.margin(outcome),
            depth_mm: -self.tip().z / MM,
            tilt_deg: self.tilt() / DEG,
            peak_force_n: self.peak_force,
            slip_mm: self.slip() / MM,
            simulated_s: self.time,
            phases: self.phases,
            retried: false,
        }
    }
}

/// A turn about z, rad.
pub(super) fn turned(angle: f64) -> Pose {
    Pose::rotation(Vector3::z() * angle)
}

fn within(value: f64, [from, to]: [f64; 2]) -> bool {
    from <= value && value <= to
}
