//! Distribution of the random errors of an insertion, and settings of the two measures under these errors: the success
//! rate, and the robust range (a pessimistic statistic of the widths of the tolerance windows).

mod draw;

pub use draw::{Draw, draws};

use crate::finger::file::is_shape;
use crate::{Priors, Search};
use input::shipped::UNCERTAINTIES;
use input::units::read::{deg, mm, percent};
use input::{Check, Document, InputError};
use parameters::numbers;
use serde::Deserialize;
use toml::Value;

/// Distribution of errors, and settings of the measures under sampled errors; SI units. Each error has the source of
/// its values; a spread of 0 leaves the error out.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Uncertainty {
    /// Name on the command line.
    pub name: String,
    /// One-line description for lists.
    pub description: String,
    /// Position of the start.
    pub offset: OffsetSpread,
    /// Rotation of the socket.
    pub yaw: YawSpread,
    /// Coefficients of friction finger-plug and plug-socket.
    pub friction: FrictionSpread,
    /// Stiffness of the fingers in the compliance and assembly directions.
    pub stiffness: StiffnessSpread,
    /// Width of the socket's opening.
    pub clearance: ClearanceSpread,
    /// Position of the part in the gripper.
    pub grasp: GraspSpread,
    /// Settings of success-rate measurements.
    #[serde(rename = "success_rate")]
    pub success: SuccessSettings,
    /// Settings of robust-range measurements.
    #[serde(rename = "robust_range")]
    pub robust: RobustSettings,
    /// Robot cell whose uncertain parameters are drawn; all errors are 0 then.
    #[serde(skip)]
    pub cell: Option<Priors>,
}

/// Settings of a success-rate measurement.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SuccessSettings {
    /// Number of trials per design.
    pub trials: u32,
    /// Confidence level of the interval, 0 to 1.
    #[serde(rename = "confidence_percent", deserialize_with = "percent")]
    pub confidence: f64,
}

/// Settings of a robust-range measurement.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobustSettings {
    /// Number of tolerance windows per design.
    pub samples: u32,
    /// Statistic of the widths of the windows.
    pub statistic: Statistic,
    /// Number of standard deviations that are subtracted.
    pub sd_factor: f64,
    /// Search for the ends of each window.
    pub search: Search,
}

/// Statistic of a sample of ranges (widths of tolerance windows).
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Statistic {
    /// Mean minus a number of standard deviations.
    MeanMinusSd,
}

/// Spread of the position of the start.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OffsetSpread {
    /// Standard deviation of the normal distribution along y, m.
    #[serde(rename = "sd_mm", deserialize_with = "mm")]
    pub sd: f64,
    /// Standard deviation of the normal distribution along x, m.
    #[serde(rename = "across_sd_mm", default, deserialize_with = "mm")]
    pub across_sd: f64,
    source: String,
}

/// Spread of the rotation of the socket about z.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct YawSpread {
    /// Standard deviation of the normal distribution, rad.
    #[serde(rename = "sd_deg", deserialize_with = "deg")]
    pub sd: f64,
    source: String,
}

/// Spread of the coefficients of friction finger-plug and plug-socket: independent uniform distributions.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionSpread {
    /// Half the width of the distribution, as a share of the nominal value.
    #[serde(rename = "half_width_percent", deserialize_with = "percent")]
    pub half_width: f64,
    source: String,
}

/// Spread of the stiffness in the compliance and assembly directions: independent lognormal distributions.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StiffnessSpread {
    /// Standard deviation, as a multiple of that of the stiffness prediction.
    pub sd_factor: f64,
    source: String,
}

/// Spread of the width of the socket's opening: a uniform distribution.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClearanceSpread {
    /// Half the width of the distribution, m.
    #[serde(rename = "half_width_mm", deserialize_with = "mm")]
    pub half_width: f64,
    source: String,
}

/// Spread of the position of the part in the gripper.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GraspSpread {
    /// Standard deviation of the normal distribution along x, m.
    #[serde(rename = "across_sd_mm", deserialize_with = "mm")]
    pub across_sd: f64,
    /// Largest downward shift, m; the distribution is uniform from 0.
    #[serde(rename = "low_max_mm", deserialize_with = "mm")]
    pub low_max: f64,
    source: String,
}

impl Uncertainty {
    /// Reads and checks a distribution; `file` is named in errors. The text may also be a cell file: its parameters are
    /// drawn from their priors, all other errors are 0, and the settings are those of the shipped uncertainty file.
    ///
    /// # Errors
    /// If the text is not an uncertainty or cell file, or a value is out of range.
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        let document = Document::parse(text, file)?;
        let table: Value = document.read()?;
        if table.get("parameter").is_some() {
            return Self::of_cell(Priors::parse(text, file)?, file);
        }
        let read = document.read()?;
        numbers::check_file("uncertainty", &table, file)?;
        Ok(read)
    }

    /// Returns the distribution of the parameters of a robot cell, with the settings of the shipped uncertainty file.
    fn of_cell(cell: Priors, file: &str) -> Result<Self, InputError> {
        if let Some(row) = cell.parameters.iter().find(|row| is_shape(&row.path)) {
            let problem =
                "cannot be drawn: it changes the printed finger; delete it, or vary it in a space";
            return Check { file }.fail(&row.name, problem);
        }
        let typical = Self::parse(UNCERTAINTIES[0].text, UNCERTAINTIES[0].file)?;
        Ok(Uncertainty {
            name: cell.name.clone(),
            description: cell.description.clone(),
            offset: OffsetSpread::default(),
            yaw: YawSpread::default(),
            friction: FrictionSpread::default(),
            stiffness: StiffnessSpread::default(),
            clearance: ClearanceSpread::default(),
            grasp: GraspSpread::default(),
            cell: Some(cell),
            ..typical
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::fixtures::refused;
    use input::shipped::UNCERTAINTIES;

    #[test]
    fn the_shipped_file_reads_in_si_units() {
        let file = UNCERTAINTIES[0];
        let typical = Uncertainty::parse(file.text, file.file).unwrap();
        assert_eq!(typical.name, "typical");
        assert!((typical.offset.sd - 2e-3).abs() < 1e-15);
        assert!((typical.friction.half_width - 0.2).abs() < 1e-15);
        assert_eq!(typical.robust.sd_factor, 1.0);
    }

    #[test]
    fn each_bad_field_is_named() {
        let good = UNCERTAINTIES[0].text;
        for (from, to, key, word) in [
            ("sd_mm = 2.0", "sd_mm = -2.0", "offset.sd_mm", "must lie in 0 .. 20"),
            (
                "sd_mm = 2.0",
                "sd_mm = 2.0\nacross_sd_mm = 21.0",
                "offset.across_sd_mm",
                "must lie in 0 .. 20",
            ),
            ("half_width_percent = 20.0", "half_width_percent = 100.0", "friction", "0 .. 99.9"),
            ("trials = 100", "trials = 0", "success_rate.trials", "1 .."),
            ("samples = 12", "samples = 1", "robust_range.samples", "2 .."),
            ("percent = 95.0", "percent = 100.0", "confidence", "must lie in"),
            ("\nsd_factor = 1.0\n#", "\ntail_percent = 10.0\n#", "tail_percent", "sd_factor"),
            ("\"mean-minus-sd\"\nsd", "\"lower-tail\"\nsd", "lower-tail", "mean-minus-sd"),
            ("sd_deg = 1.0", "sd_rad = 1.0", "sd_rad", "sd_deg"),
            ("search = \"walk\"", "search = \"run\"", "run", "walk"),
        ] {
            let text = good.replacen(from, to, 1);
            assert_ne!(text, good, "{from}");
            refused(Uncertainty::parse(&text, "u.toml"), &[key, word, "u.toml"]);
        }
    }
}
