//! Simulation of logged attempts along their commanded trajectories, and the data that are compared.

use super::curves::{Curves, STEP_S};
use super::log::{Ended, Log, LogSample, Run};
use super::question::Identification;
use super::smoother::{Datum, Predicted};
use super::touch::{bias, touch};
use input::units::MM;
use insertion::evaluation::evaluator::Specimen;
use insertion::evaluation::template::Impossible;
use insertion::outcome::Outcome;
use insertion::robot::Robot;
use insertion::space::Design;
use insertion::trial::{Course, Grasp, Trajectory};
use nalgebra::Vector3;
use parameters::Parameter;
use std::ops::Range;

/// Replayed time before the touch, s.
const AIR_S: f64 = 0.5;
/// Points per datum: 10 ms.
const POINTS: usize = 5;
/// Model error of a force: drift of the sensor, N, and share of the force.
const FORCE_N: f64 = 0.5;
const FORCE_SHARE: f64 = 0.1;
/// Model error of a pose: repeatability of a small arm, m, and share of the distance from its target.
const POSE: f64 = 0.03 * MM;
const POSE_SHARE: f64 = 0.1;
/// Forces below which there is no contact and above which there is, N, and the number of data for which they
/// differ in an event: 30 ms.
const LOST_N: f64 = 1.5;
const HAD_N: f64 = 4.0;
const EVENT: usize = 3;

/// Part of an attempt, for reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    Search,
    Push,
}

/// Logged attempt, prepared for replay.
#[derive(Debug, Clone)]
pub struct Logged {
    pub file: String,
    pub design: Design,
    pub offset: f64,
    pub ended: Ended,
    pub curves: Curves,
    trajectory: Trajectory,
    /// Index of the touch, the first compared point.
    pub touch: usize,
    /// Index of the beginning of the push.
    pub push: usize,
}

impl Logged {
    /// Returns the attempt of a run; `None` for one that touches nothing, or for a probe.
    pub fn new(run: &Run) -> Option<Self> {
        let touched = touch(&run.log).filter(|_| run.ended != Ended::Probe)?;
        let touched_s = run.log.samples[touched].time_s;
        let before = |sample: &LogSample| sample.time_s < touched_s - AIR_S;
        // Motion in the air gives no information.
        let from = run.log.samples.partition_point(before);
        let log = Log::new(&run.log.file, run.log.samples[from..].to_vec()).ok()?;
        let curves = Curves::of_log(&log, bias(&run.log));
        let since = touched_s - log.samples[0].time_s;
        let trajectory = curves.trajectory()?;
        Some(Logged {
            file: run.log.file.clone(),
            design: run.design.clone(),
            offset: run.offset,
            ended: run.ended,
            touch: (since / STEP_S) as usize,
            push: (trajectory.push_start() / STEP_S) as usize,
            curves,
            trajectory,
        })
    }

    /// Returns the attempt with the measured trajectory of the TCP as the commanded one.
    pub fn along_measured(&self) -> Option<Self> {
        let curves = Curves { target: None, ..self.curves.clone() };
        Some(Logged { trajectory: curves.trajectory()?, curves, ..self.clone() })
    }

    /// Returns the points of each datum.
    fn bins(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let bins = (self.curves.tcp.len() - self.touch.min(self.curves.tcp.len())) / POINTS;
        (0..bins).map(|i| self.touch + i * POINTS..self.touch + (i + 1) * POINTS)
    }

    /// Returns the phase of each datum.
    pub fn phases(&self) -> impl Iterator<Item = Phase> + '_ {
        let phase =
            |bin: Range<usize>| if bin.start < self.push { Phase::Search } else { Phase::Push };
        self.bins().flat_map(move |bin| std::iter::repeat_n(phase(bin), self.each()))
    }

    /// Returns the numbers per datum: three of the force, and three of the distance from the target.
    pub fn each(&self) -> usize {
        if self.curves.target.is_some() { 6 } else { 3 }
    }

    /// Returns the measured data.
    pub fn data(&self) -> Vec<Datum> {
        let off = off(&self.curves);
        let datum = |bin: Range<usize>| {
            let force = mean(&self.curves.force, &bin);
            let sd = libm::hypot(FORCE_N, FORCE_SHARE * force.norm());
            let forces = force.iter().map(|&value| Datum { value, sd }).collect::<Vec<_>>();
            let poses = off.iter().map(|off| mean(off, &bin)).flat_map(|off| {
                let sd = libm::hypot(POSE, POSE_SHARE * off.norm());
                [0, 1, 2].map(|i| Datum { value: off[i], sd })
            });
            forces.into_iter().chain(poses).collect::<Vec<_>>()
        };
        self.bins().flat_map(datum).collect()
    }

    /// Returns the simulated data, up to the first contact that is made or lost in only one of the two.
    pub fn predicted(&self, replayed: &Curves) -> Predicted {
        let off = off(replayed);
        let (mut apart, mut over) = (0, false);
        let datum = |bin: Range<usize>| {
            over = over || bin.end > replayed.force.len();
            if over {
                return vec![None; self.each()];
            }
            let [mine, other] =
                [&self.curves.force, &replayed.force].map(|force| mean(force, &bin));
            let differ =
                mine.norm().min(other.norm()) < LOST_N && mine.norm().max(other.norm()) > HAD_N;
            apart = if differ { apart + 1 } else { 0 };
            over = apart >= EVENT;
            let poses = off.iter().take(self.each() / 6).map(|off| mean(off, &bin));
            let all = [other].into_iter().chain(poses);
            all.flat_map(|vector| [0, 1, 2].map(|i| Some(vector[i]))).collect()
        };
        self.bins().flat_map(datum).collect()
    }
}

/// Returns the distance of the TCP from its target, if that is known.
fn off(curves: &Curves) -> Option<Vec<Vector3<f64>>> {
    let target = curves.target.as_ref()?;
    Some(curves.tcp.iter().zip(target).map(|(tcp, target)| tcp - target).collect())
}

fn mean(points: &[Vector3<f64>], bin: &Range<usize>) -> Vector3<f64> {
    points[bin.clone()].iter().sum::<Vector3<f64>>() / bin.len() as f64
}

impl Identification<'_> {
    /// Returns curves and outcomes of attempts with these values, on a robot and with a factor on the time step of
    /// the engine; each finger is grasped once.
    pub(super) fn replayed(
        &self,
        (robot, step_factor): (&Robot, f64),
        attempts: &[Logged],
        values: &[(&Parameter, f64)],
    ) -> Result<Vec<(Curves, Outcome)>, Impossible> {
        let Identification { evaluator, template, .. } = self;
        let mut all = Vec::with_capacity(attempts.len());
        for alike in attempts.chunk_by(|a, b| a.design == b.design) {
            let (specimen, _) = evaluator.apply(template, (&alike[0].design, None), values)?;
            let Specimen { task, finger, .. } = &specimen;
            let rig = evaluator.engine.rig(task, robot, finger, step_factor)?;
            let grasp = Grasp { stop: self.stop, ..Grasp::of(&specimen.finger) };
            let trajectories: Vec<_> = alike.iter().map(|logged| &logged.trajectory).collect();
            let followed = rig.follow(grasp, Course::Trajectories(&trajectories), STEP_S);
            all.extend(followed.into_iter().map(|(trial, samples)| {
                (Curves::of_samples(&samples, self.tool_mass), trial.outcome)
            }));
        }
        Ok(all)
    }
}
