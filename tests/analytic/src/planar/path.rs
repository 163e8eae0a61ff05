//! Insertion by steps of the drive.

use super::equilibrium::Problem;
use super::feature::Geometry;
use super::modes::State;
use super::{Assembly, V2, V3};

/// Shortest step of the drive, m; where it has no equilibrium nearby, the peg snaps. A contact closes
/// from no farther away, so that the way through the air counts for no sliding.
const SHORTEST: f64 = 1e-9;
/// Way of the peg per step of the drive beyond which an equilibrium is not the next one.
const NEARBY: f64 = 10.0;
/// Resistance at the begin of a snap, as a multiple of the stiffness.
const VISCOSITY: f64 = 1e3;
/// Way of the peg in a step of a snap, m.
const SNAP: f64 = 5e-6;
/// Steps after which a snap has no end.
const SNAP_STEPS: usize = 5000;

/// Reason why an insertion cannot continue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// No equilibrium was found, nor an end of a snap.
    NoEquilibrium,
}

/// Peg on its way, driven along -z.
#[derive(Debug, Clone)]
pub struct Insertion {
    /// Peg, hole, friction and springs.
    pub assembly: Assembly,
    /// Outlines and features.
    pub geometry: Geometry,
    /// Pose at which the springs are at rest.
    pub target: V3,
    /// Present state.
    pub state: State,
    /// Number of snaps so far.
    pub snaps: usize,
}

impl Insertion {
    /// Places the unloaded peg with the middle of its tip at a point, tilted.
    pub fn new(assembly: Assembly, tip: V2, tilt: f64) -> Self {
        let target = assembly.support.pose(tip, tilt);
        let state = State { pose: target, contacts: Vec::new() };
        Insertion { assembly, geometry: Geometry::new(&assembly), target, state, snaps: 0 }
    }

    /// Places the unloaded peg so high above the mouth that it touches nothing.
    pub fn above(assembly: Assembly, lateral: f64, tilt: f64) -> Self {
        let height = assembly.peg.half_width * libm::sin(tilt.abs()) + 1e-6;
        Self::new(assembly, V2::new(lateral, height), tilt)
    }

    /// Returns the depth of the middle of the tip below the mouth, m.
    pub fn depth(&self) -> f64 {
        -self.assembly.support.tip(&self.state.pose).y
    }

    /// Returns the load of the springs on the compliance centre: lateral, axial (negative: into the
    /// hole), N, and moment, N m.
    pub fn load(&self) -> V3 {
        self.assembly.support.stiffness().component_mul(&(self.target - self.state.pose))
    }

    /// Returns the force that pushes the peg in, N.
    pub fn force(&self) -> f64 {
        -self.load().y
    }

    /// Moves the drive by a step, m, towards the hole, in parts where equilibria lie far apart.
    ///
    /// # Errors
    /// If no equilibrium is found.
    pub fn advance(&mut self, step: f64) -> Result<(), Stop> {
        let whole = self.target - V3::y() * step;
        let next = self.problem(whole, 0.0).step(NEARBY * step);
        if let Some(state) = next.filter(|state| step < SHORTEST || !self.lands(state)) {
            self.target = whole;
            self.state = state;
            return Ok(());
        }
        if step < SHORTEST {
            self.target = whole;
            return self.snap();
        }
        self.advance(step / 2.0)?;
        self.advance(step / 2.0)
    }

    /// Returns whether contacts of a next state are still open.
    fn lands(&self, next: &State) -> bool {
        let gap = |feature| self.geometry.touch(feature, &self.state.pose).gap;
        next.contacts.iter().any(|contact| gap(contact.feature) > SHORTEST)
    }

    /// Moves the peg, against a resistance that fades, to its next equilibrium.
    fn snap(&mut self) -> Result<(), Stop> {
        self.snaps += 1;
        let mut viscosity = VISCOSITY;
        for _ in 0..SNAP_STEPS {
            if let Some(state) = self.problem(self.target, 0.0).step(SNAP) {
                self.state = state;
                return Ok(());
            }
            match self.problem(self.target, viscosity).step(SNAP) {
                Some(state) => {
                    self.state = state;
                    viscosity /= 2.0;
                }
                None => viscosity *= 4.0,
            }
        }
        Err(Stop::NoEquilibrium)
    }

    fn problem(&self, target: V3, viscosity: f64) -> Problem<'_> {
        let Insertion { assembly, geometry, state, .. } = self;
        Problem { assembly, geometry, old: state, target, viscosity }
    }
}
