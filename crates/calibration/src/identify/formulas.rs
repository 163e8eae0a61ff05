//! Closed-form estimates from the logs: stiffness of the robot, preload, friction.

use super::curves::{self, Curves, REACH, STEP_S, accelerations, rates, smoothed};
use ask_tell::statistics::{Moments, mean};
use insertion::Estimate;
use nalgebra::{DMatrix, DVector, Vector3};
use serde::Serialize;
use std::ops::Range;

/// Number of points on either side over which curves are averaged before differentiation: 10 ms.
const HALF_WIDTH: usize = 5;
/// Largest delay of the force behind the pose, points: 30 ms.
const MAX_DELAY: usize = 15;
/// Smallest relative standard deviation of a stiffness: a robot is not an ideal spring.
const MIN_RELATIVE_SD: f64 = 0.04;

/// One axis of a compliant flange: F = -k e - c e' + m a, with the force F on the tool, the lag e of the TCP behind its
/// target, the acceleration a of the TCP, and the moving mass m without the tool below the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flange {
    /// k, N/m.
    pub stiffness: Estimate,
    /// c, N s/m.
    pub damping: f64,
    /// m, kg.
    pub mass: f64,
    /// Best-fitting delay of the force behind the pose, s.
    pub delay_s: f64,
    /// Explained fraction of the variance of the force, 0 to 1.
    pub explained: f64,
}

/// Fits the flange along an axis of the tool (0 for x to 2 for z) to all attempts by least squares; the standard
/// deviation is that of the jackknife over attempts. `None` without targets, for a single attempt, or if the stiffness
/// is not significant.
pub fn flange(all: &[Curves], axis: usize) -> Option<Flange> {
    let all: Vec<Curves> = all.iter().map(Curves::in_tool).collect();
    let fits = (0..=MAX_DELAY).filter_map(|delay| {
        let sums: Vec<Sums> = all.iter().filter_map(|one| Sums::of(one, axis, delay)).collect();
        let fit = solve(sums.iter())?;
        Some((delay, sums, fit))
    });
    let (delay, sums, fit) = fits.max_by(|a, b| a.2.explained.total_cmp(&b.2.explained))?;
    let without = |i: usize| {
        let others = sums.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, sums)| sums);
        solve(others).map(|fit| fit.terms[0])
    };
    let left_out: Vec<f64> = (0..sums.len()).filter_map(without).collect();
    let Moments { count: n, squares, .. } = Moments::of(&left_out);
    let jackknife = if n > 1.0 { ((n - 1.0) / n * squares).sqrt() } else { f64::INFINITY };
    let [stiffness, damping, mass] = fit.terms;
    let known = stiffness > 0.0 && jackknife < stiffness;
    let stiffness = Estimate { mean: stiffness, sd: jackknife.max(MIN_RELATIVE_SD * stiffness) };
    let delay_s = delay as f64 * STEP_S;
    known.then_some(Flange { stiffness, damping, mass, delay_s, explained: fit.explained })
}

/// Returns the fraction of the variance of the force that a compliant flange explains, summed over the axes of the
/// tool; negative for an axis with negative stiffness, along which the robot deflects against the force.
pub(super) fn explained(all: &[Curves]) -> f64 {
    let all: Vec<Curves> = all.iter().map(Curves::in_tool).collect();
    let along = |axis: usize| {
        let sums: Vec<Sums> = all.iter().filter_map(|one| Sums::of(one, axis, 0)).collect();
        solve(sums.iter()).map_or(0.0, |fit| fit.explained.copysign(fit.terms[0]))
    };
    (0..3).map(along).sum()
}

/// Normal equations of the flange along one axis for one attempt, with bias and drift removed.
struct Sums {
    /// Products of the columns: lag, its rate, acceleration.
    products: DMatrix<f64>,
    /// Products of the columns with the force.
    with_force: DVector<f64>,
    /// Sum of squares of the force.
    force: f64,
}

/// Solution of the normal equations.
struct Fit {
    /// Stiffness, damping and mass.
    terms: [f64; 3],
    explained: f64,
}

impl Sums {
    fn of(one: &Curves, axis: usize, delay: usize) -> Option<Self> {
        let count = one.tcp.len().checked_sub(delay).filter(|&count| count > 4 * HALF_WIDTH)?;
        let target = smoothed(&smoothed(one.target.as_ref()?, HALF_WIDTH), HALF_WIDTH);
        let tcp = smoothed(&smoothed(&one.tcp, HALF_WIDTH), HALF_WIDTH);
        let force = smoothed(&smoothed(&one.force, HALF_WIDTH), HALF_WIDTH);
        let behind: Vec<Vector3<f64>> = target.iter().zip(&tcp).map(|(to, at)| to - at).collect();
        let (rate, acceleration) = (rates(&behind, REACH), accelerations(&tcp, REACH));
        let column = |values: &[Vector3<f64>], from: usize, sign: f64| {
            let column = DVector::from_fn(count, |i, _| sign * values[i + from][axis]);
            // Without the fitted straight line: bias and drift of the sensor.
            let middle = 0.5 * (column.len() as f64 - 1.0);
            let times = DVector::from_fn(column.len(), |i, _| i as f64 - middle);
            let (mean, slope) = (column.mean(), column.dot(&times) / times.norm_squared());
            column.add_scalar(-mean) - times * slope
        };
        let columns = [(&behind, -1.0), (&rate, -1.0), (&acceleration, 1.0)];
        let columns = columns.map(|(values, sign)| column(values, 0, sign));
        let force = column(&force, delay, 1.0);
        Some(Sums {
            products: DMatrix::from_fn(3, 3, |i, j| columns[i].dot(&columns[j])),
            with_force: DVector::from_fn(3, |i, _| columns[i].dot(&force)),
            force: force.norm_squared(),
        })
    }
}

/// Solves the least-squares problem of several attempts.
fn solve<'a>(sums: impl Iterator<Item = &'a Sums>) -> Option<Fit> {
    let (mut a, mut b, mut force) = (DMatrix::zeros(3, 3), DVector::zeros(3), 0.0);
    for sums in sums {
        a += &sums.products;
        b += &sums.with_force;
        force += sums.force;
    }
    // The columns differ by orders of magnitude.
    let scale = DVector::from_fn(3, |i, _| a[(i, i)].sqrt());
    if scale.iter().any(|s| *s <= 0.0) || force <= 0.0 {
        return None;
    }
    let scaled = DMatrix::from_fn(3, 3, |i, j| a[(i, j)] / (scale[i] * scale[j]));
    let right = b.component_div(&scale);
    let terms = scaled.cholesky()?.solve(&right);
    let explained = terms.dot(&right) / force;
    Some(Fit { terms: [0, 1, 2].map(|i| terms[i] / scale[i]), explained })
}

/// Returns the preload, m: the height of the TCP when the target stopped above the target at rest afterwards.
pub fn preload(all: &[Curves]) -> Option<Estimate> {
    let of = |one: &Curves| {
        let (stopped, target) = (one.stopped()?, one.target.as_ref()?);
        let rest = target[stopped..].windows(2).position(|pair| pair[0] == pair[1]);
        Some(one.tcp[stopped].z - target[stopped + rest?].z)
    };
    estimate(&all.iter().filter_map(of).collect::<Vec<_>>())
}

/// Returns the mean with its standard error.
fn estimate(values: &[f64]) -> Option<Estimate> {
    let moments = Moments::of(values);
    let Moments { count, mean, .. } = moments;
    let sd = if count > 1.0 { (moments.sample_variance() / count).sqrt() } else { 0.0 };
    (count > 0.0).then_some(Estimate { mean, sd })
}

/// One slide of a probe.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Slide {
    /// Whether the slide is along +y.
    #[serde(skip)]
    pub forth: bool,
    /// Tangential force over normal force while sliding.
    #[serde(rename = "tangential_over_normal")]
    pub ratio: f64,
    /// Whether the ratio kept rising, because the part turned in the grasp instead of sliding.
    pub rising: bool,
}

/// Friction of plug and socket, from a probe.
#[derive(Debug, Clone, PartialEq)]
pub struct Friction {
    pub slides: Vec<Slide>,
    /// Coefficient; `None` if the part slid in one direction only, or turned in all slides of a direction.
    pub coefficient: Option<Estimate>,
}

/// Height above the face above which the part is in the air, m.
const MIN_AIR_HEIGHT: f64 = 1e-3;
/// Fraction of the largest speed along y above which the part slides.
const MIN_SPEED: f64 = 0.4;
/// Shortest slide, s.
const MIN_SLIDE_S: f64 = 0.3;
/// Normal force below which there is no contact, N.
const MIN_NORMAL_N: f64 = 1.5;
/// Relative increase of the force ratio over the second half of a slide above which it has not settled.
const MAX_RISE: f64 = 0.12;
/// Smallest relative standard deviation of a coefficient: contacts deviate from Coulomb's law.
const MIN_FRICTION_RELATIVE_SD: f64 = 0.04;

/// Returns the friction from a probe along y; bias and drift of the force are estimated in the air before and after.
pub fn friction(probe: &Curves) -> Option<Friction> {
    let moved = probe.target.as_ref().unwrap_or(&probe.tcp);
    let rates = rates(&smoothed(moved, HALF_WIDTH), REACH);
    let speed: Vec<f64> = rates.iter().map(|rate| rate.y).collect();
    let fastest = speed.iter().map(|v| v.abs()).fold(0.0, f64::max);
    let force = undrifted(probe, |i| speed[i].abs() > MIN_SPEED * fastest)?;
    let least = (MIN_SLIDE_S / STEP_S) as usize;
    let each = |sign: f64| -> Vec<Slide> {
        let on = |i: usize| sign * speed[i] > MIN_SPEED * fastest && force[i].z > MIN_NORMAL_N;
        let long = runs_of(speed.len(), on).into_iter().filter(|range| range.len() >= least);
        long.map(|range| slide(&force, sign, range)).collect()
    };
    let [forth, back] = [1.0, -1.0].map(each);
    let angle = |slides: &[Slide]| {
        let settled = slides.iter().filter(|slide| !slide.rising);
        estimate(&settled.map(|slide| libm::atan(slide.ratio)).collect::<Vec<_>>())
    };
    // The slope of the face adds to the friction angle in one direction and subtracts from it in the other.
    let coefficient = angle(&forth).zip(angle(&back)).map(|(a, b)| {
        let mean = libm::tan(0.5 * (a.mean + b.mean));
        let sd = 0.5 * libm::hypot(a.sd, b.sd);
        Estimate { mean, sd: sd.max(MIN_FRICTION_RELATIVE_SD * mean) }
    });
    let slides = [forth, back].concat();
    (!slides.is_empty()).then_some(Friction { slides, coefficient })
}

/// Subtracts from the force a line through its means in the air before and after the contact, where the TCP is higher
/// than during the slides.
fn undrifted(probe: &Curves, sliding: impl Fn(usize) -> bool) -> Option<Vec<Vector3<f64>>> {
    let face = mean((0..probe.tcp.len()).filter(|&i| sliding(i)).map(|i| probe.tcp[i].z))?;
    let in_air = |i: &usize| probe.tcp[*i].z > face + MIN_AIR_HEIGHT;
    let first = (0..probe.tcp.len()).take_while(in_air).count();
    let last = (0..probe.tcp.len()).rev().take_while(in_air).count();
    let air = |range: Range<usize>| {
        let middle = 0.5 * (range.start + range.end) as f64;
        let forces = &probe.force[range];
        (forces.len() > 4 * HALF_WIDTH).then(|| (middle, curves::mean(forces)))
    };
    let before = air(0..first)?;
    let after = air(probe.tcp.len() - last..probe.tcp.len()).unwrap_or(before);
    let slope = match after.0 > before.0 {
        true => (after.1 - before.1) / (after.0 - before.0),
        false => Vector3::zeros(),
    };
    let force = smoothed(&probe.force, 2 * HALF_WIDTH);
    let less = |(i, force): (usize, Vector3<f64>)| force - before.1 - slope * (i as f64 - before.0);
    Some(force.into_iter().enumerate().map(less).collect())
}

/// Returns the slide over a range of points, along +y for a positive `sign`.
fn slide(force: &[Vector3<f64>], sign: f64, range: Range<usize>) -> Slide {
    let ratio = |from: f64, to: f64| {
        let place = |part: f64| range.start + (part * range.len() as f64) as usize;
        let part = &force[place(from)..place(to)];
        let sum: Vector3<f64> = part.iter().sum();
        // Friction acts against the slide.
        -sign * sum.y / sum.z
    };
    let (middle, last) = (ratio(0.5, 0.7), ratio(0.75, 0.95));
    Slide { forth: sign > 0.0, ratio: last, rising: last > (1.0 + MAX_RISE) * middle }
}

/// Returns the ranges of consecutive indices below `count` for which a condition holds.
pub(super) fn runs_of(count: usize, holds: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let held: Vec<usize> = (0..count).filter(|&i| holds(i)).collect();
    held.chunk_by(|a, b| a + 1 == *b).map(|run| run[0]..run[0] + run.len()).collect()
}
