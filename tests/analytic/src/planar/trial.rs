//! Outcome of an insertion and force over depth.

use super::path::{Insertion, Stop};
use super::wedging::wedges;
use super::{Assembly, V3};

/// End of an insertion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The tip reached its depth.
    Inserted,
    /// The force reached its limit with a tip edge not past its rim.
    Missed,
    /// The force reached its limit with both tip edges past the rims.
    Jammed,
}

/// Insertion from above the mouth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// Peg, hole, friction and springs.
    pub assembly: Assembly,
    /// Lateral position of the tip at the start, m.
    pub lateral: f64,
    /// Tilt at the start, rad.
    pub tilt: f64,
    /// Depth at which the peg is inserted, m.
    pub depth: f64,
    /// Force at which the insertion is given up, N.
    pub limit: f64,
}

/// Course of an insertion.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// End of it.
    pub outcome: Outcome,
    /// Depth of the tip, m, and force, N, after each step.
    pub forces: Vec<[f64; 2]>,
    /// Whether the peg could have been wedged on its way.
    pub could_wedge: bool,
    /// Number of snaps.
    pub snaps: usize,
}

impl Record {
    /// Returns whether both outcomes are possible, by the rule of `wedging`.
    pub fn indeterminate(&self) -> bool {
        self.could_wedge && self.outcome == Outcome::Inserted
    }
}

/// Tolerance of the height of a tip edge, m: more than the contacts of an engine yield.
const PAST: f64 = 0.05e-3;

impl Trial {
    /// Returns the outcome at the end pose: by depth, then by the core corner of the higher tip edge,
    /// which in a miss still lies above the core of its rim.
    pub fn classify(&self, pose: &V3) -> Outcome {
        let Assembly { peg, hole, support, .. } = &self.assembly;
        if -support.tip(pose).y >= self.depth {
            return Outcome::Inserted;
        }
        let outline = peg.outline();
        let heights = outline.corners().map(|i| support.place(pose, &outline.points[i]).y);
        match heights.fold(f64::NEG_INFINITY, f64::max) > -hole.radius - PAST {
            true => Outcome::Missed,
            false => Outcome::Jammed,
        }
    }

    /// Returns the target of the springs at the start, just above the mouth.
    pub fn start(&self) -> V3 {
        Insertion::above(self.assembly, self.lateral, self.tilt).target
    }

    /// Inserts the peg by steps of the drive, m.
    ///
    /// # Errors
    /// If the referee finds no equilibrium.
    pub fn run(&self, step: f64) -> Result<Record, Stop> {
        let mut insertion = Insertion::above(self.assembly, self.lateral, self.tilt);
        let (mut forces, mut could_wedge) = (Vec::new(), false);
        while insertion.depth() < self.depth && insertion.force() < self.limit {
            insertion.advance(step)?;
            could_wedge |= wedges(&insertion);
            forces.push([insertion.depth(), insertion.force()]);
        }
        let outcome = self.classify(&insertion.state.pose);
        Ok(Record { outcome, forces, could_wedge, snaps: insertion.snaps })
    }
}
