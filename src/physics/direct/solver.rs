//! The velocities at the end of a step: Newton's method on a convex potential.
//!
//! With the reduced system `S`, right-hand side `r` and the contacts' potentials
//! the velocities minimise `v.S v/2 - r.v + sum of potentials`; its gradient is
//! the out-of-balance impulse `S v - r - sum J^T l`. The potential's cone law has
//! associated friction, which would lift a sliding contact by `mu |u_t| h`; the
//! term `s = mu |u_t|` of De Saxce and Feng (1998, Math. Comput. Modelling 28)
//! takes that back, by a fixed point about the Newton iterations (Acary, Cadoux,
//! Lemarechal and Malick 2011, ZAMM 91).

use super::blocks::Vector6;
use super::cone::{Cone, Pull, State};
use super::dense;
use nalgebra::{Matrix4, Matrix4x3, Vector3, Vector4};

/// Out-of-balance force at which an iteration ends, N (N per 10 mm for moments).
const FORCE_TOLERANCE: f64 = 1e-4;
/// Arm by which moments are compared with forces, m.
const ARM: f64 = 0.01;
/// Newton iterations at most, in a step.
const ITERATIONS: usize = 60;
/// Error of the sliding term that is let go, m/s: 0.1 um in a step of 0.1 ms.
const SLIDING_TOLERANCE: f64 = 1e-3;
/// Trials along a line at most.
const SEARCHES: usize = 30;
/// Rounds of the fixed point at most.
const ROUNDS: usize = 6;

/// What an angular velocity moves a point by that lies at `arm` from the centre of mass,
/// m: along the world's axes `w x arm`, and `rho w_n` about the `patch` vector, the
/// normal times the patch radius.
pub(super) fn lever(arm: &Vector3<f64>, patch: &Vector3<f64>) -> Matrix4x3<f64> {
    let mut lever = Matrix4x3::zeros();
    lever.fixed_view_mut::<3, 3>(0, 0).copy_from(&-arm.cross_matrix());
    lever.set_row(3, &patch.transpose());
    lever
}

/// The same where friction acts `aside` of the point, m: it feels the turn about the normal there.
pub(super) fn moved_aside(
    lever: &Matrix4x3<f64>,
    aside: &Vector3<f64>,
    normal: &Vector3<f64>,
) -> Matrix4x3<f64> {
    let mut moved = *lever;
    let mut linear = moved.fixed_view_mut::<3, 3>(0, 0);
    linear += normal.cross(aside) * normal.transpose();
    moved
}

/// Velocity of a contact point of a body of this velocity, m/s.
pub(super) fn relative(lever: &Matrix4x3<f64>, v: &Vector6) -> Vector4<f64> {
    Vector4::new(v[0], v[1], v[2], 0.0) + lever * Vector3::new(v[3], v[4], v[5])
}

/// A contact as the solver sees it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contact {
    /// First and second body: place in the reduced system, if they move freely.
    pub place: [Option<usize>; 2],
    /// On each side: relative velocity by the body's angular velocity, m; see [`lever`].
    pub lever: [Matrix4x3<f64>; 2],
    /// Unit normal from the first to the second; its fourth component is 0.
    pub normal: Vector4<f64>,
    /// Relative velocity by the bodies whose motion is given, m/s; of four components, as
    /// all velocities and impulses here: see [`super::cone`].
    pub drift: Vector4<f64>,
    /// Least approach velocity that the gap allows, `gap / h`, m/s.
    pub bias: f64,
    /// Law of contact.
    pub cone: Cone,
    /// De Saxce's term, m/s.
    slide: f64,
    /// Relative velocity, m/s.
    velocity: Vector4<f64>,
    /// Its change along the line of search.
    change: Vector4<f64>,
    /// Impulse on the second body, N s.
    pub impulse: Vector4<f64>,
}

impl Contact {
    /// A contact between bodies at these places with these levers.
    pub fn new(
        place: [Option<usize>; 2],
        lever: [Matrix4x3<f64>; 2],
        normal: Vector3<f64>,
        cone: Cone,
    ) -> Self {
        let zero = Vector4::zeros();
        Contact {
            place,
            lever,
            normal: normal.push(0.0),
            drift: zero,
            bias: 0.0,
            cone,
            slide: 0.0,
            velocity: zero,
            change: zero,
            impulse: zero,
        }
    }

    /// Relative velocity by the free bodies' velocities.
    fn relative(&self, velocities: &[Vector6]) -> Vector4<f64> {
        let mut sum = Vector4::zeros();
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            if let Some(place) = self.place[side] {
                sum += relative(&self.lever[side], &velocities[place]) * sign;
            }
        }
        sum
    }

    fn pull(&self, along: f64) -> Pull {
        Pull::new(&(self.velocity + self.change * along), &self.normal, self.bias + self.slide)
    }

    /// What the contact would slide at, times its friction.
    fn sliding(&self) -> f64 {
        let along = self.velocity.dot(&self.normal);
        self.cone.mu * (self.velocity - self.normal * along).norm()
    }
}

/// The reduced problem and its workspace.
#[derive(Clone)]
pub(super) struct Solver {
    /// Rows of the reduced system, row by row.
    pub system: Vec<f64>,
    /// Right-hand side.
    pub rhs: Vec<Vector6>,
    /// The solution; on entry, the first guess.
    pub velocities: Vec<Vector6>,
    hessian: Vec<f64>,
    gradient: Vec<Vector6>,
    direction: Vec<Vector6>,
    /// The direction as the dense solution wants it.
    flat: Vec<f64>,
}

impl Solver {
    /// For so many bodies.
    pub fn new(bodies: usize) -> Self {
        let zeros = vec![Vector6::zeros(); bodies];
        let square = vec![0.0; 36 * bodies * bodies];
        Solver {
            system: square.clone(),
            rhs: zeros.clone(),
            velocities: zeros.clone(),
            hessian: square,
            gradient: zeros.clone(),
            direction: zeros,
            flat: vec![0.0; 6 * bodies],
        }
    }

    /// Solves; None if the numbers are not finite.
    pub fn solve(&mut self, contacts: &mut [Contact], step: f64) -> Option<()> {
        let mut iterations = 0;
        self.update_velocities(contacts);
        for contact in contacts.iter_mut() {
            contact.slide = contact.sliding();
        }
        for _ in 0..ROUNDS {
            self.newton(contacts, step * FORCE_TOLERANCE, &mut iterations)?;
            let mut error: f64 = 0.0;
            for contact in contacts.iter_mut() {
                let pull = contact.pull(0.0);
                // With the sliding term that the velocities were solved with.
                contact.impulse = contact.cone.impulse(&pull, &contact.normal);
                if contact.cone.state(&pull) != State::Apart {
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

    /// Newton's iterations, of which `iterations` have been made in this step.
    fn newton(
        &mut self,
        contacts: &mut [Contact],
        tolerance: f64,
        iterations: &mut usize,
    ) -> Option<()> {
        while *iterations < ITERATIONS {
            // A NaN goes on, and is found when the matrix is factored.
            if self.slope(contacts) < tolerance {
                break;
            }
            *iterations += 1;
            self.descend(contacts)?;
            let along = self.search(contacts);
            for (v, d) in self.velocities.iter_mut().zip(&self.direction) {
                *v += d * along;
            }
            self.update_velocities(contacts);
        }
        Some(())
    }

    /// Relative velocities at the present velocities.
    fn update_velocities(&self, contacts: &mut [Contact]) {
        for contact in contacts {
            contact.velocity = contact.relative(&self.velocities) + contact.drift;
            contact.change = Vector4::zeros();
        }
    }

    /// The gradient, and its largest component as a force times the step.
    fn slope(&mut self, contacts: &[Contact]) -> f64 {
        dense::multiply(&self.system, &self.velocities, &mut self.gradient);
        for (g, r) in self.gradient.iter_mut().zip(&self.rhs) {
            *g -= r;
        }
        for contact in contacts {
            let impulse = contact.cone.impulse(&contact.pull(0.0), &contact.normal);
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
        let scaled = |g: &Vector6| {
            let linear = g.fixed_rows::<3>(0).amax();
            linear.max(g.fixed_rows::<3>(3).amax() / ARM)
        };
        // NaN must not pass for small: `max` would drop it.
        self.gradient.iter().map(scaled).fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
    }

    /// Newton's direction.
    fn descend(&mut self, contacts: &mut [Contact]) -> Option<()> {
        self.hessian.copy_from_slice(&self.system);
        for contact in contacts.iter() {
            let pull = contact.pull(0.0);
            if contact.cone.state(&pull) != State::Apart {
                let stiffness = contact.cone.stiffness(&pull, &contact.normal);
                add_stiffness(&mut self.hessian, self.velocities.len(), contact, &stiffness);
            }
        }
        for (d, g) in self.flat.chunks_exact_mut(6).zip(&self.gradient) {
            d.copy_from_slice((-g).as_slice());
        }
        dense::factor(&mut self.hessian, 6 * self.velocities.len())?;
        dense::solve(&self.hessian, &mut self.flat);
        for (d, flat) in self.direction.iter_mut().zip(self.flat.chunks_exact(6)) {
            d.copy_from_slice(flat);
        }
        for contact in contacts.iter_mut() {
            contact.change = contact.relative(&self.direction);
        }
        Some(())
    }

    /// How far to go along the direction: all the way if the potential's slope
    /// does not turn against us, else to where it is a tenth of the first.
    fn search(&mut self, contacts: &[Contact]) -> f64 {
        let dot =
            |a: &[Vector6], b: &[Vector6]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();
        let first = dot(&self.gradient, &self.direction);
        // Along the line the quadratic part is linear in the distance.
        dense::multiply(&self.system, &self.direction, &mut self.gradient);
        let curvature = dot(&self.gradient, &self.direction);
        let pushed = |along: f64| -> f64 {
            let power = |c: &Contact| c.cone.impulse(&c.pull(along), &c.normal).dot(&c.change);
            contacts.iter().map(power).sum()
        };
        let start = first + pushed(0.0);
        let slope = |along: f64| start + along * curvature - pushed(along);
        let mut high = (1.0, slope(1.0));
        if high.1 <= 0.3 * first.abs() {
            return 1.0;
        }
        let mut low = (0.0, first);
        for _ in 0..SEARCHES {
            let at = low.0 - low.1 / (high.1 - low.1) * (high.0 - low.0);
            let value = slope(at);
            if value.abs() < 0.1 * first.abs() {
                return at;
            }
            // Illinois: an end that stays counts half, lest the other creeps up to it.
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

/// Adds `J^T K J` of a contact to the upper half, with `J = [1, lever]` on each
/// side, up to sign. `K` is symmetric, so `(K lever)^T` is `lever^T K`.
fn add_stiffness(hessian: &mut [f64], bodies: usize, contact: &Contact, k: &Matrix4<f64>) {
    let n = 6 * bodies;
    let across = contact.lever.map(|lever| k * lever);
    for row in 0..2 {
        let Some(i) = contact.place[row] else { continue };
        for column in 0..2 {
            let Some(j) = contact.place[column].filter(|&j| j >= i) else { continue };
            let sign = if row == column { 1.0 } else { -1.0 };
            let both = across[row].tr_mul(&contact.lever[column]) * sign;
            let (right, down) = (across[column] * sign, across[row] * sign);
            for r in 0..3 {
                let at = (6 * i + r) * n + 6 * j;
                let (upper, lower) = hessian[at..].split_at_mut(3 * n);
                for c in 0..3 {
                    upper[c] += sign * k[(r, c)];
                    upper[3 + c] += right[(r, c)];
                    lower[c] += down[(c, r)];
                    lower[3 + c] += both[(r, c)];
                }
            }
        }
    }
}
