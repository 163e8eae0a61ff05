//! Reads back what measurements say of a study's fingers.

use super::fits;
use super::on_bench::{BenchFinger, OnBench};
use super::provenance::Provenance;
use input::files::{self, LARGEST_OWN};
use insertion::space::Space;
use std::path::Path;

/// Name of the file.
pub(super) const BENCH_FILE: &str = "bench.json";

/// The file in `dir`; `None` where it is missing, damaged or of another provenance: it can be made
/// again.
pub(super) fn read(dir: &Path, provenance: &Provenance, space: &Space) -> Option<OnBench> {
    let text = files::read_own(&dir.join(BENCH_FILE), LARGEST_OWN).ok()?;
    let found: OnBench = serde_json::from_str(&text).ok()?;
    let fits = |finger: &BenchFinger| fits::off_the_space(&finger.design, space).is_none();
    let sound = !found.best.is_empty() && found.best.iter().all(fits);
    let sound = sound && fits::implausible(&found.simulated).is_none();
    (found.provenance == *provenance && sound).then_some(found)
}
