//! Fingers of a task file: what it may say beyond their two measured springs.

use input::units::MM;
use input::{Check, InputError};
use nalgebra::Matrix6;
use serde::Deserialize;

/// The part of a finger that the task file decides; the default leaves it as it is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FingerModel {
    /// Remote centre of compliance, if the file gives it.
    pub rcc: Option<Rcc>,
    /// Coupling of its springs, if the file gives it.
    pub coupling: Option<Coupling>,
}

/// Distance of the remote centre from the contact plane towards the tip, by infill direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rcc {
    /// At 0 degrees, m.
    pub at_zero: f64,
    /// Change with each degree, m.
    pub per_degree: f64,
}

/// Coefficients `c` that couple the six springs: `k_ij = c_ij sqrt(k_i k_j)`. For any design, a
/// positive definite matrix with ones on its diagonal makes a finger that springs back. Order:
/// translations x, y, z, rotations x, y, z about the remote centre, of the finger at -y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupling(Matrix6<f64>);

impl Rcc {
    /// The paper's, for all directions.
    pub const PAPER: Rcc = Rcc { at_zero: 21.0 * MM, per_degree: 0.0 };

    /// The distance for an infill direction in degrees, m.
    pub fn at(&self, direction_deg: f64) -> f64 {
        // 0 times an unknown direction is not unknown.
        if self.per_degree == 0.0 {
            return self.at_zero;
        }
        self.at_zero + self.per_degree * direction_deg
    }
}

impl Coupling {
    /// From the coefficients of pairs of axes; `None` unless positive definite.
    pub fn new(pairs: impl IntoIterator<Item = (usize, usize, f64)>) -> Option<Self> {
        let mut matrix = Matrix6::identity();
        for (i, j, coefficient) in pairs {
            matrix[(i, j)] = coefficient;
            matrix[(j, i)] = coefficient;
        }
        matrix.cholesky().map(|_| Coupling(matrix))
    }

    /// The coefficients of a stiffness matrix; `None` unless it is positive definite.
    pub fn of(stiffness: &Matrix6<f64>) -> Option<Self> {
        stiffness.cholesky()?;
        let scale = |i: usize, j: usize| (stiffness[(i, i)] * stiffness[(j, j)]).sqrt();
        Some(Coupling(Matrix6::from_fn(|i, j| match i == j {
            true => 1.0,
            false => stiffness[(i, j)] / scale(i, j),
        })))
    }

    /// The stiffness of such springs; the finger at +y (`side` +1) is turned by 180° about z.
    pub fn stiffness(&self, springs: [f64; 6], side: f64) -> Matrix6<f64> {
        let flips = [side, side, -1.0, side, side, -1.0];
        Matrix6::from_fn(|i, j| {
            self.0[(i, j)] * (springs[i] * springs[j]).sqrt() * flips[i] * flips[j]
        })
    }
}

const LARGEST_DIRECTION_DEG: f64 = 90.0;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawFinger {
    rcc_mm: Option<RawRcc>,
    #[serde(default)]
    coupling: Vec<RawCoupling>,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(untagged, deny_unknown_fields)]
#[serde(expecting = "a number of mm, or { at_0_deg = mm, per_deg = mm }")]
enum RawRcc {
    Fixed(f64),
    ByDirection { at_0_deg: f64, per_deg: f64 },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCoupling {
    axes: [RawAxis; 2],
    coefficient: f64,
}

#[derive(Deserialize, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
#[serde(rename_all = "kebab-case")]
enum RawAxis {
    X,
    Y,
    Z,
    Rx,
    Ry,
    Rz,
}

pub(super) fn finger(check: Check<'_>, raw: &RawFinger) -> Result<FingerModel, InputError> {
    let rcc = raw.rcc_mm.map(|raw| rcc(check, raw)).transpose()?;
    Ok(FingerModel { rcc, coupling: coupling(check, &raw.coupling)? })
}

fn rcc(check: Check<'_>, raw: RawRcc) -> Result<Rcc, InputError> {
    let key = "finger.rcc_mm";
    let rcc = match raw {
        RawRcc::Fixed(mm) => Rcc { at_zero: check.positive(key, mm)? * MM, per_degree: 0.0 },
        RawRcc::ByDirection { at_0_deg, per_deg } => Rcc {
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
        let [low, high] = [first.min(second), first.max(second)].map(|axis| *axis as usize);
        if pairs.iter().any(|&(i, j, _)| (i, j) == (low, high)) {
            return check.fail(key, format!("couples {first:?} and {second:?} twice"));
        }
        pairs.push((low, high, check.finite(key, *coefficient)?));
    }
    if pairs.is_empty() {
        return Ok(None);
    }
    let problem = "would let the finger run away: the 6x6 matrix of coefficients, with ones on its \
                   diagonal, must be positive definite (one coefficient alone: between -1 and 1)";
    Coupling::new(pairs).map_or_else(|| check.fail(key, problem), |coupling| Ok(Some(coupling)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::task_file;
    use crate::task::Task;

    fn parse(finger: &str) -> Result<FingerModel, String> {
        let text = task_file("usb").text.replace("[friction]", &format!("{finger}\n[friction]"));
        Task::parse(&text, "usb.toml").map(|task| task.finger).map_err(|error| error.to_string())
    }

    #[test]
    fn the_remote_centre_is_nothing_a_number_or_a_line() {
        assert_eq!(parse(""), Ok(FingerModel::default()));
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
                "[finger]\nrcc_mm = { at_0_deg = 2.0, per_degree = 1.0 }".to_owned(),
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
