//! Remote centre and tilting stiffness by infill, as the ribs have them: what nobody measured.

use super::chart::{Area, AxisOf, Drawn, around, axes, legend, message};
use super::marks::{dashed, line};
use super::theme::{BLUE, GREEN, ORANGE};
use crate::finger::Finger;
use crate::finger::printed::FingerError;
use crate::finger::printed::stiffness::PlanarStiffness;
use crate::surrogate::Computed;
use crate::units::MM;
use plotters::prelude::*;

/// Directions at which the mechanics is asked, degrees.
const DIRECTIONS: [f64; 3] = [0.0, 20.0, 40.0];

/// One density: at each direction the smallest, middle and largest value over the rib phases.
struct Curve {
    density: f64,
    centre_mm: Vec<[f64; 3]>,
    tilting: Vec<[f64; 3]>,
}

/// Two panels, pad and roof touching: curves with a band over the places where the first rib may
/// lie; dashed what the paper has for all designs.
pub(super) fn draw(
    [centre, tilting]: [&Area<'_>; 2],
    fingers: &Computed,
    densities: &[f64],
) -> Drawn {
    // A density whose ribs merge has no curve.
    let curves: Vec<Curve> =
        densities.iter().filter_map(|&density| curve(fingers, density).ok()).collect();
    let paper = Finger::new(1.0, 1.0);
    // The grasp point, from which the paper counts, lies 1 to 2 mm above the pad's middle.
    let below = "remote centre below the pad (mm); dashed: below the grasp point";
    let (value, corner) = (paper.rcc / MM, SeriesLabelPosition::LowerRight);
    panel(centre, below, value, &curves, |curve| &curve.centre_mm, corner)?;
    let stiffness = "tilting stiffness (N m/rad)";
    let corner = SeriesLabelPosition::UpperRight;
    panel(tilting, stiffness, paper.rotation[0], &curves, |curve| &curve.tilting, corner)
}

fn curve(fingers: &Computed, density: f64) -> Result<Curve, FingerError> {
    let (mut centre_mm, mut tilting) = (Vec::new(), Vec::new());
    for direction in DIRECTIONS {
        let found = fingers.phases([density, direction])?;
        let spread = |of: &dyn Fn(&PlanarStiffness) -> f64| {
            let mut values: Vec<f64> = found.iter().map(|[_, both]| of(both)).collect();
            values.sort_by(f64::total_cmp);
            let n = values.len();
            [values[0], (values[n / 2] + values[(n - 1) / 2]) / 2.0, values[n - 1]]
        };
        centre_mm.push(spread(&|both| both.centre_below_pad() / MM));
        tilting.push(spread(&PlanarStiffness::tilting));
    }
    Ok(Curve { density, centre_mm, tilting })
}

fn panel(
    area: &Area<'_>,
    label: &str,
    of_the_paper: f64,
    curves: &[Curve],
    of: impl Fn(&Curve) -> &Vec<[f64; 3]>,
    corner: SeriesLabelPosition,
) -> Drawn {
    let all = curves.iter().flat_map(|curve| of(curve).iter().flatten().copied());
    let mut y = around(all.chain([0.0, of_the_paper]), 0.08);
    y.start = 0.0;
    let x = AxisOf { label: "infill direction (°)", range: 0.0..44.0 };
    let mut chart = axes(area, "", x, AxisOf { label, range: y })?;
    dashed(&mut chart, [(0.0, of_the_paper), (44.0, of_the_paper)])?;
    let at = |pick: usize, values: &[[f64; 3]]| -> Vec<(f64, f64)> {
        DIRECTIONS.into_iter().zip(values).map(|(x, value)| (x, value[pick])).collect()
    };
    for (curve, colour) in curves.iter().zip([BLUE, ORANGE, GREEN]) {
        let values = of(curve);
        let (mut band, upper) = (at(0, values), at(2, values));
        band.extend(upper.into_iter().rev());
        chart
            .draw_series([Polygon::new(band, colour.rgb().mix(0.15).filled())])
            .map_err(message)?;
        let name = format!("density {} %, pad and roof", curve.density);
        line(&mut chart, at(1, values), colour.rgb().stroke_width(2), name)?;
    }
    legend(&mut chart, corner)
}
