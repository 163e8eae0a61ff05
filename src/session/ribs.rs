//! A finger as its ribs make it, to be computed or to be printed, and how stiff measured ones are.

use super::Failure;
use super::files::{find, printed_finger, stiffness_data, surrogate};
use super::finger::setting;
use super::request::DEFAULT_FINGER;
use finray::geometry::Geometry;
use finray::mechanics::{self, FingerStiffness};
use finray::printed::PrintedFinger;
use input::shipped::FINGERS;
use insertion::finger::file::{FingerFile, is_shape};
use insertion::space::{DENSITY_KEY, DIRECTION_KEY, Design};
use insertion::surrogate::{Model, Prediction};
use report::answer::Answer;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use study::StudyRecord;

/// Which finger to compute.
#[derive(Debug, Clone, clap::Args)]
pub struct RibsRequest {
    /// Infill density, percent
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true)]
    pub density: f64,
    /// Infill direction, degrees
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    pub direction: f64,
    /// Finger: finray9, or the path of a finger file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_FINGER)]
    pub finger: String,
    /// Where the first rib lies, mm [default: the finger file's]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub phase_mm: Option<f64>,
    /// A number of the finger file, as finger.skin.thickness_mm=0.8; may be given several times
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    pub set: Vec<(String, f64)>,
}

/// The ribs, the stiffness that they give, and that of the model of measured fingers.
pub type Ribs = (Geometry, FingerStiffness, Option<Prediction>);

impl RibsRequest {
    /// The ribs, the stiffness that they give, and that of the model of measured fingers, if there is
    /// one for this infill and `set` changes no shape.
    pub fn run(&self) -> Result<Ribs, Failure> {
        if let Some((key, _)) = self.set.iter().find(|(key, _)| !is_shape(key)) {
            return Err(Failure::usage(format!(
                "--set {key}: sets no number of a finger file, as finger.skin.thickness_mm does"
            )));
        }
        let set = Design(self.set.iter().cloned().collect());
        let file = finger_file(&self.finger)?;
        let finger = file.with(&set).map_err(Failure::input)?;
        let infill = Design::infill(self.density, self.direction).printed(self.phase_mm);
        let geometry = Geometry::new(&finger, &infill).map_err(Failure::input)?;
        let computed = mechanics::compute(&geometry).map_err(Failure::input)?;
        let mut design = Design::infill(self.density, self.direction);
        design.0.extend(set.0);
        Ok((geometry, computed, measured_model(&file.finger, &design)?))
    }
}

/// Which finger to print: the best of a study, or of an infill.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct PrintRequest {
    /// Folder of a study: its best design
    #[arg(value_name = "DIR", conflicts_with_all = ["density", "direction"],
          required_unless_present = "density")]
    pub dir: Option<PathBuf>,
    /// Infill density, percent
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true, requires = "direction")]
    pub density: Option<f64>,
    /// Infill direction, degrees
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, requires = "density")]
    pub direction: Option<f64>,
    /// Finger: finray9, or the path of a finger file [default: the study's, or finray9]
    #[arg(long, value_name = "NAME")]
    pub finger: Option<String>,
    /// Where the first rib lies, mm [default: the finger file's]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub phase_mm: Option<f64>,
}

impl PrintRequest {
    /// Its ribs.
    ///
    /// # Errors
    /// If a file cannot be used, the study recommends nothing, or there is no such finger.
    pub fn geometry(&self) -> Result<Geometry, Failure> {
        let (design, file, _) = self.chosen()?;
        let finger = file.with(&design).map_err(Failure::input)?;
        Geometry::new(&finger, &design.printed(self.phase_mm)).map_err(Failure::input)
    }

    /// Its stiffness by the model of measured fingers: as the study predicted it, else by the table
    /// that the finger file names. `None` if there is none.
    ///
    /// # Errors
    /// As of [`PrintRequest::geometry`].
    pub fn measured_model(&self) -> Result<Option<Prediction>, Failure> {
        let (design, file, of_study) = self.chosen()?;
        of_study.map_or_else(|| measured_model(&file.finger, &design), |found| Ok(Some(found)))
    }

    /// The design, the file of its finger, and the stiffness that a study predicted of both.
    fn chosen(&self) -> Result<(Design, FingerFile, Option<Prediction>), Failure> {
        let (design, file, stiffness) = match (&self.dir, self.density, self.direction) {
            (Some(dir), ..) => best(dir)?,
            (None, Some(density), Some(direction)) => {
                (Design::infill(density, direction), None, None)
            }
            _ => {
                let problem = "give the folder of a study, or --density and --direction";
                return Err(Failure::usage(problem));
            }
        };
        let file = match (&self.finger, file) {
            (None, Some(file)) => file,
            (named, _) => finger_file(named.as_deref().unwrap_or(DEFAULT_FINGER))?,
        };
        Ok((design, file, stiffness.filter(|_| self.finger.is_none())))
    }
}

fn finger_file(name: &str) -> Result<FingerFile, Failure> {
    let source = find("finger", FINGERS, name)?;
    FingerFile::parse(&source.text, &source.file).map_err(Failure::input)
}

/// Stiffness by the model that is fitted to the table of measured fingers which a finger file names;
/// `None` without a table, of an infill that it cannot predict, or of another shape than measured.
fn measured_model(finger: &PrintedFinger, design: &Design) -> Result<Option<Prediction>, Failure> {
    let infill = [DENSITY_KEY, DIRECTION_KEY].map(|key| design.get(key));
    let ([Some(density), Some(direction)], Some(_), false) =
        (infill, &finger.measured, design.0.keys().any(|key| is_shape(key)))
    else {
        return Ok(None);
    };
    let model = surrogate(&stiffness_data(None, finger)?, finger)?;
    Ok(model.predict(density, direction).ok())
}

/// The design that a study recommends, the finger file of its fingers, and their stiffness, if the
/// design was evaluated.
fn best(dir: &Path) -> Result<(Design, Option<FingerFile>, Option<Prediction>), Failure> {
    let record = StudyRecord::load(dir)?;
    let Some(best) = Answer::of(&record).verdict.finger().cloned() else {
        return Err(Failure::usage(format!(
            "{}: the study recommends no design; give --density and --direction",
            dir.display()
        )));
    };
    let found = record.current().iter().find(|recorded| recorded.design == best);
    Ok((best.clone(), record.finger.clone(), found.map(|recorded| recorded.stiffness)))
}

/// Which measurements the model is fitted to.
#[derive(Debug, Clone, clap::Args)]
pub struct StiffnessRequest {
    /// Your own stiffness measurements in place of the shipped ones
    #[arg(long, value_name = "FILE.csv")]
    pub stiffness_data: Option<String>,
    /// Finger that was measured: finray9, or the path of a finger file
    #[arg(long, value_name = "NAME", default_value = DEFAULT_FINGER)]
    pub finger: String,
}

impl Default for StiffnessRequest {
    fn default() -> Self {
        StiffnessRequest { stiffness_data: None, finger: DEFAULT_FINGER.to_owned() }
    }
}

impl StiffnessRequest {
    /// Fits the model.
    pub fn model(&self) -> Result<Arc<Model>, Failure> {
        let finger = printed_finger(&self.finger)?;
        surrogate(&stiffness_data(self.stiffness_data.as_deref(), &finger)?, &finger)
    }

    /// The stiffness of an infill: density, percent, and direction, degrees.
    pub fn predict(&self, density: f64, direction: f64) -> Result<Prediction, Failure> {
        Design::checked_infill(density, direction, "stiffness").map_err(Failure::input)?;
        self.model()?.predict(density, direction).map_err(Failure::input)
    }
}
