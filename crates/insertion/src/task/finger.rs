//! Remote centre and coupled springs of the fingers, from a task file.

use input::units::{MM, read::mm};
use input::{Check, InputError, shown};
use nalgebra::Matrix6;
use serde::Deserialize;

/// Properties of the fingers that a task file may set, besides the measured stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FingerModel {
    /// Remote centre of compliance, if the file gives it.
    pub rcc: Option<Rcc>,
    /// Coupling of the springs, if the file gives it.
    pub coupling: Option<Coupling>,
}

/// Distance of the remote centre below the TCP, towards the plug's tip, by infill direction.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(untagged, deny_unknown_fields)]
#[serde(expecting = "a number of mm, or { at_0_deg = mm, per_deg = mm }")]
pub enum Rcc {
    /// One distance for all directions, m.
    Fixed(#[serde(deserialize_with = "mm")] f64),
    /// Linear in the direction.
    ByDirection {
        /// Distance at 0 degrees, m.
        #[serde(deserialize_with = "mm")]
        at_0_deg: f64,
        /// Change with each degree, m.
        #[serde(deserialize_with = "mm")]
        per_deg: f64,
    },
}

/// Coefficients `c` that couple the six springs: `k_ij = c_ij sqrt(k_i k_j)`. If the matrix with ones
/// on its diagonal is positive definite, so is the stiffness of any design. Order: translations x, y,
/// z, rotations x, y, z about the remote centre, of the finger at -y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupling(Matrix6<f64>);

impl Rcc {
    /// Distance in the paper, m.
    pub const PUBLISHED_DISTANCE: f64 = 21.0 * MM;

    /// Returns the distance for an infill direction in degrees, m.
    pub fn at(&self, direction_deg: f64) -> f64 {
        match self {
            Rcc::Fixed(distance) => *distance,
            Rcc::ByDirection { at_0_deg, per_deg } => at_0_deg + per_deg * direction_deg,
        }
    }

    /// Returns whether the distance depends on the infill direction.
    pub fn varies(&self) -> bool {
        matches!(self, Rcc::ByDirection { per_deg, .. } if *per_deg != 0.0)
    }
}

impl Coupling {
    /// Returns the coupling with these coefficients of pairs of axes; `None` unless the matrix is positive definite.
    pub fn new(pairs: impl IntoIterator<Item = (usize, usize, f64)>) -> Option<Self> {
        let mut matrix = Matrix6::identity();
        for (i, j, coefficient) in pairs {
            matrix[(i, j)] = coefficient;
            matrix[(j, i)] = coefficient;
        }
        matrix.cholesky().map(|_| Coupling(matrix))
    }

    /// Returns the coupling of a stiffness matrix; `None` unless it is positive definite.
    pub fn of(stiffness: &Matrix6<f64>) -> Option<Self> {
        stiffness.cholesky()?;
        let scale = |i: usize, j: usize| (stiffness[(i, i)] * stiffness[(j, j)]).sqrt();
        let coefficient = |i: usize, j: usize| stiffness[(i, j)] / scale(i, j);
        Some(Coupling(Matrix6::from_fn(|i, j| if i == j { 1.0 } else { coefficient(i, j) })))
    }

    /// Returns the stiffness matrix of these springs; the finger at +y (`side` +1) is turned by 180° about z.
    pub fn stiffness(&self, springs: [f64; 6], side: f64) -> Matrix6<f64> {
        let flips = [side, side, -1.0, side, side, -1.0];
        Matrix6::from_fn(|i, j| {
            self.0[(i, j)] * (springs[i] * springs[j]).sqrt() * flips[i] * flips[j]
        })
    }
}

const MAX_DIRECTION_DEG: f64 = 90.0;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct RawFinger {
    #[serde(rename = "rcc_mm")]
    rcc: Option<Rcc>,
    #[serde(default)]
    coupling: Vec<RawCoupling>,
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
    if let Some(last) = raw.rcc.map(|rcc| rcc.at(MAX_DIRECTION_DEG) / MM)
        && last <= 0.0
    {
        let problem = format!("is {} mm at 90 degrees; it must stay above 0", shown(last));
        return check.fail("finger.rcc_mm", problem);
    }
    Ok(FingerModel { rcc: raw.rcc, coupling: coupling(check, &raw.coupling)? })
}

fn coupling(check: Check<'_>, raw: &[RawCoupling]) -> Result<Option<Coupling>, InputError> {
    let key = "finger.coupling";
    let mut pairs: Vec<(usize, usize, f64)> = Vec::new();
    for RawCoupling { axes: [first, second], coefficient } in raw {
        if first == second {
            return check.fail(key, format!("couples {first:?} with itself; the axes must differ"));
        }
        let [low, high] = [first.min(second), first.max(second)].map(|axis| *axis as usize);
        if pairs.iter().any(|&(i, j, _)| (i, j) == (low, high)) {
            return check.fail(key, format!("couples {first:?} and {second:?} twice"));
        }
        pairs.push((low, high, *coefficient));
    }
    if pairs.is_empty() {
        return Ok(None);
    }
    let problem = "the 6x6 matrix of the coefficients, with ones on its diagonal, is not positive definite; \
                   give smaller coefficients";
    Coupling::new(pairs).map_or_else(|| check.fail(key, problem), |coupling| Ok(Some(coupling)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::task::Task;
    use crate::tests::fixtures::{refused, task_file};

    fn parse(finger: &str) -> Result<FingerModel, String> {
        let text = task_file("usb").text.replace("[friction]", &format!("{finger}\n[friction]"));
        Task::parse(&text, "usb.toml").map(|task| task.finger).map_err(|error| error.to_string())
    }

    #[test]
    fn the_remote_centre_is_absent_constant_or_linear() {
        assert_eq!(parse(""), Ok(FingerModel::default()));
        assert_eq!(parse("[finger]\nrcc_mm = 25").unwrap().rcc.unwrap().at(40.0), 25.0 * MM);
        let line =
            parse("[finger]\nrcc_mm = { at_0_deg = 21.0, per_deg = 0.25 }").unwrap().rcc.unwrap();
        assert!((line.at(40.0) - 31.0 * MM).abs() < 1e-15);
    }

    #[test]
    fn invalid_fingers_are_refused() {
        let rcc = |value: &str| format!("[finger]\nrcc_mm = {value}");
        let pair =
            |axes: &str, c: f64| format!("[[finger.coupling]]\naxes = {axes}\ncoefficient = {c}\n");
        for (text, part) in [
            (rcc("-1.0"), "finger.rcc_mm: is -1"),
            (rcc("nan"), "finger.rcc_mm"),
            (rcc("\"far\""), "a number of mm, or {"),
            (rcc("{ at_0_deg = 2.0, per_degree = 1.0 }"), "a number of mm, or {"),
            (rcc("{ at_0_deg = 21.0, per_deg = -1.0 }"), "at 90 degrees"),
            ("[finger]\nrcc = 21.0".to_owned(), "rcc"),
            (pair("[\"y\", \"y\"]", 0.1), "with itself"),
            (pair("[\"y\", \"z\"]", 1.5), "must lie in -1 .. 1"),
            (pair("[\"y\", \"z\"]", 1.0), "positive definite"),
            (pair("[\"y\", \"w\"]", 0.5), "w"),
            (pair("[\"y\", \"z\"]", 0.5) + &pair("[\"z\", \"y\"]", 0.5), "twice"),
        ] {
            refused(parse(&text), &["usb.toml", part]);
        }
        assert!(parse(&pair("[\"y\", \"rx\"]", 0.5)).unwrap().coupling.is_some());
    }
}
