//! Evidence for an answer: robot measurements of its finger or of similar ones.

use calibration::published::{BENCH, of_task};
use calibration::rank_correlation::errors_percent;
use insertion::space::Design;
use insertion::stiffness::{Measurement, designs};
use study::{Recorded, StudyRecord};

/// Finger whose tolerable range was measured on a robot: its design and that range, mm.
pub type MeasuredFinger = (Design, f64);

/// Evidence for an answer.
#[derive(Debug, Clone, PartialEq)]
pub enum Trust {
    /// Calibrated on the user's measurements.
    Calibrated {
        /// Number of measured fingers.
        fingers: usize,
        /// Mean leave-one-out error, percent, if it is known.
        error_percent: Option<f64>,
    },
    /// Simulated on tasks with published measurements.
    Published {
        /// For each task the finger itself, if it was measured, or the measured fingers of the most similar stiffness,
        /// nearest first.
        nearest: Vec<(String, Vec<MeasuredFinger>)>,
    },
    /// Simulated only.
    Simulated {
        /// Smallest and largest mean error of the simulation on the published tasks, percent.
        error_percent: [f64; 2],
    },
}

/// Number of similar fingers that are listed.
const SIMILAR: usize = 2;

impl Trust {
    pub(super) fn of(record: &StudyRecord, finger: Option<&Recorded>) -> Self {
        if let Some(found) = &record.on_bench {
            let error_percent = found.trust.mean_deviation_percent;
            return Trust::Calibrated { fingers: found.measured, error_percent };
        }
        let nearest = |task| {
            // The published fingers were measured with the published strategies.
            let finger = finger?;
            let fingers = if finger.design.changes_task() { Vec::new() } else { published(task) };
            let named = nearest(fingers, finger);
            Some((String::from(task), (!named.is_empty()).then_some(named)?))
        };
        match record.config.tasks().map(nearest).collect() {
            Some(nearest) => Trust::Published { nearest },
            None => Trust::Simulated { error_percent: errors_percent() },
        }
    }

    /// Returns the label of the evidence.
    pub fn label(&self) -> &'static str {
        match self {
            Trust::Calibrated { fingers: 1, .. } => "corrected by one measured finger",
            Trust::Calibrated { .. } => "calibrated on measured fingers",
            Trust::Published { .. } => "simulated; similar fingers measured",
            Trust::Simulated { .. } => "simulated only",
        }
    }

    /// Returns the name of the evidence in JSON.
    pub fn key(&self) -> &'static str {
        match self {
            Trust::Calibrated { .. } => "calibrated",
            Trust::Published { .. } => "published",
            Trust::Simulated { .. } => "simulated",
        }
    }

    /// Returns a clause that states the evidence.
    pub fn reason(&self) -> String {
        match self {
            Trust::Calibrated { fingers, error_percent } => {
                let missed = error_percent
                    .map_or(String::new(), |error| format!(", leave-one-out error {error:.1} %"));
                format!("{} measured{missed}", input::counted(*fingers, "finger"))
            }
            Trust::Published { nearest } => {
                let itself = nearest.iter().all(|(_, fingers)| fingers.len() == 1);
                let who = if itself { "this finger" } else { "similar fingers" };
                let several = nearest.len() > 1;
                let of = |(task, fingers): &(String, Vec<MeasuredFinger>)| {
                    let on = if several { format!(" on {task}") } else { String::new() };
                    format!("{}{on}", ranges(fingers))
                };
                let all: Vec<String> = nearest.iter().map(of).collect();
                format!("{who} had {} on a robot", all.join(", "))
            }
            Trust::Simulated { error_percent: [least, most] } => {
                format!("the simulation error was {least:.0} to {most:.0} % on the shipped tasks")
            }
        }
    }
}

/// Returns the measured range of a finger, mm, if it is among the measured ones.
pub(super) fn range_mm(measured: &[MeasuredFinger], finger: &Design) -> Option<f64> {
    measured.iter().find(|(design, _)| design == finger).map(|(_, range_mm)| *range_mm)
}

/// Returns the ranges in words: `4.7 and 4.9 mm`.
fn ranges(fingers: &[MeasuredFinger]) -> String {
    let mut mm: Vec<String> =
        fingers.iter().map(|(_, range_mm)| format!("{range_mm:.1}")).collect();
    mm.dedup();
    format!("{} mm", mm.join(" and "))
}

/// Returns the fingers with published measurements on a task, with their stiffness; empty for a user's own task.
pub(super) fn published(task: &str) -> Vec<(MeasuredFinger, Measurement)> {
    let bench = of_task(task, BENCH);
    let one = |measurement: Measurement| {
        let design = Design::infill(measurement.density_percent, measurement.direction_deg);
        let range_mm = bench.iter().find(|found| found.design == design)?.range_mm?;
        Some(((design, range_mm), measurement))
    };
    designs().into_iter().filter_map(one).collect()
}

/// Returns the finger itself, if it was measured, else those of the most similar stiffness, nearest first
/// (the simulation distinguishes fingers by stiffness only).
fn nearest(mut all: Vec<(MeasuredFinger, Measurement)>, finger: &Recorded) -> Vec<MeasuredFinger> {
    if let Some((itself, _)) = all.iter().find(|((design, _), _)| *design == finger.design) {
        return vec![itself.clone()];
    }
    let finger = &finger.stiffness;
    let distance = |(_, found): &(MeasuredFinger, Measurement)| {
        let [compliance, assembly] = [
            libm::log(found.compliance / finger.compliance.mean),
            libm::log(found.assembly / finger.assembly.mean),
        ];
        libm::hypot(compliance, assembly)
    };
    all.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    all.into_iter().take(SIMILAR).map(|(measured, _)| measured).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_evidence_is_the_finger_itself_if_it_was_measured_else_those_of_similar_stiffness() {
        let record = StudyRecord::load("../../tests/fixtures/study".as_ref()).unwrap();
        let mut finger = record.best().unwrap().clone();
        let ranges = |finger: &Recorded| -> Vec<f64> {
            nearest(published("usb"), finger).iter().map(|(_, range_mm)| *range_mm).collect()
        };
        finger.design = Design::infill(20.0, 20.0);
        assert_eq!(ranges(&finger), [4.1]);
        // This finger was not measured; designs 8 and 11 have similar stiffness.
        finger.design = Design::infill(27.0, 39.0);
        finger.stiffness = insertion::surrogate::Prediction::exact(3.65e3, 31e3);
        assert_eq!(ranges(&finger), [5.0, 5.6]);
        assert!(published("mine").is_empty());
    }
}
