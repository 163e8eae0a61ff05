//! Rig with a closed-form window, for tests of the code that runs trials.
//!
//! Offsets within `[-(2 + 4 / k), 1 + a / 50 + (21 - r) / 10]` mm insert, with `k` and `a` the
//! stiffness in the compliance and assembly directions in N/mm and `r` the distance of the remote
//! centre in mm; below, the plug jams, and above, it misses the opening. The lower end is divided by
//! the factor on the plug-socket friction. Both ends move inward by 1 mm per degree of yaw and of
//! tilt of the start, by the shift of the start along x and by the downward shift of the part in the
//! gripper, and outward by the added clearance.

use crate::trial::{Conditions, Followed, Grasped};
use crate::{FailureClass, Finger, Grasp, Outcome, Rig, Trial};
use input::units::{DEG, MM, N_PER_MM};
use std::sync::atomic::Ordering;

/// Rig with the closed-form window.
#[derive(Debug, Clone, Copy, Default)]
pub struct FakeRig {
    /// Wall-clock time of each trial, for tests that interrupt a study.
    pub delay: std::time::Duration,
}

/// Environment variable of [`FakeRig::delay`], microseconds.
const DELAY: &str = "FINGER_OPT_FAKE_DELAY_US";

impl FakeRig {
    /// Creates the rig with the delay of the environment variable.
    pub fn from_environment() -> Self {
        let delay = std::env::var(DELAY).ok().and_then(|text| text.parse().ok());
        FakeRig { delay: std::time::Duration::from_micros(delay.unwrap_or(0)) }
    }
}

impl Rig for FakeRig {
    fn grasp<'a>(&'a self, grasp: Grasp<'a>) -> Box<dyn Grasped + 'a> {
        Box::new((*self, grasp))
    }
}

/// Returns the most negative and the most positive inserting offset, mm.
pub fn window_mm(finger: &Finger, conditions: &Conditions) -> (f64, f64) {
    let compliance = finger.compliance / N_PER_MM;
    let assembly = finger.assembly / N_PER_MM;
    let rcc = finger.rcc / MM;
    let angle = conditions.yaw.abs() + conditions.start_tilt.abs();
    let distance = conditions.start_across.abs() + conditions.grasp_low;
    let inward = angle / DEG + distance / MM - conditions.clearance / MM;
    let low = -(2.0 + 4.0 / compliance) / conditions.friction_socket;
    let high = 1.0 + assembly / 50.0 + (21.0 - rcc) / 10.0;
    (whole_nanometres(low + inward), whole_nanometres(high - inward))
}

/// Rounds a length, mm, to nanometres: a shift of 14 steps is 1.4 mm, not 1.4000000000000001.
fn whole_nanometres(mm: f64) -> f64 {
    (mm * 1e6).round() / 1e6
}

impl Grasped for (FakeRig, Grasp<'_>) {
    fn run(&self, offset: f64, _: Option<f64>, _: f64) -> Followed {
        let (FakeRig { delay }, grasp) = *self;
        let (low, high) = window_mm(&grasp.finger, &grasp.conditions);
        let stopped = grasp.stop.load(Ordering::Relaxed);
        if !stopped {
            std::thread::sleep(delay);
        }
        let offset_mm = whole_nanometres(offset / MM);
        let outcome = match offset_mm {
            _ if stopped => Outcome::Diverged,
            below if below < low => Outcome::Failed(FailureClass::Jammed),
            above if above > high => Outcome::Failed(FailureClass::PlugMissed),
            _ => Outcome::Inserted,
        };
        // Signed distance to the nearer end, mm, as the margin.
        let margin = (offset_mm - low).min(high - offset_mm).clamp(-1.0, 1.0);
        let trial = Trial {
            outcome,
            margin,
            depth_mm: if outcome == Outcome::Inserted { 12.0 } else { 0.0 },
            tilt_deg: 0.0,
            peak_force_n: 5.0 + offset_mm.abs(),
            slip_mm: 0.1,
            robot_stopped: false,
            phases: Vec::new(),
            simulated_s: 1.0,
            retried: false,
        };
        (trial, Vec::new())
    }
}

/// Closed-form rig whose trials are altered by a function of grasp, offset (m) and trial.
pub struct Altered<F>(pub F);

impl<F: Fn(&Grasp, f64, Trial) -> Trial + Send + Sync> Rig for Altered<F> {
    fn grasp<'a>(&'a self, grasp: Grasp<'a>) -> Box<dyn Grasped + 'a> {
        Box::new((self, grasp))
    }
}

impl<F: Fn(&Grasp, f64, Trial) -> Trial + Send + Sync> Grasped for (&Altered<F>, Grasp<'_>) {
    fn run(&self, offset: f64, _: Option<f64>, _: f64) -> Followed {
        let (Altered(alter), grasp) = self;
        let trial = FakeRig::default().grasp(*grasp).trial(offset);
        (alter(grasp, offset, trial), Vec::new())
    }
}
