//! Prediction of a study's fingers on the bench from measurements, kept beside the journal in
//! `bench.json`. It is found after the search, which does not know of it, and can be found again.

use super::config::BenchEffort;
use super::plausible;
use super::provenance::Provenance;
use input::files::{self, LARGEST_OWN};
use insertion::evaluation::Evaluation;
use insertion::outcome::FailureClass;
use insertion::space::{Design, Space};
use serde::{Deserialize, Serialize};
use std::path::Path;

pub(super) const BENCH_FILE: &str = "bench.json";

/// The prediction of a calibration for the fingers of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OnBench {
    /// Provenance of the prediction: of another it says nothing.
    pub provenance: Provenance,
    pub effort: BenchEffort,
    pub measured: usize,
    /// Those of them whose range was measured whole, and that range, mm.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ranges: Vec<(Design, f64)>,
    /// The others, and what they tolerate at the least, mm, if that is known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bounds: Vec<(Design, Option<f64>)>,
    /// Fingers of the space that were predicted.
    pub fingers: usize,
    pub trust: LeaveOneOut,
    /// Caveats, a line each.
    pub warnings: Vec<String>,
    /// The fingers of largest predicted range, best first; at least one.
    pub best: Vec<BenchFinger>,
    /// The first of them as simulated, with all as the task file says.
    pub simulated: Evaluation,
}

impl OnBench {
    /// The file in `dir`; `None` where it is missing, damaged or of another provenance: it can be
    /// made again.
    pub(super) fn read(dir: &Path, provenance: &Provenance, space: &Space) -> Option<OnBench> {
        let text = files::read_own(&dir.join(BENCH_FILE), LARGEST_OWN).ok()?;
        let found: OnBench = serde_json::from_str(&text).ok()?;
        let fits = |finger: &BenchFinger| plausible::off_the_space(&finger.design, space).is_none();
        let sound = !found.best.is_empty() && found.best.iter().all(fits);
        let sound = sound && plausible::implausible(&found.simulated).is_none();
        (found.provenance == *provenance && sound).then_some(found)
    }
}

/// The measured fingers, each predicted without it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeaveOneOut {
    pub fingers: usize,
    /// Mean of `|predicted - measured| / measured`, percent.
    pub mean_deviation_percent: Option<f64>,
    pub spearman: Option<f64>,
    /// How many lie in their 80 % intervals.
    pub inside: usize,
    /// Root mean square error of the simulator's stand-in, mm.
    pub emulator_error_mm: f64,
}

/// A finger's predicted bench range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BenchFinger {
    pub design: Design,
    /// Mean of its range, mm.
    pub range_mm: f64,
    /// Lower end of the 80 % interval.
    pub low_mm: f64,
    /// Upper end.
    pub high_mm: f64,
    /// Probability of its being the best of the space, 0 to 1.
    pub probability_best: f64,
    /// How it fails below and above its window.
    pub failures: [Option<FailureClass>; 2],
}
