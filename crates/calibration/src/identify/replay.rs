//! Simulation of logged attempts along their commanded trajectories, and the data in which both are compared: means of
//! force and pose over bins of the curves.

use super::curves::{Curves, STEP_S, mean};
use super::log::{Log, LogSample, Run};
use super::question::Identification;
use super::smoother::{Datum, Predicted};
use super::touch::{bias, touch};
use input::units::MM;
use insertion::trial::Trajectory;
use insertion::{Design, DesignError, Grasp, Outcome, Robot, Scenario};
use nalgebra::Vector3;
use parameters::Parameter;
use std::ops::Range;

/// Simulated time before the touch, s.
const AIR_S: f64 = 0.5;
/// Points of the curves per bin: 10 ms.
const BIN: usize = 5;
/// Constant part of the standard deviation of a force, N: drift of the sensor.
const FORCE_N: f64 = 0.5;
/// Proportional part of it, as a fraction of the force: model error.
const FORCE_SHARE: f64 = 0.1;
/// Constant part of the standard deviation of a pose, m: repeatability of a small arm.
const POSE: f64 = 0.03 * MM;
/// Proportional part of it, as a fraction of the distance from the target: model error.
const POSE_SHARE: f64 = 0.1;
/// Force below which there is certainly no contact, N.
const NO_CONTACT_N: f64 = 1.5;
/// Force above which there is certainly contact, N.
const CONTACT_N: f64 = 4.0;
/// Number of successive bins with contact in only one of measurement and simulation that ends the comparison: 30 ms.
const APART_BINS: usize = 3;

/// Logged attempt, prepared for replay.
#[derive(Debug, Clone)]
pub struct Logged {
    pub file: String,
    pub design: Design,
    /// Shift of the start along y, m.
    pub offset: f64,
    /// Outcome on the robot.
    pub outcome: Outcome,
    pub curves: Curves,
    trajectory: Trajectory,
    /// Index of the touch, the first compared point.
    pub touch: usize,
    /// Index of the beginning of the push.
    pub push: usize,
}

impl Logged {
    /// Prepares the attempt of a run; `None` for a probe, or if nothing is touched or the log after it is too short.
    pub fn new(run: &Run) -> Option<Self> {
        let (outcome, touched) = run.outcome.zip(touch(&run.log))?;
        let touched_s = run.log.samples[touched].time_s;
        let before = |sample: &LogSample| sample.time_s < touched_s - AIR_S;
        // Motion in the air gives no information.
        let from = run.log.samples.partition_point(before);
        let log = Log::new(&run.log.file, run.log.samples[from..].to_vec()).ok()?;
        let curves = Curves::of_log(&log, bias(&run.log));
        let since = touched_s - log.samples[0].time_s;
        let trajectory = curves.trajectory()?;
        let (file, design) = (run.log.file.clone(), run.design.clone());
        let touch = (since / STEP_S) as usize;
        let push = (trajectory.push_start() / STEP_S) as usize;
        Some(Logged { file, design, offset: run.offset, outcome, touch, push, curves, trajectory })
    }

    /// Returns the attempt with the measured trajectory of the TCP as the commanded one.
    pub fn along_measured(&self) -> Option<Self> {
        let curves = Curves { target: None, ..self.curves.clone() };
        Some(Logged { trajectory: curves.trajectory()?, curves, ..self.clone() })
    }

    /// Returns the bins, as ranges of points from the touch on.
    fn bins(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let bins = self.curves.tcp.len().saturating_sub(self.touch) / BIN;
        (0..bins).map(|i| self.touch + i * BIN..self.touch + (i + 1) * BIN)
    }

    /// Returns the phase of each datum, `search` or `push`.
    pub fn phases(&self) -> impl Iterator<Item = &'static str> + '_ {
        let phase = |bin: Range<usize>| if bin.start < self.push { "search" } else { "push" };
        self.bins().flat_map(move |bin| std::iter::repeat_n(phase(bin), self.data_per_bin()))
    }

    /// Returns the number of data per bin: three of the force, and three of the deviation from the target, if recorded.
    pub fn data_per_bin(&self) -> usize {
        if self.curves.target.is_some() { 6 } else { 3 }
    }

    /// Returns the measured data.
    pub fn data(&self) -> Vec<Datum> {
        let offsets = offsets(&self.curves);
        let datum = |bin: Range<usize>| {
            let force = mean(&self.curves.force[bin.clone()]);
            let sd = libm::hypot(FORCE_N, FORCE_SHARE * force.norm());
            let forces = force.iter().map(|&value| Datum { value, sd }).collect::<Vec<_>>();
            let poses =
                offsets.iter().map(|offsets| mean(&offsets[bin.clone()])).flat_map(|offset| {
                    let sd = libm::hypot(POSE, POSE_SHARE * offset.norm());
                    [0, 1, 2].map(|i| Datum { value: offset[i], sd })
                });
            forces.into_iter().chain(poses).collect::<Vec<_>>()
        };
        self.bins().flat_map(datum).collect()
    }

    /// Returns the simulated data; `None` from where contact differs between measurement and simulation, or where the
    /// simulation has ended.
    pub fn predicted(&self, replayed: &Curves) -> Predicted {
        let offsets = offsets(replayed);
        let (mut apart, mut over) = (0, false);
        let datum = |bin: Range<usize>| {
            over = over || bin.end > replayed.force.len();
            if over {
                return vec![None; self.data_per_bin()];
            }
            let [measured, simulated] =
                [&self.curves.force, &replayed.force].map(|force| mean(&force[bin.clone()]));
            let (a, b) = (measured.norm(), simulated.norm());
            apart = if a.min(b) < NO_CONTACT_N && a.max(b) > CONTACT_N { apart + 1 } else { 0 };
            over = apart >= APART_BINS;
            let offsets = offsets.iter().take(self.data_per_bin() / 6);
            let poses = offsets.map(|offsets| mean(&offsets[bin.clone()]));
            let all = [simulated].into_iter().chain(poses);
            all.flat_map(|vector| [0, 1, 2].map(|i| Some(vector[i]))).collect()
        };
        self.bins().flat_map(datum).collect()
    }
}

/// Returns the deviations of the TCP from its target, m, if the target is recorded.
fn offsets(curves: &Curves) -> Option<Vec<Vector3<f64>>> {
    let target = curves.target.as_ref()?;
    Some(curves.tcp.iter().zip(target).map(|(tcp, target)| tcp - target).collect())
}

impl Identification<'_> {
    /// Simulates attempts with these values on a robot, with a factor on the time step of the engine; each finger
    /// grasps the plug once for all its attempts, which are grouped by finger.
    pub(super) fn replayed(
        &self,
        (robot, step_factor): (&Robot, f64),
        attempts: &[Logged],
        values: &[(&Parameter, f64)],
    ) -> Result<Vec<(Curves, Outcome)>, DesignError> {
        let Identification { evaluator, template, .. } = self;
        let mut all = Vec::with_capacity(attempts.len());
        for alike in attempts.chunk_by(|a, b| a.design == b.design) {
            let scenario = evaluator.apply(template, (&alike[0].design, None), values)?;
            let scenario = Scenario { robot: robot.clone(), ..scenario };
            let rig = evaluator.rig(&scenario, None, step_factor)?;
            let grasp = Grasp { stop: self.stop, ..Grasp::of(&scenario.finger) };
            let trajectories: Vec<_> = alike.iter().map(|logged| &logged.trajectory).collect();
            all.extend(rig.follow(grasp, &trajectories).into_iter().map(|(trial, samples)| {
                (Curves::of_samples(&samples, self.tool_mass), trial.outcome)
            }));
        }
        Ok(all)
    }
}
