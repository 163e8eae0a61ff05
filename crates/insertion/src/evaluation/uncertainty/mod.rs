//! Errors from one insertion to the next, over which a success rate and a robust range are taken.

mod draw;

pub use draw::{Draw, draws};

use crate::evaluation::cell::Priors;
use crate::evaluation::tolerance::Search;
use crate::finger::file::is_shape;
use input::shipped::UNCERTAINTIES;
use input::units::{DEG, MM, PERCENT};
use input::{Check, InputError, read};
use parameters::Path;
use parameters::numbers::{SOCKET_YAW, START_ACROSS};
use serde::Deserialize;

/// A checked distribution of errors, and how many draws each measure takes; SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Name, as used on the command line.
    pub name: String,
    /// One line for lists.
    pub description: String,
    /// Spread of each error.
    pub errors: Errors,
    /// Settings of success-rate measurements.
    pub success: SuccessSettings,
    /// Settings of robust-range measurements.
    pub robust: RobustSettings,
    /// Cell whose rows are drawn in place of errors.
    pub cell: Option<Priors>,
}

/// Spread of each error; 0 switches it off.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    /// Start along y, normal: standard deviation, m.
    pub offset_sd: f64,
    /// Start along x, normal: standard deviation, m.
    pub across_sd: f64,
    /// Socket about z, normal: standard deviation, rad.
    pub yaw_sd: f64,
    /// Both coefficients of friction, uniform: half the width, as a share.
    pub friction_half_width: f64,
    /// Both stiffnesses, lognormal: standard deviations of the stiffness model.
    pub stiffness_sd_factor: f64,
    /// Width of the opening, uniform: half the width, m.
    pub clearance_half_width: f64,
    /// Part in the gripper along x, normal: standard deviation, m.
    pub grasp_across_sd: f64,
    /// Part in the gripper downwards, uniform from 0: largest, m.
    pub grasp_low_max: f64,
}

/// Settings of a success-rate measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SuccessSettings {
    /// Trials of each design.
    pub trials: u32,
    /// Probability with which the interval holds the true rate, 0 to 1.
    pub confidence: f64,
}

/// Settings of a robust-range measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobustSettings {
    /// Windows of each design.
    pub samples: u32,
    /// Statistic of their ranges.
    pub statistic: Statistic,
    /// Search for the ends of each window.
    pub search: Search,
}

/// One number for a sample of ranges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Statistic {
    /// Mean less so many standard deviations.
    MeanMinusSd(f64),
    /// Mean of the lowest share (0 to 1) of the samples, at least one of them.
    LowerTail(f64),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawUncertainty {
    name: String,
    description: String,
    offset: RawOffset,
    yaw: RawYaw,
    friction: RawFriction,
    stiffness: RawStiffness,
    clearance: RawClearance,
    grasp: RawGrasp,
    success_rate: RawSuccess,
    robust_range: RawRobust,
}

/// An error's fields, and where their values come from.
macro_rules! raw_error {
    ($($name:ident { $($field:ident),* })*) => {
        $(#[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct $name {
            $($field: f64,)*
            source: String,
        })*
    };
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawOffset {
    sd_mm: f64,
    #[serde(default)]
    across_sd_mm: f64,
    source: String,
}

raw_error! {
    RawYaw { sd_deg }
    RawFriction { half_width_percent }
    RawStiffness { sd_factor }
    RawClearance { half_width_mm }
    RawGrasp { across_sd_mm, low_max_mm }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSuccess {
    trials: u32,
    confidence_percent: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawRobust {
    samples: u32,
    statistic: RawStatistic,
    sd_factor: Option<f64>,
    tail_percent: Option<f64>,
    search: Search,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
enum RawStatistic {
    MeanMinusSd,
    LowerTail,
}

const MOST: u32 = 100_000;

impl Uncertainty {
    /// Reads and checks a distribution; `file` is named in errors. Of a cell it is that of its rows:
    /// settings are then those of the shipped file, and there are no other errors.
    ///
    /// # Errors
    /// If the text is not such a file, or a value cannot be used.
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        let rows = |table: toml::Table| table.contains_key("parameter");
        if text.parse().is_ok_and(rows) {
            return Self::of(Priors::parse(text, file)?, file);
        }
        let raw: RawUncertainty = read(text, file)?;
        let check = Check { file };
        sources(check, &raw)?;
        let rate = &raw.success_rate;
        Ok(Uncertainty {
            errors: errors(check, &raw)?,
            success: SuccessSettings {
                trials: count(check, "success_rate.trials", rate.trials, 1)?,
                confidence: share(
                    check,
                    "success_rate.confidence_percent",
                    rate.confidence_percent,
                )?,
            },
            robust: RobustSettings {
                // A standard deviation needs two.
                samples: count(check, "robust_range.samples", raw.robust_range.samples, 2)?,
                statistic: statistic(check, &raw.robust_range)?,
                search: raw.robust_range.search,
            },
            name: raw.name,
            description: raw.description,
            cell: None,
        })
    }

    fn of(cell: Priors, file: &str) -> Result<Self, InputError> {
        if let Some(row) = cell.parameters.iter().find(|row| is_shape(&row.path)) {
            let problem =
                "cannot be drawn: it makes another finger, which a space can; leave it out";
            return Check { file }.fail(&row.name, problem);
        }
        let typical = Self::parse(UNCERTAINTIES[0].text, UNCERTAINTIES[0].file)?;
        let (name, description) = (cell.name.clone(), cell.description.clone());
        Ok(Uncertainty {
            name,
            description,
            errors: Errors::default(),
            cell: Some(cell),
            ..typical
        })
    }
}

fn sources(check: Check<'_>, raw: &RawUncertainty) -> Result<(), InputError> {
    for (key, source) in [
        ("offset.source", &raw.offset.source),
        ("yaw.source", &raw.yaw.source),
        ("friction.source", &raw.friction.source),
        ("stiffness.source", &raw.stiffness.source),
        ("clearance.source", &raw.clearance.source),
        ("grasp.source", &raw.grasp.source),
    ] {
        if source.trim().is_empty() {
            return check.fail(key, "is empty; say where the value comes from");
        }
    }
    Ok(())
}

fn errors(check: Check<'_>, raw: &RawUncertainty) -> Result<Errors, InputError> {
    let friction = "friction.half_width_percent";
    let half_width = check.not_negative(friction, raw.friction.half_width_percent)?;
    if half_width >= 100.0 {
        return check.fail(friction, "must be below 100: friction cannot be negative");
    }
    // In SI units; `unit` is one of the file's, and the largest is that of the error's path.
    let error = |key, value, path: &str, unit| {
        let largest = Path::new(path).map_or(0.0, |path| path.bounds()[1]);
        match check.not_negative(key, value)? <= largest {
            true => Ok(value * unit),
            false => check.fail(key, format!("is {value}; it may be {largest} at most")),
        }
    };
    let (offset, gap, grasp) = (&raw.offset, raw.clearance.half_width_mm, &raw.grasp);
    let (factor, compliance) = (raw.stiffness.sd_factor, "cell.compliance_error_sd");
    let across = grasp.across_sd_mm;
    Ok(Errors {
        offset_sd: error("offset.sd_mm", offset.sd_mm, "cell.start_y_mm", MM)?,
        across_sd: error("offset.across_sd_mm", offset.across_sd_mm, START_ACROSS, MM)?,
        yaw_sd: error("yaw.sd_deg", raw.yaw.sd_deg, SOCKET_YAW, DEG)?,
        friction_half_width: half_width * PERCENT,
        stiffness_sd_factor: error("stiffness.sd_factor", factor, compliance, 1.0)?,
        clearance_half_width: error("clearance.half_width_mm", gap, "cell.clearance_mm", MM)?,
        grasp_across_sd: error("grasp.across_sd_mm", across, "cell.grasp_across_mm", MM)?,
        grasp_low_max: error("grasp.low_max_mm", grasp.low_max_mm, "cell.grasp_low_mm", MM)?,
    })
}

fn count(check: Check<'_>, key: &str, count: u32, least: u32) -> Result<u32, InputError> {
    if (least..=MOST).contains(&count) {
        return Ok(count);
    }
    check.fail(key, format!("is {count}; it must lie in {least} .. {MOST}"))
}

fn share(check: Check<'_>, key: &str, percent: f64) -> Result<f64, InputError> {
    if percent > 0.0 && percent < 100.0 {
        return Ok(percent * PERCENT);
    }
    check.fail(key, format!("is {percent}; it must lie between 0 and 100"))
}

fn statistic(check: Check<'_>, raw: &RawRobust) -> Result<Statistic, InputError> {
    let problem = match (raw.statistic, raw.sd_factor, raw.tail_percent) {
        (RawStatistic::MeanMinusSd, Some(factor), None) => {
            let factor = check.not_negative("robust_range.sd_factor", factor)?;
            return Ok(Statistic::MeanMinusSd(factor));
        }
        (RawStatistic::LowerTail, None, Some(percent)) => {
            let share = share(check, "robust_range.tail_percent", percent)?;
            return Ok(Statistic::LowerTail(share));
        }
        (RawStatistic::MeanMinusSd, ..) => {
            "\"mean-minus-sd\" goes with sd_factor, and without tail_percent"
        }
        (RawStatistic::LowerTail, ..) => {
            "\"lower-tail\" goes with tail_percent, and without sd_factor"
        }
    };
    check.fail("robust_range.statistic", problem)
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::UNCERTAINTIES;

    #[test]
    fn the_shipped_file_reads_in_si_units() {
        let file = UNCERTAINTIES[0];
        let typical = Uncertainty::parse(file.text, file.file).unwrap();
        assert_eq!(typical.name, "typical");
        assert!((typical.errors.offset_sd - 2e-3).abs() < 1e-15);
        assert!((typical.errors.friction_half_width - 0.2).abs() < 1e-15);
        assert_eq!(typical.robust.statistic, Statistic::MeanMinusSd(1.0));
    }

    #[test]
    fn each_bad_field_is_named() {
        let good = UNCERTAINTIES[0].text;
        for (from, to, key, word) in [
            ("sd_mm = 2.0", "sd_mm = -2.0", "offset.sd_mm", "0 or above"),
            (
                "sd_mm = 2.0",
                "sd_mm = 2.0\nacross_sd_mm = 21.0",
                "offset.across_sd_mm",
                "20 at most",
            ),
            ("half_width_percent = 20.0", "half_width_percent = 100.0", "friction", "below 100"),
            ("trials = 100", "trials = 0", "success_rate.trials", "1 .."),
            ("samples = 12", "samples = 1", "robust_range.samples", "2 .."),
            ("confidence_percent = 95.0", "confidence_percent = 100.0", "confidence", "between"),
            ("\nsd_factor = 1.0\n#", "\ntail_percent = 10.0\n#", "range.statistic", "sd_factor"),
            ("sd_deg = 1.0", "sd_rad = 1.0", "sd_rad", "sd_deg"),
            ("search = \"walk\"", "search = \"run\"", "run", "walk"),
        ] {
            let text = good.replacen(from, to, 1);
            assert_ne!(text, good, "{from}");
            let error = Uncertainty::parse(&text, "u.toml").unwrap_err().to_string();
            assert!([key, word, "u.toml"].iter().all(|part| error.contains(part)), "{error}");
        }
        let tail =
            good.replace("mean-minus-sd\"\nsd_factor = 1.0", "lower-tail\"\ntail_percent = 10.0");
        let tail = Uncertainty::parse(&tail, "u").unwrap();
        assert_eq!(tail.robust.statistic, Statistic::LowerTail(0.1));
    }
}
