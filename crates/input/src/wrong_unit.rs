//! Detection of numbers in a wrong unit.

use crate::units::{DEG, without_unit};

/// Problem and remedy of a number that is probably in a wrong unit: its bounds, and the accepted values.
pub type WrongUnit = [String; 2];

/// Returns the units mistaken for this one, and their size in it.
fn mistaken(unit: &str) -> &'static [(&'static str, f64)] {
    match unit {
        " N" => &[("kN", 1000.0), ("grams-force", 9.81e-3)],
        " kg" => &[("g", 0.001)],
        " mm/s" => &[("m/s", 1000.0)],
        " %" => &[("fractions", 100.0)],
        " mm" => {
            &[("metres", 1000.0), ("inches", 25.4), ("micrometres", 0.001), ("centimetres", 10.0)]
        }
        _ => &[],
    }
}

/// Checks that a number lies in its plausible range, in the unit of its key; a key without a unit is in mm.
pub fn number(key: &str, value: f64, [low, high]: [f64; 2]) -> Option<WrongUnit> {
    if (low..=high).contains(&value) {
        return None;
    }
    let unit = Some(without_unit(key).1).filter(|unit| !unit.is_empty()).unwrap_or(" mm");
    let shown = (value * 1e4).round() / 1e4;
    let problem = format!("{shown}{unit} is outside the plausible {low} to {high}{unit}");
    Some([problem, remedy(unit, value, [low, high])])
}

/// Returns advice on a number outside its range: the unit in which it is inside, or the range.
pub fn remedy(unit: &str, value: f64, [low, high]: [f64; 2]) -> String {
    other(unit, value, [low, high]).unwrap_or_else(|| format!("between {low} and {high}{unit}"))
}

/// Returns the unit in which a number outside its range is inside, if there is one.
pub fn other(unit: &str, value: f64, [low, high]: [f64; 2]) -> Option<String> {
    let within = |(_, factor): &&(&str, f64)| (low..=high).contains(&(value * factor));
    let (other, factor) = mistaken(unit).iter().find(within)?;
    Some(format!(
        "the unit is{unit}; if the number was in {other}, multiply by {factor}: {:.2}{unit}",
        value * factor
    ))
}

/// Checks that an infill direction, degrees, is not in radians.
pub fn direction(degrees: f64) -> Option<WrongUnit> {
    angle(degrees, [0.0, 90.0], 0.1)
}

/// Checks that an angle, degrees, is not in radians: that it is a multiple of `step`, or that its magnitude would in
/// radians be beyond the plausible range, degrees.
pub fn angle(degrees: f64, [low, high]: [f64; 2], step: f64) -> Option<WrongUnit> {
    let steps = degrees / step;
    // A right angle in four digits is 90.0002 degrees.
    if !(0.99 * low..=1.01 * high).contains(&(degrees.abs() / DEG))
        || (steps - steps.round()).abs() < 1e-6
    {
        return None;
    }
    let degrees = (degrees * 1e4).round() / 1e4;
    let problem = format!("{degrees} degrees: are these radians?");
    let remedy = format!("angles are in degrees: {degrees} rad is {:.1} degrees", degrees / DEG);
    Some([problem, remedy])
}
