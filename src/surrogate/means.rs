//! The measured fingers as their ribs have them: how far each mean carries, and what the slicer's
//! rib phase, the width of a printed line and the modulus leave open.

use super::compare::{Comparison, Verdict, compare};
use super::{Model, scale};
use crate::finger::printed::FingerError;
use crate::finger::printed::phases::{Planar, over_line_widths};
use crate::finger::printed::stiffness::PlanarStiffness;
use crate::input::stiffness::{Axis, Measurement};

/// What is computed of measured fingers.
#[derive(Debug)]
pub struct Means {
    /// Errors on designs left out.
    pub comparisons: Vec<Comparison>,
    /// What leave-one-out prefers, assembly first; none of a single finger.
    pub verdicts: Vec<Verdict>,
    /// The fingers, in input order.
    pub fingers: Vec<ComputedFinger>,
    /// Standard deviation of the modulus, percent: of the mean of measured / computed compliance
    /// stiffness. Every stiffness has it, no centre.
    pub modulus_percent: f64,
}

/// One measured finger, computed.
#[derive(Debug)]
pub struct ComputedFinger {
    /// As measured.
    pub measurement: Measurement,
    phases: Vec<Planar>,
    line_widths: [Planar; 2],
}

/// What a computed quantity may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Over the rib phases.
    pub median: f64,
    /// Over the rib phases.
    pub lowest: f64,
    /// Over the rib phases.
    pub highest: f64,
    /// Half the change from lines thinner by their error to lines thicker by it.
    pub by_line_width: f64,
}

impl ComputedFinger {
    /// A quantity, with the part touching the pad (0) or pad and roof (1), in its own unit.
    pub fn spread(&self, body: usize, quantity: impl Fn(&PlanarStiffness) -> f64) -> Spread {
        let mut sorted: Vec<f64> = self.phases.iter().map(|found| quantity(&found[body])).collect();
        sorted.sort_by(f64::total_cmp);
        let at = |i: usize| sorted.get(i).copied().unwrap_or(f64::NAN);
        let last = sorted.len().saturating_sub(1);
        let [thin, thick] = self.line_widths.each_ref().map(|found| quantity(&found[body]));
        Spread {
            median: (at(last / 2) + at(last.div_ceil(2))) / 2.0,
            lowest: at(0),
            highest: at(last),
            by_line_width: (thick - thin).abs() / 2.0,
        }
    }
}

/// Computes the fingers that a model was fitted to and compares the means.
///
/// # Errors
/// If one of them cannot be computed.
pub fn means(model: &Model) -> Result<Means, FingerError> {
    let (measurements, computed) = (model.measurements(), model.computed());
    let of = |measurement: &Measurement| {
        let [density, direction] = measurement.infill();
        Ok(ComputedFinger {
            measurement: *measurement,
            phases: computed.phases([density, direction])?,
            line_widths: over_line_widths(computed.finger(), density, direction)?,
        })
    };
    let fingers = measurements.iter().map(of).collect::<Result<Vec<_>, FingerError>>()?;
    let (comparisons, verdicts) = compare(measurements, computed)?;
    let ratio =
        |m: &Measurement| Ok(m.compliance / computed.stiffness(Axis::Compliance, m.infill())?);
    let ratios = measurements.iter().map(ratio).collect::<Result<Vec<f64>, FingerError>>()?;
    let modulus_percent = scale::error_percent(Axis::Compliance, &ratios);
    Ok(Means { comparisons, verdicts, fingers, modulus_percent })
}
