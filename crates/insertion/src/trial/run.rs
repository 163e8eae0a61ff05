//! Trials in a contact engine, repeated at half the step if they diverge.

use super::attempt::driven::Driven;
use super::attempt::{Attempt, Stop};
use super::record::{Frame, Recorder, Trace};
use super::{Followed, Grasp, Grasped, Recording, Rig, Trajectory, Trial, cell};
use crate::robot::MountedRobot;
use crate::{Finger, Outcome, Part, Phase, Robot, Solid, Stage, Task};
use contact::{Engine, Unsupported};
use input::units::N_PER_MM;
use nalgebra::Vector3;
use std::sync::{Arc, OnceLock};

/// Task, robot at its start, and an engine that supports both.
pub struct EngineRig {
    /// Task of the trials.
    pub task: Task,
    robot: Arc<MountedRobot>,
    engine: Box<dyn Engine>,
}

/// Error of a robot or an engine that does not support a task.
#[derive(Debug, thiserror::Error)]
pub enum RigError {
    /// The robot does not support the task: names of robot and task, and the reason.
    #[error("the robot `{0}` on the task `{1}`: {2}")]
    Robot(String, String, String),
    /// The engine does not support robot and task.
    #[error(transparent)]
    Engine(#[from] Unsupported),
}

impl EngineRig {
    /// Creates the rig for fingers of the paper's model.
    ///
    /// # Errors
    /// If the robot or the engine does not support the task.
    pub fn new(task: Task, robot: &Robot, engine: Box<dyn Engine>) -> Result<Self, RigError> {
        // Whether a scene is supported does not depend on the stiffness of the fingers.
        let any = Finger::new(N_PER_MM, N_PER_MM).with_model(&task.finger, 0.0);
        Self::with(task, robot, &any, engine)
    }

    /// Creates the rig, and checks that the engine supports fingers of this kind.
    ///
    /// # Errors
    /// If the robot or the engine does not support the task.
    pub fn with(
        task: Task,
        robot: &Robot,
        finger: &Finger,
        engine: Box<dyn Engine>,
    ) -> Result<Self, RigError> {
        let refused = |problem| RigError::Robot(robot.name.clone(), task.name.clone(), problem);
        let mounted = robot.mount(task.turn, task.strategy.tilt);
        let mounted = mounted.map_err(|error| refused(error.to_string()))?;
        let extra = |phase: &Phase| match Vector3::from(phase.displacement).try_normalize(0.0) {
            Some(along) if phase.stage == Stage::Assembly => mounted.overtravel(&along).abs(),
            _ => 0.0,
        };
        task.strategy.check_time(extra, mounted.settling_time()).map_err(refused)?;
        engine.supports(&cell::build(&task, &mounted, finger).scene)?;
        Ok(EngineRig { task, robot: Arc::new(mounted), engine })
    }

    /// Returns an attempt after grasp and approach.
    fn prepare<'a>(&self, engine: &dyn Engine, grasp: Grasp<'a>, recorded: bool) -> Prepared<'a> {
        let mut attempt = Attempt::new(&self.robot, &self.task, engine, grasp);
        attempt.recorder = recorded.then(Recorder::default);
        let end = attempt.prepare();
        Prepared { attempt, end, descended: OnceLock::new() }
    }

    fn grasp_with_retry<'a>(&'a self, grasp: Grasp<'a>, recorded: bool) -> GraspWithRetry<'a> {
        let prepared = self.prepare(&*self.engine, grasp, recorded);
        GraspWithRetry { rig: self, grasp, recorded, prepared, halved: OnceLock::new() }
    }
}

/// Half of the width of the plate of the friction probe, m: no plug gets near its rim.
const PLATE: f64 = 0.1;

/// Returns the task with a plate in the socket's place, its top at z = 0.
fn on_plate(task: &Task) -> Task {
    let half = Vector3::new(PLATE, PLATE, 0.0);
    let solid = Solid::Box { min: -half - Vector3::z() * PLATE, max: half };
    let plate = Part { name: "plate".to_owned(), solid, friction: None };
    Task { socket: vec![plate], mating_force: None, ..task.clone() }
}

impl Rig for EngineRig {
    fn grasp<'a>(&'a self, grasp: Grasp<'a>) -> Box<dyn Grasped + 'a> {
        Box::new(self.grasp_with_retry(grasp, false))
    }

    fn record(&self, grasp: Grasp<'_>, offset: f64) -> Option<Recording> {
        let ((trial, _), frames) =
            self.grasp_with_retry(grasp, true).run_with_retry(offset, None, 0.0);
        Some(Recording::new(trial, frames))
    }

    fn follow(&self, grasp: Grasp<'_>, each: &[&Trajectory]) -> Vec<Followed> {
        let mut held = Attempt::new(&self.robot, &self.task, &*self.engine, grasp);
        let grasped = held.grasp();
        let followed = each.iter().map(|trajectory| {
            let mut attempt = held.clone();
            let end = grasped.and_then(|()| attempt.follow(trajectory));
            attempt.result(end).0
        });
        followed.collect()
    }

    fn probe(&self, grasp: Grasp<'_>) -> Option<Followed> {
        let task = on_plate(&self.task);
        let mut attempt = Attempt::new(&self.robot, &task, &*self.engine, grasp);
        let end = attempt.grasp().and_then(|()| attempt.probe());
        Some(attempt.result(end).0)
    }

    fn driven(&self, finger: &Finger) -> Option<Driven> {
        let prepared = self.prepare(&*self.engine, Grasp::of(finger), false);
        Some(Driven::new(prepared.attempt, prepared.end))
    }
}

/// Attempt right before the search, with the inputs to repeat it at half the step.
struct GraspWithRetry<'a> {
    rig: &'a EngineRig,
    grasp: Grasp<'a>,
    recorded: bool,
    prepared: Prepared<'a>,
    /// Attempt at half the time step, once a trial has diverged.
    halved: OnceLock<Prepared<'a>>,
}

impl Grasped for GraspWithRetry<'_> {
    fn run(&self, offset: f64, every_s: Option<f64>, rest_s: f64) -> Followed {
        self.run_with_retry(offset, every_s, rest_s).0
    }
}

/// Trial with samples from the search on, and frames from the grasp on; samples and frames are empty unless requested.
pub(super) type RecordedRun = (Followed, Vec<Frame>);

impl GraspWithRetry<'_> {
    fn run_with_retry(&self, offset: f64, every_s: Option<f64>, rest_s: f64) -> RecordedRun {
        let first = self.prepared.run(offset, every_s, rest_s);
        if first.0.0.outcome != Outcome::Diverged {
            return first;
        }
        let again =
            || self.rig.prepare(&*self.rig.engine.with_half_step(), self.grasp, self.recorded);
        let ((trial, samples), frames) =
            self.halved.get_or_init(again).run(offset, every_s, rest_s);
        ((Trial { retried: true, ..trial }, samples), frames)
    }
}

/// Attempt right before the search; every offset starts from a copy.
struct Prepared<'a> {
    attempt: Attempt<'a>,
    /// Result of grasp and approach.
    end: Result<(), Stop>,
    /// Attempt after the shared descent, if there is one.
    descended: OnceLock<Option<Attempt<'a>>>,
}

impl Prepared<'_> {
    fn run(&self, offset: f64, every_s: Option<f64>, rest_s: f64) -> RecordedRun {
        let observed = every_s.is_some() || self.attempt.recorder.is_some();
        let descended = || self.descended.get_or_init(|| self.attempt.descended()).as_ref();
        let shared = if observed || self.end.is_err() { None } else { descended() };
        let mut attempt = shared.unwrap_or(&self.attempt).shifted(offset);
        // The sensor is zeroed once the robot is at rest.
        let end = self.end.and_then(|()| attempt.rest(rest_s));
        attempt.trace = every_s.map(Trace::new);
        let frames = attempt.recorder.iter_mut().flat_map(|recorder| &mut recorder.frames);
        frames.for_each(|frame| frame.transform(&attempt.socket));
        let end = end.and_then(|()| attempt.rest(rest_s));
        let end = end.and_then(|()| attempt.run_phases(|stage| stage != Stage::Approach));
        attempt.result(end)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Sample;
    use super::*;
    use crate::evaluation::tolerance::{Search, evaluate};
    use crate::tests::fixtures::{finger, refused, rig, robot, robot_file, task, task_file};
    use contact::World;
    use contact::direct::Direct;
    use contact::scene::Scene;
    use std::sync::atomic::{AtomicBool, Ordering};

    /// Engine that diverges until its step has been halved this number of times.
    #[derive(Clone, Copy)]
    struct Fragile {
        direct: Direct,
        halvings: u32,
    }

    impl Engine for Fragile {
        fn version(&self) -> String {
            "fragile".to_owned()
        }

        fn world(&self, scene: &Scene) -> Box<dyn World> {
            let broken = Direct { contact_stiffness: f64::NAN, ..self.direct };
            if self.halvings == 0 { self.direct.world(scene) } else { broken.world(scene) }
        }

        fn with_half_step(&self) -> Box<dyn Engine> {
            let direct = Direct { step_s: 0.5 * self.direct.step_s, ..self.direct };
            Box::new(Fragile { direct, halvings: self.halvings - 1 })
        }
    }

    fn trial(engine: Box<dyn Engine>) -> Trial {
        let rig = EngineRig::new(task("ket8"), &robot("servo"), engine).unwrap();
        rig.grasp(Grasp::of(&finger(2.6, 45.0))).trial(0.0)
    }

    #[test]
    fn a_trial_ends_at_once_when_it_is_to_stop() {
        let (rig, stop) = (rig(task("ket8")), AtomicBool::new(true));
        let grasp = Grasp { stop: &stop, ..Grasp::of(&finger(2.6, 45.0)) };
        let at_once = rig.grasp(grasp).trial(0.0);
        assert_eq!((at_once.outcome, at_once.simulated_s), (Outcome::Diverged, 0.0));
        stop.store(false, Ordering::SeqCst);
        let grasped = rig.grasp(grasp);
        stop.store(true, Ordering::SeqCst);
        let after_the_grasp = grasped.trial(0.0);
        assert!(after_the_grasp.simulated_s < 1.5, "nothing but grasp and approach");
        assert_eq!(rig.record(grasp, 0.0).unwrap().trial.simulated_s, 0.0);
    }

    #[test]
    fn a_protective_stop_is_reported_whatever_the_outcome() {
        let usb = task("usb");
        let soft = finger(1.18, 52.4).with_model(&usb.finger, 0.0);
        // Without a stop the push ends with 107 N; from 85 N on the plug is seated.
        for (stop_force, stopped, inserted) in
            [(150.0, false, true), (100.0, true, true), (30.0, true, false)]
        {
            let limited = Robot { stop_force, ..robot("servo") };
            let rig = EngineRig::new(usb.clone(), &limited, Box::<Direct>::default()).unwrap();
            let trial = rig.grasp(Grasp::of(&soft)).trial(0.0);
            let found = (trial.robot_stopped, trial.outcome == Outcome::Inserted);
            assert_eq!(found, (stopped, inserted), "{stop_force} N: {trial:?}");
        }
        let weak = Robot { stop_force: 30.0, ..robot("servo") };
        let rig = EngineRig::new(usb, &weak, Box::<Direct>::default()).unwrap();
        let found = evaluate(&rig, &soft, Search::Strides);
        assert_eq!((found.robot_stops, found.trials, found.nominal_stop()), (1, 1, true));
    }

    #[test]
    fn a_robot_that_takes_too_long_to_follow_is_refused() {
        let ur5e = robot_file("ur5e");
        let slow = ur5e.text.replace("damping_nms_per_rad = ", "damping_nms_per_rad = 1000");
        let robot = Robot::parse(&slow, ur5e.file).unwrap();
        let rig = EngineRig::new(task("ket8"), &robot, Box::<Direct>::default());
        refused(rig, &["at most 60 s is accepted"]);
    }

    #[test]
    fn what_diverges_is_run_once_more_at_half_the_step() {
        let fragile = |halvings| Box::new(Fragile { direct: Direct::default(), halvings });
        let sound = trial(fragile(0));
        assert_eq!((sound.outcome, sound.retried), (Outcome::Inserted, false));
        let fine = trial(Direct::default().with_half_step());
        let mended = trial(fragile(1));
        assert_eq!(mended, Trial { retried: true, ..fine });
        let lost = trial(fragile(2));
        assert_eq!((lost.outcome, lost.retried), (Outcome::Diverged, true));
    }

    #[test]
    fn samples_change_nothing_and_end_where_the_trial_ends() {
        let rig = rig(task("ket8"));
        let grasped = rig.grasp(Grasp::of(&finger(2.6, 45.0)));
        let (trial, samples) = grasped.run(0.0, Some(1e-3), 0.0);
        assert_eq!(trial, grasped.trial(0.0));
        let last = samples.last().unwrap();
        let apart = |pair: &[Sample]| pair[1].time_s - pair[0].time_s;
        assert!(samples.windows(2).all(|pair| (apart(pair) - 1e-3).abs() < 1e-8));
        assert!((last.tip_mm[2] + trial.depth_mm).abs() < 1e-2, "{last:?}");
        assert!((trial.simulated_s - last.time_s) < 2e-3);
    }

    #[test]
    fn starts_that_share_the_way_down_are_the_same_trials() {
        let slow = "speed_mm_per_s = 20.0";
        let usb = task_file("usb");
        assert!(usb.text.contains(slow));
        for speed in [slow, "speed_mm_per_s = 2000.0"] {
            let text = usb.text.replace(slow, speed);
            let rig = rig(Task::parse(&text, usb.file).unwrap());
            let prepared = rig.prepare(&Direct::default(), Grasp::of(&finger(2.6, 45.0)), false);
            assert!(speed != slow || prepared.attempt.descended().is_some());
            // A trial with samples goes all the way by itself.
            for offset in [-2.5e-3, 0.0, 4e-3] {
                let trial = prepared.run(offset, None, 0.0).0.0;
                assert_eq!(
                    trial,
                    prepared.run(offset, Some(1e-3), 0.0).0.0,
                    "{speed} at {offset} m"
                );
            }
        }
    }

    #[test]
    fn a_recorded_trial_is_the_same_trial() {
        let (rig, finger) = (rig(task("ket8")), finger(2.6, 45.0));
        let recording = rig.record(Grasp::of(&finger), 5e-4).unwrap();
        assert_eq!(recording.trial, rig.grasp(Grasp::of(&finger)).trial(5e-4));
        let frames = &recording.frames;
        let last = frames.last().unwrap();
        assert!(recording.decided_s <= last.time_s, "an outcome that no frame shows");
        assert!((last.depth_mm() - recording.trial.depth_mm).abs() < 0.01);
        // The socket is pushed the way the plug goes, and the points carry the whole force.
        let pushed = frames.iter().map(|frame| frame.force.norm()).fold(0.0, f64::max);
        assert!(pushed > 0.9 * recording.trial.peak_force_n, "{pushed}");
        let pushes = |frame: &Frame| frame.contacts.first().is_some_and(|c| c.force.z > 0.0);
        assert!(frames.iter().any(pushes));
        // The grip bends both fingers outward.
        let held = frames.iter().find(|frame| frame.time_s > 0.29).unwrap();
        let bent = |finger: usize| held.jaws[finger].inverse() * held.poses.fingers[finger];
        let [left, right] = [0, 1].map(|finger| bent(finger).translation.y);
        assert!(left < -1e-4 && right > 1e-4, "{left} and {right} m");
        // The shift of the start is the same before and after the robot comes to the socket.
        let jump = |pair: &[Frame]| {
            let [a, b] = [&pair[0], &pair[1]].map(|f| f.poses.plug.translation.vector);
            (a - b).norm()
        };
        assert!(frames.windows(2).all(|pair| jump(pair) < 2e-3));
    }
}
