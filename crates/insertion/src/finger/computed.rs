//! Computed finger: springs about its remote centre that reproduce the measured stiffness at the pad.
//!
//! A force at the middle of the pad deflects both the spring at a centre `s` below and `c` in front of the pad and the
//! tilting spring `k_t`. The two springs are in series, so
//!
//! ```text
//! 1/k_y,centre = 1/k_y - s^2/k_t,   1/k_z,centre = 1/k_z - c^2/k_t
//! ```
//!
//! Out of the plane (x, ry, rz), the full 3 x 3 stiffness of the plate at the pad, with its coupling of x to ry and rz,
//! is transformed to the same centre.

use super::{Finger, Pad};
use crate::Prediction;
use crate::task::finger::Coupling;
use finray::printed::PrintedFinger;
use finray::stiffness::PlanarStiffness;
use input::InputError;
use input::units::{MM, N_PER_MM};
use nalgebra::{Matrix3, Matrix6};

/// Returns the finger with the stiffness `at_pad` in y and z at the pad.
///
/// `plane` is the stiffness computed in the plane of the finger (y, z, rx), `across` the stiffness out of it (x, ry,
/// rz; SI units), both at the middle of the pad. `shoulder` is the height of the part's shoulder above the TCP, m.
/// `rcc`, the distance of the remote centre below the TCP, m, and `tilting`, the tilting stiffness, N m/rad, replace
/// computed values.
///
/// # Errors
/// If tilting about the centre alone is softer than the stiffness at the pad.
pub(super) fn finger(
    printed: &PrintedFinger,
    plane: PlanarStiffness,
    across: Matrix3<f64>,
    shoulder: f64,
    at_pad: &Prediction,
    [rcc, tilting]: [Option<f64>; 2],
) -> Result<Finger, InputError> {
    let [compliance, assembly] = [at_pad.compliance.mean, at_pad.assembly.mean];
    let outline = &printed.outline;
    let pad = Pad { width: outline.depth, height: outline.pad, roof: outline.roof };
    let middle = pad.middle(shoulder);
    let rcc = rcc.unwrap_or(plane.centre_below_pad() - middle);
    let (below, ahead) = (rcc + middle, plane.centre_in_front());
    let tilting = tilting.unwrap_or(plane.tilting());
    // Compliances at the centre, m/N.
    let at_centre = |name, stiffness: f64, lever: f64| {
        let centre = 1.0 / stiffness - lever * lever / tilting;
        if centre > 0.0 {
            return Ok(centre);
        }
        let (at_pad, by_tilting) = (stiffness / N_PER_MM, tilting / (lever * lever) / N_PER_MM);
        let problem = format!(
            "{name} stiffness {at_pad:.2} N/mm at the pad is impossible with a remote centre \
             {:.1} mm away and tilting stiffness {tilting:.2} N m/rad: tilting alone limits it to \
             {by_tilting:.2} N/mm; move finger.rcc_mm nearer to the pad, or use --finger-model \
             paper",
            lever / MM
        );
        Err(printed.fault(problem))
    };
    let in_y = at_centre("compliance", compliance, below)?;
    let in_z = at_centre("assembly", assembly, ahead)?;
    // x at the pad = x at the centre + ry * below + rz * ahead.
    let to_pad = Matrix3::new(1.0, below, ahead, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    let across = to_pad.transpose() * across * to_pad;
    // Stiffness on all six axes at the centre.
    let mut matrix = Matrix6::zeros();
    (matrix[(1, 1)], matrix[(2, 2)], matrix[(3, 3)]) = (1.0 / in_y, 1.0 / in_z, tilting);
    for (i, row) in ACROSS.into_iter().enumerate() {
        for (j, column) in ACROSS.into_iter().enumerate() {
            matrix[(row, column)] = across[(i, j)];
        }
    }
    Ok(Finger {
        compliance: matrix[(1, 1)],
        assembly: matrix[(2, 2)],
        depth: matrix[(0, 0)],
        rotation: [tilting, matrix[(4, 4)], matrix[(5, 5)]],
        rcc,
        ahead,
        pad,
        coupling: Coupling::of(&matrix),
        ..Finger::new(compliance, assembly)
    })
}

/// Indices of x, ry and rz among the six axes.
const ACROSS: [usize; 3] = [0, 4, 5];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::fixtures::{finger_file, refused};
    use nalgebra::Vector3;

    const SHOULDER: f64 = 3.5 * MM;
    const AT_PAD: [f64; 2] = [2.6e3, 45e3];

    /// Returns the stiffness of springs at a centre below and in front of the pad, and of a plate.
    fn stiffness(below: f64, ahead: f64, tilting: f64) -> (PlanarStiffness, Matrix3<f64>) {
        let to_centre = Matrix3::new(1.0, 0.0, below, 0.0, 1.0, ahead, 0.0, 0.0, 1.0);
        let springs = Matrix3::from_diagonal(&Vector3::new(9e3, 9e4, tilting));
        let plane = PlanarStiffness::new(to_centre.transpose() * springs * to_centre).unwrap();
        let across = Matrix3::new(6e4, -600.0, -200.0, -600.0, 9.0, 1.0, -200.0, 1.0, 5.0);
        (plane, across)
    }

    fn finger(
        [compliance, assembly]: [f64; 2],
        overrides: [Option<f64>; 2],
    ) -> Result<Finger, InputError> {
        let (plane, across) = stiffness(8.0 * MM, -2.0 * MM, 2.5);
        super::finger(
            &finger_file().finger,
            plane,
            across,
            SHOULDER,
            &Prediction::exact(compliance, assembly),
            overrides,
        )
    }

    fn at_pad_middle(finger: &Finger) -> Matrix6<f64> {
        let springs = finger.springs().map(|spring| spring.stiffness);
        let stiffness = finger.coupling.unwrap().stiffness(springs, -1.0);
        let from_centre =
            Vector3::new(0.0, 0.0, finger.pad.middle(SHOULDER)) - finger.centre(-1.0).coords;
        let mut to_pad = Matrix6::identity();
        to_pad.fixed_view_mut::<3, 3>(0, 3).copy_from(&-from_centre.cross_matrix());
        to_pad * stiffness.try_inverse().unwrap() * to_pad.transpose()
    }

    #[test]
    fn a_finger_has_the_measured_stiffness_at_the_pad_and_the_computed_tilting_stiffness() {
        let finger = finger(AT_PAD, [None; 2]).unwrap();
        let compliance = at_pad_middle(&finger);
        for (axis, stiffness) in [(1, 2.6e3), (2, 45e3), (3, 2.5)] {
            let found = 1.0 / compliance[(axis, axis)];
            assert!((found / stiffness - 1.0).abs() < 1e-12, "{axis}: {found}");
        }
        // The pad's middle lies 0.95 mm below the TCP of the keys.
        assert!((finger.rcc - 8.95 * MM).abs() < 1e-12 && finger.compliance > AT_PAD[0]);
        assert_eq!(finger.pad.height, 9.0 * MM);
        let plate = stiffness(0.0, 0.0, 1.0).1.try_inverse().unwrap();
        for (i, row) in ACROSS.into_iter().enumerate() {
            for (j, column) in ACROSS.into_iter().enumerate() {
                let error = compliance[(row, column)] - plate[(i, j)];
                assert!(error.abs() < 1e-9 * plate[(i, i)].max(plate[(j, j)]), "{i} {j}");
            }
        }
    }

    #[test]
    fn a_given_centre_replaces_the_computed_one() {
        let finger = finger(AT_PAD, [Some(5.0 * MM), Some(3.0)]).unwrap();
        assert_eq!((finger.rcc, finger.rotation[0]), (5.0 * MM, 3.0));
        assert!((1.0 / at_pad_middle(&finger)[(1, 1)] / 2.6e3 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_centre_too_far_away_for_the_stiffness_is_rejected() {
        let parts = ["finray9", "2.60 N/mm", "compliance", "39.0 mm", "2.50 N m/rad", "rcc_mm"];
        refused(finger(AT_PAD, [Some(40.0 * MM), None]), &parts);
        refused(finger([AT_PAD[0], 1e6], [None; 2]), &["assembly"]);
    }
}
