//! Descent above the socket, shared by all offsets.

use super::Attempt;
use crate::{Ending, Stage};
use contact::scene::BodyId;
use input::units::MM;

/// Clearance above the socket at which the shared descent ends, m.
const SHARED_CLEARANCE: f64 = 0.3 * MM;
/// Clearance that must remain at the end of the shared descent, m: a fast move may overshoot.
const MIN_CLEARANCE: f64 = 0.25 * MM;

impl<'a> Attempt<'a> {
    /// Returns a copy that has descended until just before the plug could touch the socket at any offset or rotation
    /// about z. `None` if the search does not begin with a move until touch, fails in the air or descends too fast.
    pub fn descended(&self) -> Option<Attempt<'a>> {
        let phase =
            self.task.strategy.phases.iter().find(|phase| phase.stage != Stage::Approach)?;
        if phase.stage != Stage::Search || !matches!(phase.ending, Ending::Touch { .. }) {
            return None;
        }
        let mut copy = self.clone();
        copy.stage = phase.stage;
        let motion = copy.motion(phase);
        let mut steps = 0;
        while steps < copy.steps(motion.duration) && copy.clearance() > SHARED_CLEARANCE {
            steps += 1;
            copy.target = motion.at(steps as f64 * copy.world.step_s());
            copy.step().ok()?;
        }
        copy.begun = Some((motion, steps));
        (copy.clearance() > MIN_CLEARANCE).then_some(copy)
    }

    /// Returns the distance from the top of the socket to the lowest corner of the plug with its latch, along z, m.
    fn clearance(&self) -> f64 {
        let plug = [self.cell.plug].into_iter().chain(self.cell.latch);
        let lowest = plug.flat_map(|body| self.heights(body)).fold(f64::INFINITY, f64::min);
        lowest - self.heights(self.cell.socket).fold(f64::NEG_INFINITY, f64::max)
    }

    fn heights(&self, body: BodyId) -> impl Iterator<Item = f64> {
        let pose = self.world.pose(body);
        let geoms = &self.cell.scene.bodies[body.0].geoms;
        geoms.iter().flat_map(move |geom| {
            let place = pose * geom.pose;
            geom.shape.corners().into_iter().map(move |corner| (place * corner).z)
        })
    }
}
