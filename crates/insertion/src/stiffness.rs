//! Measured stiffness of fingers: CSV file and its checks.

use ask_tell::statistics::median;
use input::shipped::STIFFNESS;
use input::units::N_PER_MM;
use input::{InputError, Place, Placed, check_quotes};
use parameters::numbers;

/// Direction of a finger's stiffness; as a number, its index in [`Axis::ALL`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Axis {
    /// z, the direction of assembly: loads the ribs along their length.
    Assembly,
    /// y, the direction in which the jaws close: bends the ribs.
    Compliance,
}

impl Axis {
    /// Both axes, assembly first, as in the measured file.
    pub const ALL: [Axis; 2] = [Axis::Assembly, Axis::Compliance];

    /// Returns a short name for tables and plots.
    pub fn label(self) -> &'static str {
        ["assembly (z)", "compliance (y)"][self as usize]
    }
}

/// Infill of a finger: density in percent, direction in degrees.
pub type Infill = [f64; 2];

/// Required header of a measurement file.
pub const HEADER: [&str; 5] = [
    "design",
    "infill_density_percent",
    "infill_direction_deg",
    "stiffness_assembly_n_per_mm",
    "stiffness_compliance_n_per_mm",
];

/// Largest number of measured designs: the time of the leave-one-out errors grows with its fourth power.
pub const MAX_DESIGNS: usize = 100;

/// Measured stiffness of one printed finger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement {
    /// Number of the design.
    pub design: u32,
    /// Infill density, percent.
    pub density_percent: f64,
    /// Infill direction, degrees from the assembly direction.
    pub direction_deg: f64,
    /// Stiffness in the assembly direction (z), N/m.
    pub assembly: f64,
    /// Stiffness in the compliance direction (y), N/m.
    pub compliance: f64,
}

impl Measurement {
    /// Returns the stiffness along one axis, N/m.
    pub fn stiffness(&self, axis: Axis) -> f64 {
        [self.assembly, self.compliance][axis as usize]
    }

    /// Returns density and direction of the infill.
    pub fn infill(&self) -> Infill {
        [self.density_percent, self.direction_deg]
    }
}

/// Error of measured stiffnesses.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SurrogateError {
    /// Invalid CSV, a header other than [`HEADER`], an invalid value, a column in another unit, or a measured finger
    /// whose stiffness cannot be computed.
    #[error(transparent)]
    Fault(#[from] InputError),
    /// No measured design.
    #[error("no measured design; give at least one")]
    Empty,
    /// More designs than [`MAX_DESIGNS`].
    #[error(
        "{0} measured designs are too many: {MAX_DESIGNS} at most; give the average of fingers that are \
         nearly alike"
    )]
    TooMany(usize),
    /// No model could be fitted along the axis of this [`Axis::label`].
    #[error(
        "no stiffness model in the {0} direction can be fitted: the designs must differ in density \
         and in direction"
    )]
    Unfittable(&'static str),
}

impl Placed for SurrogateError {
    fn place(&self) -> Place {
        if let SurrogateError::Fault(fault) = self { fault.place() } else { Place::default() }
    }
}

/// Reads and checks a measurement file; `file` is named in errors.
///
/// # Errors
/// If it is not CSV with the columns of [`HEADER`], a value is invalid, or a column seems to be in another unit.
pub fn parse(text: &str, file: &str) -> Result<Vec<Measurement>, SurrogateError> {
    check_units(rows(text, file)?, file)
}

/// Returns the designs that were measured for the paper.
pub fn designs() -> Vec<Measurement> {
    parse(STIFFNESS[0].text, STIFFNESS[0].file).unwrap_or_default()
}

/// Returns designs of the paper by their rank in stiffness in the compliance direction: 0 for the lowest, 10 for the
/// highest.
pub fn designs_by_rank<const N: usize>(tenths: [usize; N]) -> [Measurement; N] {
    let mut designs = designs();
    designs.sort_by(|a, b| a.compliance.total_cmp(&b.compliance));
    // The shipped file has designs.
    let last = designs.len() - 1;
    tenths.map(|tenths| designs[last * tenths / 10])
}

/// Returns the designs of the paper with the lowest, median and highest stiffness in the compliance direction.
pub fn representative_designs() -> Vec<Measurement> {
    designs_by_rank([0, 5, 10]).to_vec()
}

/// Reads a measurement file and checks each value by itself.
fn rows(text: &str, file: &str) -> Result<Vec<Measurement>, SurrogateError> {
    // The reader counts one line too few in a "\r\n" file.
    let text = text.replace("\r\n", "\n");
    let at = |line: u64| Place::file(file).line(line as usize);
    check_quotes(&text, file)?;
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let syntax = |error: csv::Error| match error.position() {
        Some(position) => at(position.line()).fault(error.to_string()),
        None => Place::file(file).fault(error.to_string()),
    };
    if reader.headers().map_err(syntax)?.iter().ne(HEADER) {
        let header = HEADER.join(",");
        return Err(at(1).fault(format!("the header must be exactly `{header}`")).into());
    }
    let mut measurements: Vec<Measurement> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(syntax)?;
        let line = record.position().map_or(0, csv::Position::line);
        let error = column_error(at(line));
        let measurement = measurement(&record).map_err(&error)?;
        check(&measurement, &measurements).map_err(&error)?;
        measurements.push(measurement);
    }
    match measurements.len() {
        0 => Err(SurrogateError::Empty),
        count if count > MAX_DESIGNS => Err(SurrogateError::TooMany(count)),
        _ => Ok(measurements),
    }
}

/// Ratio of the medians of a file and of the shipped fingers above which another unit is assumed.
const UNIT_RATIO: f64 = 100.0;

/// Checks that the median of each stiffness column is between 1/100 and 100 times that of the shipped fingers.
fn check_units(own: Vec<Measurement>, file: &str) -> Result<Vec<Measurement>, SurrogateError> {
    let shipped = rows(STIFFNESS[0].text, STIFFNESS[0].file)?;
    for (axis, column) in [(Axis::Assembly, HEADER[3]), (Axis::Compliance, HEADER[4])] {
        let median = |all: &[Measurement]| {
            median(all.iter().map(|each| each.stiffness(axis))).unwrap_or(f64::NAN) / N_PER_MM
        };
        let (given, usual) = (median(&own), median(&shipped));
        let question = match given / usual {
            ratio if ratio > UNIT_RATIO => "is the unit N/m? divide by 1000",
            ratio if ratio < 1.0 / UNIT_RATIO => "is the unit N/um or kN/mm? multiply by 1000",
            _ => continue,
        };
        let problem = format!(
            "the median is {given} N/mm, that of the published fingers is {usual}; {question}"
        );
        return Err(column_error(Place::file(file))((column, problem)));
    }
    Ok(own)
}

/// Returns a function that converts a column and its problem to an error at a place.
fn column_error(place: Place) -> impl Fn((&'static str, String)) -> SurrogateError {
    move |(column, problem)| place.clone().key(column).fault(problem).into()
}

fn measurement(record: &csv::StringRecord) -> Result<Measurement, (&'static str, String)> {
    let text = |i: usize| record.get(i).unwrap_or("").trim();
    let number = |i: usize| {
        text(i).parse::<f64>().map_err(|_| (HEADER[i], format!("`{}` is not a number", text(i))))
    };
    let design = text(0)
        .parse()
        .map_err(|_| (HEADER[0], format!("`{}` is not a whole number from 0", text(0))))?;
    Ok(Measurement {
        design,
        density_percent: number(1)?,
        direction_deg: number(2)?,
        assembly: number(3)? * N_PER_MM,
        compliance: number(4)? * N_PER_MM,
    })
}

/// Checks one measurement by itself and against those before it.
fn check(new: &Measurement, before: &[Measurement]) -> Result<(), (&'static str, String)> {
    let springs = [new.assembly, new.compliance].map(|stiffness| stiffness / N_PER_MM);
    for (name, value) in HEADER[1..].iter().zip(new.infill().into_iter().chain(springs)) {
        numbers::problem(name, value).map_or(Ok(()), |problem| Err((*name, problem)))?;
    }
    for old in before {
        if old.design == new.design {
            let problem = format!("design {} is given twice; number each once", new.design);
            return Err((HEADER[0], problem));
        }
        // A replicate would leak into the leave-one-out error of the other.
        if old.infill() == new.infill() {
            let problem = format!(
                "same density and direction as design {}; give the average of repeated measurements",
                old.design
            );
            return Err((HEADER[1], problem));
        }
    }
    Ok(())
}
