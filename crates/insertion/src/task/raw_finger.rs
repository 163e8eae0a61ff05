//! The fingers in a task file, and the checks that turn them into a [`FingerModel`].

use crate::task::finger::{Coupling, FingerModel, Rcc};
use input::units::MM;
use input::{Check, InputError};
use serde::Deserialize;

/// Largest infill direction, degrees.
const LARGEST_DIRECTION_DEG: f64 = 90.0;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawFinger {
    rcc_mm: Option<RawRcc>,
    #[serde(default)]
    coupling: Vec<RawCoupling>,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(untagged, expecting = "a number of mm, or { at_0_deg = mm, per_deg = mm }")]
enum RawRcc {
    Fixed(f64),
    ByDirection(RawByDirection),
}

#[derive(Deserialize, Clone, Copy)]
#[serde(deny_unknown_fields)]
struct RawByDirection {
    at_0_deg: f64,
    per_deg: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCoupling {
    axes: [RawAxis; 2],
    coefficient: f64,
}

#[derive(Deserialize, Clone, Copy, PartialEq, Debug)]
#[serde(rename_all = "kebab-case")]
enum RawAxis {
    X,
    Y,
    Z,
    Rx,
    Ry,
    Rz,
}

/// The fingers of a task file.
pub(super) fn finger(check: Check<'_>, raw: &RawFinger) -> Result<FingerModel, InputError> {
    let rcc = raw.rcc_mm.map(|raw| rcc(check, raw)).transpose()?;
    Ok(FingerModel { rcc, coupling: coupling(check, &raw.coupling)? })
}

fn rcc(check: Check<'_>, raw: RawRcc) -> Result<Rcc, InputError> {
    let key = "finger.rcc_mm";
    let rcc = match raw {
        RawRcc::Fixed(mm) => Rcc { at_zero: check.positive(key, mm)? * MM, per_degree: 0.0 },
        RawRcc::ByDirection(RawByDirection { at_0_deg, per_deg }) => Rcc {
            at_zero: check.positive("finger.rcc_mm.at_0_deg", at_0_deg)? * MM,
            per_degree: check.finite("finger.rcc_mm.per_deg", per_deg)? * MM,
        },
    };
    let last = rcc.at(LARGEST_DIRECTION_DEG);
    if last <= 0.0 {
        let last = last / MM;
        return check.fail(key, format!("is {last} mm at 90 degrees; it must stay above 0"));
    }
    Ok(rcc)
}

fn coupling(check: Check<'_>, raw: &[RawCoupling]) -> Result<Option<Coupling>, InputError> {
    let key = "finger.coupling";
    let mut pairs: Vec<(usize, usize, f64)> = Vec::new();
    for RawCoupling { axes: [first, second], coefficient } in raw {
        if first == second {
            return check.fail(key, format!("couples {first:?} with itself; name two axes"));
        }
        let (low, high) =
            ((*first as usize).min(*second as usize), (*first as usize).max(*second as usize));
        if pairs.iter().any(|&(i, j, _)| (i, j) == (low, high)) {
            return check.fail(key, format!("couples {first:?} and {second:?} twice"));
        }
        pairs.push((low, high, check.finite(key, *coefficient)?));
    }
    if pairs.is_empty() {
        return Ok(None);
    }
    match Coupling::new(pairs) {
        Some(coupling) => Ok(Some(coupling)),
        None => check.fail(
            key,
            "would let the finger run away: the 6x6 matrix of coefficients, with ones on its \
                 diagonal, must be positive definite (one coefficient alone: between -1 and 1)",
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::task::Task;

    fn parse(finger: &str) -> Result<FingerModel, String> {
        let text = include_str!("../../../../tasks/usb.toml")
            .replace("[friction]", &format!("{finger}\n[friction]"));
        Task::parse(&text, "usb.toml").map(|task| task.finger).map_err(|error| error.to_string())
    }

    #[test]
    fn a_task_file_may_say_nothing_of_its_fingers() {
        assert_eq!(parse(""), Ok(FingerModel::default()));
    }

    #[test]
    fn the_remote_centre_is_a_number_or_a_line() {
        assert_eq!(parse("[finger]\nrcc_mm = 25").unwrap().rcc.unwrap().at(40.0), 25.0 * MM);
        let line =
            parse("[finger]\nrcc_mm = { at_0_deg = 21.0, per_deg = 0.25 }").unwrap().rcc.unwrap();
        assert!((line.at(40.0) - 31.0 * MM).abs() < 1e-15);
    }

    #[test]
    fn bad_fingers_are_named() {
        let pair =
            |axes: &str, c: f64| format!("[[finger.coupling]]\naxes = {axes}\ncoefficient = {c}\n");
        for (text, part) in [
            ("[finger]\nrcc_mm = -1.0".to_owned(), "finger.rcc_mm: is -1"),
            ("[finger]\nrcc_mm = nan".to_owned(), "finger.rcc_mm"),
            ("[finger]\nrcc_mm = \"far\"".to_owned(), "a number of mm, or {"),
            (
                "[finger]\nrcc_mm = { at_0_deg = 21.0, per_degree = 1.0 }".to_owned(),
                "a number of mm, or {",
            ),
            ("[finger]\nrcc_mm = { at_0_deg = 21.0, per_deg = -1.0 }".to_owned(), "at 90 degrees"),
            ("[finger]\nrcc = 21.0".to_owned(), "rcc"),
            (pair("[\"y\", \"y\"]", 0.1), "with itself"),
            (pair("[\"y\", \"z\"]", 1.5), "positive definite"),
            (pair("[\"y\", \"w\"]", 0.5), "w"),
            (pair("[\"y\", \"z\"]", 0.5) + &pair("[\"z\", \"y\"]", 0.5), "twice"),
        ] {
            let error = parse(&text).unwrap_err();
            assert!(error.contains("usb.toml") && error.contains(part), "{text}: {error}");
        }
        assert!(parse(&pair("[\"y\", \"rx\"]", 0.5)).unwrap().coupling.is_some());
    }
}
