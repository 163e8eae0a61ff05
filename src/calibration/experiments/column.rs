//! The columns of a measurement file.

use super::problem::Problem;
use csv::StringRecord;
use input::shipped::nearest;
use insertion::space::{DENSITY_KEY, DIRECTION_KEY};

/// What a column holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Column {
    /// Name of the task.
    Task,
    /// Infill density, percent.
    Density,
    /// Infill direction, degrees.
    Direction,
    /// Most negative start that inserted, mm.
    Negative,
    /// Most positive start that inserted, mm.
    Positive,
    /// Width of the window, mm.
    Range,
    /// Failure class below the window.
    FailureNegative,
    /// Failure class above the window.
    FailurePositive,
    /// How many measurements the line is the mean of.
    Repeats,
    /// Largest contact force, N.
    PeakForce,
    /// Day of the measurement.
    Date,
    /// Anything.
    Note,
    /// A further design parameter, by its key in a space file.
    Set(String),
}

/// The documented columns, in the order in which a new file has them.
pub const COLUMNS: [(&str, Column); 12] = [
    ("task", Column::Task),
    (DENSITY_KEY, Column::Density),
    (DIRECTION_KEY, Column::Direction),
    ("negative_mm", Column::Negative),
    ("positive_mm", Column::Positive),
    ("range_mm", Column::Range),
    ("failure_negative", Column::FailureNegative),
    ("failure_positive", Column::FailurePositive),
    ("repeats", Column::Repeats),
    ("peak_force_n", Column::PeakForce),
    ("date", Column::Date),
    ("note", Column::Note),
];

/// Where each line says which finger was tried.
const NEEDED: [Column; 3] = [Column::Task, Column::Density, Column::Direction];

impl Column {
    /// Its name in the header.
    pub fn name(&self) -> &str {
        match self {
            Column::Set(key) => key,
            other => {
                COLUMNS.iter().find(|(_, column)| column == other).map_or("", |(name, _)| name)
            }
        }
    }

    fn from_name(name: &str) -> Result<Self, Problem> {
        if let Some((_, column)) = COLUMNS.iter().find(|(known, _)| *known == name) {
            return Ok(column.clone());
        }
        if name.starts_with("task.") || name.starts_with("finger.") {
            return Ok(Column::Set(name.to_owned()));
        }
        let known = COLUMNS.map(|(name, _)| name);
        let hint = nearest(name, &known)
            .map_or(String::new(), |near| format!(" (did you mean `{near}`?)"));
        let words = format!(
            "is no column{hint}; there are {}, and keys of a space file (task. or finger.)",
            known.join(", ")
        );
        Err(Problem::new(1, name, words))
    }
}

/// What each column of a file holds.
pub(super) fn columns(header: &StringRecord) -> Result<Vec<Column>, Problem> {
    let mut found: Vec<Column> = Vec::new();
    for name in header {
        let column = Column::from_name(name)?;
        if found.contains(&column) {
            return Err(Problem::new(1, name, "is given twice; each column may stand once"));
        }
        found.push(column);
    }
    match NEEDED.iter().find(|column| !found.contains(column)) {
        None => Ok(found),
        Some(missing) => {
            let words = "is missing; a line says which finger was tried on which task";
            Err(Problem::new(1, missing.name(), words))
        }
    }
}
