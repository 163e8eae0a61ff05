//! The one form in which a predicted stiffness leaves the program.

use super::{Estimate, Prediction};
use input::units::N_PER_MM;
use serde::{Deserialize, Deserializer, Serialize};

/// A [`Prediction`] in N/mm, to six decimals.
#[derive(Serialize, Deserialize)]
pub(super) struct StiffnessRow {
    #[serde(deserialize_with = "null_is_nan")]
    compliance_n_per_mm: f64,
    #[serde(deserialize_with = "null_is_nan")]
    compliance_sd_n_per_mm: f64,
    #[serde(deserialize_with = "null_is_nan")]
    assembly_n_per_mm: f64,
    #[serde(deserialize_with = "null_is_nan")]
    assembly_sd_n_per_mm: f64,
    #[serde(deserialize_with = "null_is_nan")]
    hull_distance: f64,
    inside_hull: bool,
}

/// JSON has no NaN: it is written as null.
pub(crate) fn null_is_nan<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

impl From<Prediction> for StiffnessRow {
    fn from(stiffness: Prediction) -> Self {
        // To a millionth of a N/mm, so that what is read back is written alike.
        let n_per_mm = |n_per_m: f64| (n_per_m / N_PER_MM * 1e6).round() / 1e6;
        StiffnessRow {
            compliance_n_per_mm: n_per_mm(stiffness.compliance.mean),
            compliance_sd_n_per_mm: n_per_mm(stiffness.compliance.sd),
            assembly_n_per_mm: n_per_mm(stiffness.assembly.mean),
            assembly_sd_n_per_mm: n_per_mm(stiffness.assembly.sd),
            hull_distance: stiffness.hull_distance,
            inside_hull: stiffness.inside_hull(),
        }
    }
}

impl From<StiffnessRow> for Prediction {
    fn from(row: StiffnessRow) -> Self {
        let estimate = |mean: f64, sd: f64| Estimate { mean: mean * N_PER_MM, sd: sd * N_PER_MM };
        Prediction {
            compliance: estimate(row.compliance_n_per_mm, row.compliance_sd_n_per_mm),
            assembly: estimate(row.assembly_n_per_mm, row.assembly_sd_n_per_mm),
            hull_distance: row.hull_distance,
        }
    }
}
