//! The value of one cell that is not empty, checked by itself: units that look wrong are told here.

use super::NOT_MEASURABLE;
use insertion::outcome::FailureClass;
use jiff::civil::Date;

/// Largest length that is taken for millimetres: no connector tolerates more.
const MOST_MM: f64 = 100.0;
/// Smallest that is not 0: a start is not set finer.
const LEAST_MM: f64 = 0.02;
/// Largest force that is taken for newtons.
const MOST_N: f64 = 5000.0;

pub(super) fn number(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{text}` is not a number")),
    }
}

pub(super) fn density(text: &str) -> Result<f64, String> {
    match number(text)? {
        share if share > 0.0 && share < 1.0 => {
            Err(format!("{share} looks like a share; give percent, as in {}", 100.0 * share))
        }
        percent if percent > 0.0 && percent <= 100.0 => Ok(percent),
        other => Err(format!("is {other}; it must lie above 0 and at most at 100 percent")),
    }
}

pub(super) fn direction(text: &str) -> Result<f64, String> {
    match number(text)? {
        radians if radians.fract() != 0.0 && radians.abs() < 1.6 => Err(format!(
            "{radians} looks like radians; give degrees, as in {:.0}",
            radians.to_degrees()
        )),
        degrees if (0.0..=90.0).contains(&degrees) => Ok(degrees),
        other => Err(format!("is {other}; it must lie from 0 to 90 degrees")),
    }
}

pub(super) fn length(text: &str) -> Result<f64, String> {
    match number(text)? {
        long if long.abs() > MOST_MM => {
            Err(format!("{long} looks like micrometres; give millimetres, as in {}", long / 1e3))
        }
        short if short != 0.0 && short.abs() < LEAST_MM => {
            Err(format!("{short} looks like metres; give millimetres, as in {}", short * 1e3))
        }
        length => Ok(length),
    }
}

/// A range, mm, or the words that there is none.
pub(super) fn range(text: &str) -> Result<Option<f64>, String> {
    if text == NOT_MEASURABLE {
        return Ok(None);
    }
    match length(text)? {
        below if below < 0.0 => Err(format!("is {below}; a range is 0 or above")),
        range => Ok(Some(range)),
    }
}

pub(super) fn failure(text: &str) -> Result<FailureClass, String> {
    let class = text.parse::<u8>().ok().and_then(|number| FailureClass::try_from(number).ok());
    let known = FailureClass::ALL.map(|class| format!("{} ({})", class.number(), class.label()));
    class.ok_or_else(|| format!("`{text}` is no failure class; there are {}", known.join(", ")))
}

/// Number of measurements that the values are the mean of.
pub(super) fn repeats(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(count @ 1..=10_000) => Ok(count),
        _ => Err(format!("`{text}` is not a whole number from 1 to 10000")),
    }
}

pub(super) fn force(text: &str) -> Result<f64, String> {
    match number(text)? {
        large if large > MOST_N => {
            Err(format!("{large} looks like millinewtons; give newtons, as in {}", large / 1e3))
        }
        below if below < 0.0 => Err(format!("is {below}; a largest force is 0 or above")),
        force => Ok(force),
    }
}

pub(super) fn date(text: &str) -> Result<String, String> {
    match text.parse::<Date>() {
        Ok(day) => Ok(day.to_string()),
        Err(_) => Err(format!("`{text}` is no day; write it as in 2026-03-31")),
    }
}
