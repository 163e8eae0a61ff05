//! Stiffness of fingers whose shape or material differs from the finger file.
//!
//! The prediction for the infill is multiplied by the ratio of two computed stiffnesses: that of this finger and that
//! of the finger in the file with the same infill. Designs that keep the numbers of the file keep their predictions.
//! The error of the computed stiffness varies between fingers: the standard deviation of ln(measured / computed) over
//! the measured fingers is added in quadrature to that of the prediction.

use crate::finger::file::is_shape;
use crate::finger::model::ComputedFingers;
use crate::{Design, Estimate, Measurement, Prediction};
use ask_tell::statistics::Moments;
use finray::mechanics::FingerStiffness;
use input::InputError;

/// Returns the prediction for a design from `infill`, the prediction for a finger of the file with its infill. For each
/// changed number of the file, `ln(value / file value)` is added in quadrature to `hull_distance`.
///
/// # Errors
/// If a finger cannot be computed.
pub fn predict(
    fingers: &ComputedFingers,
    measured: &[Measurement],
    design: &Design,
    infill: Prediction,
) -> Result<Prediction, InputError> {
    let change = |(key, value): (&String, &f64)| {
        fingers.file.numbers.number(key).map_or(0.0, |from| libm::log(value / from))
    };
    let shape = design.0.iter().filter(|(key, _)| is_shape(key));
    let squared_change: f64 = shape.map(change).map(|change| change * change).sum();
    if squared_change == 0.0 {
        return Ok(infill);
    }
    let mut original = design.clone();
    original.0.retain(|key, _| !is_shape(key));
    let changed = by_direction(&fingers.stiffness(design)?);
    let original = by_direction(&fingers.stiffness(&original)?);
    let scatter = scatter(fingers, measured)?;
    let scaled = |axis: usize, Estimate { mean, sd }: Estimate| {
        let factor = changed[axis] / original[axis];
        let mean = mean * factor;
        Estimate { mean, sd: libm::hypot(sd * factor, mean * scatter[axis]) }
    };
    Ok(Prediction {
        compliance: scaled(0, infill.compliance),
        assembly: scaled(1, infill.assembly),
        hull_distance: (infill.hull_distance.powi(2) + squared_change).sqrt(),
    })
}

/// Returns the computed stiffness in the compliance and in the assembly direction, N/m.
///
/// Pad and roof are held, as in a trial. `ComputedStiffness` of the surrogate holds the pad alone in the compliance
/// direction, which is 0.7, 0.3 and 0.2 % softer at 10 %, 0°, at 20 %, 20° and at 30 %, 0°; in the ratio of two fingers
/// this cancels to less than 0.7 % for a single shape number at a bound of `spaces/finger.toml`.
fn by_direction(computed: &FingerStiffness) -> [f64; 2] {
    [computed.pad_and_roof.in_compliance(), computed.pad_and_roof.in_assembly()]
}

/// Returns the standard deviation of ln(measured / computed) over the measured fingers in both directions; 1 for fewer
/// than two fingers.
fn scatter(fingers: &ComputedFingers, measured: &[Measurement]) -> Result<[f64; 2], InputError> {
    let ratios = measured.iter().map(|m| {
        let [density, direction] = m.infill();
        let computed = fingers.stiffness(&Design::infill(density, direction))?;
        let [compliance, assembly] = by_direction(&computed);
        Ok([libm::log(m.compliance / compliance), libm::log(m.assembly / assembly)])
    });
    let ratios: Vec<[f64; 2]> = ratios.collect::<Result<_, InputError>>()?;
    Ok([0, 1].map(|axis| {
        let scatter = Moments::of(ratios.iter().map(|ratio| ratio[axis])).sample_deviation();
        if scatter.is_nan() { 1.0 } else { scatter }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{DENSITY_KEY, DIRECTION_KEY};
    use crate::tests::fixtures::{finger_file, predicted};
    use input::units::N_PER_MM;

    const MODULUS: &str = "finger.material.modulus_gpa";

    fn fingers() -> ComputedFingers {
        ComputedFingers::new(finger_file())
    }

    fn plain() -> Prediction {
        predicted([2.4, 0.1], [40.0, 1.0])
    }

    fn design(more: &[(&str, f64)]) -> Design {
        let infill = [(DENSITY_KEY, 20.0), (DIRECTION_KEY, 20.0)];
        Design(infill.iter().chain(more).map(|&(key, value)| (key.to_owned(), value)).collect())
    }

    /// Measured fingers that are twice and half as stiff as computed.
    fn measured(fingers: &ComputedFingers) -> Vec<Measurement> {
        [(10.0, 2.0), (30.0, 0.5)]
            .map(|(density, factor)| {
                let computed = fingers.stiffness(&Design::infill(density, 0.0)).unwrap();
                let [compliance, assembly] = by_direction(&computed);
                Measurement {
                    design: 1,
                    density_percent: density,
                    direction_deg: 0.0,
                    assembly,
                    compliance: compliance * factor,
                }
            })
            .to_vec()
    }

    #[test]
    fn the_file_itself_keeps_its_prediction() {
        let fingers = fingers();
        for design in [design(&[]), design(&[(MODULUS, 2.0)])] {
            assert_eq!(predict(&fingers, &[], &design, plain()), Ok(plain()));
        }
    }

    #[test]
    fn half_the_modulus_is_half_the_stiffness_with_the_scatter_of_the_ratio() {
        let fingers = fingers();
        let found =
            predict(&fingers, &measured(&fingers), &design(&[(MODULUS, 1.0)]), plain()).unwrap();
        let close = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-9;
        assert!(close(found.compliance.mean, 1.2 * N_PER_MM), "{found:?}");
        assert!(close(found.assembly.mean, 20.0 * N_PER_MM), "{found:?}");
        // ln 2 and -ln 2 scatter by sqrt(2) ln 2.
        let sd = libm::hypot(0.05, 1.2 * 2f64.sqrt() * libm::log(2.0));
        assert!(close(found.compliance.sd, sd * N_PER_MM), "{found:?}");
        assert!(close(found.assembly.sd, 0.5 * N_PER_MM), "its ratio does not scatter: {found:?}");
        assert!(close(found.hull_distance, libm::log(2.0)), "{found:?}");
    }
}
