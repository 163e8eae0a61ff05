//! The velocities at the end of a step: Newton's method on a convex potential.
//!
//! With the reduced system `S` (bodies without contacts eliminated), right-hand side `r` and the contacts' potentials,
//! the velocities minimise `v.S v/2 - r.v + sum of potentials`; its gradient is the out-of-balance impulse `S v - r -
//! sum J^T l` (contact Jacobians `J`, impulses `l`). The potential implies associated friction, which would lift a
//! sliding contact by `mu |u_t| h` in a step `h`; the term `s = mu |u_t|` of De Saxce and Feng (1998, Math. Comput.
//! Modelling 28) compensates this, by fixed-point iterations around Newton's (Acary, Cadoux, Lemarechal and Malick
//! 2011, ZAMM 91).

use super::blocks::Vector6;
use super::cone::{Cone, SplitVelocity, State};
use super::dense::{self, Six};
use nalgebra::{Matrix4, Matrix4x3, Vector3, Vector4};

/// Out-of-balance force below which the iterations end, N; moments are divided by [`ARM`].
const FORCE_TOLERANCE: f64 = 1e-4;
/// Out-of-balance force below which the iterations end, relative to the largest normal force.
const FORCE_SHARE: f64 = 1e-3;
/// Lever arm by which moments are divided to compare them with forces, m.
const ARM: f64 = 0.01;
/// Largest number of Newton iterations in a step.
const MAX_ITERATIONS: usize = 60;
/// Accepted error of the sliding term, m/s: 0.5 um in the default step of 0.5 ms.
const SLIDING_TOLERANCE: f64 = 1e-3;
/// Largest number of evaluations of a line search.
const MAX_LINE_SEARCH_STEPS: usize = 30;
/// Largest number of fixed-point iterations.
const MAX_ROUNDS: usize = 6;

/// Returns the matrix that maps the angular velocity `w` of a body to the velocity of a point at `arm` from its centre
/// of mass, m: `w x arm` along the world's axes, and `rho w_n` about `patch`, the normal times the patch radius.
pub(super) fn lever(arm: &Vector3<f64>, patch: &Vector3<f64>) -> Matrix4x3<f64> {
    let mut lever = Matrix4x3::zeros();
    lever.fixed_view_mut::<3, 3>(0, 0).copy_from(&-arm.cross_matrix());
    lever.set_row(3, &patch.transpose());
    lever
}

/// Returns the matrix of [`lever`] for a contact point without patch radius whose friction acts at another point, at
/// the offset `aside`, m: the velocity due to rotation about the normal is that of the other point.
pub(super) fn offset_lever(
    arm: &Vector3<f64>,
    aside: &Vector3<f64>,
    normal: &Vector3<f64>,
) -> Matrix4x3<f64> {
    let mut moved = lever(arm, &Vector3::zeros());
    let mut linear = moved.fixed_view_mut::<3, 3>(0, 0);
    linear += normal.cross(aside) * normal.transpose();
    moved
}

/// Returns the velocity of a contact point of a body, m/s.
pub(super) fn point_velocity(lever: &Matrix4x3<f64>, v: &Six) -> Vector4<f64> {
    Vector4::new(v[0], v[1], v[2], 0.0) + lever * Vector3::new(v[3], v[4], v[5])
}

/// Contact of the solver. Velocities and impulses have the four components of [`super::cone`].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Contact {
    /// Indices of the first and second body in the reduced system; `None` for a fixed or driven body.
    pub place: [Option<usize>; 2],
    /// Matrix from the angular velocity of each body to the velocity of the contact point, m; see [`lever`].
    pub lever: [Matrix4x3<f64>; 2],
    /// Unit normal from the first to the second; its fourth component is 0.
    pub normal: Vector4<f64>,
    /// Relative velocity due to driven bodies, m/s.
    pub drift: Vector4<f64>,
    /// Velocity added to the normal velocity, m/s: `gap / h`; for a penetration, with stiffness `k` and damping `c`,
    /// times `k h / (k h + c)` and at least `-push_out`.
    pub bias: f64,
    /// Friction cone of the contact law.
    pub cone: Cone,
    /// De Saxce's sliding term, `mu |u_t|`, m/s.
    pub slide: f64,
    /// Relative velocity, m/s.
    pub velocity: Vector4<f64>,
    /// Relative velocity, split for the contact law.
    pub split: SplitVelocity,
    /// Change of the relative velocity for a full step along the search direction, m/s.
    pub change: Vector4<f64>,
    /// Impulse on the second body, N s.
    pub impulse: Vector4<f64>,
}

impl Contact {
    /// Returns the relative velocity due to the velocities of the reduced system, m/s.
    fn relative(&self, velocities: &[Six]) -> Vector4<f64> {
        let mut sum = Vector4::zeros();
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            if let Some(place) = self.place[side] {
                sum += point_velocity(&self.lever[side], &velocities[place]) * sign;
            }
        }
        sum
    }

    /// Returns the relative velocity after a step of length `along` in the search direction, split for the contact law.
    fn split(&self, along: f64) -> SplitVelocity {
        let velocity = self.velocity + self.change * along;
        SplitVelocity::new(&velocity, &self.normal, self.bias + self.slide)
    }

    /// Updates the split velocity and the impulse for the current velocity.
    fn apply(&mut self) {
        self.split = SplitVelocity::new(&self.velocity, &self.normal, self.bias + self.slide);
        self.impulse = self.cone.impulse(&self.split, &self.normal);
    }

    /// Returns the sliding speed times the coefficient of friction, m/s.
    fn sliding(&self) -> f64 {
        let along = self.velocity.dot(&self.normal);
        self.cone.mu * (self.velocity - self.normal * along).norm()
    }
}

/// Reduced problem and its workspace.
#[derive(Clone)]
pub(super) struct Solver {
    /// Matrix of the reduced system, row by row, both halves.
    pub system: Vec<Six>,
    /// Right-hand side.
    pub rhs: Vec<Vector6>,
    /// Solution; on entry, the initial guess.
    pub velocities: Vec<Six>,
    hessian: Vec<Six>,
    gradient: Vec<Six>,
    direction: Vec<Six>,
}

impl Solver {
    /// Creates a workspace for a number of bodies.
    pub fn new(bodies: usize) -> Self {
        let zeros = vec![[0.0; 6]; bodies];
        let square = vec![[0.0; 6]; 6 * bodies * bodies];
        Solver {
            system: square.clone(),
            rhs: vec![Vector6::zeros(); bodies],
            velocities: zeros.clone(),
            hessian: square,
            gradient: zeros.clone(),
            direction: zeros,
        }
    }

    /// Solves for the velocities; returns `None` if a Hessian is not positive definite or not finite.
    pub fn solve(&mut self, contacts: &mut [Contact], step: f64) -> Option<()> {
        let mut iterations = 0;
        self.update_velocities(contacts);
        for contact in contacts.iter_mut() {
            contact.slide = contact.sliding();
        }
        for _ in 0..MAX_ROUNDS {
            while iterations < MAX_ITERATIONS {
                // A NaN does not end the iterations; the factorization then fails.
                let slope = self.update_gradient(contacts);
                let pressed = contacts.iter().map(|c| c.impulse.dot(&c.normal)).fold(0.0, f64::max);
                if slope < (step * FORCE_TOLERANCE).max(FORCE_SHARE * pressed) {
                    break;
                }
                iterations += 1;
                self.update_direction(contacts)?;
                let along = self.line_search(contacts);
                let direction = self.direction.as_flattened();
                for (v, d) in self.velocities.as_flattened_mut().iter_mut().zip(direction) {
                    *v += d * along;
                }
                self.update_velocities(contacts);
            }
            let mut error: f64 = 0.0;
            for contact in contacts.iter_mut() {
                // The impulse belongs to the sliding term for which the velocities were solved.
                contact.apply();
                if contact.cone.state(&contact.split) != State::Apart {
                    let now = contact.sliding();
                    error = error.max((now - contact.slide).abs());
                    contact.slide = now;
                }
            }
            if error < SLIDING_TOLERANCE {
                break;
            }
        }
        Some(())
    }

    /// Sets the relative velocities of the contacts.
    fn update_velocities(&self, contacts: &mut [Contact]) {
        for contact in contacts {
            contact.velocity = contact.relative(&self.velocities) + contact.drift;
        }
    }

    /// Computes the gradient; returns its largest component, N s.
    fn update_gradient(&mut self, contacts: &mut [Contact]) -> f64 {
        dense::multiply(&self.system, &self.velocities, &mut self.gradient);
        for (g, r) in self.gradient.as_flattened_mut().iter_mut().zip(self.rhs.iter().flatten()) {
            *g -= r;
        }
        for contact in contacts {
            contact.apply();
            let impulse = contact.impulse;
            if impulse == Vector4::zeros() {
                continue;
            }
            for (side, sign) in [(0, 1.0), (1, -1.0)] {
                if let Some(place) = contact.place[side] {
                    let moment = contact.lever[side].tr_mul(&impulse) * sign;
                    let force = impulse * sign;
                    let to = &mut self.gradient[place];
                    for i in 0..3 {
                        to[i] += force[i];
                        to[3 + i] += moment[i];
                    }
                }
            }
        }
        let scaled = |g: &Six| {
            let largest = |part: &[f64]| Vector3::from_column_slice(part).amax();
            largest(&g[..3]).max(largest(&g[3..]) / ARM)
        };
        // `f64::max` would ignore a NaN.
        self.gradient.iter().map(scaled).fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
    }

    /// Computes the Newton direction; returns `None` if the Hessian is not positive definite.
    fn update_direction(&mut self, contacts: &mut [Contact]) -> Option<()> {
        self.hessian.copy_from_slice(&self.system);
        let bodies = self.velocities.len();
        for contact in contacts.iter() {
            if contact.cone.state(&contact.split) != State::Apart {
                let stiffness = contact.cone.stiffness(&contact.split, &contact.normal);
                add_stiffness(&mut self.hessian, bodies, contact, &stiffness);
            }
        }
        for (d, g) in self.direction.iter_mut().zip(&self.gradient) {
            *d = g.map(|g| -g);
        }
        dense::factor(&mut self.hessian, bodies)?;
        dense::solve(&self.hessian, &mut self.direction);
        for contact in contacts.iter_mut() {
            contact.change = contact.relative(&self.direction);
        }
        Some(())
    }

    /// Returns the step length along the direction: 1, or about that of the minimum if the potential rises steeply at
    /// 1.
    fn line_search(&mut self, contacts: &[Contact]) -> f64 {
        let dot = |a: &[Six], b: &[Six]| {
            a.iter().zip(b).map(|(a, b)| Vector6::from(*a).dot(&Vector6::from(*b))).sum::<f64>()
        };
        let first = dot(&self.gradient, &self.direction);
        // The slope of the quadratic part along the direction is linear in the step length.
        dense::multiply(&self.system, &self.direction, &mut self.gradient);
        let curvature = dot(&self.gradient, &self.direction);
        let pushed = |along: f64| -> f64 {
            let power = |c: &Contact| c.cone.impulse(&c.split(along), &c.normal).dot(&c.change);
            contacts.iter().map(power).sum()
        };
        let start = first + contacts.iter().map(|c| c.impulse.dot(&c.change)).sum::<f64>();
        let slope = |along: f64| start + along * curvature - pushed(along);
        let mut high = (1.0, slope(1.0));
        if high.1 <= 0.3 * first.abs() {
            return 1.0;
        }
        let mut low = (0.0, first);
        for _ in 0..MAX_LINE_SEARCH_STEPS {
            let at = low.0 - low.1 / (high.1 - low.1) * (high.0 - low.0);
            let value = slope(at);
            if value.abs() < 0.1 * first.abs() {
                return at;
            }
            // Illinois rule: the value of the end that stays is halved, which avoids slow convergence.
            if value < 0.0 {
                low = (at, value);
                high.1 *= 0.5;
            } else {
                high = (at, value);
                low.1 *= 0.5;
            }
        }
        if low.0 > 0.0 { low.0 } else { high.0 }
    }
}

/// Adds `J^T K J` of a contact to the upper half of the Hessian, with `J = [1, lever]` for the second body and its
/// negative for the first. `K` is symmetric, so `(K lever)^T` is `lever^T K`.
fn add_stiffness(hessian: &mut [Six], bodies: usize, contact: &Contact, k: &Matrix4<f64>) {
    let [first, second] = contact.place;
    let across = [k * contact.lever[0], k * contact.lever[1]];
    let mut add = |sides: [usize; 2], [i, j]: [usize; 2]| {
        let sign = if i == j { 1.0 } else { -1.0 };
        let [left, right] = sides.map(|side| &across[side]);
        let lever = &contact.lever[sides[1]];
        for r in 0..3 {
            let row = &mut hessian[(6 * i + r) * bodies + j];
            for c in 0..3 {
                row[c] += sign * k[(r, c)];
                row[3 + c] += sign * right[(r, c)];
            }
            let row = &mut hessian[(6 * i + 3 + r) * bodies + j];
            for c in 0..3 {
                row[c] += sign * left[(c, r)];
                row[3 + c] += sign * dot(&left.column(r).into(), &lever.column(c).into());
            }
        }
    };
    first.into_iter().for_each(|i| add([0, 0], [i, i]));
    second.into_iter().for_each(|i| add([1, 1], [i, i]));
    if let (Some(i), Some(j)) = (first, second) {
        if i < j { add([0, 1], [i, j]) } else { add([1, 0], [j, i]) }
    }
}

/// Returns the scalar product, summed in the order of nalgebra's products of any size.
#[inline(always)]
fn dot(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    (a[0] * b[0] + a[2] * b[2]) + (a[1] * b[1] + a[3] * b[3])
}
