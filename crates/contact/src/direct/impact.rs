//! Shorter steps through impacts of round edges.
//!
//! The impact of a plug of 20 g on a corner of 0.55 N/um lasts 0.3 ms. A longer step spreads the impulse over its
//! length, friction of the pads resists it, and the plug slips too little in the grasp. With sharp edges this does not
//! change the window (the offsets at which an insertion succeeds); on round rims the plug then turns instead of
//! sliding, and the ends of a window move by up to 1.2 mm (`docs/notes/simulation.md`, "Round edges").

use super::body::MovingBody;
use super::world::DirectWorld;
use crate::ContactForce;
use crate::scene::Pose;
use nalgebra::Vector3;

/// Number of parts into which a step is divided.
const PARTS: usize = 8;
/// Number of steps that are divided after an impact begins: that of the impact and three more.
const DIVIDED: usize = 4;
/// Smallest approach speed of an impact, m/s: at 5 mm/s a contact penetrates by 1 um.
const IMPACT: f64 = 5e-3;

impl DirectWorld {
    /// Returns whether the next step, whose contacts have been detected, is divided, and counts it.
    pub(super) fn divides_step(&mut self) -> bool {
        if !self.detector.has_round_shapes {
            return false;
        }
        if self.has_impact() {
            self.divided = DIVIDED;
        }
        let divided = self.divided > 0;
        self.divided = self.divided.saturating_sub(1);
        divided
    }

    /// Returns whether two surfaces meet within the step, faster than `IMPACT`.
    fn has_impact(&self) -> bool {
        self.touches.iter().any(|touch| {
            let pair = &self.pairs[touch.pair];
            let [first, second] = [pair.first, pair.second].map(|body| {
                let MovingBody { velocity, centre, .. } = &self.bodies[body.0];
                let turning: Vector3<f64> = velocity.fixed_rows::<3>(3).into();
                velocity.fixed_rows::<3>(0) + turning.cross(&(touch.point - centre))
            });
            let approach = (first - second).dot(&touch.normal);
            approach > IMPACT && touch.gap < approach * self.settings.step_s
        })
    }

    /// Takes a step in parts; the forces are the means over them.
    pub(super) fn divided_step(&mut self) -> Option<()> {
        let whole = self.settings.step_s;
        // Only driven bodies follow their paths.
        let path = |body: &MovingBody| [body.pose, body.target];
        let paths: Vec<[Pose; 2]> = self.bodies.iter().map(path).collect();
        let mut forces = vec![ContactForce::default(); self.forces.len()];
        self.settings.step_s = whole / PARTS as f64;
        let done = (1..=PARTS).try_for_each(|part| {
            if part > 1 {
                let step = self.settings.step_s;
                self.detector.detect(&self.bodies, step, &mut self.touches);
            }
            let share = part as f64 / PARTS as f64;
            for (body, [from, to]) in self.bodies.iter_mut().zip(&paths) {
                body.target = from.try_lerp_slerp(to, share, f64::EPSILON).unwrap_or(*to);
            }
            self.try_step()?;
            for (sum, force) in forces.iter_mut().zip(&self.forces) {
                sum.net += force.net / PARTS as f64;
                sum.normal_sum += force.normal_sum / PARTS as f64;
            }
            Some(())
        });
        self.settings.step_s = whole;
        self.forces = forces;
        done
    }
}
