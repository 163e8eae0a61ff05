//! Levers, capture maps and another robot of the finger that a study names, kept in its folder beside
//! the journal.

use crate::failure::Failure;
use ::report::answer::{Answer, UnderRobot};
use analysis::levers::Levers;
use analysis::map::CaptureMap;
use input::files::{self, LARGEST_OWN};
use insertion::space::Design;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::Path;
use study::{Provenance, StudyRecord, write_own_file};

pub(crate) const LEVERS: &str = "levers.json";
pub(crate) const MAPS: &str = "maps.json";
pub(crate) const ROBOTS: &str = "robots.json";

/// Analyses of the recommended finger beside its window.
#[derive(Debug, Clone, Default)]
pub struct Around {
    /// Its levers, if they were measured.
    pub levers: Option<Levers>,
    /// How insertions end over two errors of the start.
    pub maps: Vec<CaptureMap>,
    /// Its window under the robot of the study and under one as different, if the task is one's own.
    pub robots: Vec<UnderRobot>,
}

/// A file, and what it is of.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept<T> {
    provenance: Provenance,
    design: Design,
    found: T,
}

impl Around {
    /// Reads the analyses of the recommended finger from the folder of a study.
    pub(crate) fn read(dir: &Path, record: &StudyRecord) -> Self {
        let Some((provenance, design)) = subject(record) else { return Around::default() };
        let levers: Option<Levers> = read(&dir.join(LEVERS), (&provenance, &design));
        Around {
            // The span of the infill is that of all evaluations until now.
            levers: levers.map(|found| Levers {
                infill: record.spread_mm().unwrap_or(found.infill),
                ..found
            }),
            maps: read(&dir.join(MAPS), (&provenance, &design)).unwrap_or_default(),
            robots: read(&dir.join(ROBOTS), (&provenance, &design)).unwrap_or_default(),
        }
    }
}

/// The finger that a study of one task names, and what it was measured by.
pub(crate) fn subject(record: &StudyRecord) -> Option<(Provenance, Design)> {
    let design = Answer::of(record).verdict.finger()?.clone();
    let one = !record.config.several_tasks() && record.config.objective.single().is_some();
    let provenance = record.segments.last()?.provenance.clone();
    one.then_some((provenance, design))
}

/// Reads a file; `None` where it is missing, damaged or of something else.
fn read<T: DeserializeOwned>(
    path: &Path,
    (provenance, design): (&Provenance, &Design),
) -> Option<T> {
    let text = files::read_own(path, LARGEST_OWN).ok()?;
    let kept: Kept<T> = serde_json::from_str(&text).ok()?;
    (kept.provenance == *provenance && kept.design == *design).then_some(kept.found)
}

pub(crate) fn write<T: Serialize>(
    path: &Path,
    (provenance, design): (&Provenance, &Design),
    found: &T,
) -> Result<(), Failure> {
    let kept = Kept { provenance: provenance.clone(), design: design.clone(), found };
    let text = serde_json::to_string(&kept)
        .map_err(|error| Failure::running(format!("{}: {error}", path.display())))?;
    Ok(write_own_file(path, &(text + "\n"))?)
}
