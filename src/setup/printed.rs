//! Finger to print, and its stiffness predicted from measured fingers.

use super::files::DEFAULT_FINGER;
use super::files::{find, stiffness_data, surrogate};
use super::finger::InfillRequest;
use crate::failure::Failure;
use finray::geometry::Geometry;
use finray::printed::PrintedFinger;
use input::files::shell_word;
use input::shipped::FINGERS;
use insertion::finger::file::{infill, is_shape};
use insertion::{DENSITY_KEY, DIRECTION_KEY, Design, FingerFile, Prediction};
use report::answer::{Answer, words};
use std::path::{Path, PathBuf};
use study::StudyRecord;

/// Finger to print: the best of a study, or with a given infill.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct PrintRequest {
    /// Folder of a study: its recommended design
    #[arg(value_name = "DIR", conflicts_with_all = ["density", "direction"])]
    pub dir: Option<PathBuf>,
    /// Infill, unless a study is given.
    #[command(flatten)]
    pub infill: InfillRequest,
    /// Finger: finray9, or the path of a finger file [default: the study's, or finray9]
    #[arg(long, value_name = "NAME")]
    pub finger: Option<String>,
    /// Position of the first rib, mm [default: as in the finger file]
    #[arg(long, value_name = "MM")]
    pub phase_mm: Option<f64>,
}

/// Chosen finger.
pub struct PrintChoice {
    /// Geometry of the finger.
    pub geometry: Geometry,
    /// Notes on the finger of a study: which one it is, which one the headline of the study names instead, and whether
    /// the study is unfinished.
    pub notes: Vec<String>,
    design: Design,
    file: FingerFile,
    /// Stiffness that a study predicted.
    of_study: Option<Prediction>,
}

impl PrintChoice {
    /// Returns the stiffness predicted by the stiffness model of the study, else by that of the finger file; `None` if
    /// the finger file names no table of measured fingers.
    ///
    /// # Errors
    /// If the table is invalid.
    pub fn predicted_stiffness(&self) -> Result<Option<Prediction>, Failure> {
        let of_file = || predicted_stiffness(&self.file.finger, &self.design);
        self.of_study.map_or_else(of_file, |found| Ok(Some(found)))
    }
}

impl PrintRequest {
    /// Returns the finger.
    ///
    /// # Errors
    /// If a file is invalid, the study recommends no design, or the finger cannot be built.
    pub fn chosen(&self) -> Result<PrintChoice, Failure> {
        let (design, file, of_study, notes) = match &self.dir {
            Some(dir) => best(dir)?,
            None => {
                let [density, direction] =
                    self.infill.required(", or DIR, the folder of a study")?;
                (Design::infill(density, direction), None, None, Vec::new())
            }
        };
        let file = match (&self.finger, file) {
            (None, Some(file)) => file,
            (named, _) => finger_file(named.as_deref().unwrap_or(DEFAULT_FINGER))?,
        };
        let geometry = Geometry::new(&file.with(&design)?, &infill(&design, self.phase_mm))
            .map_err(Failure::input)?;
        let of_study = of_study.filter(|_| self.finger.is_none());
        Ok(PrintChoice { geometry, notes, design, file, of_study })
    }
}

/// Reads the finger file of that name or at that path.
///
/// # Errors
/// If it is invalid.
pub(crate) fn finger_file(name: &str) -> Result<FingerFile, Failure> {
    let source = find("finger", FINGERS, name)?;
    FingerFile::parse(&source.text, &source.file).map_err(Failure::input)
}

/// Returns the stiffness predicted by the stiffness model of a finger file; `None` if the file names no table of
/// measured fingers, for an infill outside the model, or for another shape than the measured one.
pub(crate) fn predicted_stiffness(
    finger: &PrintedFinger,
    design: &Design,
) -> Result<Option<Prediction>, Failure> {
    let infill = [DENSITY_KEY, DIRECTION_KEY].map(|key| design.get(key));
    let ([Some(density), Some(direction)], Some(_), false) =
        (infill, &finger.measured, design.0.keys().any(|key| is_shape(key)))
    else {
        return Ok(None);
    };
    Ok(surrogate(&stiffness_data(None, finger)?, finger)?.predict([density, direction]).ok())
}

/// Recommended design of a study, its finger file, its stiffness, if the design was evaluated, and notes on it.
type Best = (Design, Option<FingerFile>, Option<Prediction>, Vec<String>);

fn best(dir: &Path) -> Result<Best, Failure> {
    let record = StudyRecord::load(dir)?;
    let answer = Answer::of(&record);
    let Some(best) = answer.verdict.finger() else {
        let problem = "the study recommends no design; give --density and --direction";
        return Err(Failure::usage(format!("{}: {problem}", dir.display())));
    };
    let by = if record.on_bench.is_some() { "simulation and measurements" } else { "simulation" };
    let dir = shell_word(dir.display());
    let mut notes = vec![format!("exports {}, recommended by {by}", words::design(best))];
    let other = answer.use_now().filter(|other| other.design != *best);
    notes.extend(other.and_then(|other| {
        let [density, direction] = [DENSITY_KEY, DIRECTION_KEY].map(|key| other.design.get(key));
        let options = format!("--density {} --direction {}", density?, direction?);
        Some(format!("{}; export it with {options} instead of {dir}", words::use_now(&other)))
    }));
    let unfinished = || format!("the study is unfinished: optimize resume {dir}");
    notes.extend(record.unfinished().then(unfinished));
    let found = record.current().iter().find(|recorded| recorded.design == *best);
    let stiffness = found.map(|recorded| recorded.stiffness);
    Ok((best.clone(), record.finger.clone(), stiffness, notes))
}
