//! Equilibrium of the peg for given contact modes, by Newton's method.

use super::feature::{Geometry, Touch};
use super::modes::{Contact, Mode, State};
use super::{Assembly, Feature, V2, V3};
use nalgebra::{DMatrix, DVector, Matrix3x4, Vector4};

/// Iterations after which Newton's method has failed.
const ITERATIONS: usize = 12;
/// Last correction, in the units of the unknowns.
const CONVERGED: f64 = 1e-11;
/// Steps of the numerical derivatives in the units of the unknowns.
const DIFFERENCE: f64 = 1e-6;
/// Units of the unknowns: lengths, m, and angles, rad; forces have 1 N.
const UNITS: [f64; 3] = [1e-3, 1e-3, 1e-1];

/// Step from an old state to the equilibrium under a new target.
#[derive(Debug, Clone)]
pub(super) struct Problem<'a> {
    pub assembly: &'a Assembly,
    pub geometry: &'a Geometry,
    pub old: &'a State,
    /// Pose at which the springs are at rest.
    pub target: V3,
    /// Resistance to the step, as a multiple of the stiffness; 0 for a quasi-static step.
    pub viscosity: f64,
}

/// Returns the perpendicular of a normal, the tangent along which a contact slides.
pub(super) fn tangent(normal: &V2) -> V2 {
    V2::new(-normal.y, normal.x)
}

impl Problem<'_> {
    /// Returns the load of the springs on the compliance centre.
    fn load(&self, pose: &V3) -> V3 {
        let stiffness = self.assembly.support.stiffness();
        let resistance = (self.old.pose - pose) * self.viscosity;
        stiffness.component_mul(&(self.target - pose + resistance))
    }

    /// Returns the way of the peg's material point at a contact since the old state, along the tangent.
    pub fn slip(&self, touch: &Touch, pose: &V3) -> f64 {
        let arm = super::turned(self.old.pose.z - pose.z, &(touch.point - pose.xy()));
        (touch.point - self.old.pose.xy() - arm).dot(&tangent(&touch.normal))
    }

    /// Returns the force of a contact on the peg as the load on its compliance centre.
    fn wrench(touch: &Touch, pose: &V3, normal: f64, tangential: f64) -> V3 {
        let force = touch.normal * normal + tangent(&touch.normal) * tangential;
        V3::new(force.x, force.y, (touch.point - pose.xy()).perp(&force))
    }

    /// Returns the equilibrium for given modes, of rigid contacts at most one sticking; `None` if
    /// Newton's method fails.
    pub fn solve(&self, modes: &[(Feature, Mode)]) -> Option<State> {
        let mut forces = 3;
        let columns = modes.iter().map(|(_, mode)| {
            let first = forces;
            forces += if *mode == Mode::Stick { 2 } else { 1 };
            first
        });
        let columns: Vec<usize> = columns.collect();
        let mut start = DVector::zeros(forces);
        start.rows_mut(0, 3).copy_from(&self.old.pose);
        let split = |unknowns: &DVector<f64>| -> State {
            let force = |(&(feature, mode), &first): (&(Feature, Mode), &usize)| {
                let normal = unknowns[first];
                let friction = self.assembly.friction * normal;
                let tangential = match mode {
                    Mode::Forward => -friction,
                    Mode::Backward => friction,
                    Mode::Stick => unknowns[first + 1],
                };
                Contact { feature, mode, normal, tangential }
            };
            let contacts = modes.iter().zip(&columns).map(force).collect();
            State { pose: V3::new(unknowns[0], unknowns[1], unknowns[2]), contacts }
        };
        let found = newton(start, |unknowns| self.residual(&split(unknowns), unknowns.len()))?;
        Some(split(&found))
    }

    /// Returns the unbalanced loads, the gaps, and the slip of the contact that sticks.
    fn residual(&self, state: &State, unknowns: usize) -> DVector<f64> {
        let mut balance = self.load(&state.pose);
        let mut rows = Vec::with_capacity(unknowns);
        for contact in &state.contacts {
            let touch = self.geometry.touch(contact.feature, &state.pose);
            balance += Self::wrench(&touch, &state.pose, contact.normal, contact.tangential);
            rows.push((touch.gap + self.assembly.compliance * contact.normal) / UNITS[0]);
            if contact.mode == Mode::Stick {
                rows.push(self.slip(&touch, &state.pose) / UNITS[0]);
            }
        }
        DVector::from_iterator(unknowns, balance.iter().copied().chain(rows))
    }

    /// Returns the state in which two contacts stick. Their gaps, and the slip of the one that
    /// touched before, give the pose; the force between them along their line is not determined by
    /// statics, and the smallest one within the friction cones is taken. `None` if there is none.
    pub fn locked(&self, features: [Feature; 2]) -> Option<State> {
        let start = DVector::from_column_slice(self.old.pose.as_slice());
        let pose = |unknowns: &DVector<f64>| V3::new(unknowns[0], unknowns[1], unknowns[2]);
        let gap = |feature| self.geometry.touch(feature, &self.old.pose).gap.abs();
        let held = if gap(features[0]) <= gap(features[1]) { 0 } else { 1 };
        let found = newton(start, |unknowns| {
            let pose = pose(unknowns);
            let touches = features.map(|feature| self.geometry.touch(feature, &pose));
            let slip = self.slip(&touches[held], &pose);
            DVector::from_column_slice(&[touches[0].gap, touches[1].gap, slip]) / UNITS[0]
        })?;
        let pose = pose(&found);
        let touches = features.map(|feature| self.geometry.touch(feature, &pose));
        let forces = held_forces(&touches, &pose, self.load(&pose), self.assembly.friction)?;
        let contact = |i: usize| Contact {
            feature: features[i],
            mode: Mode::Stick,
            normal: forces[2 * i],
            tangential: forces[2 * i + 1],
        };
        Some(State { pose, contacts: vec![contact(0), contact(1)] })
    }
}

/// Returns normal and tangential forces of two contacts that balance a load within both friction
/// cones.
pub(super) fn held_forces(
    touches: &[Touch; 2],
    pose: &V3,
    load: V3,
    friction: f64,
) -> Option<Vector4<f64>> {
    let column =
        |i: usize, normal, tangential| Problem::wrench(&touches[i], pose, normal, tangential);
    // Moments in units of a force at 10 mm, so that the least squares weigh alike.
    let scale = V3::new(1.0, 1.0, 100.0);
    let columns =
        [column(0, 1.0, 0.0), column(0, 0.0, 1.0), column(1, 1.0, 0.0), column(1, 0.0, 1.0)];
    let matrix = Matrix3x4::from_columns(&columns.map(|column| column.component_mul(&scale)));
    let particular = matrix.pseudo_inverse(1e-12).ok()? * -load.component_mul(&scale);
    let between = (touches[1].point - touches[0].point).try_normalize(0.0)?;
    let parts = |touch: &Touch, sign: f64| {
        [sign * between.dot(&touch.normal), sign * between.dot(&tangent(&touch.normal))]
    };
    let ([a, b], [c, d]) = (parts(&touches[0], 1.0), parts(&touches[1], -1.0));
    let internal = Vector4::new(a, b, c, d);
    let (mut least, mut most) = (f64::NEG_INFINITY, f64::INFINITY);
    for (i, sign) in [(0, 1.0), (0, -1.0), (2, 1.0), (2, -1.0)] {
        let inside = |forces: &Vector4<f64>| friction * forces[i] + sign * forces[i + 1];
        let (constant, slope) = (inside(&particular), inside(&internal));
        match slope {
            slope if slope > 1e-12 => least = least.max(-constant / slope),
            slope if slope < -1e-12 => most = most.min(-constant / slope),
            _ if constant < -1e-12 => return None,
            _ => {}
        }
    }
    (least <= most).then(|| particular + internal * 0.0_f64.clamp(least, most))
}

/// Returns a root of a function whose first three unknowns are a pose.
fn newton(
    mut unknowns: DVector<f64>,
    residual: impl Fn(&DVector<f64>) -> DVector<f64>,
) -> Option<DVector<f64>> {
    let unit = |i: usize| UNITS.get(i).copied().unwrap_or(1.0);
    let count = unknowns.len();
    for _ in 0..ITERATIONS {
        let value = residual(&unknowns);
        let mut slopes = DMatrix::zeros(count, count);
        for i in 0..count {
            let at = |sign: f64| {
                let mut moved = unknowns.clone();
                moved[i] += sign * DIFFERENCE * unit(i);
                residual(&moved)
            };
            let slope = (at(1.0) - at(-1.0)) / (2.0 * DIFFERENCE);
            slopes.set_column(i, &slope);
        }
        let step = slopes.full_piv_lu().solve(&value)?;
        if !step.iter().all(|part| part.is_finite()) {
            return None;
        }
        for i in 0..count {
            unknowns[i] -= step[i] * unit(i);
        }
        if step.amax() < CONVERGED * (1.0 + unknowns.rows(3, count - 3).amax()) {
            return Some(unknowns);
        }
    }
    None
}
