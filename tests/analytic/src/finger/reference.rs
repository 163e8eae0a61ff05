//! F4: plane-stress solutions of the measured designs by another program: quadratic triangles of
//! 0.4 mm, E = 2 GPa, Poisson 0.4, geometry of the authors' CAD, at the phases given.

use super::finray9;
use crate::{CheckRow, Tolerance};
use finray::geometry::Geometry;
use finray::infill::InfillDesign;
use finray::mechanics::planar;
use finray::stiffness::PlanarStiffness;
use input::units::{MM, N_PER_MM};

/// Density, %; direction, degrees; phase, mm; then ky, N/mm, of the pad; then pad and
/// pad + roof: kz, N/mm; tilting, N m/rad; centre below and in front of the pad's middle, mm.
type Row = ([f64; 3], f64, [[f64; 2]; 4]);

const TABLE: [Row; 11] = [
    ([10.0, 0.0, 3.193], 1.19, [[23.5, 30.9], [2.70, 9.06], [10.0, 26.1], [-2.7, 5.2]]),
    ([10.0, 30.0, 3.193], 1.45, [[22.2, 26.3], [1.59, 4.06], [12.1, 26.5], [0.5, 7.8]]),
    ([15.0, 30.0, 0.653], 1.90, [[27.2, 34.1], [1.78, 4.86], [9.8, 22.9], [-0.3, 7.0]]),
    ([20.0, 0.0, 1.288], 2.09, [[32.3, 51.0], [3.17, 11.09], [5.1, 16.5], [-4.1, 3.0]]),
    ([20.0, 20.0, 1.288], 2.29, [[33.4, 46.2], [2.43, 8.01], [7.3, 20.5], [-1.9, 5.7]]),
    ([20.0, 40.0, 1.288], 2.64, [[32.0, 41.3], [2.03, 5.20], [9.3, 21.9], [-0.2, 6.9]]),
    ([25.0, 0.0, 0.145], 2.59, [[44.2, 61.6], [4.96, 18.02], [4.0, 11.6], [-4.2, 2.0]]),
    ([25.0, 40.0, 0.145], 3.11, [[36.5, 46.9], [2.18, 5.44], [8.8, 19.8], [-0.2, 6.5]]),
    ([30.0, 0.0, 0.653], 3.00, [[44.7, 70.9], [4.31, 17.52], [3.1, 10.6], [-4.7, 2.0]]),
    ([30.0, 20.0, 0.653], 3.26, [[43.7, 64.9], [3.39, 11.91], [5.0, 16.0], [-3.0, 4.2]]),
    ([30.0, 40.0, 0.653], 3.51, [[39.6, 52.1], [2.12, 5.68], [7.7, 18.1], [-0.6, 6.1]]),
];

/// The reference held nodes within 2.5 mm of the notch's corner, every 0.2 mm: the last lies here.
const HELD_ROOF: f64 = 2.4 * MM;
/// A centre is given to 0.1 mm, and moves by as much with the mesh, mm.
const CENTRE: f64 = 0.2;
/// Largest relative errors of a stiffness and a centre, and of a tilting stiffness.
const CLOSE: f64 = 0.03;
const TILTING: f64 = 0.08;

/// Number of the table: its name, its unit, the tabled and the computed value.
type Quantity = (String, &'static str, fn(&Row) -> f64, fn(&[PlanarStiffness; 2]) -> f64);

/// Returns the design with the largest error for each number of the table, F4 rows.
pub fn f4() -> Vec<CheckRow> {
    let computed: Option<Vec<_>> = TABLE.iter().map(stiffness).collect();
    quantities().into_iter().map(|quantity| worst(&quantity, computed.as_deref())).collect()
}

fn stiffness(row: &Row) -> Option<[PlanarStiffness; 2]> {
    let mut finger = finray9()?;
    finger.outline.roof = HELD_ROOF;
    let [density_percent, direction_deg, phase] = row.0;
    let design = InfillDesign { density_percent, direction_deg, phase_mm: Some(phase) };
    planar(&Geometry::new(&finger, &design).ok()?).ok()
}

fn quantities() -> Vec<Quantity> {
    let pad = |text: &str| format!("{text}, pad");
    let both = |text: &str| format!("{text}, pad+roof");
    vec![
        (pad("ky"), "N/mm", |row| row.1, |k| k[0].in_compliance() / N_PER_MM),
        (pad("kz"), "N/mm", |row| row.2[0][0], |k| k[0].in_assembly() / N_PER_MM),
        (both("kz"), "N/mm", |row| row.2[0][1], |k| k[1].in_assembly() / N_PER_MM),
        (pad("tilting"), "Nm", |row| row.2[1][0], |k| k[0].tilting()),
        (both("tilting"), "Nm", |row| row.2[1][1], |k| k[1].tilting()),
        (pad("centre below"), "mm", |row| row.2[2][0], |k| k[0].centre_below_pad() / MM),
        (both("centre below"), "mm", |row| row.2[2][1], |k| k[1].centre_below_pad() / MM),
        (pad("centre in front"), "mm", |row| row.2[3][0], |k| k[0].centre_in_front() / MM),
        (both("centre in front"), "mm", |row| row.2[3][1], |k| k[1].centre_in_front() / MM),
    ]
}

fn worst(
    (text, unit, tabled, found): &Quantity,
    computed: Option<&[[PlanarStiffness; 2]]>,
) -> CheckRow {
    let allowed = |expected: f64| match *unit {
        "mm" => (CLOSE * expected.abs()).max(CENTRE),
        "Nm" => TILTING * expected,
        _ => CLOSE * expected,
    };
    let share = |(row, k): &(&Row, &[PlanarStiffness; 2])| {
        (found(k) - tabled(row)).abs() / allowed(tabled(row))
    };
    let row = |(row, measured): (&Row, Option<f64>)| {
        let ([density, direction, _], expected) = (row.0, tabled(row));
        let text = format!("{text}, worst: {density} %, {direction} deg");
        let tolerance = match *unit {
            "mm" => Tolerance::Absolute(allowed(expected)),
            _ => Tolerance::Relative(allowed(expected) / expected),
        };
        CheckRow::new("F4", text, expected, measured.ok_or(()), unit, tolerance)
    };
    let pairs = TABLE.iter().zip(computed.unwrap_or_default());
    let worst = pairs.max_by(|a, b| share(a).total_cmp(&share(b)));
    row(worst.map_or((&TABLE[0], None), |(row, k)| (row, Some(found(k)))))
}
